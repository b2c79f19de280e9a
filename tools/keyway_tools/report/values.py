"""What a report says of a run in words and numbers: header, verdict, key numbers, joints."""

from __future__ import annotations

import contextlib
import hashlib
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..colour_scale import FIELDS
from ..deck_bytes import text_of
from ..result_files import leaves
from ..results import why_incomplete
from ..si_results import SiResults
from .errors import error_beside, number_in_words

WHERE = ("anywhere", "upstream", "downstream")
DAMAGES = ("DAMAGET", "DAMAGEC")
_JOINT_VALUES = (("opening", 1e3, "mm"), ("slip", 1e3, "mm"), ("pressure", 1e-6, "MPa"))


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
    counts = (_number(count, name.removesuffix("s")) for name, count in model.items())
    rows.append(("Model", ", ".join(counts)))
    ledger = summary.get("ledger", {})
    if "wall_s" in ledger:
        memory = ledger.get("peak_memory_mb", 0.0)
        rows.append(("Cost", f"{_time_in_words(ledger['wall_s'])}, {memory:,.0f} MB"))
    return [(name, text) for name, text in rows if text]


def _time_in_words(seconds: float) -> str:
    """'0.244 s', '18 min 52 s', '2 h 5 min'."""
    if seconds < 60.0:
        return f"{seconds:.3g} s"
    whole = round(seconds)
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


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
        how = "" if status == "running" else f" ({status})"
        found = [("bad", f"The run is incomplete{how}: {why or 'no reason is known'}.")]
        found.append(("fair", _what_follows(results)))
    found += _stability(summary)
    if results.words_on_units:
        found.append(("fair", f"Units: {results.words_on_units}."))
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
        return _of_tables(results)
    last = steps[-1]
    if last.get("procedure") == "frequency":
        return f"step {last['name']} with {_number(len(last.get('frequencies', [])), 'mode')}"
    increments = _number(last.get("increments", 0), "increment")
    return f"step {last['name']}, {increments} to {last.get('time', 0.0):.6g} s of the step"


def _what_follows(results: SiResults) -> str:
    """Up to where the page of an incomplete run holds: job.json may be older than the tables."""
    steps = results.summary.get("steps", [])
    row = _last_row(results)
    if not steps or row is None or row[:2] <= (len(steps), steps[-1].get("increments", 0)):
        return f"What follows holds up to there: {_last_time(results)}."
    return (
        f"Key numbers, joints and balances below hold up to {_last_time(results)}: "
        f"{results.job}.json was written then. Tables, curves and saved fields go on: the last row "
        f"of {results.job}_energy.csv is that of {_in_words(row)}."
    )


def _last_row(results: SiResults) -> tuple[int, int, float] | None:
    """Step, increment and time of the last row of job_energy.csv."""
    try:
        table = results.table("energy")
        step, increment, time = (table[name][-1] for name in ("step", "increment", "time"))
    except (OSError, KeyError, IndexError, ValueError):
        return None
    return int(step), int(increment), float(time)


def _in_words(row: tuple[int, int, float]) -> str:
    return f"step {row[0]}, increment {row[1]}, time {row[2]:.6g} s"


def _of_tables(results: SiResults) -> str:
    """The last increment in job_energy.csv: a run that was killed early has no step in job.json."""
    row = _last_row(results)
    if row is None:
        return "no step was computed"
    return (
        f"{_in_words(row)}, by {results.job}_energy.csv; {results.job}.json was not yet written, "
        "so that numbers are missing below, and pictures and tables are there"
    )


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
    """Extremes of the run: label, value, unit, place, time, and the path in job.json. Displacements
    and openings are those of all increments, the others those of the steps with *ENVELOPE."""
    summary = results.si_summary
    known = {"U": ("displacement", summary.get("displacement") or {})}
    known |= {name: (f"envelopes.{name}", found) for name, found in
              summary.get("envelopes", {}).items() if name not in ("U", "OPENING")}  # fmt: skip
    known["OPENING"] = ("joints", _largest_openings(summary.get("joints", {})))
    rows = []
    for name, (path, values) in known.items():
        field = FIELDS.get(name)
        scale, unit = (field.scale, field.unit) if field else (1.0, "")
        label = field.label if field else name
        if path.startswith("envelopes"):
            label += _steps_of_envelope(results, name)
        for where in (w for w in WHERE if "value" in values.get(w, {})):
            extreme = values[where]
            if name in DAMAGES and not extreme["value"]:
                extreme = {"value": 0.0}  # neither place nor time
            rows.append({
                "label": label,
                "where": "" if where == "anywhere" else where,
                "value": scale * extreme["value"],
                "unit": unit,
                "time": extreme.get("time"),
                "in_step": time_in_step(results, extreme.get("time")),
                "x": extreme.get("x"),
                "error": error_beside(results, name, scale, unit) if where == "anywhere" else "",
                "path": extreme.get("path", f"{path}.{where}.value"),
            })  # fmt: skip
    return rows + _dissipated(results)


def _largest_openings(joints: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The largest opening of all joints anywhere and on each face, with its path in job.json."""
    found: dict[str, dict[str, Any]] = {}
    for where in WHERE:
        for name, joint in joints.items():
            extreme = joint.get("opening", {}).get(where, {})
            if extreme.get("value", -1.0) > found.get(where, {}).get("value", -1.0):
                found[where] = {**extreme, "path": f"joints.{name}.opening.{where}.value"}
    return found


def _steps_of_envelope(results: SiResults, name: str) -> str:
    """' (2 of 5 steps)' where not all steps have an envelope."""
    try:
        steps = [step for step in results.steps() if step.procedure != "frequency"]
    except (OSError, KeyError):
        return ""
    count = sum(name in step.envelopes for step in steps)
    return f" ({count} of {len(steps)} steps)" if 0 < count < len(steps) else ""


def _dissipated(results: SiResults) -> list[dict[str, Any]]:
    """What cracking and crushing have dissipated, and the volume beyond elasticity."""
    damage = results.summary.get("damage", {})
    energy, volume = 1e-6 * results.units.energy, results.units.length**3
    rows = []
    for label, path, scale, unit in (
        ("Dissipated by cracking", "dissipated.cracking", energy, "MJ"),
        ("Dissipated by crushing", "dissipated.crushing", energy, "MJ"),
        ("Volume beyond elasticity", "inelastic.volume", volume, "m\u00b3"),
    ):
        part, key = path.split(".")
        if value := damage.get(part, {}).get(key):
            rows.append({"label": label, "where": "", "value": scale * value, "unit": unit,
                         "time": None, "in_step": "", "x": None, "error": "",
                         "path": f"damage.{path}"})  # fmt: skip
    return rows


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


def accuracy(results: SiResults) -> list[tuple[str, str]]:
    """What job.json has under 'accuracy' beside the estimates, name and value."""
    known = results.summary.get("accuracy", {})
    if not any(step.get("increments") for step in results.summary.get("steps", [])):
        return []
    rest = {key: value for key, value in known.items() if key not in ("estimates", "joints")}
    shares = {name: joint.get("penetration_over_opening", 0.0) for name, joint in
              known.get("joints", {}).items()}  # fmt: skip
    if shares:
        worst = max(shares, key=lambda name: shares[name])
        rest["largest_penetration_over_opening"] = f"{shares[worst]:.4g} ({worst})"
    rows = leaves(rest, "")
    return [
        (path.replace("_", " ").replace(".", ": "), number_in_words(value)) for path, value in rows
    ]


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
    content = _content_of_deck(results.folder, deck)
    if content is None:
        caution = "The deck is neither here nor in a folder above the results, so its remarks are "
        caution += "not shown. Write the report in the folder in which the run was started."
        return DeckHeader(title_of(echo_of(results)), "", caution)
    same = digest_of(content) == deck.get("sha256")
    caution = "" if same else "The deck has changed since the run: this is its text of today."
    text = text_of(content)
    remarks = []
    for line in text.split("\n"):
        if line.startswith("**"):
            remarks.append(line[2:].removeprefix(" ").rstrip())
        elif line.startswith("*") and not line.upper().startswith("*HEADING"):
            break
    return DeckHeader(title_of(text), "\n".join(remarks).strip("\n"), caution)


def _content_of_deck(folder: Path, deck: dict[str, Any]) -> bytes | None:
    """The deck, whose name is relative to where the program ran: here, in the folder of the
    results or in one above it. Of several files the one with the digest of the run."""
    found = []
    for place in (Path(), folder, *folder.resolve().parents):
        with contextlib.suppress(OSError):
            found.append((place / deck.get("file", "")).read_bytes())
    same = (content for content in found if digest_of(content) == deck.get("sha256"))
    return next(same, found[0] if found else None)


def digest_of(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def title_of(text: str) -> str:
    """The first line below *HEADING."""
    found = re.search(r"^\*HEADING[^\n]*\n(?:\*\*[^\n]*\n)*([^*\n][^\n]*)", text, re.M | re.I)
    return found[1].strip() if found else ""


def echo_of(results: SiResults) -> str:
    """The deck as the program has read it, all defaults filled in: the start of job.log."""
    ends = ("warnings of the deck", "ignored input", "step ", "finished", "stopped")
    try:
        lines = results.path(".log").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return ""
    kept = []
    for line in lines:
        if line.startswith(ends):
            break
        kept.append(line)
    return "\n".join(kept[:2000])
