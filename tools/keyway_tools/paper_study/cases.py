"""The cases of the study as a table: what each is, and the command that makes its deck."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

import make_dam
import make_jinping
import make_motion

MOTION = make_jinping.INPUT / "xingbiling"  # seed 3, 20 s


@dataclass(frozen=True)
class Size:
    """How large the dams are and how long they shake."""

    xingbiling: str  # options of tools/make_dam.py: cells, and elements in them
    jinping: int  # unknowns
    sensitivity: int
    duration: float  # [s]
    frequency: int = 50  # increments between two saved states


SIZES = {
    "full": Size(
        "--arc 40 --levels 16 --bottom 8 --thick 4 --rock-upstream 5 --rock-downstream 5 "
        "--rock-deep 6 --refine 2 --fine-refine 3 --fine-thick 6",
        100_000, 40_000, 20.0,
    ),
    "small": Size(
        "--arc 16 --levels 7 --bottom 2 --thick 2 --refine 2 --fine-refine 3 --fine-thick 3",
        15_000, 15_000, 3.0,
    ),
    "tiny": Size(
        "--arc 14 --levels 6 --bottom 2 --thick 1 --refine 1 --fine-refine 2 --fine-thick 2",
        6_000, 6_000, 0.05, 1,
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Case:
    """One run: tool and options; `{}` in them stands for the folder of the study."""

    name: str
    group: str  # xingbiling, jinping, sensitivity
    title: str
    tool: str  # make_dam or make_jinping
    options: str
    factor: str = ""  # of a sensitivity: what it changes
    value: str = ""
    seed: int = 3  # of the motion

    def command(self, deck: Path, motion: Path = MOTION) -> str:
        """The command line that makes the deck with the motion of a folder."""
        return shlex.join([f"tools/{self.tool}.py", *self._arguments(deck, motion)])

    def make(self, deck: Path, motion: Path) -> None:
        """Write the deck; raises RuntimeError when that fails."""
        deck.parent.mkdir(parents=True, exist_ok=True)
        tool = make_jinping if self.tool == "make_jinping" else make_dam
        if tool.main(self._arguments(deck, motion)):
            raise RuntimeError(f"case {self.name}: the deck could not be made")

    def _arguments(self, deck: Path, motion: Path) -> list[str]:
        options = shlex.split(self.options)
        if self.tool == "make_jinping":
            return [str(deck), *options, "--motion-of", str(motion)]
        files = [str(motion / f"motion_{axis}.txt") for axis in "xyz"]
        return ["-o", str(deck), *options, "--motion", *files]


def motion_of(seed: int, folder: Path, duration: float = 20.0) -> Path:
    """The folder of a motion: that of input/, or another seed of the same spectrum."""
    if seed == 3:
        return MOTION
    made = folder / "motions" / f"seed_{seed}"
    if not (made / "motion.json").exists():
        made.mkdir(parents=True, exist_ok=True)
        options = ["--seed", str(seed), "--duration", f"{duration:g}", "--no-pictures"]
        make_motion.main(["-o", str(made / "motion"), *options])
    return made


def list_cases(size: Size) -> list[Case]:
    """All cases in the order of the page."""
    return [*_xingbiling(size), *_jinping(size), *_sensitivity(size)]


def choose(cases: list[Case], patterns: list[str]) -> list[Case]:
    """Cases whose name or group fits a pattern; a name goes before a group.

    Raises ValueError where a pattern fits none.
    """
    chosen: list[Case] = []
    for pattern in patterns or ["*"]:
        found = [case for case in cases if case.name == pattern]
        found = found or [c for c in cases if fnmatch(c.name, pattern) or c.group == pattern]
        if not found:
            names = ", ".join(c.name for c in cases)
            raise ValueError(f"no case fits '{pattern}'; there are {names}")
        chosen += found
    return [case for case in cases if case in chosen]


def _xingbiling(size: Size) -> list[Case]:
    """The dam of section 4.1: the same joints between equal and between different meshes."""
    common = (
        f"{size.xingbiling} --joints 2 --histories --duration {size.duration:g} "
        f"--picture-every {size.frequency} "
    )
    rows = (
        ("classical", "classical joint, same mesh", "--join matching"),
        ("chain", "the paper's chain, different meshes", "--fine 2 --join chain"),
        ("one_step", "joint on surfaces, different meshes", "--fine 2 --join surfaces"),
        ("classical_fine", "classical joint, all as fine as the finer block", "--join matching"),
    )
    found = []
    for name, title, options in rows:
        text = common + options
        if name == "classical_fine":
            words = text.split()
            at = words.index
            words[at("--refine") + 1] = words[at("--fine-refine") + 1]
            words[at("--thick") + 1] = words[at("--fine-thick") + 1]
            text = shlex.join(words)
        text += f" --title {shlex.quote(f'Xingbiling, {title}')}"
        found.append(Case(f"xingbiling_{name}", "xingbiling", title, "make_dam", text))
    return found


def _jinping(size: Size) -> list[Case]:
    """The dam of section 4.2."""
    common = f"--unknowns {size.jinping} --duration {size.duration:g}"
    common += f" --picture-every {size.frequency}"
    rows = (
        ("jinping", "outlets, Table 1", ""),
        ("jinping_without_outlets", "no outlets, Table 1", " --no-outlets"),
        ("jinping_fracture_energy", "outlets, G_f", " --law fracture-energy"),
    )
    return [
        Case(name, "jinping", title, "make_jinping", common + more) for name, title, more in rows
    ]


def _sensitivity(size: Size) -> list[Case]:
    """Jinping at a smaller size, one thing changed at a time."""
    common = f"--duration {size.duration:g} --picture-every {size.frequency}"
    base = f"{common} --unknowns {size.sensitivity}"
    half, twice = round(0.5 * size.sensitivity), 2 * size.sensitivity
    rows = [
        ("base", "base", "as it is", base),
        ("kn_1e10", "joint stiffness", "1.25e10 Pa/m", f"{base} --kn 1.25e10"),
        ("kn_1e11", "joint stiffness", "1.25e11 Pa/m", f"{base} --kn 1.25e11"),
        ("kn_1e13", "joint stiffness", "1.25e13 Pa/m", f"{base} --kn 1.25e13"),
        ("friction_03", "friction", "0.3", f"{base} --friction 0.3"),
        ("friction_10", "friction", "1.0", f"{base} --friction 1.0"),
        ("damping_02", "damping", "2 %", f"{base} --damping 0.02 1 5"),
        ("damping_10", "damping", "10 %", f"{base} --damping 0.1 1 5"),
        ("damping_current", "damping", "current stiffness", f"{base} --damping-base CURRENT"),
        ("mesh_half", "mesh", f"{half} unknowns", f"{common} --unknowns {half}"),
        ("mesh_twice", "mesh", f"{twice} unknowns", f"{common} --unknowns {twice}"),
        ("recovery_sign", "recovery", "SIGN", f"{base} --recovery SIGN"),
        ("recovery_energy", "recovery", "ENERGY", f"{base} --recovery ENERGY"),
        # *MODEL CHANGE takes no chains: joints on surfaces, also for the comparison
        ("at_once", "stages", "at once, surfaces", f"{base} --join auto"),
        ("stages", "stages", "lifts, grouted", f"{base} --join auto --lifts 4 --grouting 4"),
    ]
    found = [
        Case(f"s_{name}", "sensitivity", f"{factor}: {value}", "make_jinping", options,
             factor, value)
        for name, factor, value, options in rows
    ]  # fmt: skip
    for seed in (5, 7):
        title = f"motion: seed {seed}"
        found.append(
            Case(f"s_motion_{seed}", "sensitivity", title, "make_jinping", base, "motion",
                 f"seed {seed}", seed)
        )  # fmt: skip
    return found


Log = Callable[[str], None]
