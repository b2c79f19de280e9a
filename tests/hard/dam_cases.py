"""Hard cases of arch dams: strong motions, joints with cracking, large models."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from concrete_decks import paper_concrete
from dam_trials import MOTION_DT, STRONG, Trial, deck_of, measure, trial_of
from hard_case import Chapter, energies, fed, off, over_limits, unbalance
from keyway_tools.arch_blocks import BlockOptions
from keyway_tools.arch_dam import DamOptions, build_arch_dam
from keyway_tools.arch_deck import DeckOptions, arch_dam_deck
from keyway_tools.arch_rock import RockOptions
from keyway_tools.arch_shape import ArchShape
from keyway_tools.deck_text import mesh_deck

DAMS = Chapter("Arch dams")
UNDAMPED, DAMPED = (0.0, 2.0, 10.0), (0.05, 2.0, 10.0)


def shake(keyway, trial: Trial, peak: float, name: str = "dam"):
    """Runs a trial with three waves under one hull, of `peak` [g] along and across the stream."""
    text, files = deck_of(replace(trial, components=(False, False, False)))
    time = np.arange(0.0, STRONG + 0.5 * MOTION_DT, MOTION_DT)
    hull = 9.81 * np.sin(np.pi * time / STRONG) ** 2
    for axis, (hz, share) in enumerate(((2.3, 1.0), (3.1, 1.0), (5.3, 2.0 / 3.0))):
        wave = share * peak * hull * np.sin(2.0 * np.pi * (hz + hz * time / 5.0) * time)
        files[f"motion_{axis}.txt"] = "".join(f"{value:.12e}\n" for value in wave)
    return keyway(text, files=files, name=name)


def worst(run) -> float:
    """The largest of: error of the energy and its growth after the motion, over 1e-6; iterations
    over 25; 1 + cut-backs, if any."""
    found = measure(run)
    energy = max(found.unbalance, found.growth)
    return over_limits(energy, found.cutbacks, found.most_iterations)


CRITERION = (
    "energy error and growth after the motion over 1e-6; iterations over 25; 1 + cut-backs, if any"
)


@DAMS.case("small dam, 1.5 g", "two joints, rock, no damping, 1.5 g", CRITERION, 1.0)
def strong_motion(keyway):
    run = shake(keyway, trial_of(1.0, 1e12, 0.01, UNDAMPED, is_coarse=True, duration=2.8), 1.5)
    return worst(run), [run]


@DAMS.case(
    "cracking dam, RECOVERY=ENERGY",
    "Table 1, rock, no joints, no damping, 0.7 g, increments of 0.01 s with ALPHA=0",
    "created energy over the largest energy; error of the energy balance",
    1e-6,
)
def cracking_dam(keyway):
    law = paper_concrete(young=22e9, density=2400.0, recovery="ENERGY").cards("CONCRETE")
    elastic = "*MATERIAL, NAME=CONCRETE\n*DENSITY\n2400.0\n*ELASTIC\n2.2e+10, 0.167\n"
    scheme = ("*DYNAMIC, DIRECT, ALPHA=-0.05", "*DYNAMIC, ALPHA=0.")
    trial = trial_of(1.0, 1e12, 0.01, UNDAMPED, is_coarse=True, duration=3.0, num_joints=0)
    run = shake(keyway, replace(trial, edits=((elastic, law), scheme)), 0.7)
    assert energies(run)["fracture"][-1] > 0.1 * energies(run)["kinetic"].max()
    return max(fed(run), unbalance(run)), [run]


def block_dam(num_joints: int) -> Trial:
    """Blocks of meshes 1:2 on a held base."""
    trial = trial_of(
        1.0,
        1e12,
        0.01,
        UNDAMPED,
        is_coarse=True,
        duration=2.7,
        has_rock=False,
        num_joints=num_joints,
    )
    options = replace(trial.options, friction=0.8)
    return replace(trial, options=options, blocks=BlockOptions(fine=(2,), slave="coarse"))


@DAMS.case(
    "small dam, meshes 1:2",
    "blocks of meshes 1:2 at two joints between surfaces, friction 0.8, 0.5 g, no damping",
    CRITERION,
    1.0,
    full=True,
)
def different_meshes(keyway):
    run = shake(keyway, block_dam(2), 0.5)
    return worst(run), [run]


@DAMS.case(
    "dam of seven blocks, meshes 1:2",
    "six joints between blocks of meshes 1:2, friction 0.8, 0.5 g, no damping",
    CRITERION,
    1.0,
    full=True,
)
def seven_blocks(keyway):
    run = shake(keyway, block_dam(6), 0.5)
    return worst(run), [run]


@DAMS.case(
    "dam, increments times ten",
    "two joints at increments of 0.01 and 0.001 s, 0.3 g, damped",
    "difference of the largest displacement",
    2e-2,
    full=True,
)
def times_ten(keyway):
    runs = [
        shake(keyway, trial_of(1.0, 1e11, dt, DAMPED, is_coarse=True), 0.3, name=f"d{k}")
        for k, dt in enumerate((0.01, 0.001))
    ]
    found, exact = (run.json["envelopes"]["U"]["anywhere"]["value"] for run in runs)
    return off([found], [exact]), runs


@DAMS.case("dam with 12 joints", "twelve joints, rock, 0.5 g, 4 s", CRITERION, 1.0, full=True)
def twelve_joints(keyway):
    run = shake(keyway, trial_of(1.0, 1e12, 0.01, DAMPED, num_joints=12), 0.5)
    return worst(run), [run]


def large_mesh(num_joints: int):
    """About 39 000 unknowns, rock included."""
    rock = RockOptions(num_upstream=4, num_downstream=4, num_deep=4)
    options = DamOptions(
        num_arc=96, num_height=28, num_thick=4, num_bottom=16, num_joints=num_joints, rock=rock
    )
    return build_arch_dam(ArchShape(), options)


def large_dam(keyway, num_joints: int, cards: tuple[tuple[str, str], ...]):
    """A large dam for 20 s of motion; `cards` are edits of its deck."""
    mesh = large_mesh(num_joints)
    names = tuple(f"motion_{axis}.txt" for axis in range(3))
    options = DeckOptions(motions=names, duration=20.0, tensile_strength=1e6, cohesion=1e6)
    text = arch_dam_deck(mesh, "A large dam", "mesh.inp", options)
    for old, new in cards:
        assert old in text, f"the deck has no '{old}'"
        text = text.replace(old, new)
    files = {"mesh.inp": mesh_deck(mesh, dict.fromkeys(mesh.brick_sets, "C3D8"), "")}
    time = np.arange(0.0, 20.0, MOTION_DT)
    lot = np.random.default_rng(7)
    hull = np.minimum(np.minimum(time / 3.0, 1.0), np.maximum((18.0 - time) / 8.0, 0.0))
    for name, peak in zip(names, (0.3, 0.3, 0.2), strict=True):
        noise = np.convolve(lot.standard_normal(len(time)), np.hanning(14), mode="same") * hull
        noise *= peak * 9.81 / np.abs(noise).max()
        files[name] = "".join(f"{value:.12e}\n" for value in noise)
    return keyway(text, files=files, name="dam")


@DAMS.case(
    "large dam with 9 joints, 20 s",
    "39 000 unknowns, nine joints with strength and friction, rock, 0.3 g",
    "error of the energy balance over 1e-6; iterations over 25; 1 + cut-backs, if any",
    1.0,
    full=True,
)
def large_joints(keyway):
    run = large_dam(keyway, 9, ())
    found = measure(run, 17.0)
    return over_limits(found.unbalance, found.cutbacks, found.most_iterations), [run]


@DAMS.case(
    "large dam with cracks, joints and uplift, 20 s",
    "39 000 unknowns, Table 1, five joints that bear the water of the lake, 0.3 g",
    "error of the energy balance",
    1e-6,
    full=True,
)
def large_cracking(keyway):
    law = paper_concrete(young=22e9, density=2400.0).cards("CONCRETE")
    elastic = "*MATERIAL, NAME=CONCRETE\n*DENSITY\n2400.0\n*ELASTIC\n2.2e+10, 0.167\n"
    water = (
        "*JOINT LAW, NAME=CONTRACTION",
        "*JOINT LAW, NAME=CONTRACTION, UPLIFT=LAKE, PROFILE=OPEN",
    )
    cuts = ("*DYNAMIC, DIRECT,", "*DYNAMIC,")
    run = large_dam(keyway, 5, ((elastic, law), water, cuts))
    return unbalance(run), [run]
