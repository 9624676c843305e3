"""The pages for contributors name files that are there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = ["CONTRIBUTING.md", "docs/how-it-works.md", "docs/verification.md", "scenarios/README.md"]


def files() -> list[str]:
    """All files below the folders that the pages speak of."""
    folders = ("dismech_cli", "docs", "scenarios", "tests")
    return [f"/{path.relative_to(ROOT)}" for name in folders for path in (ROOT / name).rglob("*")]


def named(page: str) -> set[str]:
    """Files and folders of the source that a page names in code."""
    words = re.findall(r"`([\w/.*]+)`", (ROOT / page).read_text(encoding="utf-8"))
    return {word for word in words if word.endswith((".py", "/"))}


def stands(path: str, found: list[str]) -> bool:
    pattern = re.compile("/" + re.escape(path.rstrip("/")).replace(r"\*", "[^/]*") + "$")
    return any(pattern.search(file) for file in found)


@pytest.mark.parametrize("page", PAGES)
def test_what_a_page_names_is_there(page: str) -> None:
    found = files()
    assert [
        path for path in sorted(named(page)) if not stands(path, found) and not (ROOT / path).exists()
    ] == []


def test_a_path_that_is_not_there_is_noticed() -> None:
    found = files()
    assert stands("solve/integrators.py", found)
    assert not stands("solve/solvers.py", found)
    assert not stands("build/", found)


def test_every_room_is_on_the_page() -> None:
    page = (ROOT / "docs/how-it-works.md").read_text(encoding="utf-8")
    rooms = {path.parent.name for path in (ROOT / "dismech_cli").glob("*/__init__.py")}
    headings = " ".join(re.findall(r"^### (.*)", page, re.MULTILINE))
    assert {room for room in rooms if f"`{room}/`" not in headings} == set()
