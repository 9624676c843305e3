"""The page on the command line tells what the program does."""

from __future__ import annotations

import re
from pathlib import Path

from cli_call import call

from dismech_cli.cli.app import app
from dismech_cli.session.exit_codes import Exit

__all__ = ["call"]

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "cli.md").read_text(encoding="utf-8")


def test_every_command_and_no_other_is_listed():
    table = PAGE[PAGE.index("| command | does |") : PAGE.index("### `run`")]
    assert re.findall(r"^\| `(\w+)", table, re.MULTILINE) == [c.name for c in app.registered_commands]


def test_every_option_of_run_is_listed(call):
    table = PAGE[PAGE.index("| option | meaning |") : PAGE.index("A scenario is read")]
    offered = set(re.findall(r"--[a-z][a-z-]+", call("run", "-h").stdout))
    listed = set(re.findall(r"--[a-z][a-z-]+", table))
    assert offered - listed == {"--output", "--help", "--quiet", "--verbose"}
    assert listed <= offered


def test_every_exit_code_is_listed():
    table = PAGE[PAGE.index("| code | meaning |") :]
    assert {int(code) for code in re.findall(r"^\| (\d+) \|", table, re.MULTILINE)} == {*map(int, Exit), 143}
