"""Energy of cracks that close and open: RECOVERY=ENERGY creates none, the weights of r do.

A bar of Table 1, undamped, one end of which is thrown at 2 m/s: it cracks at once, and its crack
closes and opens with every wave. `numerical` of the balance falls where energy is created, by the
law (no increment helps) or by the time stepping (of second order).
"""

from __future__ import annotations

import numpy as np
import pytest
from concrete_decks import Bar, paper_concrete
from harness import Run


def thrown_bar(keyway, recovery: str, increment: float) -> Run:
    """10 m long, ten elements."""
    concrete = paper_concrete(density=2400.0, recovery=recovery)
    bar = Bar(weak=concrete, length=10.0, side=1.0, num_rest=9)
    step = f"*STEP, INC=100000\n*DYNAMIC, ALPHA=0\n{increment!r}, 0.02\n*END STEP\n"
    deck = bar.deck("*INITIAL CONDITIONS, TYPE=VELOCITY\nRIGHT, 1, 2.0\n" + step)
    return keyway(deck, name=f"{recovery}_{increment}".replace(".", "_"))


def created(run: Run) -> tuple[float, float]:
    """Energy created by anything, and by the law as it says, over the energy of the throw."""
    numerical = run.csv("energy")["numerical"]
    start = run.csv("energy")["kinetic"][0]
    largest = np.max(np.maximum.accumulate(numerical) - numerical)
    return largest / start, run.json["damage"]["created"] / start


def test_no_energy_from_the_split(keyway):
    """The law creates none; what the time stepping creates falls with the square of increments."""
    coarse, fine = (thrown_bar(keyway, "ENERGY", size) for size in (4e-5, 1e-5))
    assert created(coarse)[1] == created(fine)[1] == 0.0
    assert created(fine)[0] < created(coarse)[0] / 8.0
    assert created(fine)[0] < 1e-3
    assert not [text for text in fine.json["warnings"] if "created" in text]


@pytest.mark.parametrize("recovery", ["LEE-FENVES", "SIGN"])
def test_energy_from_a_weight(keyway, recovery):
    """It stays with small increments, is what the law says, and the warning names the law."""
    run = thrown_bar(keyway, recovery, 1e-5)
    found, by_law = created(run)
    assert found > 0.05
    assert by_law == pytest.approx(found, rel=0.15)
    assert any("the law of concrete has created" in text for text in run.json["warnings"])
    assert not any("time stepping" in text for text in run.json["warnings"])


def test_warning_of_a_stress_that_jumps(keyway):
    """With RECOVERY=SIGN large increments are not to blame either: its stress jumps."""
    run = thrown_bar(keyway, "SIGN", 1e-4)
    assert any("the law of concrete has created" in text for text in run.json["warnings"])
    assert not any("time stepping" in text for text in run.json["warnings"])
