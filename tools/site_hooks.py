"""Hooks of MkDocs (mkdocs.yml): what the pages of docs/ need to become a site.

Formulas become MathML, which browsers draw without scripts. README.md is the first page; CHANGELOG
and CONTRIBUTING are pages, too. Links to files outside of docs/ become the path of the file. The
gallery is made here, by runs of the program.
"""

from __future__ import annotations

import html
import re
from pathlib import Path
from typing import Any

import make_gallery
from latex2mathml.converter import convert
from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parent.parent
# Pages of the site that stand beside docs/.
BESIDE = {
    "README.md": "index.md",
    "CHANGELOG.md": "CHANGELOG.md",
    "CONTRIBUTING.md": "CONTRIBUTING.md",
}
_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)#\s]+)(#[^)\s]*)?\)")
_FORMULA = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)


def on_files(files: Any, config: Any) -> Any:
    """Add the pages that stand beside docs/ and the gallery."""
    for name, page in BESIDE.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        text = re.sub(r"(\]\()docs/", r"\1", text)
        files.append(File.generated(config, page, content=text))
    pictures = make_gallery.make_gallery()
    page = (make_gallery.FOLDER / "gallery.md").read_text(encoding="utf-8")
    files.append(File.generated(config, "gallery.md", content=page))
    for name, path in pictures.items():
        files.append(File.generated(config, name, content=path.read_bytes()))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Links to what is no page or picture of the site become plain paths."""
    here = Path(page.file.src_uri).parent

    def replace(found: re.Match[str]) -> str:
        text, target, anchor = found[1], found[2], found[3] or ""
        if "://" in target:
            return found[0]
        name = Path(target).name
        if target.startswith("../") and name in BESIDE and str(here) == ".":
            return f"[{text}]({BESIDE[name]}{anchor})"
        uri = (Path("/") / here / target).resolve().relative_to("/").as_posix()
        if (
            target.startswith("../" * (len(here.parts) + 1))
            or files.get_file_from_path(uri) is None
        ):
            path = target.lstrip("./")
            return text if path in text else f"{text} (`{path}`)"
        return found[0]

    return _LINK.sub(replace, markdown)


def on_page_content(content: str, page: Any, config: Any, files: Any) -> str:
    """Formulas as MathML. Raises ValueError, with the page, for one that cannot be read."""

    def replace(found: re.Match[str]) -> str:
        source = html.unescape(found[3]).strip()
        display = "block" if found[2] == "[" else "inline"
        try:
            return convert(source, display=display)
        except Exception as error:
            raise ValueError(f"{page.file.src_uri}: the formula {source!r}: {error!r}") from error

    return _FORMULA.sub(replace, content)
