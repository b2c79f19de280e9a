"""The HTML page of a report, written from results; all that it needs is in the file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from ..colour_scale import Scales
from ..dam_views import Faces
from ..pictures_shapes import largest_state, masses_in_words
from ..si_results import SiResults
from .curves import ledger, plots
from .errors import estimates
from .scene import scene
from .templates import render
from .values import accuracy, deck_of, echo_of, header, joints, key_numbers, verdict

HERE = Path(__file__).parent


def write_page(all_results: list[SiResults], scales: Scales, path: Path) -> Path:
    """Write one page for one run, or for two side by side."""
    runs = [_run(results, scales) for results in all_results]
    _share_factor([run["scene"] for run in runs if run["scene"]])
    first = largest_state_time(all_results[0]) if runs[0]["scene"] else None
    data = {
        "time": first,
        "runs": [{key: run[key] for key in ("scene", "plots", "ledger")} for run in runs],
    }
    text = render(
        HERE / "page.html",
        title=" and ".join(run["name"] for run in runs),
        runs=runs,
        js=Markup((HERE / "page.js").read_text(encoding="utf-8")),
        plotly=Markup(get_plotlyjs().replace("</script", "<\\/script")),
        data=Markup(json.dumps(_finite(data), allow_nan=False).replace("<", "\\u003c")),
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def _share_factor(scenes: list[dict[str, Any]]) -> None:
    """Two runs are drawn with the same enlargement, the smaller one."""
    moving = [one["states"] for one in scenes if one["states"]]
    for states in moving:
        states["factor"] = min(other["factor"] for other in moving)


def largest_state_time(results: SiResults) -> float | None:
    """The time of the saved state that a reader sees first."""
    found = largest_state(results, Faces(results).nodes)
    return None if found is None else float(f"{found[1]:.9g}")


def _run(results: SiResults, scales: Scales) -> dict[str, Any]:
    """All that the page says of a run."""
    numbers = key_numbers(results)
    drawn, no_scene = _scene_of(results, scales)
    effects = results.summary.get("effects", [])
    return {
        "name": results.job,
        "deck": deck_of(results),
        "echo": echo_of(results),
        "header": header(results),
        "verdict": verdict(results),
        "numbers": numbers,
        "has_stresses": any(row["unit"] == "MPa" for row in numbers),
        "has_errors": any(row["error"] for row in numbers),
        "estimates": estimates(results, [row["label"] for row in numbers]),
        "accuracy": accuracy(results),
        "joints": joints(results),
        "frequencies": _frequencies(results),
        "effects": ", ".join(f"{one['name']} ({one['kind']})" for one in effects),
        "scene": drawn,
        "no_scene": no_scene,
        "plots": plots(results) if drawn or results.path(".h5").exists() else [],
        "ledger": ledger(results),
    }


def _scene_of(results: SiResults, scales: Scales) -> tuple[dict[str, Any] | None, str]:
    """The view in space, or why there is none."""
    if not results.path(".h5").exists():
        return None, f"There is no {results.job}.h5, which holds the mesh and its fields."
    return scene(results, scales), ""


def _frequencies(results: SiResults) -> list[dict[str, Any]]:
    """Frequencies and effective masses of all modes."""
    rows = []
    for number, step in enumerate(results.summary.get("steps", [])):
        for k, mode in enumerate(step.get("frequencies", [])):
            mass = results.units.mass * np.array(mode.get("effective_mass", [0.0] * 3))
            path = f"steps.{number}.frequencies.{k}.hz"
            words = masses_in_words(mass)
            rows.append({"mode": mode["mode"], "hz": mode["hz"], "mass": words, "path": path})
    return rows


def _finite(value: Any) -> Any:
    """NaN and infinity, which JSON has not, become null."""
    if isinstance(value, dict):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return int(value) if isinstance(value, np.integer) else value
