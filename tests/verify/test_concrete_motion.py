"""Dams that crack in an earthquake: the run ends, the energies add up, threads do not matter."""

from __future__ import annotations

import numpy as np
import pytest
from concrete_decks import paper_concrete
from dam_trials import DeckOptions, Trial, run_trial
from keyway_tools.deck_cracking_monolith import CARDS, monolith_mesh, monolith_motion
from keyway_tools.deck_text import small_deck

MOTION_FILE = "cracking_monolith_motion.txt"
# Bricks of up to 13 m: 2 E G_f / f_t^2 = 15.5 m with 1000 N/m
COARSE = (("2.e6, 300.", "2.e6, 1000."), ("0.9, 3.e-4", "0.9, 1.e-3"))
SHORT = ("0.01, 6., 1.e-5, 0.01", "0.01, 3., 1.e-5, 0.01")


def shaken_monolith(
    keyway, *options: str, size: float = 1.0, element: str = "C3D8I", edits=(), name="job"
):
    """Run of the monolith on a coarse mesh; `size` times the motion of the deck."""
    cards = CARDS
    for old, new in (*COARSE, SHORT, *edits):
        assert old in cards, f"the deck has no '{old}'"
        cards = cards.replace(old, new)
    deck = small_deck("A trial.", monolith_mesh(6, 9, 5), element, cards)
    motion = "".join(f"{size * float(line)!r}\n" for line in monolith_motion().split())
    return keyway(deck, *options, files={MOTION_FILE: motion}, name=name)


def check_energies(run, given_back: float = 1e-12) -> dict[str, np.ndarray]:
    """The balance closes and the dissipated energy never decreases.

    The balance is an identity but for the tolerance of the iteration (1e-6 of the forces); 0.1 % is
    allowed. With viscosity plastic strain still lags after a reversal of the stress, which recovers
    1e-5 of the energy.
    """
    table = run.csv("energy")
    assert table["error"].max() < 1e-3
    for name in ("fracture", "crushing"):
        assert np.diff(table[name]).min() >= -given_back * table[name].max()
    assert np.all(table["crushing"] <= table["fracture"] * (1.0 + 1e-12))
    return table


def test_energies_of_a_cracking_monolith(keyway):
    """The monolith cracks; job.json has the place, and its sums agree with the table."""
    run = shaken_monolith(keyway, size=3.0)
    table = check_energies(run)
    assert table["fracture"][-1] > 0.0
    damage = run.json["damage"]
    assert 0.0 < damage["DAMAGET"]["value"] <= 0.9 + 1e-9
    total = damage["dissipated"]["cracking"] + damage["dissipated"]["crushing"]
    assert total == pytest.approx(table["fracture"][-1], rel=1e-6)
    assert damage["dissipated"]["crushing"] == pytest.approx(
        table["crushing"][-1], abs=1e-6 * total
    )


def test_threads_do_not_change_a_cracking_monolith(keyway):
    """One and two threads: the same displacements to 1e-9 of the largest, as with joints."""
    tables = [
        shaken_monolith(keyway, "-j", str(n), size=3.0, name=f"threads{n}").csv("node_CREST")
        for n in (1, 2)
    ]
    assert len(tables[0]["U1"]) == len(tables[1]["U1"])
    apart = np.abs(tables[0]["U1"] - tables[1]["U1"]).max() / np.abs(tables[0]["U1"]).max()
    assert apart < 1e-9


RECOVERY = "RECOVERY=LEE-FENVES"
HARD = {
    "the switch of the paper": {
        "size": 4.0,
        "edits": [(RECOVERY, "RECOVERY=SIGN")],
    },
    "six times the motion": {"size": 6.0},
    "twelve times the motion": {"size": 12.0},
    "cracks that stay soft": {"size": 4.0, "edits": [("RECOVERY=1.", "RECOVERY=0.")]},
    "viscosity": {"size": 4.0, "edits": [("0.6667, 0.\n", "0.6667, 1.e-3\n")]},
    "viscosity without created energy": {
        "size": 4.0,
        "edits": [
            ("0.6667, 0.\n", "0.6667, 1.e-3\n"),
            (RECOVERY, "RECOVERY=ENERGY"),
        ],
    },
    "C3D8": {"size": 4.0, "element": "C3D8"},
    "C3D8B": {"size": 4.0, "element": "C3D8B"},
    "C3D8R": {"size": 4.0, "element": "C3D8R"},
    "large increments": {
        "size": 4.0,
        "edits": [("0.01, 3., 1.e-5, 0.01", "0.02, 3., 1.e-5, 0.02")],
    },
}
QUICK = {"six times the motion", "the switch of the paper"}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[] if n in QUICK else [pytest.mark.full]) for n in HARD]
)
def test_hard_motion_runs(keyway, name):
    """The run ends, its energies add up, and held switches are reported."""
    given_back = 1e-5 if name.startswith("viscosity") else 1e-12
    run = shaken_monolith(keyway, **HARD[name])
    check_energies(run, given_back)
    is_held = any("jump of RECOVERY=SIGN" in warning for warning in run.json["warnings"])
    assert is_held == (name == "the switch of the paper")


@pytest.mark.parametrize("recovery", ["LEE-FENVES", pytest.param("SIGN", marks=pytest.mark.full)])
def test_jointed_dam_cracks(keyway, recovery):
    """Opening joints and cracking concrete: the coarse arch dam at twice the motion."""
    concrete = paper_concrete(young=22e9, density=2400.0, recovery=recovery).cards("CONCRETE")
    plain = "*MATERIAL, NAME=CONCRETE\n*DENSITY\n2400.0\n*ELASTIC\n2.2e+10, 0.167\n"
    trial = Trial(
        size=2.0,
        duration=3.0,
        is_coarse=True,
        options=DeckOptions(damping=(0.05, 2.0, 10.0)),
        edits=((plain, concrete), ("*DYNAMIC, DIRECT", "*DYNAMIC")),
    )
    run = run_trial(keyway, trial)
    check_energies(run)
    assert run.json["damage"]["DAMAGET"]["value"] > 0.0
    assert run.json["envelopes"]["OPENING"]["anywhere"]["value"] > 1e-3
