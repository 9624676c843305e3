from __future__ import annotations

import json
import re
import subprocess
import sys
import time

import pytest
from cli_call import call
from cli_process import environment

import dismech_cli

__all__ = ["call"]

COMMANDS = (
    "run",
    "check",
    "explain",
    "resume",
    "study",
    "sweep",
    "compare",
    "render",
    "report",
    "export",
    "gradient",
    "calibrate",
    "init",
    "examples",
    "schema",
    "doctor",
)
HEAVY = (
    "numpy",
    "scipy",
    "h5py",
    "pyvista",
    "vtk",
    "vtkmodules",
    "pydantic",
    "meshio",
    "matplotlib",
    "imageio",
    "numba",
)

LOOK = """
import json, sys
from dismech_cli.cli.exits import exit_code
from dismech_cli.cli.app import app
code = exit_code(app, sys.argv[1:])
print(json.dumps([int(code), sorted(name for name in sys.modules if "." not in name)]), file=sys.stderr)
"""


# Typer itself reads the options of a subcommand with pydantic.
@pytest.mark.parametrize(
    ("arguments", "allowed"),
    [
        (("--help",), set()),
        (("--version",), set()),
        (("run", "--help"), {"pydantic"}),
        (("run", "--overwrite", "x.yaml"), {"pydantic"}),
    ],
)
def test_help_imports_nothing_heavy(arguments, allowed):
    done = subprocess.run(
        [sys.executable, "-c", LOOK, *arguments],
        env=environment(),
        capture_output=True,
        text=True,
        check=True,
    )
    code, modules = json.loads(done.stderr.splitlines()[-1])
    assert code == (2 if "x.yaml" in arguments else 0)
    assert set(HEAVY) & set(modules) <= allowed


def test_help_is_fast():
    # Measured against Python's own start, which shares whatever else the machine does now.
    def best(*arguments: str) -> float:
        times = []
        for _ in range(3):
            tick = time.perf_counter()
            subprocess.run([sys.executable, *arguments], env=environment(), capture_output=True, check=True)
            times.append(time.perf_counter() - tick)
        return min(times)

    bare = best("-c", "import typing, dataclasses, inspect, pathlib")
    assert best("-m", "dismech_cli", "--help") < max(0.5, 8.0 * bare)


def test_version(call):
    assert call("--version").stdout == f"dismech {dismech_cli.__version__}\n"


@pytest.mark.parametrize("option", ["-h", "--help"])
@pytest.mark.parametrize("command", COMMANDS)
def test_help_leads_with_examples(call, command, option):
    done = call(command, option)
    assert done.code == 0
    assert re.search(rf"^ +dismech {command}\b", done.stdout, re.MULTILINE)
    assert done.stdout.index(f"  dismech {command}") < done.stdout.index("Options:")


def test_help_lists_exactly_the_commands(call):
    text = call("--help").stdout
    listed = re.findall(r"^  (\w+)  ", text[text.index("Commands:") :], re.MULTILINE)
    assert tuple(listed) == COMMANDS


def test_the_wrong_command_line_ends_with_2(call):
    for arguments in (
        ("rn",),
        ("run",),
        ("run", "--nope", "x.yaml"),
        ("run", "a", "b"),
        ("resume", "nowhere"),
    ):
        done = call(*arguments)
        assert done.code == 2, arguments
        assert "Traceback" not in done.stderr
    assert "Did you mean 'run'" in call("rn").stderr


def test_completion_is_offered():
    done = subprocess.run(
        [sys.executable, "-m", "dismech_cli"],
        env=environment(_DISMECH_COMPLETE="complete_bash", COMP_WORDS="dismech exp", COMP_CWORD="1"),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.split() == ["explain", "export"]
