"""The page on failed solves quotes the program word by word."""

from __future__ import annotations

import ast
import re
import shutil
from pathlib import Path

import pytest
from cli_call import call
from cli_process import ROOT
from pages import follow

from dismech_cli.run import failure
from dismech_cli.solve.status import Status

__all__ = ["call"]

PAGE = (ROOT / "docs" / "failed.md").read_text(encoding="utf-8")
QUOTES = re.findall(r"^\| `([^`]+)` \|", PAGE, re.MULTILINE)


def said() -> list[str]:
    """All that the program may say: constant texts, with what is put into them as one blank sign."""
    texts = []
    for node in ast.walk(ast.parse(Path(failure.__file__).read_text(encoding="utf-8"))):
        if isinstance(node, ast.JoinedStr):
            parts = [p.value if isinstance(p, ast.Constant) else "\0" for p in node.values]
            texts.append("".join(map(str, parts)))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            texts.append(node.value)
    return [*texts, *(status.advice for status in Status)]


@pytest.mark.parametrize("quote", QUOTES)
def test_a_quote(quote: str):
    assert any(quote in text for text in said())


def test_there_are_quotes():
    assert len(QUOTES) >= 15


@pytest.mark.parametrize("status", [s for s in Status if s is not Status.CONVERGED])
def test_every_way_to_fail_is_told(status: Status):
    tables = [getattr(failure, name) for name in dir(failure) if name.endswith("_ADVICE") and name.isupper()]
    advice = [status.advice, *(table[status] for table in tables if status in table)]
    assert any(quote in text for quote in QUOTES for text in advice)


def test_the_example(call, tmp_path: Path):
    shutil.copytree(ROOT / "docs" / "tuning", tmp_path / "docs" / "tuning")
    follow("docs/failed.md", tmp_path, call, pictures=False)
