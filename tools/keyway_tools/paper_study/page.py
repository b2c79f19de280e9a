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
from .cases import Case, motion_of
from .facts import Facts, facts_of
from .pictures import jinping_pictures, plot_factor, xingbiling_pictures
from .runner import Outcome
from .verdicts import dam_verdicts, differences, joint_verdicts, robust

HERE = Path(__file__).parent
MISSING = "temperature, uplift, and many records with a reduced model"
CLASSICAL = "xingbiling_classical"


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
    }
    page = folder / "paper_study.html"
    html = render(
        HERE / "paper_study.html",
        title="Two arch dams of Xu, Chen, Li and Yue (2014)",
        header=header,
        facts=list(facts.values()),
        concrete=embed(concrete),
        commands=[(o.case.name, _command(o.case, folder)) for o in outcomes],
        data=Markup(text.replace("</", "<\\/")),
        missing=MISSING,
        **content,
    )
    page.write_text(html, encoding="utf-8")
    return page


def embed(files: list[Path]) -> list[dict[str, str]]:
    """Pictures as text for the page."""
    return [
        {"name": file.stem, "data": base64.b64encode(file.read_bytes()).decode()} for file in files
    ]


def _command(case: Case, folder: Path) -> str:
    deck = folder / "decks" / case.name / f"{case.name}.inp"
    return case.command(deck, motion_of(case.seed, folder))


def _xingbiling(
    facts: dict[str, Facts], runs: dict[str, SiResults], folder: Path
) -> dict[str, Any]:
    """Tables against the classical joint, and their pictures."""
    chosen = {name: run for name, run in runs.items() if name.startswith("xingbiling")}
    others = [name for name in chosen if name != CLASSICAL]
    if CLASSICAL not in chosen or not others:
        return {"tables": [], "joint_verdicts": [], "xingbiling": {}}
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
    }


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
            {"title": outcome.case.title, "verdicts": dam_verdicts(facts[name]),
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
