"""A folder with a small scenario, for the tests of the scenario language."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from dismech_cli.scenario.load import LoadedScenario, load

SCENE = """\
schema_version: 1
name: cantilever
materials:
  silicone: {youngs_modulus: 2 MPa, poisson_ratio: 0.5, density: 1.2 g/cm^3}
geometry:
  - type: rod
    name: beam
    material: silicone
    radius: 1 mm
    generate: {shape: line, from: [0, 0, 0], to: [100 mm, 0, 0], nodes: 11}
motions:
  - {type: clamp, where: beam.start}
forces:
  - {type: gravity, acceleration: [0, 0, -9.81]}
numerics:
  dt: 5 ms
  t_end: 2 s
"""

TOML = """\
schema_version = 1
name = "cantilever"
numerics.dt = "5 ms"
numerics.t_end = 2

[materials.silicone]
youngs_modulus = "2 MPa"
poisson_ratio = 0.5
density = 1200

[[geometry]]
type = "rod"
name = "beam"
material = "silicone"
radius = "1 mm"
generate = { shape = "line", from = [0, 0, 0], to = [0.1, 0, 0], nodes = 11 }

[[motions]]
type = "clamp"
where = "beam.start"

[[forces]]
type = "gravity"
acceleration = [
  0, 0,  # sideways
  -9.81,
]
"""


@dataclass(frozen=True)
class Folder:
    """A folder with a scenario; paths are relative so that messages are short."""

    path: Path

    def write(self, name: str, text: str) -> None:
        target = self.path / name
        target.parent.mkdir(exist_ok=True)
        target.write_text(text, encoding="utf-8")

    def load(self, text: str = SCENE, *overrides: str, profile: str | None = None) -> LoadedScenario:
        self.write("scene.yaml", text)
        return load("scene.yaml", overrides=overrides, profile=profile)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Folder:
    monkeypatch.chdir(tmp_path)
    return Folder(tmp_path)
