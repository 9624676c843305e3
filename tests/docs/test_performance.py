"""The page on performance has the command that makes each table."""

from __future__ import annotations

import re
from pathlib import Path

from benchmarks.__main__ import SECTIONS, TABLES

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "performance.md").read_text(encoding="utf-8")


def test_every_section_of_the_benchmarks_has_its_command():
    rows = re.findall(r"^\| .*?\| `python -m benchmarks (\w+)` \|", PAGE, re.MULTILINE)
    assert tuple(row for row in rows if row not in TABLES) == SECTIONS
