"""What agrees with the paper and what does not, in sentences."""

from __future__ import annotations

from dataclasses import dataclass

from .facts import DAMAGED, FACES, UPPER, Facts

# Section 4.1: differences of the maxima, proposed against classical joint
PAPER = {
    "tension": 0.065,
    "opening, upstream face": 0.01,
    "opening, downstream face": 0.065,
}
# Section 4.2 [Pa]
PAPER_TENSION, PAPER_COMPRESSION = 2.48e6, -28.73e6
STRENGTH_SLACK = 0.005  # of f_t
AT_CREST = 0.95  # of the height
LARGE_MOVEMENT = 0.1  # of the crest, that stays after the motion [m]


@dataclass(frozen=True)
class Verdict:
    """A sentence with the colour of its mark: good, fair or bad."""

    kind: str
    text: str


@dataclass(frozen=True)
class Difference:
    """One quantity of two runs."""

    quantity: str
    classical: float
    proposed: float
    scale: float  # to the unit of the table
    unit: str
    paper: float | None

    @property
    def relative(self) -> float:
        """Relative to the classical joint; NaN where that has none."""
        return self.proposed / self.classical - 1.0 if self.classical else float("nan")


def differences(classical: Facts, proposed: Facts) -> list[Difference]:
    """Maxima of the envelopes of two runs; the stresses of both faces, openings by face."""

    def both(name: str, place: str) -> tuple[float, float]:
        return (classical.value(name, place) or 0.0, proposed.value(name, place) or 0.0)

    rows = [("tension", *both("S1", "anywhere"), 1e-6, "MPa")]
    rows += [(f"tension, {face} face", *both("S1", face), 1e-6, "MPa") for face in FACES]
    rows += [(f"compression, {face} face", *both("S3", face), 1e-6, "MPa") for face in FACES]
    rows += [(f"opening, {face} face", *both("OPENING", face), 1e3, "mm") for face in FACES]
    return [Difference(*row, PAPER.get(row[0])) for row in rows]


def joint_verdicts(classical: Facts, proposed: Facts) -> list[Verdict]:
    """Differences of the joint models beside those that the paper reports."""
    found = []
    for one in differences(classical, proposed):
        if one.paper is None or one.classical == 0.0:
            continue
        size = abs(one.relative)
        kind = "good" if size <= one.paper else "fair"
        found.append(
            Verdict(kind, f"{proposed.title}: {one.quantity} differs by {100 * size:.2g} % from "
                    f"that of the classical joint; the paper reports {100 * one.paper:.2g} %.")
        )  # fmt: skip
    return found


def dam_verdicts(facts: Facts) -> list[Verdict]:
    """Jinping: each statement of section 4.2."""
    return [
        *_stress_verdicts(facts), *_opening_verdicts(facts), *_damage_verdicts(facts),
        *_movement_verdicts(facts),
    ]  # fmt: skip


def _stress_verdicts(facts: Facts) -> list[Verdict]:
    tension, compression = facts.value("S1_POINT"), facts.value("S3_POINT")
    if tension is None or compression is None:
        return []
    ratio = tension / PAPER_TENSION
    kind = "good" if abs(ratio - 1.0) <= STRENGTH_SLACK else "fair"
    text = (
        f"The largest tension at integration points is {1e-6 * tension:.4g} MPa, {ratio:.3f} of "
        "the paper's 2.48 MPa, which is f_t."
    )
    if ratio > 1.0 + STRENGTH_SLACK:
        text += (
            " The law allows more than f_t under tension in several directions, and beside "
            "compression with a recovery other than ENERGY (docs/theory.md, 11.2)."
        )
    found = [Verdict(kind, text)]
    ratio = compression / PAPER_COMPRESSION
    kind = "good" if 0.5 <= ratio <= 1.5 else "fair"
    found.append(
        Verdict(kind, f"The largest compression at integration points is {-1e-6 * compression:.4g} "
                f"MPa, {ratio:.2f} of the paper's 28.73 MPa, at {_place(facts, 'S3_POINT')}; the "
                "paper has it at the outlets.")
    )  # fmt: skip
    return found


def _opening_verdicts(facts: Facts) -> list[Verdict]:
    if not facts.openings:
        return []
    size = {name: max(faces.values()) for name, faces in facts.openings.items()}
    most = _opens_most(facts)
    if not most:
        return [Verdict("fair", "No joint opens; in the paper joint 1 opens most.")]
    first, *_, last = size
    kind = "good" if most == first else "fair"
    text = f"{most} opens most, {1e3 * size[most]:.3g} mm; in the paper it is joint 1."
    if most == last:
        text += " This dam is symmetric, so that joint 1 and the last one differ by the motion."
    found = [Verdict(kind, text)]
    opened = [name for name in size if size[name] > 0.05 * size[most] and facts.places[name]]
    at_crest = [name for name in opened if facts.places[name][2] >= AT_CREST * facts.height]
    kind = "good" if len(at_crest) == len(opened) else "fair"
    others = ", ".join(
        f"{name} at z = {facts.places[name][2]:.4g} m" for name in opened if name not in at_crest
    )
    text = f"{len(at_crest)} of {len(opened)} joints that open have their largest opening within "
    text += "5 % of the height from the crest, where the paper has it"
    found.append(Verdict(kind, text + (f"; {others}." if others else ".")))
    return found


def _damage_verdicts(facts: Facts) -> list[Verdict]:
    damaged = facts.damaged
    if not damaged:
        return []
    if damaged["all"] == 0.0:
        return [Verdict("fair", f"No element has a mean damage of {DAMAGED:g} or more.")]
    upper = damaged["upper downstream"] / damaged["all"]
    share = damaged["all"] / damaged["volume of the dam"]
    kind = "good" if upper > 0.5 else "fair"
    return [
        Verdict(kind, f"{100 * share:.2g} % of the dam has a mean damage of {DAMAGED:g} or more; "
                f"{100 * upper:.3g} % of that is on the downstream side above {UPPER:g} of the "
                "height, where the paper has its damage."),
        _lower_verdict(damaged),
    ]  # fmt: skip


def _lower_verdict(damaged: dict[str, float]) -> Verdict:
    """Damage at heel and abutments, which the paper does not show."""
    lower = damaged["lower"] / damaged["all"]
    if lower == 0.0:
        return Verdict("good", "There is no damage in the lower part, as in the paper.")
    before = damaged["lower, before the motion"] / damaged["lower"]
    text = (
        f"{100 * lower:.3g} % of the damaged concrete is below {UPPER:g} of the height; the paper "
        f"shows none there. {100 * before:.3g} % of that is damaged before the motion, by weight "
        "and water; the motion does the rest, in elements beside the abutment, whose stress grows "
        "with every finer mesh."
    )
    return Verdict("good" if lower < 0.1 else "fair", text)


def _movement_verdicts(facts: Facts) -> list[Verdict]:
    """What the motion leaves behind; the paper shows no displacements."""
    if facts.moved is None or not facts.slips:
        return []
    name = max(facts.slips, key=lambda name: facts.slips[name])
    slip = facts.slips[name]
    text = (
        f"The motion moves the crest at the crown by {facts.moved:.2g} m for good, and {name} "
        f"slips by up to {slip:.2g} m; the paper shows neither."
    )
    if facts.moved > LARGE_MOVEMENT:
        text += (
            " Elastic concrete keeps a small part of such a displacement (Sensitivity, concrete): "
            "the plastic strain of cracks stays, and blocks that cracks have loosened tilt further "
            "with each large opening. The law of Table 1 is not meant for cracks that are this "
            "wide, and joints have friction here but no shear keys: read displacements and slips "
            "with care."
        )
    return [Verdict("fair" if facts.moved > LARGE_MOVEMENT else "good", text)]


def _place(facts: Facts, name: str) -> str:
    x = facts.extremes[name]["anywhere"].get("x")
    return "(" + ", ".join(f"{v:.4g}" for v in x) + ") m" if x else "a place without coordinates"


def robust(base: Facts, others: list[Facts]) -> list[Verdict]:
    """Which findings of the base every variant has too."""
    found = []
    for text, holds in FINDINGS.items():
        if not holds(base):
            found.append(Verdict("fair", f"{text}: not so in the base itself."))
            continue
        against = [one.title for one in others if not holds(one)]
        kind = "fair" if against else "good"
        end = f"not with {'; '.join(against)}." if against else f"in all {len(others)} variants."
        found.append(Verdict(kind, f"{text}: {end}"))
    return found


def _opens_most(facts: Facts) -> str:
    """The joint that opens most, '' where none opens."""
    size = {name: max(faces.values()) for name, faces in facts.openings.items()}
    most = max(size, key=lambda name: size[name])
    return most if size[most] > 0.0 else ""


FINDINGS = {
    "An outer joint (1 or 6) opens most": lambda f: _opens_most(f) in ("JOINT1", "JOINT6"),
    "Compression does not exceed the paper's 28.73 MPa": lambda f: (
        (f.value("S3_POINT") or 0.0) >= PAPER_COMPRESSION
    ),
    "Tension at points is within 8 % of f_t": lambda f: (
        abs((f.value("S1_POINT") or 0.0) / PAPER_TENSION - 1.0) < 0.08
    ),
    "The outlets' height and above have damage downstream": lambda f: (
        f.damaged.get("upper downstream", 0.0) > 0.0
    ),
    "Most of the damage is in the upper downstream part": lambda f: (
        f.damaged.get("upper downstream", 0.0) > 0.5 * max(f.damaged.get("all", 0.0), 1e-300)
    ),
}
