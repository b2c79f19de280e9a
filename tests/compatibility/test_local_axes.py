"""Supports and loads in local axes without *TRANSFORM: a block on an inclined plane."""

import numpy as np
import pytest
from flat_twin import Block, element_lines, id_lines, last_field, node_lines, turn

YOUNG, POISSON, PRESSURE, SETTLEMENT = 2e10, 0.2, 3e6, 2e-3
BLOCK = Block((2, 2, 3), (2.0, 3.0, 4.0))
AXIS, ANGLE = (1.0, 2.0, 3.0), 37.0
PLANE = 1000  # a node without elements: its displacement 1 is that of the plane along its normal


def equation(*terms: tuple[str, int, float]) -> str:
    return f"{len(terms)}\n" + "".join(f"{n}, {d}, {c:.17g}\n" for n, d, c in terms)


def deck() -> tuple[str, np.ndarray]:
    """The deck, and the rows of local axes (x, y along the plane, z its normal)."""
    axes = turn(np.eye(3), np.zeros(3), AXIS, ANGLE)
    x = turn(BLOCK.nodes, np.zeros(3), AXIS, ANGLE)
    base = BLOCK.nodes_at(2, 0.0)
    corner, edge = 1, 1 + BLOCK.n[0]  # at the origin, and at the end of the local x axis
    along, normal = axes[0], axes[2]
    inner = [n for n in base if n not in (corner, edge)]
    text = f"""\
*NODE
{node_lines(x)}
{PLANE}, 0., 0., 0.
*ELEMENT, TYPE=C3D8I, ELSET=ALL
{element_lines(BLOCK.solids)}
*NSET, NSET=ROLLERS
{id_lines(inner)}
*ELSET, ELSET=CAP
{id_lines(BLOCK.layer(top=True))}
*SOLID SECTION, ELSET=ALL, MATERIAL=ROCK
*MATERIAL, NAME=ROCK
*ELASTIC
{YOUNG}, {POISSON}
*EQUATION
"""
    # On the plane: n . u = settlement of the plane, the largest component of n first.
    order = sorted(range(3), key=lambda i: -abs(normal[i]))
    on_plane = [("ROLLERS", i + 1, normal[i]) for i in order]
    text += equation(*on_plane, (str(PLANE), 1, -1.0))
    # The corner goes with the plane: u = settlement n.
    for i in range(3):
        text += equation((str(corner), i + 1, 1.0), (str(PLANE), 1, -normal[i]))
    # The edge slides along the local x axis: u = settlement n + s t, with s at the largest t.
    order = sorted(range(3), key=lambda i: -abs(along[i]))
    lead = order[0]
    for i in order[1:]:
        ratio = along[i] / along[lead]
        rest = normal[i] - ratio * normal[lead]
        text += equation(
            (str(edge), i + 1, 1.0), (str(edge), lead + 1, -ratio), (str(PLANE), 1, -rest)
        )
    text += f"""\
*BOUNDARY
{PLANE}, 2, 3
*STEP
*STATIC
*BOUNDARY
{PLANE}, 1, 1, {-SETTLEMENT}
*DLOAD
CAP, P2, {PRESSURE}
*NODE FILE
U, RF
*END STEP
"""
    return text, axes


def test_a_block_on_an_inclined_plane(keyway):
    """Uniaxial pressure: u = (nu p x, nu p y, -p z)/E in local axes, and the plane settles. The
    plane carries p A. Round-off of the direct solver is far below 1e-10."""
    text, axes = deck()
    run = keyway(text)
    x, y, z = BLOCK.nodes.T
    local = PRESSURE / YOUNG * np.stack([POISSON * x, POISSON * y, -z], axis=1)
    local[:, 2] -= SETTLEMENT
    moved, force = last_field(run, "U"), last_field(run, "RF")
    is_solid = run.results.node_id != PLANE
    assert moved[is_solid] == pytest.approx(local @ axes, abs=1e-10 * SETTLEMENT)
    thrust = PRESSURE * BLOCK.size[0] * BLOCK.size[1]
    assert force[~is_solid][0, 0] == pytest.approx(thrust, rel=1e-9)
