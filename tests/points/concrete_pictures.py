"""Pictures and numbers of docs/concrete_validation.md from the curves of concrete_validation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import published
from concrete_validation import (
    GOPALARATNAM_SHAH_LENGTHS,
    KARSAN_JIRSA_PEAK,
    KARSAN_JIRSA_TURNS,
    at,
    biaxial_envelope,
    opening,
    residuals,
)
from concretes import JINPING, TABLE_1
from keyway_tools.picture_style import new_figure, save_figure
from point_decks import Curve

MILLI, MEGA = 1e-3, 1e6
POINTS = {"linestyle": "none", "marker": "o", "markerfacecolor": "none", "color": "black"}


def axial(curve: Curve) -> tuple[np.ndarray, np.ndarray]:
    """Sizes of strain in 1e-3 and stress in MPa."""
    sign = 1.0 if abs(curve.stress[:, 0].max()) > abs(curve.stress[:, 0].min()) else -1.0
    return sign * curve.strain[:, 0] / MILLI, sign * curve.stress[:, 0] / MEGA


def finish(axes, x: str, y: str, title: str) -> None:
    axes.set(xlabel=x, ylabel=y, title=title)
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    axes.legend()


def draw_table_1(curves, axes) -> None:
    rows = TABLE_1[:, 1] + TABLE_1[:, 0] / JINPING.young
    axes.plot(*axial(curves["TABLE1CYCLES"]), "C1-", lw=1.0, label="with unloading")
    axes.plot(*axial(curves["TABLE1"]), "C0-", label="one pull")
    axes.plot(rows / MILLI, TABLE_1[:, 0] / MEGA, label="Table 1", **POINTS)
    finish(axes, "strain [1e-3]", "stress [MPa]", "Tension, Table 1 (Fig 12)")


def draw_gopalaratnam(curves, axes) -> None:
    for length, style in zip(GOPALARATNAM_SHAH_LENGTHS, ("C0-", "C1--"), strict=True):
        width, share = opening(curves[f"GOPALARATNAM{round(1e3 * length)}"], length)
        axes.plot(width / 1e-6, share, style, label=f"program, length {1e3 * length:.0f} mm")
    width = np.linspace(0.0, 70e-6, 15)
    fit = published.gopalaratnam_shah(width)
    axes.plot(width / 1e-6, fit, label="Gopalaratnam & Shah 1985, fit", **POINTS)
    finish(axes, "opening [1e-6 m]", "stress over its peak", "Softening in tension")


def draw_exponential(curves, sign: str, points: np.ndarray, axes) -> None:
    axes.plot(*axial(curves[f"EXACT{sign}"]), "C0-", label="exponential law")
    axes.plot(*axial(curves[f"STEPS{sign}"]), "C1--", label="as in increments of 1e-4")
    axes.plot(points[:, 0] / MILLI, points[:, 1] / MEGA, label="blackbear", **POINTS)
    name = {"T": "tension", "C": "compression"}[sign]
    finish(axes, "strain [1e-3]", "stress [MPa]", f"Lee and Fenves' laws, {name}")


def draw_karsan(curves, axes) -> None:
    axes.plot(*axial(curves["KARSANLEEFENVES"]), "C2:", label="Lee and Fenves' constants")
    axes.plot(*axial(curves["KARSAN"]), "C0-", label="fitted, with unloading")
    points = published.KARSAN_JIRSA_ENVELOPE
    axes.plot(*points.T, label="Karsan & Jirsa 1969, envelope", **POINTS)
    turns = np.array(KARSAN_JIRSA_TURNS)
    rest = published.karsan_jirsa_residual(turns, KARSAN_JIRSA_PEAK)
    axes.plot(rest / MILLI, 0.0 * rest, "kx", label="their residual strains", clip_on=False)
    finish(axes, "strain [1e-3]", "stress [MPa]", "Cyclic compression")


KUPFER = (
    ("1", published.KUPFER_UNIAXIAL, "C0", "o", "1 : 0"),
    ("EQUAL", published.KUPFER_EQUAL, "C1", "s", "1 : 1"),
    ("HALF", published.KUPFER_HALF, "C2", "^", "1 : 0.52"),
)


def draw_kupfer_curves(curves, axes) -> None:
    for name, points, colour, marker, label in KUPFER:
        axes.plot(*axial(curves[f"KUPFER{name}"]), color=colour, label=label)
        axes.plot(*points.T, color=colour, marker=marker, ls="none", mfc="none")
    finish(axes, "strain [1e-3]", "larger stress [MPa]", "Kupfer et al. 1969 (points) and program")


def draw_kupfer_envelope(curves, axes) -> None:
    ratio, peak = biaxial_envelope(curves).T
    axes.plot(ratio, peak, "C0-", label="program, f_b0/f_c0 1.16")
    axes.plot(ratio, published.kupfer_gerstle(ratio), "C1--", label="Kupfer & Gerstle 1973, fit")
    whole = published.KUPFER_UNIAXIAL[:, 1].max()
    found = [(r, p[:, 1].max() / whole) for r, p in published.KUPFER_RATIOS]
    axes.plot(*np.array(found).T, label="Kupfer et al. 1969", **POINTS)
    axes.set(xlim=(0.0, 1.0), ylim=(0.9, 1.4), xlabel="ratio of the stresses")
    axes.set(ylabel="larger stress at failure over f_c", title="Biaxial strength")
    axes.legend()


def draw_all(curves: dict[str, Curve], folder: Path) -> None:
    """Writes the pictures."""

    def picture(name: str, *parts) -> None:
        figure, all_axes = new_figure(columns=2, width=10.0, row_height=3.4)
        for part, axes in zip(parts, all_axes, strict=True):
            part(axes)
        save_figure(figure, folder / f"concrete_{name}.png")

    picture("tension", lambda a: draw_table_1(curves, a), lambda a: draw_gopalaratnam(curves, a))
    picture(
        "exponential",
        lambda a: draw_exponential(curves, "T", published.BLACKBEAR_TENSION, a),
        lambda a: draw_exponential(curves, "C", published.BLACKBEAR_COMPRESSION, a),
    )
    picture(
        "compression",
        lambda a: draw_karsan(curves, a),
        lambda a: draw_kupfer_curves(curves, a),
    )
    figure, axes = new_figure(width=5.0, row_height=3.4)
    draw_kupfer_envelope(curves, axes)
    save_figure(figure, folder / "concrete_biaxial.png")


def print_numbers(curves: dict[str, Curve]) -> None:
    """The numbers of the page."""
    for name in ("EXACT", "STEPS"):
        for sign, points in (
            ("T", published.BLACKBEAR_TENSION),
            ("C", published.BLACKBEAR_COMPRESSION),
        ):
            found = at(curves[f"{name}{sign}"], points[:, 0])
            print(name, sign, found / MEGA, found / points[:, 1] - 1.0)
    points = published.KARSAN_JIRSA_ENVELOPE
    for name in ("KARSANENVELOPE", "KARSANLEEFENVES"):
        apart = at(curves[name], points[:, 0] * MILLI) / MEGA - points[:, 1]
        print(name, "rms", np.sqrt(np.mean(apart**2)), "largest", np.abs(apart).max())
    print("residual", residuals(curves["KARSAN"]) / MILLI)
    rest = published.karsan_jirsa_residual(np.array(KARSAN_JIRSA_TURNS), KARSAN_JIRSA_PEAK)
    print("theirs", rest / MILLI)
    for name, points, *_ in KUPFER:
        curve = curves[f"KUPFER{name}"]
        apart = at(curve, points[:, 0] * MILLI) / MEGA - points[:, 1]
        top = int(np.argmax(np.abs(curve.stress[:, 0])))
        print(name, "rms", np.sqrt(np.mean(apart**2)), "peak", axial(curve)[1][top], end=" ")
        print("at", axial(curve)[0][top], "theirs", points[np.argmax(points[:, 1])])
    print(biaxial_envelope(curves))
    for length in GOPALARATNAM_SHAH_LENGTHS:
        width, share = opening(curves[f"GOPALARATNAM{round(1e3 * length)}"], length)
        print(length, np.abs(share - published.gopalaratnam_shah(width)).max())
