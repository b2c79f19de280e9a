"""The site is built without a network, no page of it asks for one, its search works from disk."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from harness import ROOT
from keyway_tools.report.browser import OPTIONS, find_browser

pytestmark = pytest.mark.timeout(900)  # [s] runs and pictures of the gallery, on a busy machine


@pytest.fixture(scope="module")
def site(tmp_path_factory, program_path) -> Path:
    folder = tmp_path_factory.mktemp("site") / "site"
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1", "http_proxy": "http://127.0.0.1:9"}
    environment["https_proxy"] = environment["http_proxy"]
    environment["KEYWAY"] = str(program_path.resolve())
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)],
        cwd=ROOT, env=environment, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-4000:]
    return folder


def test_the_site_is_whole(site):
    for page in ("index", "theory", "deck", "tutorials/first_dam", "CHANGELOG", "messages"):
        assert (site / f"{page}.html").exists()
    theory = (site / "theory.html").read_text(encoding="utf-8")
    assert theory.count("<math") > 300
    assert "arithmatex" not in theory
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        loaded = re.findall(r'<(?:script|img|iframe)[^>]*src="(https?:[^"]+)"', text)
        loaded += re.findall(r'<link[^>]*rel="stylesheet"[^>]*href="(https?:[^"]+)"', text)
        assert loaded == [], page
    assert "crack" in (site / "search/search_index.json").read_text(encoding="utf-8")


def test_every_page_is_in_the_navigation(site):
    index = (site / "index.html").read_text(encoding="utf-8")
    listed = set(re.findall(r'<a href="([^"#:]+\.html)" class="md-nav__link', index))
    pages = {page.relative_to(site).as_posix() for page in site.rglob("*.html")}
    assert pages - listed == {"404.html"}


def test_the_gallery_has_its_pictures(site):
    page = (site / "gallery.html").read_text(encoding="utf-8")
    pictures = re.findall(r'<img alt="[^"]*" src="(gallery/[^"]+)"', page)
    assert len(pictures) > 8
    for picture in pictures:
        assert (site / picture).stat().st_size > 10_000


@pytest.mark.skipif(find_browser() is None, reason="no Chromium, Chrome or Edge")
def test_search_works_from_disk(site):
    from playwright.sync_api import sync_playwright

    asked, errors = [], []
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=find_browser(), args=OPTIONS)
        page = browser.new_context(offline=True).new_page()
        page.on("request", lambda request: asked.append(request.url))
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto((site / "tutorials/first_dam.html").as_uri())
        page.click("input.md-search__input")
        page.get_by_text("Type to start searching").wait_for(state="attached")
        page.keyboard.type("reservoir")
        page.wait_for_selector(".md-search-result__item", timeout=60_000)
        found = page.inner_text(".md-search-result__list")
        browser.close()
    assert "Keywords" in found
    assert errors == []
    assert [url for url in asked if not url.startswith("file:")] == []
