"""Plugins: named on the command line alone, hashed, and held to the protocol."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path
from typing import Any

import pytest
from cli_call import Call
from cli_call import call as call
from control_decks import arm
from numpy.testing import assert_array_equal

import dismech_cli
from dismech_cli.errors import ControlError, ScenarioError

PROGRAM = """
import numpy as np

class Hold:
    def __init__(self, level):
        self.level = level
    def start(self, n):
        return {"count": np.zeros(1), "n": np.full(1, float(n))}
    def sample(self, t, y, r, memory):
        return np.full(int(memory["n"][0]), self.level), {**memory, "count": memory["count"] + 1.0}

class Falls(Hold):
    def sample(self, t, y, r, memory):
        if t > 0.1:
            raise ValueError("no idea")
        return super().sample(t, y, r, memory)

class Short(Hold):
    def sample(self, t, y, r, memory):
        return np.zeros(1), memory

class Nan(Hold):
    def sample(self, t, y, r, memory):
        return np.full(int(memory["n"][0]), np.nan), memory

class Forgets(Hold):
    def sample(self, t, y, r, memory):
        return np.zeros(int(memory["n"][0])), {}

class Words(Hold):
    def start(self, n):
        return {"name": "mine"}

class Half:
    def start(self, n):
        return {}
"""


def deck(name: str = "mine:Hold", **settings: Any) -> dict[str, Any]:
    scene = arm()
    scene["controllers"]["bend"] = {
        "type": "plugin",
        "name": name,
        "period": 0.02,
        "settings": settings or {"level": 5.0},
    }
    scene["output"] = {"every": 0.02}
    return scene


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    scene, program = tmp_path / "scene.yaml", tmp_path / "mine.py"
    scene.write_text(json.dumps(deck()))
    program.write_text(PROGRAM)
    return scene, program


def test_a_plugin_runs_only_where_it_is_named(call: Call, files: tuple[Path, Path]) -> None:
    scene, program = files
    done = call("run", scene, "-o", "out")
    assert done.code == 2
    assert "controllers.bend.name: comes from a file that runs as a program" in done.stderr
    assert "--plugin mine.py" in done.stderr
    assert not Path("out").exists()
    assert call("run", scene, "-o", "out", "--plugin", program).code == 0
    manifest = json.loads(Path("out/manifest.json").read_text())
    digest = hashlib.sha256(program.read_bytes()).hexdigest()
    assert manifest["hashes"][str(program)] == digest
    assert Path("out/inputs/mine.py").read_text() == PROGRAM


def test_only_the_same_plugin_goes_on(call: Call, files: tuple[Path, Path]) -> None:
    scene, program = files
    assert call("run", scene, "-o", "straight", "--plugin", program).code == 0
    assert call("run", scene, "-o", "out", "--plugin", program, "--until", "0.11 s").code == 0
    done = call("resume", "out")
    assert done.code == 2
    assert "was run with a plugin: name it again, --plugin mine.py" in done.stderr
    program.write_text(PROGRAM + "\n")
    done = call("resume", "out", "--plugin", program)
    assert done.code == 2
    assert "is not the plugin that it was run with" in done.stderr
    program.write_text(PROGRAM)
    assert call("resume", "out", "--plugin", program).code == 0
    tables = [(Path(name) / "scalars.csv").read_text().splitlines() for name in ("straight", "out")]
    columns = [k for k, name in enumerate(tables[0][0].split(",")) if not name.startswith("wall")]
    rows = [[[row.split(",")[k] for k in columns] for row in table] for table in tables]
    assert_array_equal(rows[0], rows[1])


def test_what_fails_inside_is_told_with_controller_and_time(call: Call, files: tuple[Path, Path]) -> None:
    scene, program = files
    scene.write_text(json.dumps(deck("mine:Falls", level=1.0)))
    done = call("run", scene, "-o", "out", "--plugin", program)
    assert done.code == 3
    assert "controller 'bend' fails at t = 0.12 s: ValueError: no idea" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("Short", r"commands at t = 0 s values of shape \(1,\), not \(4,\)"),
        ("Nan", "commands at t = 0 s a value that is not finite"),
        ("Forgets", "remembers at t = 0 s other names than start gave"),
    ],
)
def test_what_is_no_command_is_told(files: tuple[Path, Path], name: str, told: str) -> None:
    report = dismech_cli.simulate(
        dismech_cli.load_mapping(deck(f"mine:{name}", level=1.0)), plugins=[files[1]]
    )
    assert report.exit == 3
    assert re.search(told, report.message)


@pytest.mark.parametrize(
    ("name", "settings", "told"),
    [
        ("mine:Nobody", {"level": 1.0}, "defines no class 'Nobody'"),
        ("mine:Hold", {"height": 1.0}, "cannot make a 'Hold' of these settings"),
        ("mine:Half", {}, "class 'Half' has no method 'sample'"),
        ("other:Hold", {"level": 1.0}, "--plugin other.py"),
    ],
)
def test_what_is_no_controller_is_told(
    files: tuple[Path, Path], name: str, settings: dict[str, Any], told: str
) -> None:
    scene = deck(name)
    scene["controllers"]["bend"]["settings"] = settings
    with pytest.raises(ScenarioError, match=told):
        dismech_cli.simulate(dismech_cli.load_mapping(scene), plugins=[files[1]])


def test_a_file_that_cannot_be_run_is_told(tmp_path: Path) -> None:
    bad = tmp_path / "bad.py"
    bad.write_text("1/0")
    for file, told in (
        (bad, "ZeroDivisionError"),
        (tmp_path / "none.py", "cannot read it"),
        (tmp_path / "a.txt", "expected a Python file"),
    ):
        with pytest.raises(ScenarioError, match=told):
            dismech_cli.simulate(dismech_cli.load_mapping(deck()), plugins=[file])


def test_memory_that_is_no_array_is_told(files: tuple[Path, Path]) -> None:
    with pytest.raises(ControlError, match="remembers in start as 'name' what is no array"):
        dismech_cli.simulate(dismech_cli.load_mapping(deck("mine:Words", level=1.0)), plugins=[files[1]])


def test_the_shipped_plugin_leads_its_arm() -> None:
    folder = Path(__file__).parents[2] / "scenarios" / "plugins"
    report = dismech_cli.simulate(folder / "following_arm.yaml", plugins=[folder / "follow.py"])
    assert report.exit == 0, report.message
