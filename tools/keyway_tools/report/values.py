"""What a report says of a run in words and numbers: header, verdict, key numbers, joints."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..colour_scale import FIELDS
from ..result_files import leaves
from ..results import why_incomplete
from ..si_results import SiResults

WHERE = ("anywhere", "upstream", "downstream")
_JOINT_VALUES = (("opening", 1e3, "mm"), ("slip", 1e3, "mm"), ("pressure", 1e-6, "MPa"))
# Estimates in job.json by the names of envelopes
ESTIMATE_OF = {"U": "displacement", "OPENING": "opening", "S1": "S1", "S3": "S3"}
_PARTS = ("time", "mesh", "joints", "iteration")  # of an error


def header(results: SiResults) -> list[tuple[str, str]]:
    """Deck, digest, date, program and machine."""
    summary = results.summary
    program = summary.get("program", {})
    rows = [
        ("Deck", summary.get("deck", {}).get("file", results.job)),
        ("Digest", f"sha256 {summary.get('deck', {}).get('sha256', 'unknown')}"),
        ("Date of the results", results.date),
        ("Program", f"{program.get('name', '')} {program.get('version', '')}".strip()),
        ("Built with", ", ".join([program.get("compiler", ""), *program.get("libraries", [])])),
    ]
    machine = summary.get("machine") or program.get("machine")
    if machine:
        rows.append(("Machine", _machine_in_words(machine)))
    model = summary.get("model", {})
    rows.append(("Model", ", ".join(f"{count:,} {name}" for name, count in model.items())))
    ledger = summary.get("ledger", {})
    if "wall_s" in ledger:
        memory = ledger.get("peak_memory_mb", 0.0)
        rows.append(("Cost", f"{ledger['wall_s']:.3g} s, {memory:.3g} MB"))
    return [(name, text) for name, text in rows if text]


def _machine_in_words(machine: Any) -> str:
    """Processor, threads, kernels, memory, as far as they are known."""
    if not isinstance(machine, dict):
        return str(machine)
    words = {
        "processor": "{}",
        "processors": "processors: {}",
        "threads": "threads: {}",
        "blas_kernels": "kernels of OpenBLAS: {}",
        "memory_mb": "{} MB",
    }
    found = leaves(machine, "")
    return ", ".join(words.get(name, f"{name}: {{}}").format(value) for name, value in found)


def verdict(results: SiResults) -> list[tuple[str, str]]:
    """Sentences on how the run ended, each with 'good', 'fair' or 'bad'."""
    summary = results.summary
    status = summary.get("status", "unknown")
    if status == "finished":
        found = [("good", f"The run has finished: {_last_time(results)}.")]
    else:
        why = why_incomplete(results.folder, results.job)
        found = [("bad", f"The run is incomplete ({status}): {why or 'no reason is known'}.")]
        found.append(("fair", f"What follows holds up to there: {_last_time(results)}."))
    found += _stability(summary)
    warnings = summary.get("warnings", [])
    if warnings:
        found.append(("fair", f"The program has given {_number(len(warnings), 'warning')}:"))
        found += [("fair", str(warning)) for warning in warnings]
    else:
        found.append(("good", "No warnings."))
    ignored = summary.get("ignored_input", [])
    found += [
        ("fair", f"Without effect: {one.get('keyword')}, line {one.get('line')}: {one.get('why')}")
        for one in ignored
    ]
    return found


def _last_time(results: SiResults) -> str:
    """The end of the last step in words."""
    steps = results.summary.get("steps", [])
    if not steps:
        return "no step was computed"
    last = steps[-1]
    if last.get("procedure") == "frequency":
        return f"step {last['name']} with {_number(len(last.get('frequencies', [])), 'mode')}"
    increments = _number(last.get("increments", 0), "increment")
    return f"step {last['name']}, {increments} to {last.get('time', 0.0):.6g} s of the step"


def _stability(summary: dict[str, Any]) -> list[tuple[str, str]]:
    """Balance of energy, cut increments, residual."""
    found = []
    moving = [step for step in summary.get("steps", []) if step.get("increments")]
    if moving:
        error = max(abs(step.get("energy", {}).get("error", 0.0)) for step in moving)
        kind = "good" if error < 1e-3 else "fair" if error < 1e-2 else "bad"
        what = "Stable: energies balance to" if kind == "good" else "Energies balance only to"
        found.append((kind, f"{what} {100.0 * error:.2g} % of the largest energy."))
        cuts = sum(step.get("cutbacks", 0) for step in moving)
        if cuts:
            found.append(("fair", f"{_number(cuts, 'increment')} did not converge and were cut."))
    return found


def _number(count: int, noun: str) -> str:
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def key_numbers(results: SiResults) -> list[dict[str, Any]]:
    """Extremes of the envelopes and the largest displacement, which every run has: label, value,
    unit, place, time, and the path in job.json."""
    summary = results.si_summary
    known = {name: (f"envelopes.{name}", found) for name, found in
             summary.get("envelopes", {}).items()}  # fmt: skip
    if "U" not in known and summary.get("displacement"):
        known = {"U": ("displacement", summary["displacement"]), **known}
    rows = []
    for name, (path, values) in known.items():
        field = FIELDS.get(name)
        scale, unit = (field.scale, field.unit) if field else (1.0, "")
        for where in (w for w in WHERE if "value" in values.get(w, {})):
            extreme = values[where]
            rows.append({
                "label": field.label if field else name,
                "where": "" if where == "anywhere" else where,
                "value": scale * extreme["value"],
                "unit": unit,
                "time": extreme.get("time"),
                "in_step": time_in_step(results, extreme.get("time")),
                "x": extreme.get("x"),
                "error": _estimate(results, name, scale, unit) if where == "anywhere" else "",
                "path": f"{path}.{where}.value",
            })  # fmt: skip
    return rows


def _known_estimates(results: SiResults) -> dict[str, Any]:
    """The estimates of errors in job.json, by quantity."""
    known = results.summary.get("accuracy", {}).get("estimates", {})
    return known if isinstance(known, dict) else {}


def time_in_step(results: SiResults, time: float | None) -> str:
    """Step and time in it of a total time, where the run has several steps that take time."""
    ends, last = [], 0.0
    for step in results.summary.get("steps", []):
        if step.get("increments"):
            ends.append((step["name"], last))
            last += step.get("time", 0.0)
    if time is None or len(ends) < 2:
        return ""
    name, start = next((one for one in reversed(ends) if one[1] < time), ends[0])
    return f"{name} {time - start:.5g}"


def _estimate(results: SiResults, name: str, scale: float, unit: str) -> str:
    """The estimate of the error of an envelope in the unit of the page."""
    known = _known_estimates(results)
    if not known or name not in ESTIMATE_OF:
        return ""
    found = known.get(ESTIMATE_OF[name])
    if not isinstance(found, dict):
        return "not estimated"
    if "singular" in found or "not_known" in found:
        return _estimate_in_words(found)
    scale *= results.units.length if name in ("U", "OPENING") else results.units.stress
    words = "error not estimated"
    if "error" in found:
        parts = (f"{part} {scale * found[part]:.4g}" for part in _PARTS if part in found)
        words = f"\u00b1 {scale * found['error']:.4g} {unit} ({', '.join(parts)})"
    if "springs" in found:
        words += f"; springs of joints contribute about {scale * found['springs']:.4g} {unit}"
    if "history" in found:
        words += f"; histories \u00b1 {100.0 * found['history']:.2g} % (time)"
    return words


def _estimate_in_words(found: Any) -> str:
    if not isinstance(found, dict):
        return _in_words(found)
    if "singular" in found:
        return f"a singular place ({found['singular']}): this stress grows with every refinement"
    if "not_known" in found:
        return f"not known: {found['not_known']}"
    parts = [f"{key} {_in_words(value)}" for key, value in leaves(found, "") if key != "value"]
    return ", ".join(parts)


def estimates(results: SiResults) -> list[tuple[str, str, str]]:
    """All estimates of errors: quantity, value, error and its parts, in the units of the deck."""
    rows = []
    for name, found in _known_estimates(results).items():
        value = found.get("value") if isinstance(found, dict) else None
        words = "" if value is None else _in_words(value)
        rows.append((name.replace("_", " "), words, _estimate_in_words(found)))
    return rows


def accuracy(results: SiResults) -> list[tuple[str, str]]:
    """What job.json has under 'accuracy' beside the estimates, name and value."""
    known = results.summary.get("accuracy", {})
    rest = {key: value for key, value in known.items() if key not in ("estimates", "joints")}
    shares = {name: joint.get("penetration_over_opening", 0.0) for name, joint in
              known.get("joints", {}).items()}  # fmt: skip
    if shares:
        worst = max(shares, key=lambda name: shares[name])
        rest["largest_penetration_over_opening"] = f"{shares[worst]:.4g} ({worst})"
    rows = leaves(rest, "")
    return [(path.replace("_", " ").replace(".", ": "), _in_words(value)) for path, value in rows]


def _in_words(value: Any) -> str:
    """A number with four digits; a text as it is."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def joints(results: SiResults) -> list[dict[str, Any]]:
    """Largest opening, slip and pressure of each joint, with place and time."""
    rows = []
    for name, joint in results.si_summary.get("joints", {}).items():
        row: dict[str, Any] = {"name": name, "points": joint.get("points"), "area": None}
        if "area" in joint:
            row["area"] = results.units.length**2 * joint["area"]
        row["values"] = []
        for key, scale, unit in _JOINT_VALUES:
            extreme = joint.get(key, {}).get("anywhere", {})
            value = extreme.get("value")
            row["values"].append({
                "value": None if value is None else scale * value,
                "unit": unit,
                "time": extreme.get("time"),
                "in_step": time_in_step(results, extreme.get("time")),
                "x": extreme.get("x"),
                "path": f"joints.{name}.{key}.anywhere.value",
            })  # fmt: skip
        rows.append(row)
    return rows


@dataclass(frozen=True)
class DeckHeader:
    """The title and the remarks at the top of a deck, and what is to be said of them."""

    title: str
    remarks: str
    caution: str


def deck_of(results: SiResults) -> DeckHeader:
    """The head of the deck, as far as the deck is still there."""
    deck = results.summary.get("deck", {})
    path = Path(deck.get("file", ""))
    if not path.is_absolute() and not path.exists():
        path = results.folder / path
    try:
        content = path.read_bytes()
    except OSError:
        caution = "The deck is not where it was when it ran; its remarks cannot be shown."
        return DeckHeader(title_of(echo_of(results)), "", caution)
    same = hashlib.sha256(content).hexdigest() == deck.get("sha256")
    caution = "" if same else "The deck has changed since the run: this is its text of today."
    text = content.decode("utf-8", "replace")
    remarks = []
    for line in text.splitlines():
        if line.startswith("**"):
            remarks.append(line[2:].removeprefix(" ").rstrip())
        elif line.startswith("*") and not line.upper().startswith("*HEADING"):
            break
    return DeckHeader(title_of(text), "\n".join(remarks).strip("\n"), caution)


def title_of(text: str) -> str:
    """The first line below *HEADING."""
    found = re.search(r"^\*HEADING[^\n]*\n(?:\*\*[^\n]*\n)*([^*\n][^\n]*)", text, re.M | re.I)
    return found[1].strip() if found else ""


def echo_of(results: SiResults) -> str:
    """The deck as the program has read it, all defaults filled in: the start of job.log."""
    try:
        lines = results.path(".log").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return ""
    kept = []
    for line in lines:
        if line.startswith(("step ", "finished", "stopped")):
            break
        kept.append(line)
    return "\n".join(kept[:2000])
