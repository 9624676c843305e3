"""What a scene does not need is not loaded: short runs spend most of their time on imports."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).parents[2]

# a scene of one rod with fixed steps and gravity, whose kernels NumPy runs
RUN = """
import json, sys
import dismech_cli
dismech_cli.simulate("scenarios/contortion.yaml", kernels="numpy")
print(json.dumps(sorted(name for name in sys.modules if name.startswith("dismech_cli."))))
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


def test_a_plain_run_loads_nothing_of_other_scenes() -> None:
    done = subprocess.run([sys.executable, "-c", RUN], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = set(json.loads(done.stdout.splitlines()[-1]))
    assert "dismech_cli.run.loop" in loaded
    assert not NEEDLESS & loaded


def test_what_is_needless_there_exists() -> None:
    assert [name for name in NEEDLESS if find_spec(name) is None] == []
