"""The command line: options, exit codes, the reference of keywords, the check of a deck."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

BLOCK = """*ELEMENT, TYPE=C3D8, ELSET=BLOCK
1, 1, 2, 3, 4, 5, 6, 7, 8
*NODE, NSET=ALL
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*NSET, NSET="Base of it", GENERATE
1, 4
*SOLID SECTION, ELSET=Block, MATERIAL=ROCK
*MATERIAL, NAME=ROCK
*DENSITY
2400.
*ELASTIC,
20.D9, .24
*BOUNDARY
BASE OF IT, PINNED
5, 2
*STEP
*STATIC
*DLOAD
BLOCK, GRAV, 9.81, 0, 0, -1
*CLOAD
7, 1, 5.
*END STEP
*STEP, NAME=MORE
*STATIC
*DLOAD
BLOCK, GRAV, 10., 0, 0, -2
*END STEP
*STEP, NAME=TURNED
*STATIC
*DLOAD
BLOCK, GRAV, 1., 1, 0, 0
*BOUNDARY, OP=NEW
BASE OF IT, 1, 3
*END STEP
*STEP, NAME=CLEARED
*STATIC
*CLOAD, OP=NEW
7, 2, 1.
*DLOAD, OP=NEW
1, P2, 1e5
*END STEP
"""


def run(program: Path, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(program.resolve()), *arguments], cwd=folder, capture_output=True, text=True
    )


def steps_of(text: str) -> dict[str, list[str]]:
    """Lines of `--check` below each 'Step n NAME'."""
    steps: dict[str, list[str]] = {}
    name = ""
    for line in text.splitlines():
        if line.startswith("Step "):
            name = line.split(maxsplit=2)[2]
            steps[name] = []
        elif name:
            steps[name].append(" ".join(line.split()))
    return steps


def test_check_lists_what_each_step_inherits(program_path: Path, tmp_path: Path) -> None:
    (tmp_path / "block.inp").write_text(BLOCK)
    done = run(program_path, tmp_path, "--check", "block.inp")
    assert done.returncode == 0, done.stderr
    assert done.stderr.startswith("block.inp:")
    assert "warning: 'BLOCK GRAV' of an earlier step ends" in done.stderr
    steps = steps_of(done.stdout)
    assert list(steps) == ["STEP-1", "MORE", "TURNED", "CLEARED"]

    def loads(name: str) -> list[str]:
        return sorted(x.split(" ", 2)[2] for x in steps[name] if x.startswith("load "))

    first, last = (
        f", sum of the forces {force} N, loaded nodes: 1" for force in ("5 0 0", "0 1 0")
    )
    assert loads("STEP-1") == [
        "gravity BLOCK: factor 0 to 9.81",
        f"point forces: factor 0 to 1{first}",
    ]
    assert loads("MORE") == [
        "gravity BLOCK: factor 9.81 to 10",
        f"point forces: factor 1 to 1{first}",
    ]
    # Another direction: the old weight fades while the new one comes in.
    assert loads("TURNED") == [
        "gravity BLOCK: factor 0 to 1",
        "gravity BLOCK: factor 10 to 0",
        f"point forces: factor 1 to 1{first}",
    ]
    assert loads("CLEARED") == [
        "gravity BLOCK: factor 1 to 0",
        f"point forces: factor 0 to 1{last}",
        f"point forces: factor 1 to 0{first}",
        "pressure 1 P2: factor 0 to 100000",
    ]
    supports = [next(x for x in lines if x.startswith("supports")) for lines in steps.values()]
    assert [int(x.split()[1]) for x in supports] == [13, 13, 12, 12]


def test_check_says_how_a_load_changes(program_path: Path, tmp_path: Path) -> None:
    """By an amplitude, by a ramp, or at once where there is inertia. It then keeps its value."""
    cards = "*AMPLITUDE, NAME=PULSE\n0., 0., 0.1, 3.\n"
    model = BLOCK[: BLOCK.index("*STEP")] + cards
    weight = "*DLOAD{}\nBLOCK, GRAV, {}, 0., 0., -1.\n"
    steps = [
        "*STATIC\n" + weight.format("", "9.81"),
        "*DYNAMIC, DIRECT\n0.01, 0.1\n" + weight.format("", "10."),
        "*DYNAMIC, DIRECT\n0.01, 0.1\n" + weight.format(", AMPLITUDE=PULSE", "2."),
        "*DYNAMIC, DIRECT\n0.01, 0.1\n",
    ]
    deck = model + "".join(f"*STEP\n{step}*END STEP\n" for step in steps)
    (tmp_path / "block.inp").write_text(deck)
    done = run(program_path, tmp_path, "--check", "block.inp")
    assert done.returncode == 0, done.stderr
    lines = steps_of(done.stdout).values()
    assert [[x.split(": ", 1)[1] for x in step if x.startswith("load ")] for step in lines] == [
        ["factor 0 to 9.81"],
        ["factor 10 from the start, 9.81 before"],
        ["factor 2 times amplitude PULSE"],
        ["factor 6"],
    ]


def test_prints_of_a_step_replace_those_of_their_kind(program_path: Path, tmp_path: Path) -> None:
    """The first *NODE PRINT of a step ends those of earlier steps; further ones are added."""
    base = "*NODE PRINT, NSET=BASE OF IT"
    steps = [
        f"*EL PRINT, ELSET=BLOCK\nS\n*NODE PRINT, NSET=ALL\nU\n{base}\nRF",
        f"{base}, FREQUENCY=3\nU\n*NODE PRINT, NSET=ALL, FREQUENCY=0\nU",
        "*EL PRINT, ELSET=BLOCK, FREQUENCY=0\nS",
    ]
    model = BLOCK[: BLOCK.index("*STEP")]
    deck = model + "".join(f"*STEP\n*STATIC\n{cards}\n*END STEP\n" for cards in steps)
    (tmp_path / "block.inp").write_text(deck)
    lines = steps_of(run(program_path, tmp_path, "--check", "block.inp").stdout).values()
    assert [[x.split(" ", 1)[1] for x in step if x.startswith("print ")] for step in lines] == [
        ["ELSET BLOCK: S every 1", "NSET ALL: U every 1", "NSET BASE OF IT: RF every 1"],
        ["ELSET BLOCK: S every 1", "NSET BASE OF IT: U every 3"],
        ["NSET BASE OF IT: U every 3"],
    ]


def test_echo_shows_defaults(program_path: Path, tmp_path: Path) -> None:
    (tmp_path / "block.inp").write_text(BLOCK)
    echo = run(program_path, tmp_path, "--check", "block.inp").stdout
    assert "*ELASTIC, TYPE=ISOTROPIC" in echo
    assert "*SOLID SECTION, ELSET=Block, MATERIAL=ROCK, MASS=CONSISTENT" in echo
    assert not list(tmp_path.glob("block*.json")), "--check solves nothing"


def test_joint_stiffness_from_the_slave_side(program_path: Path) -> None:
    """paper_notes.md, 3: k_n = E / 0.02 m, k_t = k_n / (2 (1 + nu)); here E 22e9, nu 0.167."""
    deck = Path(__file__).parent.parent / "input" / "xingbiling_matching"
    done = run(program_path, deck, "--check", "xingbiling_matching.inp")
    assert done.returncode == 0, done.stderr
    assert "KN 1.1e12 Pa/m, KT 4.71294e11 Pa/m" in done.stdout


def test_reads_150_000_nodes_in_two_seconds(program_path: Path, tmp_path: Path) -> None:
    if "release" not in str(program_path):
        pytest.skip("a matter of the release build")
    n = 53
    lines = ["*NODE, NSET=ALL"]
    for k in range(n**3):
        x, y, z = k % n, k // n % n, k // n**2
        lines.append(f"{k + 1}, {x * 1.37:.6f}, {y * 2.113:.6f}, {z * 0.917:.6f}")
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=DAM")
    corners = [0, 1, 1 + n, n, n * n, 1 + n * n, 1 + n + n * n, n + n * n]
    starts = [
        1 + x + n * y + n * n * z for z in range(n - 1) for y in range(n - 1) for x in range(n - 1)
    ]
    for e, a in enumerate(starts, 1):
        lines.append(", ".join(str(i) for i in [e, *(a + c for c in corners)]))
    lines.append(f"*NSET, NSET=BASE, GENERATE\n1, {n * n}\n*NSET, NSET=MANY")
    lines += [", ".join(str(i) for i in range(k, k + 8)) for k in range(1, n**3 - 8, 8)]
    lines.append(BLOCK[BLOCK.index("*MATERIAL") : BLOCK.index("*BOUNDARY")])
    lines.append("*SOLID SECTION, ELSET=DAM, MATERIAL=ROCK\n*BOUNDARY\nBASE, 1, 3\n*STEP\n*STATIC")
    lines.append("*DLOAD\nDAM, GRAV, 9.81, 0, 0, -1\n*END STEP")
    (tmp_path / "big.inp").write_text("\n".join(lines))
    done = run(program_path, tmp_path, "-q", "--check", "big.inp")
    assert done.returncode == 0, done.stderr
    cost = done.stdout.partition("Cost on this machine\n")[2].splitlines()
    reason = "no forecast: planning the factor of more than 300000 unknowns takes too long"
    assert cost[0].split(maxsplit=2)[2] == reason
    assert re.fullmatch(r" +files +about \S+ MB", cost[1])
    timed = subprocess.run(
        ["bash", "-c", 'time "$0" --check big.inp > /dev/null', str(program_path.resolve())],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={"TIMEFORMAT": "%U %S"},
    )
    seconds = sum(float(x) for x in timed.stderr.split())
    assert seconds < 2.0, "processor time to read and verify 148 877 nodes, 140 608 elements"


@pytest.mark.parametrize(
    ("arguments", "code", "stream", "text"),
    [
        ([], 0, "stdout", "usage: keyway [options] job.inp"),
        (["--help"], 0, "stdout", "--check"),
        (["--version"], 0, "stdout", "SuiteSparse"),
        (["--keywords"], 0, "stdout", "*BASE MOTION"),
        (["--keywords", "joint", "law"], 0, "stdout", "TENSILE STRENGTH"),
        (["--keywords", "*elastic"], 0, "stdout", "Young's modulus; a number > 0 [Pa]; required"),
        (["--keywords", "STATC"], 2, "stderr", "did you mean '*STATIC'?"),
        (["--fields"], 0, "stdout", "OPENING"),
        (["--fields", "traction"], 0, "stdout", "TN,T1,T2"),
        (["--fields", "FOO"], 2, "stderr", "'FOO'; expected a name of keyway --fields"),
        (["--fields", "OPENIN"], 2, "stderr", "did you mean 'OPENING'?"),
        (["--chekc", "a.inp"], 2, "stderr", "did you mean '--check'?"),
        (["--umat", "lib.so", "a.inp"], 2, "stderr", "cannot load the UMAT"),
        (["--continue", "nowhere.inp"], 2, "stderr", "cannot read 'nowhere.inp'"),
        (["-q"], 2, "stderr", "no deck is named"),
        (["-j", "many", "a.inp"], 2, "stderr", "expected a number of threads from 1 to 256"),
        (["-o"], 2, "stderr", "-o needs a value"),
        (["-o", "", "job.inp"], 2, "stderr", "-o needs a value"),
        (["nowhere.inp"], 2, "stderr", "cannot read 'nowhere.inp'"),
    ],
)
def test_options(arguments, code, stream, text, program_path: Path, tmp_path: Path) -> None:
    done = run(program_path, tmp_path, *arguments)
    assert done.returncode == code
    assert text in getattr(done, stream)


@pytest.mark.parametrize("line", ["\x1a", "\x0c\n", " \x1a\r\n"])
def test_a_mark_of_old_systems_has_no_effect(line, program_path: Path, tmp_path: Path) -> None:
    (tmp_path / "job.inp").write_bytes((BLOCK + line).encode())
    done = run(program_path, tmp_path, "--check", "job.inp")
    assert done.returncode == 0
    at = BLOCK.count("\n") + 1
    assert done.stderr.startswith(f"job.inp:{at}: warning: a line of control characters alone")


@pytest.mark.parametrize(
    ("word", "hidden", "letter"),
    [
        ("*STATIC", "*STATIC\u00a0", "a no-break space (U+00A0)"),
        ("20.D9", "\u00a020.D9", "a no-break space (U+00A0)"),
        ("MATERIAL=ROCK", "MATERIAL=ROCK\u200b", "a letter without width (U+200B)"),
        ("*DENSITY", "*DEN\x0cSITY", "a control character (U+000C)"),
    ],
)
def test_invisible_letters_are_named(
    word, hidden, letter, program_path: Path, tmp_path: Path
) -> None:
    deck = BLOCK.replace(word, hidden, 1)
    (tmp_path / "job.inp").write_text(deck, encoding="utf-8")
    done = run(program_path, tmp_path, "--check", "job.inp")
    assert done.returncode == 2
    assert f"; the word has {letter}" in done.stderr


def test_numbers_of_three_digit_exponents_keep_their_e(program_path: Path, tmp_path: Path) -> None:
    test = "*MATERIAL, NAME=A\n*ELASTIC\n{}, 0.2\n*MATERIAL TEST, NAME=T\n1e-4, 1\n"
    for young, stress in (("25e9", "2.50000E+06"), ("25e148", "2.50000E+145")):
        (tmp_path / "job.inp").write_text(test.format(young))
        row = run(program_path, tmp_path, "--material", "job.inp").stderr.splitlines()[1]
        start = f"T                    S11 {stress:>12}  1.000E-04  0.00000E+00  0.000E+00 "
        assert row.startswith(start)


@pytest.mark.parametrize("folder", ["job.inp", "job.inp/results"])
def test_a_file_in_place_of_a_folder(folder, program_path: Path, tmp_path: Path) -> None:
    """A mistake in the command line: the system has not failed. The deck stays as it is."""
    deck = BLOCK.replace("BASE OF IT, PINNED\n5, 2\n", "BASE OF IT, PINNED\n")
    (tmp_path / "job.inp").write_text(deck)
    done = run(program_path, tmp_path, "-q", "-o", folder, "job.inp")
    assert done.returncode == 2
    assert f"cannot write in the folder '{folder}': a file has this name" in done.stderr
    assert (tmp_path / "job.inp").read_text() == deck


def test_a_run_leaves_nothing_of_an_earlier_one(program_path: Path, tmp_path: Path) -> None:
    steps = "*STEP\n*STATIC, DIRECT\n{}, 1.\n*CLOAD\n7, 1, 5.\n{}*NODE FILE\nU\n*END STEP\n"
    deck = tmp_path / "job.inp"
    other = tmp_path / "job_node_OTHER.csv"
    other.write_text("of somebody else\n")
    for increment, request in ((0.25, "*NODE PRINT, NSET=ALL\nU\n*ENVELOPE\nU\n"), (0.5, "")):
        deck.write_text(BLOCK + steps.format(increment, request))
        subprocess.run([program_path, "-q", "-o", tmp_path, deck], check=True)
        assert (tmp_path / "job_node_ALL.csv").exists() == bool(request)
    assert sorted(p.name for p in (tmp_path / "job_vtk").iterdir()) == [
        "job_0001.vtu",
        "job_0002.vtu",
    ]
    assert other.exists()
