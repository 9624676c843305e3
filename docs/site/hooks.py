"""What MkDocs does besides: pages outside of docs/, links among all of them, formulas without a script.

In the repository pages link to each other by their places there, so that they read well without a site.
Here each file outside of docs/ that a page names comes along, at its place in the repository, and links
are set anew.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterator
from html import unescape
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[2]
PAGES = (
    "scenarios/README.md",
    "benchmarks/RESULTS.md",
    "benchmarks/results/memory.md",
    "benchmarks/results/published.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
)
LINK = re.compile(r'(\]\(|<img src="|href=")([^)"#\s]+)([^)"\s]*)')
CODE = re.compile(r"^(```|~~~).*?^\1|`[^`\n]+`", re.MULTILINE | re.DOTALL)
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages outside of docs/, and what pages link to there."""
    known = {_in_repository(file.src_uri, config) for file in files.documentation_pages()}
    wanted = dict.fromkeys(PAGES)
    for page in [*sorted(known), *PAGES]:
        wanted |= dict.fromkeys(_outside(page))
    for name in wanted:
        files.append(File.generated(config, name, abs_src_path=str(ROOT / name)))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Set links anew, from places in the repository to places in the site."""
    here = _in_repository(page.file.src_uri, config)
    start = posixpath.dirname(page.file.src_uri)

    def moved(link: re.Match[str]) -> str:
        target = _target(here, link[2])
        place = None if target is None else _in_site(target)
        if place is None or files.get_file_from_path(place) is None:
            return link[0]
        return f"{link[1]}{posixpath.relpath(place, start or '.')}{link[3]}"

    return _outside_code(markdown, moved)


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Formulas as MathML, which browsers draw themselves."""
    return FORMULA.sub(
        lambda found: convert(unescape(found[2]), display="inline" if found[1] == "span" else "block"), html
    )


def _outside_code(markdown: str, moved: Callable[[re.Match[str]], str]) -> str:
    """Links replaced wherever they are no code."""
    parts, end = [], 0
    for code in CODE.finditer(markdown):
        parts += [LINK.sub(moved, markdown[end : code.start()]), code[0]]
        end = code.end()
    return "".join([*parts, LINK.sub(moved, markdown[end:])])


def _outside(page: str) -> Iterator[str]:
    """Files outside of docs/ that a page of the repository links to."""
    text = CODE.sub("", (ROOT / page).read_text(encoding="utf-8"))
    for link in LINK.finditer(text):
        target = _target(page, link[2])
        if target is not None and not target.startswith("docs/") and (ROOT / target).is_file():
            yield target


def _target(page: str, link: str) -> str | None:
    """The file of the repository that a link of a page names; None if it names none."""
    if "://" in link:
        return None
    return posixpath.normpath(posixpath.join(posixpath.dirname(page), link))


def _in_site(name: str) -> str | None:
    """Where a file of the repository lies in the site; None where it may lead out of it."""
    return None if name.startswith("..") else name.removeprefix("docs/")


def _in_repository(name: str, config: MkDocsConfig) -> str:
    """The file of the repository that a page of the site is."""
    return f"docs/{name}" if (Path(config.docs_dir) / name).exists() else name
