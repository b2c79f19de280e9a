"""What joints between different meshes cost an arch dam: the paper's chain and joints on surfaces.

    python docs/studies/different_meshes.py KEYWAY FOLDER [--only NAME ..] [--element C3D8]

The dam of input/xingbiling_matching on cells of 16 x 7 (tools/make_dam.py), weight, water and its
10 s of motion. Blocks have 2 elements along a cell's side and 2 through the thickness; the middle
block is finer or shifted. Finished runs in FOLDER are kept. Writes the tables of
docs/studies/different_meshes.md to FOLDER/tables.md, from the job.json files there.
"""

import argparse
import contextlib
import io
import json
import subprocess
import sys
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import h5py  # noqa: E402
import make_dam  # noqa: E402
import numpy as np  # noqa: E402
from keyway_tools.paper_study.checks import excess  # noqa: E402

CELLS = "--arc 16 --levels 7 --bottom 2 --thick 2 --joints 2 --refine 2"
AXIS_Y = 254.886  # of the crest's upstream arc [m]
JOINT = 0.2715  # angle of the joints' planes from the crown [rad]
FOOT = 40.0  # [m]; below, the foot's edges are singular: stresses follow the mesh without end
MOTION = [str(ROOT / f"input/xingbiling_matching/motion_{axis}.txt") for axis in "xyz"]
THREE = "--fine-refine 3 --fine-thick 3"
FOUR = "--fine-refine 4 --fine-thick 4"
SAME = "--fine-refine 2 --fine-thick 2"
SHIFT = f"--fine 2 {SAME} --shift 0.5"
BASE3 = "--refine 3 --thick 3"
SHIFT3 = f"{THREE} --shift 0.5"
QUANTITIES = tuple(
    (name, side) for name in ("S1", "S3", "OPENING") for side in ("upstream", "downstream")
)


@dataclass(frozen=True)
class Case:
    """A dam of the study; `fine` is the matching mesh whose middle block it has."""

    title: str
    joined: str
    options: str
    fine: str = ""  # "" for a matching mesh
    coarse: str = "coarse"  # the matching mesh whose other blocks it has


CASES = {
    "classical": Case("matching, 2, foot shared", "JOINT8", "", "coarse"),
    "coarse": Case("matching, 2", "JOINT8", ""),
    "three": Case("matching, 3", "JOINT8", f"--fine 1 2 3 {THREE}"),
    "four": Case("matching, 4", "JOINT8", f"--fine 1 2 3 {FOUR}"),
    "shifted": Case("matching, 2, levels shifted", "JOINT8", f"--fine 1 2 3 {SAME} --shift 0.5"),
    "three_surfaces": Case("3:2", "surfaces", f"--fine 2 {THREE}", "three"),
    "three_chain": Case("3:2", "chain", f"--fine 2 {THREE} --join chain", "three"),
    "four_surfaces": Case("2:1", "surfaces", f"--fine 2 {FOUR}", "four"),
    "four_chain": Case("2:1", "chain", f"--fine 2 {FOUR} --join chain", "four"),
    "local_surfaces": Case(
        "2:1, upper third", "surfaces", f"--fine 2 {FOUR} --fine-above 0.66", "four"
    ),
    "local_chain": Case(
        "2:1, upper third", "chain", f"--fine 2 {FOUR} --fine-above 0.66 --join chain", "four"
    ),
    "four_swapped": Case(
        "2:1, coarse slave", "surfaces", f"--fine 2 {FOUR} --slave coarse", "four"
    ),
    "three_swapped": Case(
        "3:2, coarse slave", "surfaces", f"--fine 2 {THREE} --slave coarse", "three"
    ),
    "equal_surfaces": Case("1:1", "surfaces", "--join surfaces", "coarse"),
    "equal_chain": Case("1:1", "chain", "--join chain", "coarse"),
    "shifted_surfaces": Case("1:1, levels shifted", "surfaces", SHIFT, "shifted"),
    "shifted_chain": Case("1:1, levels shifted", "chain", f"{SHIFT} --join chain", "shifted"),
    "base3": Case("matching, 3, rock 3", "JOINT8", BASE3, coarse="base3"),
    "shifted3": Case(
        "the same, levels shifted", "JOINT8", f"{BASE3} --fine 1 2 3 {SHIFT3}", coarse="base3"
    ),
    "shifted3_surfaces": Case(
        "1:1 of these", "surfaces", f"{BASE3} --fine 2 {SHIFT3}", "shifted3", "base3"
    ),
    "shifted3_chain": Case(
        "1:1 of these", "chain", f"{BASE3} --fine 2 {SHIFT3} --join chain", "shifted3", "base3"
    ),
}


def run_case(program: str, folder: Path, name: str, extra: list[str]) -> bool:
    """Make the deck and run it, unless that is done; False when it stops."""
    place = folder / name
    report = place / "results" / "dam.json"
    if report.exists() and json.loads(report.read_text())["status"] == "finished":
        return True
    options = [*CELLS.split(), *CASES[name].options.split(), *extra]
    options += [] if name == "classical" else ["--tie-all"]
    with contextlib.redirect_stdout(io.StringIO()) as said:
        code = make_dam.main(["-o", str(place / "dam.inp"), *options])
    assert code == 0, said.getvalue()
    command = [program, "-q", "-j", "1", "-o", str(place / "results"), str(place / "dam.inp")]
    done = subprocess.run(command, capture_output=True, text=True)
    (place / "said.txt").write_text(done.stdout + done.stderr)
    print(f"{name}: exit code {done.returncode} {done.stderr[-300:]}", flush=True)
    return done.returncode == 0


def read(folder: Path, name: str) -> dict | None:
    """Summary of a finished run."""
    file = folder / name / "results" / "dam.json"
    report = json.loads(file.read_text()) if file.exists() else {"status": "missing"}
    return report if report["status"] == "finished" else None


def extremes(report: dict) -> list[float]:
    """Values of QUANTITIES."""
    return [report["envelopes"][name][side]["value"] for name, side in QUANTITIES]


def row(name: str, reports: dict[str, dict], chosen: tuple[str, ...]) -> str:
    """Line of a main table: values, and in percent the distance from the coarse matching mesh."""
    case, report = CASES[name], reports[name]
    coarse = extremes(reports[case.coarse])
    cells = [case.title, case.joined]
    cells += [str(report["model"]["unknowns"])] if "OPENING" in chosen else []
    worst = 0.0
    fine = extremes(reports[case.fine]) if case.fine in reports else coarse
    for (quantity, _), value, old, new in zip(
        QUANTITIES, extremes(report), coarse, fine, strict=True
    ):
        if quantity not in chosen:
            continue
        scale, digits = (1e3, 2) if quantity == "OPENING" else (1e-6, 3)
        change = 100.0 * (value / old - 1.0) if abs(old) > 1e-5 else 0.0
        cells.append(
            f"{scale * value:.{digits}f}" + ("" if name == case.coarse else f" ({change:+.2f})")
        )
        worst = max(worst, 100.0 * excess(value, old, new))
    cells.append(f"{worst:.2g} %" if case.fine else "")
    return "| " + " | ".join(cells) + " |"


def main_tables(folder: Path) -> str:
    """Tables of stresses and of openings in all finished cases."""
    reports = {name: read(folder, name) for name in CASES}
    reports = {name: report for name, report in reports.items() if report}
    return "\n".join(
        main_table(reports, first, texts)
        for first, texts in (
            (["mesh", "joined by"], {"S1": "S1 [MPa]", "S3": "S3 [MPa]"}),
            (["mesh", "joined by", "unknowns"], {"OPENING": "opening [mm]"}),
        )
    )


def main_table(reports: dict[str, dict], first: list[str], texts: dict[str, str]) -> str:
    """The table of some quantities; `texts` gives their heads."""
    heads = [*first, *(f"{text} {side}" for text in texts.values() for side in ("up", "down"))]
    heads.append("outside")
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    lines += [row(name, reports, tuple(texts)) for name in CASES if name in reports]
    return "\n".join(lines) + "\n"


def face_envelopes(folder: Path, name: str) -> dict[tuple, np.ndarray]:
    """Largest S1 and smallest S3 [Pa] at the faces' nodes, by place and block of the node."""
    with h5py.File(folder / name / "results" / "dam.h5") as file:
        x = file["mesh/x"][:]
        nodes = file["mesh/connectivity"][:][file["mesh/section"][:] == 0][:, :8]
        is_face = (file["faces/upstream"][:] + file["faces/downstream"][:]) > 0
        steps = [step["envelopes"] for step in file["steps"].values() if "envelopes" in step]
        high = np.max([step["S1_MAX"][:] for step in steps], axis=0)
        low = np.min([step["S3_MIN"][:] for step in steps], axis=0)
    centre = x[nodes].mean(axis=1)
    angle = np.arctan2(centre[:, 0], AXIS_Y - centre[:, 1])
    found = {}
    for block, is_in in enumerate((angle < -JOINT, abs(angle) < JOINT, angle > JOINT)):
        for node in np.unique(nodes[is_in]):
            if is_face[node]:
                found[(block, *np.round(x[node], 4))] = np.array([high[node], low[node]])
    return found


def field_row(folder: Path, name: str) -> str:
    """How far S1 and S3 lie outside of both matching meshes, at nodes that all three have."""
    meshes = [face_envelopes(folder, n) for n in (name, CASES[name].coarse, CASES[name].fine)]
    places = [p for p in meshes[0] if p in meshes[1] and p in meshes[2] and p[3] > FOOT]
    value, coarse, fine = (np.array([mesh[p] for p in places]) for mesh in meshes)
    low, high = np.minimum(coarse, fine), np.maximum(coarse, fine)
    outside = np.maximum(np.maximum(low - value, value - high), 0.0) / np.abs(coarse).max(axis=0)
    gain = np.abs(fine - coarse) / np.abs(coarse).max(axis=0)
    cells = [CASES[name].title, CASES[name].joined, str(len(places))]
    for k in range(2):
        cells += [f"{100 * f(v[:, k]):.2g}" for v in (outside, gain) for f in (np.max, np.mean)]
    return "| " + " | ".join(cells) + " |"


def field_table(folder: Path) -> str:
    """Fields of the faces against the two matching meshes."""
    heads = ["mesh", "joined by", "nodes"]
    heads += [
        f"{q}: {what}, {how}"
        for q in ("S1", "S3")
        for what in ("outside", "coarse to fine")
        for how in ("largest", "mean")
    ]
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    names = [n for n in CASES if CASES[n].fine and read(folder, n) and read(folder, CASES[n].fine)]
    return "\n".join([*lines, *(field_row(folder, name) for name in names)]) + "\n"


def effort_table(folder: Path) -> str:
    """Points of the joints, iterations, cut-backs of every case."""
    lines = ["| mesh | joined by | joint points | iterations an increment | most | cut back |"]
    lines += ["|---|---|---|---|---|---|"]
    for name, case in CASES.items():
        report = read(folder, name)
        if report is None:
            continue
        steps = report["steps"]
        increments = sum(step["increments"] for step in steps)
        iterations = sum(step["iterations"] for step in steps) / increments
        cuts = sum(step["cutbacks"] for step in steps)
        points = sum(joint["points"] for joint in report["joints"].values())
        most = report["accuracy"]["most_iterations"]
        cells = (case.title, case.joined, points, f"{iterations:.2f}", most, cuts)
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run what is asked for; write the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", nargs="+", default=["*"], help="names of cases, with * and ?")
    parser.add_argument("--element", default="C3D8", help="of dam and rock (C3D8)")
    parser.add_argument("--static", action="store_true", help="weight and water alone")
    parser.add_argument("--bonded", action="store_true", help="joints that never open")
    chosen = parser.parse_args()
    extra = ["--element", chosen.element]
    extra += [] if chosen.static else ["--motion", *MOTION]
    extra += ["--bonded"] if chosen.bonded else []
    for name in CASES:
        if any(fnmatch(name, word) for word in chosen.only):
            run_case(chosen.program, chosen.folder, name, extra)
    tables = (main_tables, field_table, effort_table)
    text = "\n".join(table(chosen.folder) for table in tables)
    (chosen.folder / "tables.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
