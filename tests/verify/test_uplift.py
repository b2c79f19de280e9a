"""Water in joints (*JOINT LAW, UPLIFT): statics of a rigid dam section, code_aster's SSNP142."""

import dataclasses

import h5py
import numpy as np
import pytest
from joint_decks import amplitude, dynamic, static
from keyway_tools.box_mesh import box_mesh
from keyway_tools.deck_text import mesh_deck
from scipy.optimize import brentq
from uplift_decks import GRAVITY, WATER, Section, facets, joined, lake, weight

LEVEL = 9.0  # [m]
OUTPUT = "*NODE FILE, FREQUENCY=100000\nU, OPENING\n*JOINT PRINT, JOINT=BED\n"
# The block is elastic and soft beside nothing: k_n height / E = 1e8 * 10 / 1e13.
RIGID = 1e-4


def joint_fields(run, step: int = 1, name: str = "BED") -> dict[str, np.ndarray]:
    """Geometry of a joint and its fields at the end of a step."""
    with h5py.File(run.folder / f"{run.job}.h5") as file:
        increments = file[f"steps/{step:04d}/increments"]
        last = increments[sorted(increments)[-1]][f"joints/{name}"]
        fields = {key: value[:] for key, value in last.items()}
        return fields | {key: file[f"joints/{name}/{key}"][:] for key in ("x", "area")}


def rigid_tractions(section: Section, found: dict[str, np.ndarray], uplift: np.ndarray):
    """Normal tractions of a rigid section on bonded springs: sums over the points of the joint."""
    x, area = found["x"][:, 0], found["area"]
    force, arm = section.weight
    push = WATER * GRAVITY * LEVEL**2 / 2.0
    normal = (uplift * area).sum() - force
    moment = (uplift * area * x).sum() - force * arm - push * LEVEL / 3.0  # about the heel
    sums = np.array([[(area * x ** (i + j)).sum() for j in range(2)] for i in range(2)])
    a, b = np.linalg.solve(sums, [normal, moment])
    return a + b * x


@pytest.mark.parametrize("integration", ["NODES", "GAUSS"])
@pytest.mark.parametrize("ground_is_slave", [False, True])
@pytest.mark.parametrize("ground_counts", [0, 14, 29], ids=["JOINT8", "coarse", "fine"])
def test_linear_uplift_under_a_rigid_block(
    keyway, integration, ground_is_slave, ground_counts
) -> None:
    """Bonded springs: the tractions vary linearly, the sums of forces and moments are zero."""
    section = Section(
        law="KN=1e8, KT=1e8, TENSILE STRENGTH=1e9, UPLIFT=LAKE",
        integration=integration,
        ground_is_slave=ground_is_slave,
        ground_counts=ground_counts,
        grading=1.4,
    )
    run = keyway(section.deck(static(weight() + lake(LEVEL) + OUTPUT)))
    found = joint_fields(run)
    uplift = WATER * GRAVITY * LEVEL * (1.0 - found["x"][:, 0] / section.base)
    assert found["water"] == pytest.approx(uplift, rel=1e-9, abs=1e-6)
    wanted = rigid_tractions(section, found, uplift)
    assert found["traction"][:, 0] == pytest.approx(wanted, abs=RIGID * np.abs(wanted).max())
    assert run.json["steps"][0]["energy"]["error"] < 1e-7
    parts = run.json["ledger"]["parts"]
    assert {"name": "water of LAKE in joint BED (LINEAR)", "kind": "uplift"} in run.json["effects"]
    assert "recover water of LAKE in joint BED (LINEAR)" in [part["name"] for part in parts]


def test_tail_water(keyway) -> None:
    """Two metres of water behind the dam: the straight line between both heads."""
    section = Section(law="KN=1e8, KT=1e8, TENSILE STRENGTH=1e9, UPLIFT=LAKE, TAIL WATER=RIVER")
    river = "*RESERVOIR, NAME=RIVER, SURFACE=DOWNSTREAM, LEVEL=2., BED=0.\n"
    run = keyway(section.deck(static(weight() + lake(LEVEL) + river + OUTPUT)))
    found = joint_fields(run)
    share = found["x"][:, 0] / section.base
    wanted = WATER * GRAVITY * (LEVEL * (1.0 - share) + 2.0 * share)
    assert found["water"] == pytest.approx(wanted, rel=1e-9)


def crack_under_open_uplift(section: Section) -> tuple[float, float]:
    """Length of the crack under a rigid block with the full head in it, and pressure at the toe.

    Springs without tension carry a triangle on what is closed: moments about the toe.
    """
    force, arm = section.weight
    head = WATER * GRAVITY * LEVEL
    push = head * LEVEL / 2.0

    def unbalance(crack: float) -> float:
        closed = section.base - crack
        water = head * crack * (section.base - 0.5 * crack)
        resisting = force * (section.base - arm) - push * LEVEL / 3.0 - water
        return resisting - (force - head * crack) * closed / 3.0

    crack = brentq(unbalance, 0.0, section.base / 2.0)
    return crack, 2.0 * (force - head * crack) / (section.base - crack)


@pytest.mark.parametrize("increments", [1, 8])
@pytest.mark.parametrize("ground_counts", [0, 67], ids=["JOINT8", "3:2"])
def test_open_uplift_under_a_rigid_block(keyway, increments, ground_counts) -> None:
    """The crack settles where water, weight and springs balance, however many increments it takes.

    The crack's tip lies between two points of the joint: half a column, 0.025 m. The pressure of
    the water ends there too, so that forces are wrong by at most half a column's share of the
    head, 0.4 % of the weight's moment; 1 % is allowed.
    """
    section = Section(
        counts=(100, 4),
        ground_counts=ground_counts,
        law="KN=1e8, KT=1e8, FRICTION=2., UPLIFT=LAKE, PROFILE=OPEN",
    )
    step = static(weight() + lake(LEVEL) + OUTPUT, f"{1.0 / increments!r}, 1.")
    run = keyway(section.deck(step))
    found = joint_fields(run)
    crack, toe = crack_under_open_uplift(section)
    is_open = found["opening"] > 0.0
    head = np.full(is_open.sum(), WATER * GRAVITY * LEVEL)
    assert found["water"][is_open] == pytest.approx(head, rel=1e-12)
    assert (found["water"][~is_open] == 0.0).all()
    width = section.base / section.counts[0]
    tip = found["x"][is_open, 0].max() + 0.5 * width
    assert tip == pytest.approx(crack, abs=1.01 * width)
    assert -found["traction"][:, 0].min() == pytest.approx(toe, rel=0.01)
    assert run.json["steps"][0]["energy"]["error"] < 1e-6


def test_closed_crack_mouth_keeps_water_out(keyway) -> None:
    """Open at the toe only: no uplift with PROFILE=OPEN, although the joint is open there."""
    section = Section(law="KN=1e8, KT=1e8, FRICTION=2., UPLIFT=LAKE, PROFILE=OPEN")
    push = "*DSLOAD\nDOWNSTREAM, P, 40000.\n"
    run = keyway(section.deck(static(weight() + push + lake(1.0) + OUTPUT)))
    found = joint_fields(run)
    assert (found["opening"] > 0.0).any()
    assert (found["opening"][found["x"][:, 0] < 1.0] < 0.0).all()
    assert (found["water"] == 0.0).all()


def test_water_comes_and_goes_with_its_reservoir(keyway) -> None:
    """A dry step, a full one, half the level, and full again: the joint returns to its first
    state."""
    section = Section(law="KN=1e8, KT=1e8, TENSILE STRENGTH=1e9, UPLIFT=LAKE")
    steps = [
        static(weight() + OUTPUT, "0.5, 1.", "DRY"),
        static(lake(LEVEL), "0.25, 1.", "FULL"),
        static(lake(0.5 * LEVEL), "0.25, 1.", "HALF"),
        static(lake(LEVEL), "0.25, 1.", "AGAIN"),
    ]
    run = keyway(section.deck("".join(steps)))
    dry, full, half, again = (joint_fields(run, step) for step in range(1, 5))
    assert "water" not in dry
    assert half["water"] == pytest.approx(0.5 * full["water"], abs=1e-6)
    assert again["water"] == pytest.approx(full["water"], abs=1e-6)
    size = np.abs(full["traction"][:, 0]).max()
    assert np.abs(half["traction"] - full["traction"]).max() > 0.1 * size
    assert again["traction"][:, 0] == pytest.approx(full["traction"][:, 0], abs=1e-6 * size)


@pytest.mark.parametrize("profile", ["LINEAR", "OPEN"])
@pytest.mark.parametrize("ground_counts", [0, 13], ids=["JOINT8", "3:2"])
def test_energy_with_water_in_a_shaken_joint(keyway, profile, ground_counts) -> None:
    """The dam rocks on its joint, water follows the opening: the energy balance closes."""
    section = Section(
        counts=(20, 10),
        ground_counts=ground_counts,
        crest=1.5,
        young=2e10,
        law=f"KN=1e10, KT=1e10, FRICTION=0.8, UPLIFT=LAKE, PROFILE={profile}",
    )
    time = np.arange(0.0, 1.001, 0.01)
    shaking = amplitude("QUAKE", time, 3.0 * np.sin(2.0 * np.pi * 4.0 * time))
    steps = static(weight() + lake(LEVEL) + OUTPUT, "0.25, 1.") + dynamic(
        "*BASE MOTION, DOF=1, AMPLITUDE=QUAKE\n", 0.005, 1.0
    )
    run = keyway(section.deck(shaking + steps))
    assert run.json["steps"][1]["energy"]["error"] < 1e-5
    assert run.json["joints"]["BED"]["opening"]["upstream"]["value"] > 1e-4


@pytest.mark.parametrize("profile", ["LINEAR", "OPEN"])
def test_rocking_in_parts(keyway, profile) -> None:
    """Steps in a row are the step in one piece: water that follows the opening of the last
    increment of a step comes in the first one of the next, not at once."""
    section = Section(
        counts=(10, 5),
        crest=1.5,
        young=2e10,
        law=f"KN=1e10, KT=1e10, FRICTION=0.8, UPLIFT=LAKE, PROFILE={profile}",
    )
    time = np.arange(0.0, 0.401, 0.01)
    shaking = amplitude("QUAKE", time + 1.0, 3.0 * np.sin(2.0 * np.pi * 4.0 * time))
    shaking = shaking.replace("NAME=QUAKE", "NAME=QUAKE, TIME=TOTAL TIME")
    runs = {}
    for parts in (1, 8):
        steps = static(weight() + lake(LEVEL) + OUTPUT, "0.25, 1.")
        steps += parts * dynamic("*BASE MOTION, DOF=1, AMPLITUDE=QUAKE\n", 0.005, 0.4 / parts)
        table = keyway(section.deck(shaking + steps), name=f"in_{parts}").csv("joint_BED")
        moving = (table["step"] > 1) & (table["increment"] > 0)
        runs[parts] = {name: table[name][moving] for name in ("opening", "tn")}
    opening = runs[1]["opening"].max()
    assert opening > 1e-4
    # Round-off in the sums of times, in a motion that opens and closes points.
    assert runs[8]["opening"] == pytest.approx(runs[1]["opening"], abs=1e-7 * opening)
    size = np.abs(runs[1]["tn"]).max()
    assert runs[8]["tn"] == pytest.approx(runs[1]["tn"], abs=1e-7 * size)


# --- code_aster SSNP142, modelling A: a section 5 m wide below and 1.5 m above (its geometry file
# ssnp142f.datg), 10 m high, on 5 m of ground 15 m wide, everything 3e12 Pa.
ASTER = Section(
    crest=1.5,
    counts=(50, 40),
    young=3e12,
    law="KN=1e12, KT=1e12, TENSILE STRENGTH=100., UPLIFT=LAKE",
    beside=(5.0, 20),
    depth=(5.0, 20),
)


@pytest.mark.parametrize("ground_counts", [0, 37], ids=["JOINT8", "4:3"])
def test_code_aster_ssnp142(keyway, ground_counts) -> None:
    """Heel 4.01e-7 m (7 %), toe -4.25e-7 m and -4.25e5 Pa (5 %): GEFDYN, with code_aster's bounds.

    Along the joint code_aster's own values, on another mesh: 2 % of the opening at the heel.
    """
    section = dataclasses.replace(ASTER, ground_counts=ground_counts)
    run = keyway(section.deck(static(weight() + lake(LEVEL) + OUTPUT)))
    found = joint_fields(run)
    x = found["x"][:, 0]
    heel, toe = np.argmin(x), np.argmax(x)
    assert found["opening"][heel] == pytest.approx(4.01e-7, rel=0.07)
    assert found["opening"][toe] == pytest.approx(-4.25e-7, rel=0.05)
    assert found["traction"][toe, 0] - found["water"][toe] == pytest.approx(-4.25e5, rel=0.05)
    for place, jump in ((1.3, 1.33680e-7), (3.2, -1.38295e-7), (4.6, -3.18963e-7)):
        at = np.argmin(abs(x - place))
        assert found["opening"][at] == pytest.approx(jump, abs=0.02 * 4.23e-7)


def two_blocks(gap: str) -> str:
    """Two blocks of an upright wall, their contraction joint at x = 2; upstream is y = 0.

    The wall is 3 m thick below and 1 m above, its upstream face leans; the joint's foot is level.
    """

    def place(start: float):
        def where(a, b, c):
            low, high = 0.5 * c, 3.0 - 1.5 * c
            return np.stack([start + 2.0 * a, low + (high - low) * b, 8.0 * c], axis=-1)

        return where

    mesh, (left, right) = joined(box_mesh((2, 3, 8), place(0.0)), box_mesh((2, 3, 8), place(2.0)))
    mesh.joints = np.concatenate([facets(left[-1]), facets(right[0])], axis=1)
    bricks = np.arange(96).reshape(2, 2, 3, 8)
    mesh.brick_sets = {"WALL": np.arange(96)}
    mesh.joint_sets = {"SEAM": np.arange(len(mesh.joints))}
    mesh.node_sets = {"FOOT": np.concatenate([left[:, :, 0].ravel(), right[:, :, 0].ravel()])}
    mesh.surfaces["UPSTREAM"] = [(int(brick), 3) for brick in bricks[:, :, 0].ravel()]
    return (
        mesh_deck(mesh, {"WALL": "C3D8"}, "")
        + "*MATERIAL, NAME=C\n*DENSITY\n2400.\n*ELASTIC\n2e10, 0.2\n"
        + "*SOLID SECTION, ELSET=WALL, MATERIAL=C\n"
        + f"*JOINT LAW, NAME=LAW, KN=1e11, UPLIFT=LAKE{gap}\n"
        + "*JOINT, NAME=SEAM, LAW=LAW, ELSET=SEAM\n*BOUNDARY\nFOOT, 1, 3\n"
        + static(lake(6.0) + "*NODE FILE\nU, OPENING\n")
    )


def test_contraction_joint(keyway) -> None:
    """An upright joint: the head of each height, falling along the stream; full where it is open.

    Distances are those to the leaning edges of the joint's face.
    """
    found = joint_fields(keyway(two_blocks("")), name="SEAM")
    y, z = found["x"][:, 1], found["x"][:, 2]
    upstream, downstream = y - z / 16.0, 3.0 - 1.5 * z / 8.0 - y
    upstream /= np.hypot(1.0, 1.0 / 16.0)
    downstream /= np.hypot(1.0, 1.5 / 8.0)
    head = WATER * GRAVITY * np.maximum(6.0 - z, 0.0)
    inside = (z > 1.0) & (z < 7.0)  # beyond, the nearest place of an edge is its end
    wanted = head * downstream / (upstream + downstream)
    assert found["water"][inside] == pytest.approx(wanted[inside], rel=1e-6, abs=1e-3)

    found = joint_fields(keyway(two_blocks(", PROFILE=OPEN, GAP=0.01"), name="gap"), name="SEAM")
    assert found["water"] == pytest.approx(head, abs=1e-6)
