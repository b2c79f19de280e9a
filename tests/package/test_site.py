"""The site is built without a network; no page of it asks for one."""

from __future__ import annotations

import os
import re
import subprocess
import sys

from harness import ROOT


def test_the_site_is_whole(tmp_path):
    site = tmp_path / "site"
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1", "http_proxy": "http://127.0.0.1:9"}
    environment["https_proxy"] = environment["http_proxy"]
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(site)],
        cwd=ROOT, env=environment, capture_output=True, text=True, timeout=250,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-4000:]
    for page in ("index", "theory", "deck", "tutorials/first_dam", "CHANGELOG"):
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
