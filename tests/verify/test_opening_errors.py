"""The estimated errors of the largest opening at the end of a static step: of the mesh, of the
springs of closed joints and of the iteration, each against runs without that error."""

import pytest
from joint_decks import BOTH_MESHES, Block, static

SHEARS = {"a fifth": 0.25, "a half": 0.35}  # of the base that opens: horizontal over vertical load
ELEMENTS = ("C3D8", "C3D8B", "C3D8I")
# Of the estimate over the error, and of the error over the estimate. With four elements in the
# width the concentrated forces of the dual solution are as wide as the part that opens: 2.04.
FACTORS = {2: 2.1, 4: 2.0}


def lifted(count: int, element: str, shear: float, stiffness: str = "1e12", **options) -> str:
    """A column on a joint that a horizontal acceleration lifts at its left edge."""
    controls = options.pop("controls", "")
    law = f"KN={stiffness}, KT={stiffness}, FRICTION=1.0"
    counts = (2 * count, 1, 4 * count)
    block = Block((1.0, 0.25, 2.0), counts, 1e9, 0.2, law=law, element=element, **options)
    step = static(f"{controls}*DLOAD\nBLOCK, GRAV, 10., {shear!r}, 0., -1.\n")
    return block.deck(step)


def opening(run) -> float:
    return run.json["joints"]["BED"]["opening"]["anywhere"]["value"]


def estimate(run) -> dict[str, float]:
    return run.json["accuracy"]["estimates"]["opening"]


@BOTH_MESHES
@pytest.mark.parametrize("part", SHEARS)
def test_mesh(keyway, documented, part, meshes):
    """The truth: C3D8I with 48 elements in the width."""
    limit = opening(keyway(lifted(24, "C3D8I", SHEARS[part])))
    for element in ELEMENTS:
        for count, factor in FACTORS.items():
            run = keyway(lifted(count, element, SHEARS[part], meshes=meshes))
            found = estimate(run)
            assert found["value"] == opening(run)
            effectivity = found["mesh"] / abs(limit - opening(run))
            assert 1.0 / factor < effectivity < factor
            if not meshes:
                documented("error of an opening", (part, element), f"{2 * count}", effectivity)


@BOTH_MESHES
@pytest.mark.parametrize("part", SHEARS)
def test_springs(keyway, documented, part, meshes):
    """The truth: springs a thousand times as stiff."""
    for element in ELEMENTS:
        run = keyway(lifted(4, element, SHEARS[part], "1e11", meshes=meshes))
        found = estimate(run)
        rigid = opening(keyway(lifted(4, element, SHEARS[part], "1e14", meshes=meshes)))
        effectivity = found["joints"] / abs(found["value"] - rigid)
        assert 0.5 < effectivity < 2.0
        if not meshes:
            documented("error of an opening", (part, element), "springs", effectivity)


def test_iteration(keyway):
    """An iteration that ends early, against one that goes on; no point slides on the way."""
    for residual in (0.5, 0.2):
        controls = f"*CONTROLS, RESIDUAL={residual!r}, INCREMENT=1.\n"
        found = estimate(keyway(lifted(8, "C3D8", 0.35, controls=controls)))
        true = abs(found["value"] - opening(keyway(lifted(8, "C3D8", 0.35))))
        assert 0.5 < found["iteration"] / true < 2.0


def test_words(keyway):
    """The closing lines have value, error and parts."""
    run = keyway(lifted(4, "C3D8", 0.35))
    log = (run.folder / f"{run.job}.log").read_text(encoding="utf-8")
    (line,) = (x for x in log.splitlines() if "BED: largest opening" in x)
    for part in (", +-", "(mesh ", "joints "):
        assert part in line
    assert "iteration" not in line  # far below a thousandth


def test_soft_springs(keyway):
    """Springs that give more than a quarter of the opening are named, and are no error."""
    run = keyway(lifted(4, "C3D8", 0.35, "1e9"))
    found = estimate(run)
    assert found["springs"] > 0.25 * found["value"]
    assert "joints" not in found
    assert found["error"] == pytest.approx(found["mesh"] + found["iteration"])
    log = (run.folder / f"{run.job}.log").read_text(encoding="utf-8")
    (line,) = (x for x in log.splitlines() if "BED: largest opening" in x)
    assert ", springs of joints contribute about" in line
    assert "joints " not in line.split("(mesh ")[1].split(")")[0]


def test_one_point(keyway):
    """For C3D8R the estimate was up to 60 times the error of the mesh."""
    assert "mesh" not in estimate(keyway(lifted(4, "C3D8R", 0.35)))


def test_switched_off(keyway):
    """ERROR ESTIMATE=OFF: nothing; a joint that stays closed has no estimate of its opening."""
    off = keyway(lifted(2, "C3D8", 0.35, controls="*CONTROLS, ERROR ESTIMATE=OFF\n"))
    assert off.json["accuracy"]["estimates"] == {}
    assert not any(p["name"].startswith("estimate") for p in off.json["ledger"]["parts"])
    assert "opening" not in keyway(lifted(2, "C3D8", 0.1)).json["accuracy"]["estimates"]
