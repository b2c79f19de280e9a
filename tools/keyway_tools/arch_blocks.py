"""An arch dam whose blocks have different meshes, which meet at joints and on the rock.

from keyway_tools.arch_blocks import BlockOptions, build_block_dam
mesh = build_block_dam(ArchShape(), DamOptions(), BlockOptions(fine=(2,)))

All blocks are cut from one lattice (arch_lattice), so that joint faces and bases coincide for any
meshes. Blocks of one mesh keep the classical joint of JOINT8 elements.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from .arch_dam import DamOptions
from .arch_lattice import Lattice, Part, PartMesh, in_cells
from .arch_rock import build_rock
from .arch_shape import ArchShape
from .arch_stations import TooCoarseError, joint_stations, place_stations
from .mesh_data import BrickMesh
from .outlets.options import OutletOptions
from .outlets.part import OutletPart

FINE = PartMesh(refine=2, thick=6)
JOINS = ("auto", "auto-chain", "matching", "surfaces", "chain")


@dataclass(frozen=True)
class BlockOptions:
    """Which blocks are finer, and how meshes are joined."""

    refine: int = 1  # elements along each side of a cell in ordinary blocks and on the rock
    fine: tuple[int, ...] = ()  # blocks with a separate mesh, from 1 at the left end
    fine_mesh: PartMesh = FINE
    # of single blocks: meshes other than fine_mesh
    own_meshes: dict[int, PartMesh] = field(default_factory=dict, hash=False)
    outlets: OutletOptions | None = None  # in one of the fine blocks
    fine_above: float = 0.0  # share of the height above which they are finer
    # auto: JOINT8 between equal meshes, surfaces between different ones (auto-chain: the chain)
    join: str = "auto"
    # side of a joint on surfaces: fine or coarse (equal meshes: right, left). A block of two parts
    # is never the slave: its nodes along the tie between them follow others
    slave: str = "fine"
    is_tied: bool = False  # tie every block to the rock, also with equal meshes

    def mesh_of(self, block: int) -> PartMesh:
        """The mesh of a fine block."""
        return self.own_meshes.get(block, self.fine_mesh)

    def __post_init__(self) -> None:
        if self.join not in JOINS:
            raise ValueError(f"join must be one of {', '.join(JOINS)}, found '{self.join}'")
        if self.slave not in ("fine", "coarse"):
            raise ValueError(f"slave must be fine or coarse, found '{self.slave}'")
        if not 0.0 <= self.fine_above < 1.0:
            raise ValueError(f"--fine-above {self.fine_above:g}: expected 0 or more and below 1")


@dataclass
class Block:
    """The parts of a block from the lowest to the highest."""

    number: int
    parts: list[Part]
    is_fine: bool
    is_tied: bool

    def faces_to(self, side: str) -> list[tuple[int, int]]:
        """Faces LEFT, RIGHT, UPSTREAM or DOWNSTREAM of all parts."""
        return [face for part in self.parts for face in part.faces.get(side, [])]

    def has_mesh_of(self, other: Block) -> bool:
        """True if both blocks have one part each, with equal meshes."""
        both = [part.mesh for block in (self, other) for part in block.parts]
        return len(both) == 2 and both[0] == both[1]


class Assembly:
    """A mesh that grows; nodes may be replaced by others at the same place."""

    def __init__(self) -> None:
        self.x: list[np.ndarray] = []
        self.num_nodes = 0
        self.mesh = BrickMesh(np.zeros((0, 3)), np.zeros((0, 8), int), np.zeros((0, 8), int))
        self.replaced: dict[int, int] = {}

    def add_nodes(self, x: np.ndarray) -> np.ndarray:
        """Append nodes; their numbers."""
        self.x.append(x)
        self.num_nodes += len(x)
        return np.arange(self.num_nodes - len(x), self.num_nodes)

    def add_part(self, part: Part) -> None:
        """Append a part; its faces then refer to bricks of the whole mesh."""
        first = len(self.mesh.bricks)
        self.add_nodes(part.x)
        self.mesh.bricks = np.concatenate((self.mesh.bricks, part.bricks))
        for name, faces in part.faces.items():
            part.faces[name] = [(brick + first, face) for brick, face in faces]

    def merge(self, nodes: np.ndarray, into: np.ndarray) -> None:
        """Replace nodes by others."""
        for old, new in zip(nodes.ravel().tolist(), into.ravel().tolist(), strict=True):
            self.replaced[old] = new

    def number_of(self) -> np.ndarray:
        """Final number of every node before the replacement; unused ones are dropped."""
        target = np.arange(self.num_nodes)
        for old, new in self.replaced.items():
            last = new
            while last in self.replaced:
                last = self.replaced[last]
            target[old] = last
        kept = np.unique(target)
        number = np.full(self.num_nodes, -1)
        number[kept] = np.arange(len(kept))
        return number[target]


def build_block_dam(shape: ArchShape, dam: DamOptions, options: BlockOptions) -> BrickMesh:
    """The whole mesh; left-right symmetric when the blocks are."""
    stations = place_stations(shape, dam.num_arc, dam.num_height, dam.num_bottom)
    lattice = Lattice(shape, stations)
    joints = joint_stations(shape, stations, dam.num_joints, dam.joint_places)
    ends = [-stations.count, *joints, stations.count]
    whole = Assembly()
    base = PartMesh(options.refine, dam.num_thick)
    blocks = _build_blocks(whole, lattice, ends, base, options, dam.rock is not None)
    mesh = whole.mesh
    mesh.brick_sets["DAM"] = np.arange(len(mesh.bricks))
    for side in ("UPSTREAM", "DOWNSTREAM"):
        mesh.surfaces[side] = [face for block in blocks for face in block.faces_to(side)]
    for left, right in pairwise(blocks):
        _join(whole, left, right, options)
    feet = [_add_foot(whole, lattice, base)] if dam.rock else []
    for block in blocks:
        _rest_on_rock(whole, block, feet, base)
    number = whole.number_of()
    mesh.x = np.zeros((number.max() + 1, 3))
    mesh.x[number[::-1]] = np.concatenate(whole.x)[::-1]
    mesh.bricks, mesh.joints, mesh.quads = (
        number[e] for e in (mesh.bricks, mesh.joints, mesh.quads)
    )
    for name, members in mesh.node_sets.items():
        mesh.node_sets[name] = np.unique(number[members])
    _name_nodes(mesh, shape)
    if dam.rock is None:
        mesh.node_sets["FIXED"] = mesh.node_sets["ABUTMENT"]
    else:
        foot = number[feet[0]]
        build_rock(mesh, foot, shape, dam.rock)
        _name_ground(mesh, blocks, foot, base)
    return mesh


def _build_blocks(
    whole: Assembly,
    lattice: Lattice,
    ends: list[int],
    base: PartMesh,
    options: BlockOptions,
    has_rock: bool,
) -> list[Block]:
    """All blocks, from the left end to the right."""
    unknown = [b for b in options.fine if not 1 <= b < len(ends)]
    if unknown:
        raise ValueError(f"fine blocks must lie in 1..{len(ends) - 1}, found {unknown[0]}")
    cut = round(options.fine_above * lattice.top)
    slot = lattice.stations.foot_slot
    fixed = max((int(slot[abs(joint)]) for joint in ends[1:-1]), default=0)
    blocks = []
    for number, columns in enumerate(pairwise(ends), start=1):
        is_fine = number in options.fine
        own = options.mesh_of(number) if is_fine else base
        layers = [(0, lattice.top, own)]
        if is_fine and cut > 0:
            foot = max(int(slot[abs(c)]) for c in columns)
            _check_cut(number, foot, cut, lattice.top, options.fine_above)
            layers = [(0, cut, base), (cut, lattice.top, own)]
        outlets = options.outlets if options.outlets and options.outlets.block == number else None
        parts = []
        for low, high, mesh in layers:
            stretch = lattice, mesh, columns, (low, high), fixed, whole.num_nodes
            is_pierced = outlets and high == lattice.top
            parts.append(OutletPart(outlets, *stretch) if is_pierced else Part(*stretch))
            whole.add_part(parts[-1])
        lowest = layers[0][2]
        differs = (lowest.refine, lowest.thick) != (base.refine, base.thick)
        climbs = max(int(slot[abs(c)]) for c in columns) > fixed
        differs = differs or (lowest.shift != 0.0 and climbs)
        blocks.append(Block(number, parts, is_fine, has_rock and (options.is_tied or differs)))
        if len(parts) == 2:
            _tie_lift(whole.mesh, number, parts)
    return blocks


def _check_cut(number: int, foot: int, cut: int, top: int, share: float) -> None:
    """Raises ValueError for a block that meets the rock where it is to be finer, or ends there."""
    if cut >= top:
        raise TooCoarseError(
            f"--fine-above {share:g}: block {number} has no level of {top} above that; expected a "
            "smaller --fine-above or more --levels"
        )
    if foot > cut:
        # levels are rounded to elements: a finer mesh may help by a level or two
        raise (TooCoarseError if foot - cut <= 2 and foot < top else ValueError)(
            f"block {number} meets the rock at level {foot} of {top}, above level {cut}, where it "
            "is to be finer; expected "
            + (
                "a block between two joints"
                if foot == top
                else f"--fine-above {foot / top:.2f} or more"
            )
        )


def _tie_lift(mesh: BrickMesh, number: int, parts: list[Part]) -> None:
    """The tie between the lower and the finer upper part of a block."""
    names = f"LIFT{number}_FINE", f"LIFT{number}_COARSE"
    mesh.surfaces[names[0]] = parts[1].faces["BASE"]
    mesh.surfaces[names[1]] = parts[0].faces["TOP"]
    mesh.ties[f"LIFT{number}"] = names


def _join(whole: Assembly, left: Block, right: Block, options: BlockOptions) -> None:
    """The joint between two neighbours."""
    name = f"JOINT{left.number}"
    is_equal = left.has_mesh_of(right)
    join = options.join
    if join.startswith("auto"):
        different = "chain" if join == "auto-chain" else "surfaces"
        join = "matching" if is_equal else different
    if join == "matching":
        if not is_equal:
            raise ValueError(f"{name}: JOINT8 elements need equal meshes on both sides")
        _join_by_elements(whole, left, right, name)
        return
    slave, master = (right, left) if right.is_fine or not left.is_fine else (left, right)
    side = {left.number: "RIGHT", right.number: "LEFT"}
    if join == "chain":
        _join_by_chain(whole, slave, master, side, name)
        return
    if options.slave == "coarse" or len(slave.parts) > 1:
        slave, master = master, slave
    names = f"{name}_SLAVE", f"{name}_MASTER"
    for surface, block in zip(names, (slave, master), strict=True):
        whole.mesh.surfaces[surface] = block.faces_to(side[block.number])
    whole.mesh.surface_joints[name] = names
    _name_crest(whole, slave, side[slave.number], name)


def _name_crest(whole: Assembly, block: Block, side: str, name: str) -> None:
    """Nodes at the crest of a joint: downstream and upstream edge."""
    part = block.parts[-1]
    line = part.nodes[part.left if side == "LEFT" else part.right, part.top]
    whole.mesh.node_sets[f"{name}_CREST"] = line[[0, -1]]


def _add_joint_elements(mesh: BrickMesh, name: str, master: np.ndarray, slave: np.ndarray) -> None:
    first = len(mesh.joints)
    mesh.joints = np.concatenate((mesh.joints, np.hstack((master, slave))))
    mesh.joint_sets[name] = np.arange(first, len(mesh.joints))


def _join_by_elements(whole: Assembly, one: Block, other: Block, name: str) -> None:
    """The classical joint: JOINT8 between equal faces; blocks not tied share their foot row."""
    left, right = one.parts[0], other.parts[0]
    _add_joint_elements(whole.mesh, name, left.side(left.right), right.side(right.left))
    foot = left.foot(left.right)
    if not (one.is_tied and other.is_tied):
        whole.merge(right.nodes[right.left, foot], left.nodes[left.right, foot])
    line = left.nodes[left.right, left.top]
    whole.mesh.node_sets[f"{name}_CREST"] = line[[0, -1]]


def _join_by_chain(
    whole: Assembly, fine: Block, coarse: Block, side: dict[int, str], name: str
) -> None:
    """The paper's chain: fine face, penalty, quads with own nodes, JOINT8, coarse face."""
    mesh = whole.mesh
    if len(coarse.parts) > 1:
        raise ValueError(f"{name}: a chain needs one mesh on its coarse side")
    part = coarse.parts[0]
    station = part.left if side[coarse.number] == "LEFT" else part.right
    faces = part.side(station)
    nodes = np.unique(faces)
    x = np.concatenate(whole.x)[nodes]
    own = whole.add_nodes(x)[np.searchsorted(nodes, faces)]
    quads = f"IFACE{name.removeprefix('JOINT')}"
    mesh.quad_sets[quads] = np.arange(len(mesh.quads), len(mesh.quads) + len(own))
    mesh.quads = np.concatenate((mesh.quads, own))
    # the coarse face is the master; its normal points to the quads
    order = slice(None) if side[coarse.number] == "RIGHT" else slice(None, None, -1)
    _add_joint_elements(mesh, name, faces[:, order], own[:, order])
    mesh.surfaces[f"{name}_FINE"] = fine.faces_to(side[fine.number])
    mesh.interfaces[quads] = (quads, f"{name}_FINE")
    _name_crest(whole, coarse, side[coarse.number], name)


def _add_foot(whole: Assembly, lattice: Lattice, base: PartMesh) -> np.ndarray:
    """Nodes on which the rock is built: shape (stations, thickness + 1)."""
    end = lattice.stations.count * base.refine
    share = np.linspace(0.0, 1.0, base.thick + 1)
    lines = [
        lattice.line(
            in_cells(i, base.refine), in_cells(lattice.foot(i, base.refine), base.refine), share
        )
        for i in range(-end, end + 1)
    ]
    return whole.add_nodes(np.concatenate(lines)).reshape(len(lines), -1)


def _rest_on_rock(whole: Assembly, block: Block, feet: list[np.ndarray], base: PartMesh) -> None:
    """Give a block the rock's nodes, unless it is to be tied."""
    part, mesh = block.parts[0], whole.mesh
    foot = part.foot_line()
    known = mesh.node_sets.get("ABUTMENT", np.zeros(0, int))
    mesh.node_sets["ABUTMENT"] = np.union1d(known, foot)
    if feet and not block.is_tied:
        middle = len(feet[0]) // 2
        rock = feet[0][middle + part.left : middle + part.right + 1]
        free = np.array([node not in whole.replaced for node in foot.ravel().tolist()])
        whole.merge(foot.ravel()[free], rock.ravel()[free])


def _name_ground(mesh: BrickMesh, blocks: list[Block], foot: np.ndarray, base: PartMesh) -> None:
    """Ties of blocks to the rock under them."""
    rock = mesh.brick_sets["ROCK"]
    faces = mesh.bricks[rock][:, [2, 3, 6, 7]]
    column_of = np.full(len(mesh.x), -1)
    column_of[foot] = np.arange(len(foot))[:, None]
    column = column_of[faces].min(axis=1)  # -1 away from the dam
    middle = len(foot) // 2
    for block in blocks:
        if block.is_tied:
            part = block.parts[0]
            first, last = (
                s // part.mesh.refine * base.refine + middle for s in (part.left, part.right)
            )
            under = rock[(column >= first) & (column < last)]
            names = f"BASE{block.number}_DAM", f"BASE{block.number}_ROCK"
            mesh.surfaces[names[0]] = part.faces["BASE"]
            mesh.surfaces[names[1]] = [(int(brick), 5) for brick in under]
            mesh.ties[f"BASE{block.number}"] = names


def _name_nodes(mesh: BrickMesh, shape: ArchShape) -> None:
    """Sets of the crest, the crown and the point whose history is printed."""
    used = np.unique(mesh.bricks)
    x = mesh.x[used]
    mesh.node_sets["CREST"] = used[x[:, 2] == shape.height]
    mesh.node_sets["CROWN"] = used[x[:, 0] == 0.0]
    top = used[(x[:, 0] == 0.0) & (x[:, 2] == shape.height)]
    mesh.node_sets["CROWN_CREST"] = top[[np.argmin(mesh.x[top, 1])]]
