"""Petersson's notched beam: two meshes, four elements, three curves, against a cohesive crack.

    python docs/studies/petersson_beam.py KEYWAY FOLDER

Prints the table of docs/verification.md and draws docs/pictures/petersson_beam.png into FOLDER.
"""

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
sys.path.insert(0, str(ROOT / "tests" / "verify"))
sys.path.insert(0, str(ROOT / "tools"))
from harness import Program  # noqa: E402
from keyway_tools.picture_style import new_figure, save_figure  # noqa: E402
from test_petersson_beam import COARSE, FINE, PUBLISHED, beam_curve, reference  # noqa: E402

MESHES = {"10 mm": COARSE, "5 mm": FINE}
STRONG = 330e6  # [Pa], ten times the strength in compression


def line(name, element, mesh, compression, beam) -> None:
    """A row: largest load, loads at the two deflections, distance from the cohesive crack."""
    wanted = reference(name)
    worst = np.abs(np.interp(beam.tip, wanted.tip, wanted.load) - beam.load).max()
    loads = " ".join(f"{beam.at_tip(deflection):7.1f}" for deflection, _ in PUBLISHED)
    share = 100.0 * worst / wanted.load.max()
    print(f"{name:12} {element:6} {mesh:6} {compression / 1e6:4.0f} MPa", end="  ")
    print(f"{beam.load.max():7.1f} {loads} {share:5.1f} %", flush=True)


def main(program: str, folder: str) -> None:
    """Runs and draws."""
    keyway = Program(Path(program).resolve(), Path(folder), 1)
    figure, axes = new_figure(1, width=7.5, row_height=4.0)
    for name, element, compression in (
        ("bilinear", "C3D8", 33e6),
        ("bilinear", "C3D8R", 33e6),
        ("bilinear", "C3D8B", 33e6),
        ("bilinear", "C3D8I", 33e6),
        ("exponential", "C3D8I", 33e6),
        ("bilinear", "C3D8I", STRONG),
        ("exponential", "C3D8I", STRONG),
        ("linear", "C3D8I", STRONG),
    ):
        for size, mesh in MESHES.items():
            beam = beam_curve(keyway, name, mesh, element, compression)
            line(name, element, size, compression, beam)
            if name == "bilinear" and (element == "C3D8" or compression > 33e6):
                label = f"{element}, bricks of {size}"
                label += ", f_c 330 MPa" if compression > 33e6 else ""
                axes.plot(1e3 * beam.tip, beam.load, label=label)
    wanted = reference("bilinear")
    axes.plot(1e3 * wanted.tip, wanted.load, "k--", label="cohesive crack, bilinear")
    wanted = reference("exponential")
    axes.plot(1e3 * wanted.tip, wanted.load, "k:", label="cohesive crack, exponential")
    points = np.array(PUBLISHED)
    axes.errorbar(
        1e3 * points[:, 0], points[:, 1], 0.05 * points[:, 1], fmt="ks", ms=4, capsize=3,
        label="SSNP166, 5 %",
    )  # fmt: skip
    axes.set(xlabel="deflection [mm]", ylabel="load [N]", xlim=(0, 0.8), ylim=(0, 900))
    axes.set_title("Petersson's notched beam")
    axes.legend(loc="lower center")
    print(save_figure(figure, Path(folder) / "petersson_beam.png"))


if __name__ == "__main__":
    main(*sys.argv[1:])
