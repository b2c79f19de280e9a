"""The histories of a run as curves of a report: openings, slips, displacements, energies, cost."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..result_files import energy_names
from ..si_results import SiResults

MOST_POINTS = 2000  # of a curve
MOST_CURVES = 6


def curve(name: str, time: np.ndarray, values: np.ndarray) -> dict[str, Any]:
    """A curve with six digits; of a long one, the least and the largest value of each part."""
    if len(time) > MOST_POINTS:
        parts = np.array_split(np.arange(len(time)), MOST_POINTS // 2)
        kept = [k for p in parts for k in (p[values[p].argmin()], p[values[p].argmax()])]
        chosen = np.unique(kept)
        time, values = time[chosen], values[chosen]
    digits = [[float(f"{v:.6g}") for v in column] for column in (time, values)]
    return {"name": name, "x": digits[0], "y": digits[1]}


def plots(results: SiResults) -> list[dict[str, Any]]:
    """All plots: title, unit and curves of each."""
    found = [
        *_joint_plots(results),
        *_displacement_plots(results),
        _energy_plot(results),
        _damage_plot(results),
    ]
    return [plot for plot in found if plot and plot["curves"]]


def _plot(title: str, unit: str, curves: list[dict[str, Any]]) -> dict[str, Any]:
    return {"title": title, "unit": unit, "curves": curves}


def _joint_plots(results: SiResults) -> list[dict[str, Any]]:
    """Largest opening and slip of each joint; histories of points that the deck prints."""
    found = []
    histories = {name: results.history(f"joints/{name}") for name in results.joint_names()}
    histories = {n: table for n, table in histories.items() if len(table.get("time", ()))}
    for key in ("opening", "slip"):
        curves = [curve(n, table["time"], 1e3 * table[key]) for n, table in histories.items()]
        found.append(_plot(f"Largest {key} of joints", "mm", curves))
    for name in (name for name in results.tables() if name.startswith("joint_")):
        table = results.table(name)
        points = _most(table, "point", "opening")
        curves = [
            curve(f"point {point}", table["time"][rows], 1e3 * table["opening"][rows])
            for point, rows in points.items()
        ]
        title = f"Opening of joint {results.joint_of_table(name.removeprefix('joint_'))}"
        found.append(_plot(title, "mm", curves))
    return found


def _displacement_plots(results: SiResults) -> list[dict[str, Any]]:
    """Displacements of the nodes that the deck prints, one plot a set of nodes."""
    found = []
    for name in (name for name in results.tables() if name.startswith("node_")):
        table = results.table(name)
        if not len(table.get("U1", ())):
            continue
        table["size"] = np.sqrt(sum(table[f"U{k}"] ** 2 for k in (1, 2, 3)))
        curves = [
            curve(f"node {node}, U{k}", table["time"][rows], 1e3 * table[f"U{k}"][rows])
            for node, rows in list(_most(table, "node", "size").items())[:2]
            for k in (1, 2, 3)
        ]
        of_set = results.set_of_table(name.removeprefix("node_"))
        title = f"Displacements of {of_set}, relative to the base"
        found.append(_plot(title, "mm", curves))
    return found


def _most(table: dict[str, np.ndarray], key: str, column: str) -> dict[int, np.ndarray]:
    """Rows of the nodes or points with the largest values of a column."""
    if len(table.get(column, ())) == 0:
        return {}
    rows = {int(n): np.flatnonzero(table[key] == n) for n in np.unique(table[key])}
    values = np.nan_to_num(table[column], nan=-np.inf)  # no value where a joint is not there
    order = sorted(rows, key=lambda n: -values[rows[n]].max())
    return {n: rows[n] for n in order[:MOST_CURVES]}


def _energy_plot(results: SiResults) -> dict[str, Any] | None:
    table = results.history("energy")
    energies = {name: np.abs(table[name]).max(initial=0.0) for name in energy_names(table)}
    largest = max(energies.values(), default=0.0)
    if not largest > 0.0:
        return None
    scale, unit = (1e-6, "MJ") if largest > 1e5 else (1e-3, "kJ") if largest > 1e2 else (1.0, "J")
    shown = [name for name, size in energies.items() if size > 1e-6 * largest]
    return _plot("Energies", unit, [curve(n, table["time"], scale * table[n]) for n in shown])


def _damage_plot(results: SiResults) -> dict[str, Any] | None:
    table = results.history("damage")
    if table.get("inelastic_volume", np.zeros(0)).max(initial=0.0) <= 0.0:
        return None
    names = {"inelastic_volume": "beyond elasticity"}
    names |= {f"volume_{k}": f"damage of {k} % or more" for k in (10, 50, 90)}
    curves = [curve(label, table["time"], table[name]) for name, label in names.items()]
    return _plot("Damaged volume", "m3", curves)


def ledger(results: SiResults, most: int = 12) -> list[dict[str, Any]]:
    """The parts of the run that took longest, the others together."""
    parts = results.summary.get("ledger", {}).get("parts", [])
    order = sorted(parts, key=lambda part: -part.get("wall_s", 0.0))
    rows = [{"name": p["name"], "seconds": p["wall_s"]} for p in order[:most]]
    if len(order) > most:
        rows.append({"name": "other", "seconds": sum(p["wall_s"] for p in order[most:])})
    return rows
