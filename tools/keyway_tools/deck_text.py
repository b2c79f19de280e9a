"""Pieces of deck text: nodes, elements, sets, surfaces."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .mesh_data import BrickMesh

IDS_A_LINE = 12


def comment(text: str) -> str:
    """Lines of text as comment lines of a deck."""
    return "\n".join(f"** {line}".rstrip() for line in text.splitlines())


def node_lines(x: np.ndarray) -> Iterable[str]:
    """Data lines of *NODE; reading gives exactly the same numbers."""
    for number, point in enumerate(x.tolist(), start=1):
        yield f"{number}, {point[0]!r}, {point[1]!r}, {point[2]!r}"


def element_lines(first: int, elements: np.ndarray) -> Iterable[str]:
    """Data lines of *ELEMENT for elements numbered from `first`."""
    for number, nodes in enumerate((elements + 1).tolist(), start=first):
        yield f"{number}, " + ", ".join(map(str, nodes))


def id_lines(positions: np.ndarray) -> Iterable[str]:
    """Data lines of a set."""
    ids = (np.sort(positions) + 1).tolist()
    for start in range(0, len(ids), IDS_A_LINE):
        yield ", ".join(map(str, ids[start : start + IDS_A_LINE]))


def mesh_deck(mesh: BrickMesh, element_types: dict[str, str], header: str) -> str:
    """Mesh part of a deck: *NODE, *ELEMENT by set, *ELSET, *NSET, *SURFACE.

    Bricks are numbered from 1 in the order of the mesh, joint elements and then quads after them.
    """
    lines = [comment(header)] if header else []
    lines += ["*NODE", *node_lines(mesh.x)]
    for name, members in mesh.brick_sets.items():
        lines.append(f"*ELEMENT, TYPE={element_types[name]}, ELSET={name}")
        lines.extend(element_lines(int(members[0]) + 1, mesh.bricks[members]))
    for name, members in mesh.joint_sets.items():
        lines.append(f"*ELEMENT, TYPE=JOINT8, ELSET={name}")
        first = len(mesh.bricks) + int(members[0]) + 1
        lines.extend(element_lines(first, mesh.joints[members]))
    for name, members in mesh.quad_sets.items():
        lines.append(f"*ELEMENT, TYPE=IFACE4, ELSET={name}")
        first = len(mesh.bricks) + len(mesh.joints) + int(members[0]) + 1
        lines.extend(element_lines(first, mesh.quads[members]))
    for name, members in mesh.element_sets.items():
        lines.append(f"*ELSET, ELSET={name}")
        lines.extend(id_lines(members))
    for name, members in mesh.node_sets.items():
        lines.append(f"*NSET, NSET={name}")
        lines.extend(id_lines(members))
    for name, faces in mesh.surfaces.items():
        lines.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
        lines.extend(f"{brick + 1}, S{face}" for brick, face in faces)
    return "\n".join(lines) + "\n"


def small_deck(head: str, mesh: BrickMesh, element_type: str, cards: str) -> str:
    """Header, mesh, then the cards of materials and steps."""
    name = next(iter(mesh.brick_sets))
    return comment(head) + "\n" + mesh_deck(mesh, {name: element_type}, "") + cards.lstrip("\n")
