"""The dam of a deck: its nodes, its two faces, and how deep each node lies between them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyvista as pv

from ..deck_bytes import capitals
from ..mesh_data import BRICK_FACES
from ..study.deck_cards import Deck, fields_of, read_deck
from ..study.mesh_sets import MeshSets, element_rows, read_sets
from ..upright import axes_with_up_last

FACE_NAMES = [f"S{number}" for number in range(1, len(BRICK_FACES) + 1)]
TALLEST = 500.0  # [m]; the tallest dams have 335 m
CLOSE = 1e-9  # of the dam's size: round-off of coordinates


@dataclass(frozen=True)
class Dam:
    """Nodes of the dam by their numbers in the deck; positions count from 0."""

    numbers: np.ndarray  # (nodes)
    x: np.ndarray  # (nodes, 3) [m]; the last axis points up
    bricks: np.ndarray  # (bricks, 8) positions
    upstream: list[list[int]]  # faces: positions of three or four nodes
    downstream: list[list[int]]
    others: np.ndarray  # numbers of all other nodes of the deck
    sources: set[Path]  # files of the deck
    axes: list[int]  # of the deck, from 0, for the axes of x


@dataclass(frozen=True)
class Place:
    """Where a node lies in the thickness."""

    depth: np.ndarray  # below the upstream face [m]
    thickness: np.ndarray  # [m]
    z_upstream: np.ndarray  # height of the nearest point of the upstream face [m]
    z_downstream: np.ndarray


def read_dam(path: Path, dam: str, upstream: str, downstream: str, up: int | None = None) -> Dam:
    """The dam of a deck by the names of its elements and of its faces. Raises ValueError.

    `up` is the axis 1..3 that points up; None: as in *RESERVOIR.
    """
    if not path.is_file():
        raise ValueError(f"there is no deck '{path}'")
    deck = read_deck(path)
    if deck.has("PART") or deck.has("INSTANCE"):
        what = "the mesh has parts and instances (*PART)"
        raise ValueError(f"{path}: {what}; expected *NODE and *ELEMENT outside of parts")
    sets = read_sets(deck)
    if capitals(dam) not in sets.element_sets:
        raise ValueError(
            f"{path}: no set of elements '{dam}'; expected one of {_list(sets.element_sets)}"
        )
    elements = _bricks(deck, sets.element_sets[capitals(dam)])
    if not elements:
        raise ValueError(f"{path}: set '{dam}' has no element of 8 nodes")
    numbers = np.unique(np.concatenate([np.array(nodes) for nodes in elements.values()]))
    position = {int(number): place for place, number in enumerate(numbers)}
    faces = [_face(path, deck, sets, name, elements) for name in (upstream, downstream)]
    common = {frozenset(face) for face in faces[0]} & {frozenset(face) for face in faces[1]}
    if common:
        names = f"'{upstream}' (upstream) and '{downstream}' (downstream)"
        raise ValueError(
            f"{path}: {len(common)} faces belong to {names}; expected the two opposite faces"
        )
    axes = axes_with_up_last((up or _up_of(path, deck)) - 1)
    x = np.array([sets.nodes[int(number)] for number in numbers])[:, axes]
    height = float(np.ptp(x[:, -1]))
    if height > TALLEST:
        what = f"the dam is {height:.5g} high along {'xyz'[axes[-1]]}"
        raise ValueError(f"{path}: {what}; expected lengths in m, and no dam above {TALLEST:g} m")
    return Dam(
        numbers,
        x,
        np.array([[position[n] for n in nodes] for nodes in elements.values()]),
        *([[position[n] for n in dict.fromkeys(face)] for face in own] for own in faces),
        np.array(sorted(set(sets.nodes) - set(position)), dtype=int),
        deck.sources,
        axes,
    )


def _up_of(path: Path, deck: Deck) -> int:
    """UP of the first reservoir, 3 where there is none or none is given. Raises ValueError."""
    card = next(deck.of("RESERVOIR"), None)
    word = (card.value("UP") if card else "") or "3"
    if word not in ("1", "2", "3"):
        raise ValueError(f"{path}: *RESERVOIR: UP={word}; expected 1, 2 or 3")
    return int(word)


def _list(names) -> str:
    return ", ".join(sorted(names)[:12]) or "none"


def _bricks(deck: Deck, wanted: set[int]) -> dict[int, list[int]]:
    """Nodes of the solids of a set, by the number of the element."""
    found = {}
    for card in deck.of("ELEMENT"):
        if not card.value("TYPE").startswith("C3D8"):
            continue
        found |= {number: nodes for number, nodes in element_rows(card) if number in wanted}
    return found


def _face(
    path: Path, deck: Deck, sets: MeshSets, name: str, elements: dict[int, list[int]]
) -> list[list[int]]:
    """Node numbers of each face of a surface, or of the faces whose nodes all are in a node set."""
    card = next((c for c in deck.of("SURFACE") if c.value("NAME") == capitals(name)), None)
    found: list[list[int]] = []
    if card is not None:
        for line in card.lines:
            label, face = (item.strip() for item in [*fields_of(line), ""][:2])
            if face.upper() not in FACE_NAMES:
                known = f"{', '.join(FACE_NAMES[:-1])} or {FACE_NAMES[-1]}"
                raise ValueError(f"{path}: surface '{name}': found '{line}'; expected {known}")
            corners = BRICK_FACES[FACE_NAMES.index(face.upper())]
            own = [e for e in sets.elements_of(label) if e in elements]
            found += [[elements[e][k] for k in corners] for e in own]
    elif capitals(name) in sets.node_sets:
        kept = sets.node_sets[capitals(name)]
        for nodes in elements.values():
            faces = [[nodes[k] for k in corners] for corners in BRICK_FACES]
            found += [face for face in faces if len(set(face)) > 2 and kept.issuperset(face)]
    else:
        known = [c.value("NAME") for c in deck.of("SURFACE")] + list(sets.node_sets)
        raise ValueError(f"{path}: no surface or node set '{name}'; expected one of {_list(known)}")
    if not found:
        raise ValueError(f"{path}: '{name}' has no face of the dam's elements")
    return found


def place_nodes(dam: Dam) -> Place:
    """Depth and thickness at each node by the nearest points of both faces."""
    near, far = (_nearest(dam, faces) for faces in (dam.upstream, dam.downstream))
    depth = np.linalg.norm(dam.x - near, axis=1)
    rest = np.linalg.norm(dam.x - far, axis=1)
    return Place(depth, depth + rest, near[:, 2], far[:, 2])


def nodes_without_thickness(dam: Dam, place: Place) -> np.ndarray:
    """Positions of the nodes at which the faces meet.

    Raises ValueError where one of them is below the crest: then the faces are not opposite ones.
    """
    size = float(np.ptp(dam.x, axis=0).max())
    found = np.flatnonzero(place.thickness <= CLOSE * size)
    low = found[dam.x[found, 2] < dam.x[:, 2].max() - CLOSE * size]
    if len(low):
        x, y, z = dam.x[low[0], np.argsort(dam.axes)]
        raise ValueError(
            f"{len(low)} nodes lie on both faces, as node {dam.numbers[low[0]]} at ({x:.5g}, "
            f"{y:.5g}, {z:.5g}) m: the dam has no thickness there; expected --upstream and "
            "--downstream to be opposite faces, which meet at the crest at most"
        )
    return found


def first_layer(dam: Dam, place: Place) -> float:
    """Largest thickness of the elements at the upstream face [m]."""
    wet = np.unique(np.concatenate(dam.upstream).astype(int))
    at_face = np.isin(dam.bricks, wet).sum(axis=1) >= 3
    return float(place.depth[dam.bricks[at_face]].max())


def _nearest(dam: Dam, faces: list[list[int]]) -> np.ndarray:
    """The nearest point of a face to each node, the node itself where it is one of the face."""
    cells = np.concatenate([[len(face), *face] for face in faces])
    skin = pv.PolyData(dam.x, cells).triangulate()
    point = np.asarray(skin.find_closest_cell(dam.x, return_closest_point=True)[1])
    own = np.unique(np.concatenate(faces).astype(int))
    point[own] = dam.x[own]
    return point
