"""All cases of the study, in the order of the page."""

from __future__ import annotations

import shlex
from dataclasses import replace

from ..jinping.decks import increment_of
from .cases import Case
from .motions import Motion
from .sizes import Size

LIFTS = "--lifts 4 --grouting 2 4"
FIRST_SEED = 101  # of the records


def list_cases(size: Size) -> list[Case]:
    """All cases in the order of the page."""
    return [
        *_xingbiling(size), *_jinping(size), *_sensitivity(size), *_checks(size), *_records(size)
    ]  # fmt: skip


def _xingbiling(size: Size) -> list[Case]:
    """The dam of section 4.1: joints between equal and between different meshes; its building."""
    shaken = f"--joints 2 --histories --duration {size.duration:g} "
    shaken += f"--picture-every {size.frequency}"
    fine = _with_equal_blocks(size.xingbiling, "--fine", "-")
    # Levels of a block half an element apart: no face fits, all elements have the same size.
    shifted = _with_equal_blocks(size.xingbiling, "-", "--fine") + " --shift 0.5"
    rows = (
        ("classical", "classical joint, same mesh", size.xingbiling, "--join matching"),
        ("chain", "the paper's chain, different meshes", size.xingbiling, "--fine 2 --join chain"),
        ("one_step", "joint on surfaces, different meshes", size.xingbiling,
         "--fine 2 --join surfaces"),
        ("classical_fine", "classical joint, all as fine as the finer block", fine,
         "--join matching"),
        ("classical_shifted", "classical joint, levels of all blocks shifted", shifted,
         "--fine 1 2 3 --join matching"),
        ("one_step_shifted", "joint on surfaces, levels of one block shifted", shifted,
         "--fine 2 --join surfaces"),
        ("chain_shifted", "the paper's chain, levels of one block shifted", shifted,
         "--fine 2 --join chain"),
    )  # fmt: skip
    found = []
    for name, title, mesh, options in rows:
        # Tied to the rock in all of them: shared nodes would smooth the stress at the foot.
        text = f"{mesh} {shaken} {options} --tie-all "
        text += f"--title {shlex.quote(f'Xingbiling, {title}')}"
        found.append(Case(f"xingbiling_{name}", "xingbiling", title, "make_dam", text))
    built = f"{size.built} {shaken}"
    seasons = (
        ("at_once", "weight at once", built, ""),
        ("stages", "four lifts, grouted twice", f"{built} {LIFTS}", ""),
        ("summer", "built, shaken in August", f"{built} {LIFTS}", "summer"),
        ("winter", "built, shaken in February", f"{built} {LIFTS}", "winter"),
    )
    for name, title, options, season in seasons:
        text = f"{options} --title {shlex.quote(f'Xingbiling, {title}')}"
        found.append(
            Case(f"xingbiling_{name}", "xingbiling built", title, "make_dam", text,
                 season=season, level=105.0)
        )  # fmt: skip
    return found


def _with_equal_blocks(mesh: str, take: str, give: str) -> str:
    """The options of a mesh whose blocks all have the elements of one kind of block: those of the
    finer block have `--fine` before their names, those of the others have `-`."""
    words = mesh.split()
    for name in ("-refine", "-thick"):
        words[words.index(give + name) + 1] = words[words.index(take + name) + 1]
    return " ".join(words)


LONGER = "--increment 0.008"  # than those of the large dam, for many runs [s]


def _jinping(size: Size) -> list[Case]:
    """The dam of section 4.2."""
    common = f"--unknowns {size.jinping} --duration {size.duration:g}"
    rows = (
        ("jinping", "outlets, Table 1", "table1", ""),
        ("jinping_without_outlets", "no outlets, Table 1", "table1", " --no-outlets"),
        ("jinping_fracture_energy", "outlets, G_f", "fracture-energy", " --law fracture-energy"),
    )
    found = []
    for name, title, law, more in rows:
        # As often as with increments of 0.01 s, those of Xingbiling
        every = f" --picture-every {round(0.01 / increment_of(law) * size.frequency)}"
        found.append(Case(name, "jinping", title, "make_jinping", common + every + more))
    return found


def _sensitivity(size: Size) -> list[Case]:
    """Jinping at a smaller size and with longer increments, one thing changed at a time."""
    common = f"--duration {size.duration:g} --picture-every {size.frequency} {LONGER}"
    base = f"{common} --unknowns {size.sensitivity}"
    # *MODEL CHANGE takes no chains: joints on surfaces, also for the comparison
    auto = f"{base} --join auto"
    half, twice = round(0.5 * size.sensitivity), 2 * size.sensitivity
    rows = [
        ("base", "base", "as it is", base),
        *(
            (f"kn_1e{power}", "joint stiffness", f"1.25e{power} Pa/m", f"{base} --kn 1.25e{power}")
            for power in (10, 11, 13, 14)
        ),
        ("friction_03", "friction", "0.3", f"{base} --friction 0.3"),
        ("friction_10", "friction", "1.0", f"{base} --friction 1.0"),
        ("damping_02", "damping", "2 %", f"{base} --damping 0.02 1 5"),
        ("damping_10", "damping", "10 %", f"{base} --damping 0.1 1 5"),
        ("damping_current", "damping", "current stiffness", f"{base} --damping-base CURRENT"),
        ("mesh_half", "mesh", f"{half} unknowns", f"{common} --unknowns {half}"),
        ("mesh_twice", "mesh", f"{twice} unknowns", f"{common} --unknowns {twice}"),
        ("recovery_sign", "recovery", "SIGN", f"{base} --recovery SIGN"),
        ("recovery_lee_fenves", "recovery", "LEE-FENVES", f"{base} --recovery LEE-FENVES"),
        ("no_outlets", "outlets", "none", f"{base} --no-outlets"),
        ("elastic", "concrete", "elastic", f"{base} --law elastic"),
        ("fracture_energy", "concrete", "G_f", f"{base} --law fracture-energy"),
        ("at_once", "building", "at once, surfaces", auto),
        ("uplift", "building", "water in open joints, surfaces", f"{auto} --uplift OPEN"),
        ("stages", "building", "lifts, grouted", f"{auto} {LIFTS}"),
    ]
    found = [
        Case(f"s_{name}", "sensitivity", f"{factor}: {value}", "make_jinping", options,
             factor, value)
        for name, factor, value, options in rows
    ]  # fmt: skip
    built = replace(found[-1], factor="building")
    for season in ("summer", "winter"):
        found.append(
            replace(built, name=f"s_{season}", title=f"building: {season}", value=season,
                    season=season, level=300.0)
        )  # fmt: skip
    for seed in (5, 7):
        value = f"seed {seed}"
        found.append(
            Case(f"s_motion_{seed}", "sensitivity", f"motion: {value}", "make_jinping", base,
                 "motion", value, Motion(seed, max(size.duration, 10.0)))
        )  # fmt: skip
    return found


def _checks(size: Size) -> list[Case]:
    """Half the increment, and a motion without the component across the valley."""
    base = f"--duration {size.duration:g} --picture-every {size.frequency} {LONGER}"
    base += f" --unknowns {size.sensitivity}"
    return [
        Case("c_half_increment", "checks", "half the increment", "make_jinping",
             f"{base} --increment 0.004 --picture-every {2 * size.frequency}"),
        Case("c_symmetric", "checks", "no motion across the valley", "make_jinping", base,
             motion=Motion(is_symmetric=True)),
    ]  # fmt: skip


def _records(size: Size) -> list[Case]:
    """Xingbiling under many motions, by the reduced model."""
    options = f"{size.record} --joints 2 --duration {size.duration:g} --reduced 0.02"
    return [
        Case(f"r_{seed}", "records", f"record of seed {seed}", "make_dam", options,
             motion=Motion(seed, max(size.duration, 10.0)))
        for seed in range(FIRST_SEED, FIRST_SEED + size.num_records)
    ]  # fmt: skip
