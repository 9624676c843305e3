"""Whoever follows a tutorial gets what it shows."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_call import call
from pages import follow

__all__ = ["call"]

PAGES = ["finger", "parachute", "cloth"]


@pytest.mark.parametrize("name", PAGES)
def test_a_tutorial(name: str, tmp_path: Path, call):
    follow(f"docs/tutorials/{name}.md", tmp_path, call, pictures=False)


def test_the_start(tmp_path: Path, call):
    follow("docs/index.md", tmp_path, call, pictures=False)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAGES)
def test_a_tutorial_with_its_pictures(name: str, tmp_path: Path, call):
    follow(f"docs/tutorials/{name}.md", tmp_path, call, pictures=True)
    assert (tmp_path / f"{name}.png").stat().st_size > 10_000
