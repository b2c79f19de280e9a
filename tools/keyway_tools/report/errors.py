"""Estimates of errors in words, in the units of the page."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ..colour_scale import FIELDS
from ..result_files import leaves
from ..si_results import SiResults

# Estimates in job.json by the names of envelopes
ESTIMATE_OF = {"U": "displacement", "OPENING": "opening", "S1": "S1", "S3": "S3"}
_PARTS = ("time", "mesh", "joints", "iteration")  # of an error
SMALLEST_PART = 1e-3  # that is named, over the whole error


def known_estimates(results: SiResults) -> dict[str, Any]:
    """The estimates of errors in job.json, by quantity."""
    known = results.summary.get("accuracy", {}).get("estimates", {})
    return known if isinstance(known, dict) else {}


def error_beside(results: SiResults, name: str, scale: float, unit: str) -> str:
    """The estimate of the error of an envelope in the unit of the page."""
    known = known_estimates(results)
    if not known or name not in ESTIMATE_OF:
        return ""
    found = known.get(ESTIMATE_OF[name])
    if not isinstance(found, dict):
        return "not estimated"
    if "singular" in found:
        return f"a singular place ({found['singular']}): this stress grows with every refinement"
    if "not_known" in found:
        return f"not known: {found['not_known']}"
    scale *= results.units.length if name in ("U", "OPENING") else results.units.stress
    words = "error not estimated"
    if "error" in found:
        parts = (
            f"{part} {scale * found[part]:.4g}"
            for part in _PARTS
            if part in found and abs(found[part]) >= SMALLEST_PART * abs(found["error"])
        )
        missing = _not_in(results, name, found)
        words = f"\u00b1 {scale * found['error']:.4g} {unit} ({', '.join(parts)}{missing})"
    if "springs" in found:
        words += f"; springs of joints contribute about {scale * found['springs']:.4g} {unit}"
    if "history" in found:
        words += f"; histories \u00b1 {100.0 * found['history']:.2g} % (time)"
    return words


def _not_in(results: SiResults, name: str, found: dict[str, Any]) -> str:
    """What an error leaves out, in the words of the last lines of job.log."""
    if "mesh" not in found:
        return "; mesh not estimated"
    steps = results.summary.get("steps", [])
    has_inertia = any(step.get("procedure") == "dynamic" for step in steps)
    return "; time not estimated" if name in ("S1", "S3") and has_inertia else ""


def estimates(results: SiResults, labels: Iterable[str]) -> list[tuple[str, str]]:
    """Estimates of errors that do not stand beside one of the numbers with these labels."""
    rows = []
    known = known_estimates(results)
    for name, quantity in ESTIMATE_OF.items():
        shown = FIELDS[name]
        if quantity in known and shown.label not in labels:
            rows.append((shown.label, error_beside(results, name, shown.scale, shown.unit)))
    for quantity, found in known.items():
        if quantity == "stress":
            rows.append(("Mesh, in the stresses of the whole model", _of_mesh(found)))
        elif quantity == "law":
            rows.append(("Increments, in the law of the solids", _of_law(results, found)))
        elif quantity not in ESTIMATE_OF.values():
            rows.append((quantity.replace("_", " "), _all_values(found)))
    return rows


def _of_mesh(found: dict[str, Any]) -> str:
    """Energy norm, time, and the part of the volume that is elastic."""
    words = f"{100.0 * found['relative']:.3g} % in the energy norm"
    if "at" in found:
        words += f", at {found['at']:.5g} s"
    if found.get("elastic_volume", 1.0) < 1.0:
        share = 100.0 * found["elastic_volume"]
        words += f", in the solids that are elastic then, {share:.4g} % of the volume"
    return words


def _of_law(results: SiResults, found: dict[str, Any]) -> str:
    """Dissipated energy, and the largest change of a stress."""
    stress = 1e-6 * results.units.stress * found["stress"]
    words = f"{100.0 * found['relative']:.3g} % of the dissipated energy, "
    return f"{words}at most {stress:.3g} MPa in a stress ({found['points']} points sampled)"


def _all_values(found: Any) -> str:
    """All that is known of a quantity that this page does not know."""
    if not isinstance(found, dict):
        return number_in_words(found)
    return ", ".join(f"{key} {number_in_words(value)}" for key, value in leaves(found, ""))


def number_in_words(value: Any) -> str:
    """A number with four digits; a text as it is."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
