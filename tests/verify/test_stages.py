"""*MODEL CHANGE: elements that come without stress, and go (docs/theory.md, 15)."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
from stage_decks import GRAVITY, LOAD, OUTPUT, STONE, WEIGHT, YOUNG, add, build, lifts, remove, step
from tied_blocks import Blocks, node_set

ROUND_OFF = 1e-12  # of sums of a few terms, over the largest value
FORMULATIONS = ("C3D8", "C3D8B", "C3D8I", "C3D8R")

CRACKING = f"""*DENSITY
2400.
*ELASTIC
{YOUNG!r}, 0.
*CONCRETE DAMAGED PLASTICITY
30.
*CONCRETE COMPRESSION HARDENING
20e6, 0.
*CONCRETE TENSION STIFFENING, TYPE=GFI
20e3, 2.
*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT
0., 0.
0.9, 3e-4
"""


def last_rows(run, table: str) -> dict[str, np.ndarray]:
    """The rows of the last increment."""
    rows = run.csv(table)
    end = rows["step"] == rows["step"][-1]
    end &= rows["increment"] == rows["increment"][end][-1]
    return {name: column[end] for name, column in rows.items()}


def balances(run) -> None:
    """The energies balance to round-off in every step."""
    assert max(s["energy"]["error"] for s in run.json["steps"]) < ROUND_OFF


@pytest.mark.parametrize("tied", [False, True], ids=["shared", "tied"])
@pytest.mark.parametrize("element", FORMULATIONS)
def test_a_column_of_ten_lifts(keyway, element, tied):
    """Stress and settlement of a column that is built lift by lift, exact at the nodes.

    A node at height k settles from the moment when its lift is placed: by its own lift, h/2 + the
    weight of that lift on k - 1 lifts, and by the 10 - k lifts above.
    """
    if tied and element == "C3D8R":
        pytest.skip("C3D8R has the same ties")
    run = keyway(lifts(10, tied=tied, element=element) + build(10))
    stress = last_rows(run, "el_BODY")
    u = last_rows(run, "node_EVERY")
    model = lifts(10, tied=tied)
    nodes = model.split("*ELEMENT")[0].splitlines()[1:]
    z = np.array([float(line.split(",")[3]) for line in nodes])
    unit = WEIGHT / YOUNG
    for k in range(1, 11):
        settled = -unit * ((10 - k) * k + (k - 1) + 0.5)
        placed_with = u["U3"][z[u["node"].astype(int) - 1] == k]
        assert np.abs(placed_with - settled).min() < ROUND_OFF * 25 * unit
    levels = np.unique(np.round(stress["S33"] / WEIGHT, 9))
    assert levels.tolist() == [k - 9.5 for k in range(10)]
    others = np.max([np.abs(stress[f"S{i}"]) for i in ("11", "22", "12", "13", "23")])
    assert others < 1e-9 * WEIGHT
    balances(run)


def test_weight_on_the_complete_column_settles_more(keyway):
    """The crest of a column that is complete before it has weight: H^2/2 of the weight over E."""
    built = last_rows(keyway(lifts(10) + build(10), name="built"), "node_EVERY")["U3"]
    whole = last_rows(keyway(lifts(10) + step(LOAD + OUTPUT), name="whole"), "node_EVERY")["U3"]
    assert whole.min() == pytest.approx(-50.0 * WEIGHT / YOUNG, rel=1e-12)
    assert built.min() == pytest.approx(-29.5 * WEIGHT / YOUNG, rel=1e-12)


@pytest.mark.parametrize("law", [None, CRACKING], ids=["elastic", "cracking"])
def test_an_element_that_comes_has_no_stress_and_returns_the_state(keyway, law):
    """A weightless lift on a loaded column has no stress; removed and added it changes nothing."""
    model = lifts(3, law) if law else lifts(3)
    load = f"*DLOAD\nL1, GRAV, {GRAVITY!r}, 0, 0, -1\nL2, GRAV, {GRAVITY!r}, 0, 0, -1\n"
    steps = step(remove("L3") + load + OUTPUT) + step(add("L3")) + step(remove("L3"))
    run = keyway(model + steps + step(add("L3")))
    rows = run.csv("el_BODY")
    top = rows["element"] == rows["element"].max()
    assert np.abs(rows["S33"][top]).max() < 1e-9 * WEIGHT
    u = run.csv("node_EVERY")
    end = [u["U3"][u["step"] == s] for s in (1, 2, 3, 4)]
    for other in end[1:]:
        assert np.abs(other - end[0])[u["node"][u["step"] == 1] <= 12].max() < 1e-17
    balances(run)


def test_removing_a_lift_with_weight_and_adding_it_again(keyway):
    """The state returns; between, the column has lost the weight of the lift."""
    steps = build(4) + step(remove("L4")) + step(add("L4"))
    run = keyway(lifts(4) + steps)
    rows = run.csv("el_BODY")
    stress = {s: rows["S33"][rows["step"] == s] for s in (4, 5, 6)}
    element = rows["element"][rows["step"] == 4]
    assert np.abs(stress[6] - stress[4]).max() < 1e-9 * WEIGHT
    assert np.abs(stress[5][element < 4] - stress[4][element < 4] - WEIGHT).max() < 1e-9 * WEIGHT
    assert np.abs(stress[5][element == 4]).max() == 0.0
    balances(run)


def test_an_element_that_is_gone_has_no_energy(keyway, monkeypatch):
    """ENER of an absent element is zero, whatever memory held before."""
    monkeypatch.setenv("MALLOC_PERTURB_", "120")
    output = OUTPUT.replace("S, E\n", "S, ENER\n")
    run = keyway(lifts(2) + step(LOAD + output) + step(remove("L2")))
    rows = run.csv("el_BODY")
    energy = {s: rows["ENER"][(rows["step"] == s) & (rows["element"] == 2)] for s in (1, 2)}
    assert energy[1].max() > 0.0
    assert (energy[2] == 0.0).all()


def test_the_change_acts_over_the_step(keyway):
    """Half of the weight of a lift acts after half of its step, so does its absence."""
    run = keyway(
        lifts(2)
        + step(remove("L2") + LOAD + OUTPUT)
        + step(add("L2"), data="0.5, 1., 0.5, 0.5\n")
        + step(remove("L2"), data="0.25, 1., 0.25, 0.25\n")
    )
    rows = run.csv("el_BODY")
    low = (rows["element"] == 1) & (rows["point"] == 1)
    assert rows["S33"][low] / -WEIGHT == pytest.approx(
        [0.5, 1.0, 1.5, 1.25, 1.0, 0.75, 0.5], rel=1e-12
    )
    balances(run)


def test_pressure_on_absent_elements_does_not_act(keyway):
    """A pressure on the top of both lifts acts on those that are there."""
    load = "*DLOAD\nBODY, P2, 1000.\n"
    run = keyway(lifts(2) + step(remove("L2") + load + OUTPUT) + step(add("L2")))
    rows = run.csv("el_BODY")
    low = (rows["element"] == 1) & (rows["point"] == 1)
    assert rows["S33"][low] == pytest.approx([-1000.0, -2000.0], rel=1e-12)


def test_a_dynamic_step_starts_at_rest(keyway):
    """Nothing moves after the stages; the frequency is that of the complete column."""
    shake = "*STEP\n*DYNAMIC, DIRECT, ALPHA=0\n1e-4, 1e-2\n*END STEP\n"
    modes = "*STEP\n*FREQUENCY\n1\n*END STEP\n"
    run = keyway(lifts(4) + build(4) + modes + shake, name="built")
    rows = run.csv("node_EVERY")
    at_rest = rows["U3"][rows["step"] == 4]
    moved = rows["U3"][rows["step"] == 6].reshape(-1, len(at_rest))
    assert np.abs(moved - at_rest).max() < 1e-9 * np.abs(at_rest).max()
    other = keyway(lifts(4) + step(LOAD) + modes, name="whole")
    assert run.json["steps"][4]["frequencies"] == other.json["steps"][1]["frequencies"]


def test_cracks_of_a_lift_that_leaves_are_forgotten(keyway):
    """A lift is torn, removed and placed again: the new one has no damage, the old one keeps its.

    What the removed lift has dissipated remains in job_energy.csv and job_damage.csv; the damaged
    volume is that of the lift that is there. The energies balance, to 1e-3 within the increments
    that open a crack.
    """
    pull = "*BOUNDARY\nCREST, 3, 3, {}\n"
    model = lifts(2, CRACKING) + "*NSET, NSET=CREST\n9, 10, 11, 12\n"
    output = OUTPUT.replace("S, E", "S, DAMAGET")
    run = keyway(
        model
        + step(pull.format(1e-4) + output, data="0.01, 1., 1e-6, 0.01\n")
        + step(remove("L2") + pull.format(0.0))
        + step(add("L2"))
    )
    rows = run.csv("el_BODY")
    low, high = (rows["element"] == e for e in (1, 2))
    end = [np.nonzero(rows["step"] == s)[0][-16:] for s in (1, 2, 3)]
    damage = [(rows["DAMAGET"][e][low[e]].max(), rows["DAMAGET"][e][high[e]].max()) for e in end]
    assert max(damage[0]) > 0.01
    assert damage[1][0] >= damage[0][0] and damage[1][1] == 0.0
    assert damage[2] == pytest.approx(damage[1], rel=1e-9)
    assert np.abs(rows["S33"][end[2]][high[end[2]]]).max() < 1e-6 * 20e3  # of the equilibrium
    assert run.json["steps"][-1]["energy"]["error"] < 1e-3
    balance, grown = run.csv("energy"), run.csv("damage")
    before, after = (np.nonzero(grown["step"] == s)[0][-1] for s in (1, 2))
    torn = grown["inelastic_volume"]
    assert torn[before] > 1.0 >= torn[after] > 0.0
    assert grown["cracking"][before] > 0.0
    assert np.diff(grown["cracking"]).min() >= 0.0 and np.diff(balance["fracture"]).min() >= 0.0
    assert grown["cracking"] + grown["crushing"] == pytest.approx(balance["fracture"], rel=1e-9)
    assert run.json["damage"]["dissipated"]["cracking"] == pytest.approx(grown["cracking"][-1])


def test_pictures_show_the_elements_that_are_there(keyway):
    """Cells of the VTK series, step by step."""
    run = keyway(lifts(3) + build(3).replace("*NODE PRINT", "*NODE FILE\nU\n*NODE PRINT"))
    folder = run.folder / "job_vtk"
    cells = [
        path.read_bytes().split(b'NumberOfCells="')[1].split(b'"')[0]
        for path in sorted(folder.glob("job_0*.vtu"))
    ]
    assert cells == [b"1", b"2", b"3"]


def test_the_stage_of_each_element(keyway):
    """STAGE is the step in which an element was added last, 0 while it is absent."""
    request = LOAD + "*EL FILE\nSTAGE\n"
    steps = step(remove("L2", "L3") + request) + step(add("L2")) + step(add("L3"))
    steps += step(remove("L3")) + step(add("L3"))
    run = keyway(lifts(3) + steps)
    expected = [[1, 0, 0], [1, 2, 0], [1, 2, 3], [1, 2, 0], [1, 2, 5]]
    with h5py.File(run.folder / "job.h5") as file:
        nodes = np.unique(file["mesh/connectivity"][:])
        level = file["mesh/x"][:, 2][nodes]
        for number, stages in enumerate(expected, start=1):
            group = file[f"steps/{number:04d}"]
            now = group["increments"][sorted(group["increments"])[-1]]
            assert group["stage"][:].tolist() == stages
            assert now["elements/STAGE"][:].tolist() == stages
            of_node = [stages[0], *stages]  # of the lift below a level: it comes first
            at_level = [set(now["STAGE"][:][nodes][level == z]) for z in range(4)]
            assert at_level == [{s} for s in of_node]
    frames = sorted((run.folder / "job_vtk").glob("job_0*.vtu"))
    assert b"STAGE_ELEMENT" in frames[0].read_bytes()


def test_a_deck_without_stages_has_no_stage(keyway):
    """A request of STAGE is a warning where nothing comes or goes."""
    run = keyway(lifts(1) + step(LOAD + "*EL FILE\nS, STAGE\n"))
    assert "step STAGE has no field STAGE; it is not written" in run.stderr
    with h5py.File(run.folder / "job.h5") as file:
        assert "stage" not in file["steps/0001"]


def test_a_part_without_support_is_named(keyway):
    """A lift that is removed below another leaves that one without support."""
    run = keyway(lifts(3) + step(LOAD) + step(remove("L2")), code=1)
    assert "the stiffness matrix is singular at node" in run.stderr


def test_a_block_beside_another_that_has_settled(keyway):
    """The second of two blocks side by side has no stress where it is cast against the first."""
    blocks = Blocks()
    blocks.add("A", (2, 0, 2), (1, 0, 1), (4, 0, 4))
    blocks.add("B", (2, 2, 4), (1, 0, 1), (4, 0, 4))
    blocks.share("A", "B")
    base = np.concatenate((blocks.side("A", "Z0"), blocks.side("B", "Z0")))
    cards = node_set("EVERY", range(len(blocks.x))) + node_set("BASE", base)
    model = blocks.deck({"": f"*DENSITY\n2400.\n*ELASTIC\n{YOUNG!r}, 0.\n"}, cards)
    load = f"*DLOAD\nA, GRAV, {GRAVITY!r}, 0, 0, -1\n"
    run = keyway(
        model + "*BOUNDARY\nBASE, 1, 3\n" + step(remove("B") + load + OUTPUT) + step(add("B"))
    )
    rows = last_rows(run, "el_BODY")
    assert np.abs(rows["S13"]).max() < 1e-9 * WEIGHT
    assert np.abs(rows["S33"][rows["element"] > 8]).max() < 1e-9 * WEIGHT


def test_a_joint_below_an_absent_block_is_not_open(keyway):
    """A gap of 10 mm below a block that is not there is no opening: not in the largest values, the
    envelope, or the table."""
    blocks = Blocks()
    blocks.add("LOW", (4, 0, 4), (1, 0, 1), (1, 0, 1))
    blocks.add("A", (2, 0, 2), (1, 0, 1), (1, 1, 2))
    blocks.add("B", (2, 2, 4), (1, 0, 1), (1, 1, 2))
    top = np.concatenate((blocks.side("A", "Z1"), blocks.side("B", "Z1")))
    cards = node_set("BASE", blocks.side("LOW", "Z0")) + node_set("TOP", top)
    cards += "*JOINT LAW, NAME=LAW, KN=1e10, KT=1e10, GAP=0.01\n"
    cards += "".join(f"*JOINT, NAME=J{b}, LAW=LAW\n{b}_Z0, LOW_Z1\n" for b in "AB")
    output = "*JOINT PRINT, JOINT=JB\n*ENVELOPE\nOPENING\n"
    push = "*BOUNDARY\nTOP, 3, 3, -0.02\n"
    deck = blocks.deck({"": STONE}, cards + "*BOUNDARY\nBASE, 1, 3\nTOP, 1, 2\n")
    run = keyway(deck + step(remove("B") + push + output))
    assert run.json["joints"]["JA"]["opening"]["anywhere"]["value"] == 0.0
    assert run.json["joints"]["JB"]["opening"]["anywhere"]["value"] == 0.0
    assert run.json["envelopes"]["OPENING"]["anywhere"]["value"] == 0.0
    assert (run.csv("joint_JB")["opening"] == 0.0).all()
