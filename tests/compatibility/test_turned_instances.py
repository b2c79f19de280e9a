"""Two instances of a part, both turned, with a joint, cracks, loads and supports of the instances,
shaken: equal to their flat twin."""

import numpy as np
from flat_twin import Block, element_lines, id_lines, last_field, node_lines, turn
from test_parts import CONCRETE

BLOCK = Block((2, 2, 2), (2.0, 3.0, 1.0))
SHIFT = (0.0, 0.0, 1.0)
AXIS = ((0.5, 0.5, 0.0), (1.5, 2.5, 3.0))  # two points
ANGLE = 37.0
SIDE = range(1, len(BLOCK.solids) + 1, 2)
CARDS = f"""\
*Surface Interaction, name=Rock
*Surface Behavior, pressure-overclosure=LINEAR
1e11
*Friction
0.8, 1e11
*Amplitude, name=Quake, definition=EQUALLY SPACED, fixed interval=0.02
0., 3., -5., 4., -2., 0.
*Material, name=Concrete
*Density
2400.
*Elastic
2e10, 0.2
{CONCRETE.replace("50000., 0.", "100000., 0.").replace("500., 0.0003", "1000., 0.0003")}"""
STEPS = """\
*Step, name=Weight, nlgeom=NO
*Static
0.5, 1., 1e-05, 1.
*Dload
{one}, GRAV, 9.81, {down}
{two}, GRAV, 9.81, {down}
*Dsload
{side}, P, 20000.
*Cload
{node}, 1, 500.
*End Step
*Step, name=Quake, nlgeom=NO
*Dynamic, direct, alpha=-0.05, initial=NO
0.01, 0.2
*Base Motion, dof=1, amplitude=Quake, scale=2.
*Output, history, frequency=1
*Node Output, nset={top}
U
*Output, field, freq=5
*Node Output
U
*Element Output
DAMAGET
*End Step
"""


def down() -> str:
    """The local z axis downwards: the weight presses the joint in any position."""
    axis = np.subtract(AXIS[1], AXIS[0])
    return ", ".join(f"{x:.17g}" for x in turn(np.array([[0.0, 0.0, -1.0]]), 0.0, axis, ANGLE)[0])


def assembly() -> str:
    axis = ", ".join(str(x) for point in AXIS for x in point)
    corner = BLOCK.nodes_at(2, 1.0)[-1]
    steps = STEPS.format(
        one="Lower-1.All",
        two="Upper-1.All",
        down=down(),
        side="Upper-1.Side",
        node=f"Upper-1.{corner}",
        top="Upper-1.Top",
    )
    return f"""\
*Heading
*Part, name=Block
*Node
{node_lines(BLOCK.nodes)}
*Element, type=C3D8
{element_lines(BLOCK.solids)}
*Nset, nset=Base
{id_lines(BLOCK.nodes_at(2, 0.0))}
*Nset, nset=Top, internal
{id_lines(BLOCK.nodes_at(2, 1.0))}
*Elset, elset=All, generate
  1, {len(BLOCK.solids)}, 1
*Elset, elset=_Side_S6, internal
{id_lines(SIDE)}
*Surface, type=ELEMENT, name=Side
_Side_S6, S6
*Elset, elset=_Roof_S2, internal
{id_lines(BLOCK.layer(top=True))}
*Surface, type=ELEMENT, name=Roof
_Roof_S2, S2
*Elset, elset=_Sole_S1, internal
{id_lines(BLOCK.layer(top=False))}
*Surface, type=ELEMENT, name=Sole
_Sole_S1, S1
*Solid Section, elset=All, material=Concrete
,
*End Part
*Assembly, name=Assembly
*Instance, name=Lower-1, part=Block
0., 0., 0.
{axis}, {ANGLE}
*End Instance
*Instance, name=Upper-1, part=Block
{", ".join(map(str, SHIFT))}
{axis}, {ANGLE}
*End Instance
*End Assembly
{CARDS}*Contact Pair, interaction=Rock, small sliding, type=SURFACE TO SURFACE
Upper-1.Sole, Lower-1.Roof
*Boundary
Lower-1.Base, ENCASTRE
{steps}"""


def turned() -> np.ndarray:
    """Coordinates of both instances."""
    axis = np.subtract(AXIS[1], AXIS[0])
    moved = [turn(BLOCK.nodes + s, np.array(AXIS[0]), axis, ANGLE) for s in (0.0, SHIFT)]
    return np.concatenate(moved)


def flat(x: np.ndarray) -> str:
    """The model without parts, with these coordinates."""
    corner = BLOCK.nodes_at(2, 1.0)[-1]
    steps = STEPS.format(
        one="ONE", two="TWO", down=down(), side="SIDE", node=100 + corner, top="TOP"
    )
    return f"""\
*NODE
{node_lines(x[: len(x) // 2])}
{node_lines(x[len(x) // 2 :], 101)}
*ELEMENT, TYPE=C3D8B, ELSET=ONE
{element_lines(BLOCK.solids)}
*ELEMENT, TYPE=C3D8B, ELSET=TWO
{element_lines(BLOCK.solids + 100, 101)}
*NSET, NSET=BASE
{id_lines(BLOCK.nodes_at(2, 0.0))}
*NSET, NSET=TOP
{id_lines(100 + n for n in BLOCK.nodes_at(2, 1.0))}
*ELSET, ELSET=SIDE
{id_lines(100 + e for e in SIDE)}
*SURFACE, NAME=SIDE
SIDE, S6
*ELSET, ELSET=ROOF
{id_lines(BLOCK.layer(top=True))}
*SURFACE, NAME=ROOF
ROOF, S2
*ELSET, ELSET=SOLE
{id_lines(100 + e for e in BLOCK.layer(top=False))}
*SURFACE, NAME=SOLE
SOLE, S1
*SOLID SECTION, ELSET=ONE, MATERIAL=CONCRETE
*SOLID SECTION, ELSET=TWO, MATERIAL=CONCRETE
{CARDS}*CONTACT PAIR, INTERACTION=ROCK, SMALL SLIDING, TYPE=SURFACE TO SURFACE
SOLE, ROOF
*BOUNDARY
BASE, 1, 3
{steps}"""


def test_turned_instances_equal_their_flat_twin(keyway):
    parts = keyway(assembly(), name="parts")
    # Rotation by two programs: round-off of coordinates of 3 m.
    assert np.abs(parts.results.x - turned()).max() < 2e-15
    # The twin has the same bits, since cracks and contact multiply round-off (here by 1e5).
    twin = keyway(flat(parts.results.x), name="flat")
    assert last_field(parts, "DAMAGET").max() > 0.02
    joint = parts.json["joints"]["CONTACT1"]
    assert min(joint[key]["anywhere"]["value"] for key in ("opening", "slip")) > 1e-6
    for name in ("U", "DAMAGET"):
        assert np.array_equal(last_field(parts, name), last_field(twin, name))
    a, b = parts.csv("node_UPPER-1.TOP"), twin.csv("node_TOP")
    assert all(np.array_equal(a[name], b[name]) for name in ("time", "U1", "U2", "U3"))
    assert parts.json["joints"] == twin.json["joints"]
    assert parts.json["steps"][1]["energy"] == twin.json["steps"][1]["energy"]
