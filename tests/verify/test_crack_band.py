"""The fracture energy of a brick is G_f times its area, along its long side and across it.

Exact except for the residual strength of f_t/1000 (theory.md, 11.4): after the opening w the energy
is G_f (1 - 1e-6) + 1e-3 f_t (w - w_u). The cube root of the volume as the width of the band would
give 1/2.9 and 1.7 times as much in a brick of 1 x 1 x 5.
"""

import numpy as np
import pytest

YOUNG, STRENGTH, ENERGY = 25e9, 2.48e6, 400.0
LAST_OPENING = 2.0 * ENERGY / STRENGTH
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)


def torn_brick(size, axis, element="C3D8", energy=ENERGY, option="", opening=2.0 * LAST_OPENING):
    """A brick with free sides, pulled along an axis (0-2) until its crack is open."""
    lines = ["*NODE"]
    lines += [f"{n}, {x}, {y}, {z}" for n, (x, y, z) in enumerate(CORNERS * size, start=1)]
    lines += [f"*ELEMENT, TYPE={element}, ELSET=BRICK", "1, 1, 2, 3, 4, 5, 6, 7, 8"]
    for name, side in (("HELD", 0), ("PULLED", 1)):
        members = np.flatnonzero(CORNERS[:, axis] == side) + 1
        lines += [f"*NSET, NSET={name}", ", ".join(map(str, members))]
    lines += ["*MATERIAL, NAME=CONCRETE", "*ELASTIC", f"{YOUNG}, 0.2"]
    lines += ["*CONCRETE DAMAGED PLASTICITY", "32.5"]
    lines += ["*CONCRETE COMPRESSION HARDENING", "30e6, 0."]
    lines += [f"*CONCRETE TENSION STIFFENING, TYPE=GFI{option}", f"{STRENGTH}, {energy}"]
    lines += ["*SOLID SECTION, ELSET=BRICK, MATERIAL=CONCRETE"]
    along, across, third = axis + 1, (axis + 1) % 3 + 1, (axis + 2) % 3 + 1
    lines += ["*BOUNDARY", f"HELD, {along}, {along}", f"1, {across}, {across}"]
    # the corner beside node 1 on the axis `across` keeps the brick from turning about its own
    beside = 1 + int(np.flatnonzero((np.eye(3)[across - 1] == CORNERS).all(axis=1))[0])
    lines += [f"1, {third}, {third}", f"{beside}, {third}, {third}"]
    lines += ["*STEP, INC=1000", "*STATIC", "0.005, 1., 1e-8, 0.02"]
    lines += ["*BOUNDARY", f"PULLED, {along}, {along}, {opening!r}"]
    lines += ["*EL PRINT, ELSET=BRICK", "S", "*END STEP", ""]
    return "\n".join(lines)


def energy_of_crack(run):
    return run.json["steps"][-1]["energy"]["fracture"]


@pytest.mark.parametrize("element", ["C3D8", "C3D8B", "C3D8I", "C3D8R"])
@pytest.mark.parametrize("axis", [0, 2])
def test_energy_of_a_long_brick(keyway, element, axis):
    """0.2 %: the midpoint rule at the kinks of the curve, in increments of 2 % of the path."""
    size = np.array([0.5, 0.5, 2.5])
    run = keyway(torn_brick(size, axis, element))
    area = size.prod() / size[axis]
    stays = 1e-3 * STRENGTH * LAST_OPENING
    assert energy_of_crack(run) / area == pytest.approx(ENERGY + stays, rel=2e-3)


def test_strength_of_a_brick_that_is_too_long(keyway):
    """Four times as long as 2 E G_f / f_t^2: half the strength (2 %: an increment of the pull),
    the same energy (1 %: the curve drops at once, within an increment) and a warning."""
    longest = 2.0 * YOUNG * ENERGY / STRENGTH**2
    deck = torn_brick(
        np.array([1.0, 1.0, 4.0 * longest]),
        2,
        option=", LONG ELEMENTS=LOWER STRENGTH",
        opening=3.0 * LAST_OPENING,
    )
    run = keyway(deck)
    assert max(run.csv("el_BRICK")["S33"]) == pytest.approx(0.5 * STRENGTH, rel=0.02)
    assert energy_of_crack(run) == pytest.approx(ENERGY, rel=0.01)
    # The jump of the brick to its broken state is reported too.
    (warning,) = [w for w in run.json["warnings"] if "elements are longer" in w]
    assert "1 of 1 elements are longer" in warning
    assert warning.endswith("elements 1")


@pytest.mark.parametrize("energy", [100.0, 150.0, 200.0, 300.0])
def test_longest_brick(keyway, energy):
    """2 E G_f / f_t^2, verification.md: 0.813, 1.219, 1.626, 2.439 m."""
    longest = 2.0 * YOUNG * energy / STRENGTH**2
    fits = torn_brick(np.array([0.5, 0.5, 0.999 * longest]), 2, energy=energy)
    keyway(fits, "--check")
    too_long = torn_brick(np.array([0.5, 0.5, 1.001 * longest]), 2, energy=energy)
    run = keyway(too_long, "--check", code=2, name="long")
    assert "element 1 has a length of " in run.stderr
    assert float(run.stderr.split("at most ")[1].split(",")[0]) == pytest.approx(longest, rel=1e-5)


def crushed_and_torn(depth: float, tension: float, recovery: str) -> str:
    """A brick of 0.5 x depth x 0.5 with free sides, under a tension [Pa] along y, that is crushed
    along x and then torn along x."""
    size = np.array([0.5, depth, 0.5])
    lines = torn_brick(size, 0, energy=200.0).split("\n*STEP")[0]
    lines = lines.replace("PLASTICITY\n32.5", f"PLASTICITY, RECOVERY={recovery}\n32.5")
    lines = lines.replace("30e6, 0.", "12e6, 0.\n20e6, 0.25e-3\n25e6, 1e-3")
    lines += "\n*NSET, NSET=FAR\n3, 4, 7, 8\n*BOUNDARY\n"
    lines += "".join(f"{n}, 2, 2\n" for n in (1, 2, 5, 6))
    load = f"*CLOAD\nFAR, 2, {tension * 0.25 / 4.0!r}\n"
    for name, sizes, end in (("CRUSH", "0.1, 1., 1e-8, 0.1", -0.5e-3), ("TEAR", TEARING, 0.3e-3)):
        lines += f"*STEP, NAME={name}, INC=1000\n*STATIC\n{sizes}\n{load}"
        lines += f"*BOUNDARY\nPULLED, 1, 1, {end!r}\n*EL PRINT, ELSET=BRICK\nS, SDV\n*END STEP\n"
    return lines


TEARING = "0.005, 1., 1e-8, 0.005"


@pytest.mark.parametrize("recovery", ["ENERGY", "LEE-FENVES"])
@pytest.mark.parametrize("depth", [0.25, 1.5])
def test_crack_of_a_crushed_brick(keyway, depth, recovery):
    """A lateral tension of 1 Pa while the brick is crushed does not choose the width of the crack
    that tears it later: 0.5 m along x, not the depth. 1 %: increments of 0.5 % of the path."""
    run = keyway(crushed_and_torn(depth, 1.0, recovery))
    steps = run.json["steps"]
    torn = steps[1]["energy"]["fracture"] - steps[0]["energy"]["fracture"]
    assert run.csv("el_BRICK")["SDV11"][-1] == pytest.approx(0.5, rel=1e-9)
    # The plastic strain of crushing is not a crack: the residual strength does no more than 1e-3.
    assert torn / (0.5 * depth) == pytest.approx(200.0, rel=0.01)
