"""Pictures of different meshes that meet: a patch, tractions of a stiff joint, Hertz's pressure.

    python docs/studies/mesh_pairs.py KEYWAY FOLDER

Draws docs/pictures/mesh_pairs.png and docs/pictures/hertz_pressure.png into FOLDER.
"""

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
for folder in ("tests", "tests/verify", "tools"):
    sys.path.insert(0, str(ROOT / folder))
from exact_fields import uniform  # noqa: E402
from harness import Program  # noqa: E402
from keyway_tools.picture_style import COLOURS, new_figure, save_figure  # noqa: E402
from loaded_pairs import Loaded  # noqa: E402
from mesh_pairs import Pair  # noqa: E402
from test_hertz import CONTACT, PRESSURE, contact  # noqa: E402
from test_mesh_pairs_patch import JOINED, MESHES, six_states  # noqa: E402
from test_mesh_pairs_traction import traction_along  # noqa: E402


def draw_face(axes, pair: Pair, grid: np.ndarray, colour: str, label: str) -> None:
    """Lines of one face's grid."""
    x = pair.local
    for k, line in enumerate([*grid, *grid.T]):
        axes.plot(x[line, 0], x[line, 1], color=colour, lw=1.0, label=label if k == 0 else None)


def draw_patch(keyway: Program, axes, mesh: str) -> None:
    """Both faces of a pair, and the points of their joint."""
    pair = Pair(*MESHES[mesh])
    cards, give = JOINED["joint"]
    loaded = Loaded(pair, {"33": uniform(six_states()["33"], pair, give)})
    run = keyway(loaded.deck(cards("UPPER"), "*JOINT PRINT, JOINT=J\n"), name="patch")
    table = run.csv("joint_J")
    x = np.stack([table[c] for c in "xyz"], axis=1) @ pair.turn
    draw_face(axes, pair, pair.low[:, :, -1], COLOURS[0], "master")
    draw_face(axes, pair, pair.high[:, :, 0], COLOURS[1], "slave")
    axes.plot(x[:, 0], x[:, 1], "o", color=COLOURS[1], ms=4.0)
    assert np.abs(table["tn"] / 1e6 - 1.0).max() < 1e-10
    axes.set(title=f"'{mesh}': 1 MPa at each point", aspect="equal")
    axes.set(xlabel="a [m]", ylabel="b [m]")
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.15), ncols=2)


def draw_tractions(keyway: Program, axes) -> None:
    """Normal traction in the middle plane of a cantilever, 2 against 3 facets; exactly 0."""
    for integration, slave, colour in (
        ("GAUSS", "UPPER", COLOURS[4]),
        ("NODES", "UPPER", COLOURS[1]),
        ("NODES", "LOWER", COLOURS[0]),
    ):
        place, normal, _ = traction_along(keyway, 2, (2, 3), slave, integration)
        finer = "finer" if slave == "UPPER" else "coarser"
        name = f"at nodes, the {finer} face as slave"
        name = name if integration == "NODES" else "at points of the segments"
        axes.plot(place, normal, color=colour, label=name)
    axes.set(title="Traction of a stiff joint, 2 : 3", xlabel="along the cantilever [m]")
    axes.set(ylabel="normal traction / bending stress", ylim=(-1.0, 1.5))
    axes.legend(loc="upper right")


def draw_hertz(keyway: Program, folder: Path) -> None:
    """Pressures over the radius."""
    figure, axes = new_figure(1, width=7.5, row_height=4.0)
    r = np.linspace(0.0, 1.0, 200)
    axes.plot(r, np.sqrt(1.0 - r**2), color="black", label="Hertz")
    for fine, mirrored, colour, name in (
        ((9, 11), True, COLOURS[0], "sphere on its mirror plane, 9 : 11 facets"),
        ((11, 9), True, COLOURS[2], "sphere on its mirror plane, 11 : 9"),
        ((9, 11), False, COLOURS[1], "two spheres as meshed, 9 : 11"),
    ):
        found = contact(keyway, fine, "LOWER", mirrored)
        near = found["r"] < 1.5 * CONTACT
        axes.plot(
            found["r"][near] / CONTACT, found["p"][near] / PRESSURE, "o", ms=3.5, color=colour,
            label=name,
        )  # fmt: skip
    axes.set(xlabel="r / a", ylabel="p / p0", title="Pressure between spheres, R 50 mm, 4 mm")
    axes.legend()
    save_figure(figure, folder / "hertz_pressure.png")


def main(program: str, target: str) -> None:
    """Runs and draws."""
    folder = Path(target)
    keyway = Program(Path(program).resolve(), folder, 1)
    figure, axes = new_figure(1, width=11.0, row_height=4.2, columns=2)
    draw_patch(keyway, axes[0], "by lot")
    draw_tractions(keyway, axes[1])
    save_figure(figure, folder / "mesh_pairs.png")
    draw_hertz(keyway, folder)


if __name__ == "__main__":
    main(*sys.argv[1:])
