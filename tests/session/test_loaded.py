"""What a scene does not need is not loaded: short runs spend most of their time on imports."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]

# a scene of one rod with fixed steps and gravity, whose kernels NumPy runs
RUN = """
import json, sys
import dismech_cli
dismech_cli.simulate("scenarios/contortion.yaml", kernels="numpy")
from dismech_cli.scenario.values.spec import Spec
def kinds(of):
    return [one for kind in of.__subclasses__() for one in (kind, *kinds(kind))]
print(json.dumps({
    "modules": list(sys.modules),
    "compiled": [kind.__name__ for kind in kinds(Spec) if kind.__pydantic_complete__],
    "kinds": len(kinds(Spec)),
}))
"""

NEEDLESS = frozenset(
    f"dismech_cli.{name}"
    for name in (
        "compose.control.loops",
        "compose.control.probes",
        "compose.control.springs",
        "compose.loads.flow",
        "compose.loads.followers",
        "control.channel",
        "control.gain",
        "control.incremental",
        "control.port",
        "control.positional",
        "control.sensor",
        "control.target",
        "forces.edge_torque",
        "forces.follower",
        "forces.moment",
        "forces.pressure",
        "forces.thrust",
        "forces.viscous",
        "kernels.noted",
        "kernels.projection",
        "mesh.files.read",
        "run.accuracy",
        "run.adaptive",
        "run.pace",
        "run.path_control",
        "run.stops",
        "solve.marched",
        "solve.weaving",
        "solve.woven",
    )
)


@pytest.fixture(scope="module")
def loaded() -> dict[str, Any]:
    """What a plain run has loaded: modules, and classes of the language that were compiled."""
    done = subprocess.run([sys.executable, "-c", RUN], cwd=ROOT, capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout.splitlines()[-1]))


def test_a_plain_run_loads_nothing_of_other_scenes(loaded: dict[str, Any]) -> None:
    assert "dismech_cli.run.loop" in loaded["modules"]
    assert not NEEDLESS & set(loaded["modules"])
    assert not {"numpy.f2py", "numpy.testing"} & set(loaded["modules"])


def test_a_plain_run_compiles_the_parts_of_the_language_that_it_has(loaded: dict[str, Any]) -> None:
    compiled = set(loaded["compiled"])
    assert {"Scenario", "Rod", "Clamp", "RampLaw", "ImplicitEuler", "Render"} <= compiled
    assert not {"Shell", "Contact", "Study", "Sphere", "HingeJoint", "GeneralizedAlpha"} & compiled
    assert len(compiled) < loaded["kinds"] / 4


def test_what_is_needless_there_exists() -> None:
    assert [name for name in NEEDLESS if find_spec(name) is None] == []
