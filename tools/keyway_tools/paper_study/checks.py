"""What the study asks of its own runs: size, time, strength, energy, increment, symmetry."""

from __future__ import annotations

from .facts import FACES, IN_PLANE, Facts
from .verdicts import PAPER_TENSION, STRENGTH_SLACK, Verdict

UNKNOWNS, SECONDS = 100_000, 2400.0  # of Jinping on two cores
ENERGY_ERROR, STEP_ERROR, SYMMETRY_ERROR = 1e-6, 0.02, 1e-3
# Of a coupling, beside equal meshes: stress on the faces, openings. The chain: as the paper says.
COUPLINGS = {"one_step": ("the joint on surfaces", 0.01, 0.005),
             "chain": ("the paper's chain", 0.065, 0.01)}  # fmt: skip
PLACES = (("", "one block is finer, 3:2", "classical_fine"),
          ("_shifted", "the levels of one block are shifted by half an element",
           "classical_shifted"))  # fmt: skip


def run_verdicts(facts: Facts) -> list[Verdict]:
    """Size, time, strength and energies of one run of Jinping."""
    rows = []
    if facts.wall_s is not None:
        kept = facts.unknowns >= UNKNOWNS and facts.wall_s < SECONDS
        rows.append(
            (kept, f"{facts.unknowns} unknowns, {facts.increments} increments, {facts.cutbacks} "
             f"cut, in {facts.wall_s / 60.0:.1f} minutes; asked are {UNKNOWNS} in "
             f"{SECONDS / 60.0:.0f}.")
        )  # fmt: skip
    tension = facts.value("S1_POINT")
    if tension is not None:
        ratio = tension / PAPER_TENSION
        rows.append(
            (ratio <= 1.0 + STRENGTH_SLACK, f"The tension at points is at most {ratio:.4f} f_t; "
             f"asked is {1.0 + STRENGTH_SLACK:g}.")
        )  # fmt: skip
    rows.append(
        (facts.energy_error < ENERGY_ERROR, f"The energy balance closes to "
         f"{facts.energy_error:.1e}; asked is {ENERGY_ERROR:g}.")
    )  # fmt: skip
    rows.append(
        (facts.largest_fall <= 0.0, "The dissipation of cracks and joints "
         + ("never falls." if facts.largest_fall <= 0.0 else
            f"falls by up to {facts.largest_fall:.1e} of its final value in one increment."))
    )  # fmt: skip
    return [Verdict("good" if is_kept else "fair", text) for is_kept, text in rows]


def check_verdicts(facts: dict[str, Facts]) -> list[Verdict]:
    """Half the increment against the base of the sensitivity; symmetry."""
    found = []
    base, half = facts.get("s_base"), facts.get("c_half_increment")
    if base and half and opens(base) and half.openings:
        size = largest_change(base, half)
        kind = "good" if size < STEP_ERROR else "fair"
        found.append(
            Verdict(kind, f"Half the increment changes the largest openings of joints by up to "
                    f"{100.0 * size:.2g} % of the largest of all; asked is less than "
                    f"{100.0 * STEP_ERROR:g} %.")
        )  # fmt: skip
    mirrored = facts.get("c_symmetric")
    if mirrored and opens(mirrored):
        size = asymmetry(mirrored)
        is_kept = size < SYMMETRY_ERROR
        text = (
            "Without the motion across the valley joints at mirrored places open alike to "
            f"{size:.1e} of the largest opening."
        )
        if not is_kept and mirrored.in_plane_until is not None:
            text += (
                f" The crest at the crown stays in the plane of symmetry to {IN_PLANE:g} of its "
                f"displacement until {mirrored.in_plane_until:.3g} s. Then the round-off of the "
                "mirrored halves has grown: the block that cracks have loosened rocks and slides, "
                "and what it does later depends on the smallest differences. Openings after this "
                "time are one of many possible histories."
            )
        found.append(Verdict("good" if is_kept else "fair", text))
    return found


def coupling_verdicts(facts: dict[str, Facts]) -> list[Verdict]:
    """What the coupling of different meshes changes, measured as in
    docs/studies/different_meshes.md: values outside of those of the two equal meshes."""
    found = []
    for coupling, (words, stress, opening) in COUPLINGS.items():
        for ending, where, other in PLACES:
            names = (f"{coupling}{ending}", "classical", other)
            runs = [run for name in names if (run := facts.get(f"xingbiling_{name}"))]
            if len(runs) < len(names) or not all(run.unknowns for run in runs):
                continue
            kept = _outside(runs, ("S1", "S3")), _outside(runs, ("OPENING",))
            is_good = kept[0] <= stress and kept[1] <= opening
            found.append(
                Verdict("good" if is_good else "fair", f"Where {where}, {words} changes the "
                        f"largest stress on the faces by {100.0 * kept[0]:.2g} % beyond the values "
                        f"of both equal meshes and the largest opening by {100.0 * kept[1]:.2g} %; "
                        f"asked are at most {100.0 * stress:g} and {100.0 * opening:g} %.")
            )  # fmt: skip
    return found


def _outside(runs: list[Facts], fields: tuple[str, ...]) -> float:
    """How far the largest values of the first run lie outside of those of two others."""
    return max(
        excess(*(run.value(field, face) or 0.0 for run in runs))
        for field in fields
        for face in FACES
    )


def excess(value: float, first: float, second: float) -> float:
    """How far a value lies outside of two others, over the larger of these."""
    low, high = sorted((first, second))
    return max(low - value, value - high, 0.0) / (max(abs(low), abs(high)) or 1.0)


def opens(facts: Facts) -> bool:
    """Whether a joint of a finished run has opened."""
    return any(max(faces.values()) > 0.0 for faces in facts.openings.values())


def largest_change(first: Facts, second: Facts) -> float:
    """Largest difference of openings by joint and face over the largest opening of the first."""
    largest = max(max(faces.values()) for faces in first.openings.values())
    changes = [
        abs(second.openings[name][face] - first.openings[name][face])
        for name in first.openings
        for face in FACES
    ]
    return max(changes) / largest if largest else 0.0


def asymmetry(facts: Facts) -> float:
    """Largest difference of openings at mirrored joints over the largest opening."""
    ordered = list(facts.openings.values())
    largest = max(max(faces.values()) for faces in ordered)
    pairs = zip(ordered, reversed(ordered), strict=True)
    changes = [abs(one[face] - other[face]) for one, other in pairs for face in FACES]
    return max(changes) / largest if largest else 0.0
