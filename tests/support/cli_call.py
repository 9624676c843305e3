"""The program called inside the test process."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from cli_process import Done

from dismech_cli.cli.app import app
from dismech_cli.cli.exits import exit_code
from dismech_cli.output.threads import COUNTS

Call = Callable[..., Done]


@pytest.fixture
def call(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> Callable[..., Done]:
    """Call the program in an empty folder; its thread settings do not outlive the test."""
    monkeypatch.chdir(tmp_path)
    for name in COUNTS:
        monkeypatch.setenv(name, "1")
    monkeypatch.delenv("MKL_CBWR", raising=False)

    def run(*arguments: object) -> Done:
        capfd.readouterr()
        code = exit_code(app, [str(argument) for argument in arguments])
        out, err = capfd.readouterr()
        return Done(int(code), out, err)

    return run
