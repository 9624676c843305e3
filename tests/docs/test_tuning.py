"""Every row of the tuning guide shows its symptom, and its cure takes it away."""

from __future__ import annotations

import re

import pytest
from cli_call import call
from cli_process import ROOT

__all__ = ["call"]

PAGE = (ROOT / "docs" / "tuning.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| .*?`(.+?)` \| .*? \| \[(\w+)\]\((\S+)\) \| `(.+)` \|$", PAGE, re.MULTILINE)


def seen(call, file: str, *more: str) -> tuple[int, str]:
    done = call("run", ROOT / "docs" / file, "--no-render", *more)
    return done.code, done.stdout + done.stderr


@pytest.mark.parametrize(("words", "name", "file", "cure"), ROWS, ids=[row[1] for row in ROWS])
def test_a_row(call, words: str, name: str, file: str, cure: str):
    _, text = seen(call, file)
    assert words in text
    code, text = seen(call, file, "--set", cure)
    assert code == 0, text
    assert words not in text


def test_every_scene_has_its_row():
    scenes = {path.stem for path in (ROOT / "docs" / "tuning").glob("*.yaml")} - {"arm"}
    assert scenes == {name for _, name, _, _ in ROWS}
    assert len(ROWS) == len(scenes)
