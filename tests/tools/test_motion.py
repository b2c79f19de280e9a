"""Ground motions: exact response spectra, fit to the target, rest at the end, reproducible."""

import make_motion
import numpy as np
import pytest
from keyway_tools.design_spectrum import DesignSpectrum
from keyway_tools.ground_motion import MotionOptions, correct_baseline, final_motion, fit_motion
from keyway_tools.response_spectrum import absolute_acceleration, response_spectrum
from scipy.integrate import solve_ivp

SHORT = MotionOptions(num_trials=2, num_scalings=20)


@pytest.fixture(scope="module")
def motion():
    return fit_motion(DesignSpectrum(), [7, 0], SHORT)


def test_spectrum_has_the_corners_of_the_standard():
    beta = DesignSpectrum(plateau=2.5, corner=0.2)
    assert beta([0.0, 0.05, 0.1, 0.2]) == pytest.approx([1.0, 1.75, 2.5, 2.5])
    assert beta(0.4) == pytest.approx(2.5 * 0.5**0.6)
    assert beta(10.0) == pytest.approx(0.5)


def test_step_response_is_the_closed_form():
    """A constant ground acceleration: u'' + 2 z w u' + w^2 u = -1, exact in every step."""
    dt, period, z = 0.05, 0.7, 0.05
    t = dt * np.arange(60)
    w = 2.0 * np.pi / period
    wd = w * np.sqrt(1.0 - z**2)
    decay = np.exp(-z * w * t)
    exact = 1.0 - decay * (np.cos(wd * t) - z / np.sqrt(1.0 - z**2) * np.sin(wd * t))
    found = absolute_acceleration(np.ones(60), dt, period, z)
    # at t = 0 the oscillator has neither moved nor any velocity
    assert found == pytest.approx(exact, abs=1e-12)


def test_response_to_noise_is_what_an_integrator_finds():
    dt, period, z = 0.02, 0.3, 0.05
    ground = np.random.default_rng(3).normal(size=100)
    t = dt * np.arange(100)
    w = 2.0 * np.pi / period

    def rate(time, state):
        return [state[1], -np.interp(time, t, ground) - 2.0 * z * w * state[1] - w**2 * state[0]]

    state = np.zeros(2)
    found = [0.0]
    for n in range(99):  # one call a piece: the corners of the ground motion are no obstacle
        state = solve_ivp(rate, t[n : n + 2], state, rtol=1e-10, atol=1e-13).y[:, -1]
        found.append(-(2.0 * z * w * state[1] + w**2 * state[0]))
    assert absolute_acceleration(ground, dt, period, z) == pytest.approx(found, abs=1e-7)


def test_resonance_of_a_sine():
    """Steady state at resonance: sqrt(1 + 4 z^2) / (2 z) of the ground acceleration."""
    t = np.arange(0.0, 60.0, 0.005)
    spectrum = response_spectrum(np.sin(2.0 * np.pi * t), 0.005, [1.0])
    assert spectrum[0] == pytest.approx(np.sqrt(1.0 + 0.01) / 0.1, rel=2e-3)


def test_stiff_oscillator_moves_with_the_ground(motion):
    assert response_spectrum(motion.acceleration, 0.01, [0.005])[0] == pytest.approx(1.0, rel=0.02)


def test_record_fits_its_target(motion):
    assert motion.mean_misfit < 0.05
    assert np.abs(motion.misfit).max() < 0.25


def test_peak_is_the_specified_one(motion):
    assert np.abs(motion.acceleration).max() == pytest.approx(1.0, rel=1e-14)


def test_ground_is_at_rest_at_the_end(motion):
    assert final_motion(motion.acceleration, 0.01) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert motion.acceleration[0] == 0.0
    assert abs(motion.acceleration[-1]) < 1e-12


def test_baseline_leaves_a_resting_record_alone():
    shape = np.sin(np.linspace(0.0, np.pi, 1001)) ** 2
    once = correct_baseline(np.random.default_rng(1).normal(size=1001) * shape, 0.01, shape)
    assert final_motion(once, 0.01) == pytest.approx([0.0, 0.0], abs=1e-12)


def test_same_seed_same_record(motion):
    again = fit_motion(DesignSpectrum(), [7, 0], SHORT)
    assert np.array_equal(again.acceleration, motion.acceleration)
    other = fit_motion(DesignSpectrum(), [8, 0], SHORT)
    assert not np.allclose(other.acceleration, motion.acceleration)


def test_files_hold_the_record_and_pictures_appear(tmp_path, capsys):
    assert (
        make_motion.main(["-o", str(tmp_path / "m"), "--duration", "4", "--format", "PAIRS"]) == 0
    )
    names = {path.name for path in tmp_path.iterdir()}
    assert names >= {"m_x.txt", "m_y.txt", "m_z.txt", "m.json", "m_spectra.png", "m_records.png"}
    pairs = np.loadtxt(tmp_path / "m_z.txt", delimiter=",")
    assert pairs[:, 0] == pytest.approx(0.01 * np.arange(401))
    assert np.abs(pairs[:, 1]).max() == pytest.approx(0.269 * 9.81 * 2.0 / 3.0, rel=1e-11)
    assert "mean misfit" in capsys.readouterr().out


def test_impossible_times_are_refused(tmp_path, capsys):
    assert make_motion.main(["-o", str(tmp_path / "m"), "--duration", "0.1"]) == 2
    assert "duration" in capsys.readouterr().err
