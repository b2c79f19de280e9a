"""The page of the study: HTML that needs no other file, with its data inside."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

from markupsafe import Markup

from ..picture_style import Sheet
from ..report.templates import render
from ..si_results import SiResults
from .cases import Case
from .checks import check_verdicts, coupling_verdicts, run_verdicts
from .facts import Facts, facts_of
from .openings import plot_profiles
from .pictures import jinping_pictures, plot_factor, xingbiling_pictures
from .records import plot_fractiles, sentences
from .runner import Outcome
from .verdicts import dam_verdicts, differences, joint_verdicts, robust

HERE = Path(__file__).parent
CLASSICAL = "xingbiling_classical"
MODELS = ("chain", "one_step", "classical_fine")
BUILT = ("at_once", "stages", "summer", "winter")


def write_page(
    folder: Path, header: list[list[str]], outcomes: list[Outcome], concrete: list[Path]
) -> Path:
    """Pictures, data and page of the cases that have run; the page."""
    pictures = folder / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    facts = {outcome.case.name: facts_of(outcome) for outcome in outcomes}
    runs = {
        o.case.name: SiResults(o.folder, o.case.name) for o in outcomes if o.is_finished
    }  # fmt: skip
    data = {"header": dict(header), "cases": [one.as_data() for one in facts.values()]}
    text = json.dumps(data, indent=1)
    (folder / "paper_study.json").write_text(text + "\n", encoding="utf-8")
    content = {
        **_xingbiling(facts, runs, pictures),
        "dams": _jinping(outcomes, facts, runs, pictures),
        **_sensitivity([o.case for o in outcomes], facts, pictures),
        **_records(outcomes, facts, pictures),
        "checks": check_verdicts(facts),
    }
    page = folder / "paper_study.html"
    html = render(
        HERE / "paper_study.html",
        title="Two arch dams of Xu, Chen, Li and Yue (2014)",
        header=header,
        facts=[facts[o.case.name] for o in outcomes if o.case.group != "records"],
        concrete=embed(concrete),
        commands=[line for o in outcomes for line in _commands(o.case, folder)],
        data=Markup(text.replace("</", "<\\/")),
        **content,
    )
    page.write_text(html, encoding="utf-8")
    return page


def embed(files: list[Path]) -> list[dict[str, str]]:
    """Pictures as text for the page."""
    return [
        {"name": file.stem, "data": base64.b64encode(file.read_bytes()).decode()} for file in files
    ]


def _commands(case: Case, folder: Path) -> list[str]:
    deck = folder / "decks" / case.name / f"{case.name}.inp"
    return case.commands(deck, folder / "motions")


def _xingbiling(
    facts: dict[str, Facts], runs: dict[str, SiResults], folder: Path
) -> dict[str, Any]:
    """Tables against the classical joint, and their pictures."""
    all_models = (CLASSICAL, *(f"xingbiling_{one}" for one in MODELS))
    chosen = {name: runs[name] for name in all_models if name in runs}
    built = _built(facts, runs, folder)
    others = [name for name in chosen if name != CLASSICAL]
    if CLASSICAL not in chosen or not others:
        return {"tables": [], "joint_verdicts": [], "xingbiling": {}, "built": built}
    first = facts[CLASSICAL]
    tables = [
        {"title": facts[name].title, "first": "classical", "second": facts[name].title,
         "rows": differences(first, facts[name])}
        for name in others
    ]  # fmt: skip
    proposed = [name for name in others if not name.endswith("_fine")]
    said = [one for name in proposed for one in joint_verdicts(first, facts[name])]
    labelled = {facts[name].title: run for name, run in chosen.items()}
    pictures = xingbiling_pictures(labelled, folder)
    return {
        "tables": tables,
        "joint_verdicts": said,
        "xingbiling": {key: embed(files) for key, files in pictures.items()},
        "built": built,
        "coupling": coupling_verdicts(facts),
    }


def _built(facts: dict[str, Facts], runs: dict[str, SiResults], folder: Path) -> dict[str, Any]:
    """Xingbiling with weight at once, built in lifts, in summer and in winter."""
    chosen = {name: runs[name] for name in (f"xingbiling_{one}" for one in BUILT) if name in runs}
    if len(chosen) < 2:
        return {}
    labelled = {facts[name].title: run for name, run in chosen.items()}
    sheet = Sheet(folder / "xingbiling_built")
    numbers = [facts[name] for name in chosen]
    names = [one.title for one in numbers]
    bars = plot_factor("building and season", numbers, names, Sheet(folder / "xingbiling_bars"))
    return {"pictures": embed(bars + plot_profiles(labelled, sheet))}


def _records(
    outcomes: list[Outcome], facts: dict[str, Facts], folder: Path
) -> dict[str, list[Any]]:
    """Fractiles of the largest opening."""
    numbers = [facts[o.case.name] for o in outcomes if o.case.group == "records" and o.is_finished]
    if len(numbers) < 2:
        return {"records": [], "record_sentences": []}
    pictures = plot_fractiles(numbers, Sheet(folder / "records"))
    return {"records": embed(pictures), "record_sentences": sentences(numbers)}


def _jinping(
    outcomes: list[Outcome], facts: dict[str, Facts], runs: dict[str, SiResults], folder: Path
) -> list[dict[str, Any]]:
    """Each dam with what it says about the paper, and its pictures."""
    found = []
    for outcome in outcomes:
        name = outcome.case.name
        if outcome.case.group != "jinping" or name not in runs:
            continue
        has_outlets = "--no-outlets" not in outcome.case.options
        pictures = jinping_pictures(runs[name], folder, has_outlets)
        found.append(
            {"title": outcome.case.title,
             "verdicts": dam_verdicts(facts[name]) + run_verdicts(facts[name]),
             "pictures": {key: embed(files) for key, files in pictures.items()}}
        )  # fmt: skip
    return found


def _sensitivity(cases: list[Case], facts: dict[str, Facts], folder: Path) -> dict[str, Any]:
    """One picture for each factor, and what holds in all variants."""
    run = {c.name: c for c in cases if c.group == "sensitivity" and facts[c.name].unknowns}
    base = facts.get("s_base") if "s_base" in run else None
    variants = [case for name, case in run.items() if name != "s_base"]
    if base is None or not variants:
        return {"factors": [], "robust": []}
    factors = []
    for factor in dict.fromkeys(case.factor for case in variants):
        chosen = [case for case in variants if case.factor == factor]
        values = ["as it is", *(case.value for case in chosen)]
        numbers = [base, *(facts[case.name] for case in chosen)]
        sheet = Sheet(folder / f"sensitivity_{factor.replace(' ', '_')}")
        files = plot_factor(factor, numbers, values, sheet)
        factors.append({"name": factor.capitalize(), "pictures": embed(files)})
    return {"factors": factors, "robust": robust(base, [facts[c.name] for c in variants])}
