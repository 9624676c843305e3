"""The site is built without warnings, needs nothing but itself and shows every page."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("material", reason="the extra docs is not installed")

ROOT = Path(__file__).resolve().parents[2]
FETCHED = re.compile(
    r"<(?:script|link|img|source|iframe|video)\b[^>]*(?:src|href)=[\"']?(?:https?:)?//[^>]*>"
)


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """The site, built as a contributor does, where links astray are errors."""
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "mkdocs",
            "build",
            "--strict",
            "-q",
            "-f",
            str(ROOT / "mkdocs.yml"),
            "-d",
            str(folder),
        ],
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return folder


def pages(site: Path) -> dict[str, str]:
    return {str(file.relative_to(site)): file.read_text(encoding="utf-8") for file in site.rglob("*.html")}


def test_pages_fetch_nothing(site: Path):
    assert {name: found for name, text in pages(site).items() if (found := FETCHED.findall(text))} == {}
    assert not [
        file
        for file in site.rglob("*.css")
        if re.search(r"url\([\"']?(?:https?:)?//", file.read_text(encoding="utf-8"))
    ]


def test_every_page_is_there(site: Path):
    made = pages(site)
    for page in (ROOT / "docs").rglob("*.md"):
        assert str(page.relative_to(ROOT / "docs").with_suffix(".html")) in made
    assert {"scenarios/index.html", "benchmarks/RESULTS.html", "CHANGELOG.html"} <= made.keys()


def test_formulas_are_drawn_by_the_browser(site: Path):
    made = pages(site)
    assert made["theory.html"].count("<math") >= 20
    assert [name for name, text in made.items() if "arithmatex" in text] == []


def test_what_would_be_fetched_is_noticed():
    assert FETCHED.search('<script src="https://unpkg.com/x"></script>')
    assert FETCHED.search('<link rel="stylesheet" href=//fonts.example/css>')
    assert not FETCHED.search('<a href="https://doi.org/10"><img src="images/x.png"></a>')
