"""Shell completion: templates, keys of --set, fields of a run."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from dismech_cli import simulate
from dismech_cli.cli.app import app

SCENARIOS = Path(__file__).parents[2] / "scenarios"
CANTILEVER = str(SCENARIOS / "twisted_rod.yaml")


def completed(*words: str) -> list[str]:
    """What a shell offers for the last word."""
    # what bash hands to the program, and reads from it
    shell = {
        "_DISMECH_COMPLETE": "complete_bash",
        "COMP_WORDS": shlex.join(["dismech", *words]),
        "COMP_CWORD": str(len(words)),
    }
    done = CliRunner().invoke(app, [], prog_name="dismech", env=shell)
    assert done.exit_code == 0, done.output
    return done.stdout.split()


def test_templates() -> None:
    assert completed("init", "canti")[:2] == ["cantilever", "cantilever_dynamic_1e5"]
    assert completed("init", "no_such") == []


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("numer", ["numerics."]),
        ("numerics.d", ["numerics.dt="]),
        ("numerics.newton.t", ["numerics.newton.tolerance="]),
        ("geome", ["geometry[0]."]),
        ("geometry[0].ra", ["geometry[0].radius="]),
        ("geometry[0].generate.n", ["geometry[0].generate.nodes="]),
        ("motions[1].rel", ["motions[1].release="]),
        ("materials.", ["materials.silicone."]),
        ("initial", ["initial=", "initial_velocity="]),
        ("numerics.dt=", []),
        ("geometry[7].ra", []),
        ("nothing.of", []),
        ("forces[0", []),
    ],
)
@pytest.mark.parametrize("command", ["run", "check", "explain"])
def test_keys(command: str, typed: str, offered: list[str]) -> None:
    assert completed(command, CANTILEVER, "--set", typed) == offered


def test_keys_without_a_scenario(tmp_path: Path) -> None:
    assert completed("run", "--set", "numer") == ["numerics="]
    assert completed("run", str(tmp_path / "none.yaml"), "--set", "numer") == ["numerics="]


def test_of_a_run(tmp_path: Path) -> None:
    run = tmp_path / "run"
    simulate(CANTILEVER, overrides=["output.fields=[velocity, twist]"], out=run)
    assert completed("resume", str(run), "--set", "output.ev") == ["output.every="]
    assert completed("render", str(run), "--color-by", "") == ["none", "speed", "velocity", "twist"]
    assert completed("render", str(run), "--color-by", "t") == ["twist"]
    assert completed("render", str(tmp_path), "--color-by", "") == []
    assert completed("export", str(run), "--to", "v") == ["vtu"]
