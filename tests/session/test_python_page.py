"""The Python of the documentation runs as it stands, block after block."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from numpy.testing import assert_allclose

from dismech_cli import Limits, simulate

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def execute(page: str) -> dict[str, object]:
    """Run all Python blocks of a page in one namespace; a failure names the line of the page."""
    text = (ROOT / page).read_text(encoding="utf-8")
    names: dict[str, object] = {}
    found = list(BLOCK.finditer(text))
    assert found, page
    for block in found:
        above = text.count("\n", 0, block.start(1))
        exec(compile("\n" * above + block[1], page, "exec"), names)
    return names


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DISMECH_CACHE", str(tmp_path / "cache"))
    return tmp_path


def the_arm() -> dict[str, object]:
    """The scenario that the page on Python makes."""
    text = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    names: dict[str, object] = {}
    exec(BLOCK.search(text)[1].rpartition("\n\n\n")[0], names)
    return json.loads(json.dumps(names["arm"](2e-3), default=np.ndarray.tolist))


def test_page_on_python(folder, capsys):
    (folder / "arm.yaml").write_text(yaml.safe_dump(the_arm()))
    names = execute("docs/python.md")
    printed = capsys.readouterr()
    for said in (
        "<mapping>: geometry[0].radius: expected a length such as '1 m', got a mass, '2 kg'",
        "sag kept: measured ",
        "sag missed: measured ",
    ):
        assert said in printed.out
    assert "plan: " in printed.err
    assert names["loaded"].scenario.numerics.dt == 0.0025
    assert names["loaded"].provenance["numerics.dt"].origin == "--set 'numerics.dt=2.5 ms'"
    # The sag goes with the square of the radius, but for some percent of large deflections and swing.
    assert_allclose(np.polyfit(np.log(names["radii"]), np.log(names["sags"]), 1)[0], -2.0, rtol=0.03)
    manifest = json.loads((folder / "results/mine/manifest.json").read_text())
    assert manifest["status"] == "interrupted"


def test_page_on_outputs(folder):
    scenario = ROOT / "scenarios" / "cantilever.yaml"
    simulate(scenario, limits=Limits(until=0.05), out="results/cantilever/20261122T070000Z-1a2b3c")
    run = execute("docs/outputs.md")["run"]
    assert len(run) > 1


def _first_scene(folder):
    scenario = re.search(r"^```yaml\n(.*?)^```$", (ROOT / "README.md").read_text(), re.MULTILINE | re.DOTALL)
    (folder / "arm.yaml").write_text(scenario[1])


def test_readme(folder):
    _first_scene(folder)
    report = execute("README.md")["report"]
    assert report.scalars["kinetic"][-1] > 0.0


def test_the_first_scene_is_right_at_the_steps_that_are_shown(folder):
    """Beside a fifth of them: shapes of all frames, as shares of the largest motion."""
    _first_scene(folder)

    def shapes(**how):
        report = simulate("arm.yaml", **how).raise_for_status()
        return np.stack([frame.positions for frame in report.frames])

    right = shapes(overrides=["numerics.dt=1 ms"])
    moved = np.sqrt(((right - right[0]) ** 2).sum(axis=2).mean(axis=1)).max()

    def error(**how):
        return np.sqrt(((shapes(**how) - right) ** 2).sum(axis=2).mean(axis=1)).max() / moved

    assert moved > 0.2
    assert error() < 2e-3
    assert error(profile="draft") < 2e-2
    assert error(overrides=["numerics.dt=null"]) < 5e-2
