"""A browser of this machine, without a window: prints a page to PDF."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "microsoft-edge")
# The picture in space is drawn by the processor: servers have no graphics card.
OPTIONS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
SHOW_ON_PAPER = """async () => {
  window.dispatchEvent(new Event("beforeprint"));
  await Promise.all([...document.images].filter(i => i.src).map(i => i.decode()));
}"""
READY = "body[data-ready], body[data-failed]"  # of a report that is drawn
WAIT = 240_000  # [ms]


def find_browser() -> str | None:
    """The program that BROWSER_FOR_REPORTS names, else one of the usual names."""
    wanted = [os.environ.get("BROWSER_FOR_REPORTS", ""), *NAMES]
    return next((found for name in wanted if name and (found := shutil.which(name))), None)


@contextmanager
def opened(path: Path, errors: list[str], ready: str = READY) -> Iterator[Any]:
    """The page as a browser shows it, once it has the element `ready`; `errors` collects those of
    its console."""
    from playwright.sync_api import sync_playwright

    program = find_browser()
    if program is None:
        raise FileNotFoundError("there is no Chromium, Chrome or Edge on this machine")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=OPTIONS)
        try:
            context = browser.new_context(offline=True, viewport={"width": 1000, "height": 700})
            context.set_default_timeout(WAIT)
            page = context.new_page()
            page.on("console", lambda m: errors.append(m.text) if m.type == "error" else None)
            page.on("pageerror", lambda error: errors.append(str(error)))
            page.goto(path.resolve().as_uri(), wait_until="commit")
            page.wait_for_selector(ready)
            yield page
        finally:
            browser.close()


def print_pdf(path: Path) -> Path:
    """Print a page to a PDF beside it."""
    errors: list[str] = []
    target = path.with_suffix(".pdf")
    with opened(path, errors) as page:
        page.evaluate(SHOW_ON_PAPER)
        page.pdf(path=target, prefer_css_page_size=True, print_background=True)
    return target
