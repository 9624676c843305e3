"""What exact derivatives cost beside the run that they belong to."""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from dismech_cli.run.loop import run
from dismech_cli.session.narrator import Silent
from dismech_cli.session.sinks import Latest
from dismech_cli.studies.gradient.gradient import Method, exact, find
from dismech_cli.studies.gradient.nearby import nearby
from dismech_cli.studies.gradient.run import differentiated, exactly, run_taped, start_run
from dismech_cli.studies.gradient.setting import Setting
from dismech_cli.studies.source import Source

from .clock import in_turns
from .table import table, verdict

EDGE = 5e-3  # length of an edge [m]
DT = 5e-3
BAR = 1.0
Deck = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Scene:
    """A scene with the four values that it is differentiated by."""

    deck: Deck
    size: str

    @property
    def by(self) -> tuple[str, ...]:
        """A modulus, a density, a size of the section, a load."""
        return (
            "materials.rubber.youngs_modulus",
            "materials.rubber.density",
            f"geometry[0].{self.size}",
            "forces[0].acceleration[2]",
        )


def _falling(body: Deck, end: str, *, dimension: int, t_end: float, integrator: str) -> Deck:
    return {
        "schema_version": 1,
        "name": "benchmark",
        "dimension": dimension,
        "materials": {"rubber": {"youngs_modulus": 1e7, "poisson_ratio": 0.45, "density": 1273.52}},
        "geometry": [{"name": "body", "material": "rubber"} | body],
        "motions": [{"type": "clamp", "where": "body.left" if body["type"] == "shell" else "body.start"}],
        "forces": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "output": {"fields": [], "probes": {"tip": {"position": end, "component": "z"}}},
        "numerics": {"integrator": {"type": integrator}, "dt": DT, "t_end": t_end, "kernels": "numba"},
    }


def _rod(shape: Deck, **keys: Any) -> Scene:
    return Scene(_falling({"type": "rod", "radius": 5e-3, "generate": shape}, "body.end", **keys), "radius")


def _line(nodes: int) -> Deck:
    return {"shape": "line", "from": [0, 0, 0], "to": [EDGE * (nodes - 1), 0, 0], "nodes": nodes}


def _helix(nodes: int) -> Deck:
    turns = 3.7 * (nodes - 1) / 99
    shape = {"shape": "helix", "origin": [0, 0, 0], "axis": [0, 0, -1], "radius": 0.02, "pitch": 0.05}
    return shape | {"turns": turns, "handedness": "right", "nodes": nodes}


def _sheet(bending: str, **keys: Any) -> Scene:
    size = 12 * EDGE
    shape = {"shape": "sheet", "origin": [0, 0, 0], "length": size, "width": size, "divisions": 12}
    body = {"type": "shell", "thickness": 1e-3, "bending": bending, "generate": shape}
    return Scene(_falling(body, "body.right", dimension=3, **keys), "thickness")


def scenes() -> dict[str, Scene]:
    """Scenes by name."""
    alpha = {"t_end": 0.5, "integrator": "generalized_alpha"}
    return {
        "planar rod, 101 nodes": _rod(_line(101), dimension=2, **alpha),
        "planar rod, 101 nodes, TR-BDF2": _rod(_line(101), dimension=2, t_end=0.5, integrator="tr_bdf2"),
        "isotropic rod, 101 nodes": _rod(_line(101), dimension=3, **alpha),
        "framed helix, 101 nodes": _rod(_helix(101), dimension=3, **alpha),
        "framed helix, 101 nodes, TR-BDF2": _rod(_helix(101), dimension=3, t_end=0.5, integrator="tr_bdf2"),
        "framed helix, 1000 nodes": _rod(
            _helix(1000), dimension=3, t_end=0.1, integrator="generalized_alpha"
        ),
        "sheet, hinges": _sheet("hinge", t_end=0.2, integrator="generalized_alpha"),
        "sheet, free normals": _sheet("midedge", t_end=0.2, integrator="generalized_alpha"),
    }


def measure(scene: Scene, seconds: float) -> tuple[int, float, list[float]]:
    """Steps, milliseconds of one, and what else costs per run: exact balances, forward, adjoint."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        path.write_text(json.dumps(scene.deck), encoding="utf-8")
        source = Source.of(path, (), None, allow_outside=False)
        loaded, composition = start_run(source, Silent())
        target, _ = find(loaded, composition, "tip")
        settings = [Setting.of(loaded, one) for one in scene.by]
        near = nearby(source, settings, composition)
    plain = replace(composition.simulation, frame_every=1e300)
    simulation = exactly(composition, {"tip": composition.simulation.probes["tip"]})
    taped = run_taped(simulation, Silent())
    model = differentiated(taped, near, simulation.model.driver)
    spent = in_turns(
        [
            lambda: run(plain, Latest()),
            lambda: run_taped(simulation, Silent()),
            lambda: exact(Method.FORWARD, simulation, target, taped, model, near),
            lambda: exact(Method.ADJOINT, simulation, target, taped, model, near),
        ],
        seconds=seconds,
    )
    steps, ratios = len(taped.steps), np.median(spent[:, 1:] / spent[:, :1], axis=0)
    return steps, 1e3 * float(spent[:, 0].min()) / steps, [float(one) for one in ratios]


def report(quick: bool) -> str:
    """Derivatives to four values, in runs."""
    rows = []
    for name, scene in scenes().items():
        print(f"  {name}", flush=True)
        steps, each, (exactly_run, forward, adjoint) = measure(scene, 2.0 if quick else 8.0)
        own = [verdict(one / exactly_run, BAR) for one in (forward, adjoint)]
        rows.append((name, steps, each, exactly_run, forward, adjoint, *own))
    return "\n\n".join(
        (
            "## Exact derivatives of a run\n\n"
            "The position of the tip at the end, by a modulus, a density, a size of the section and the "
            "weight; generalised-alpha unless said. The run that a derivative belongs to solves its balances "
            "to 1e-10: what it costs, and the sweeps, in plain runs of the scene; and the sweeps in such "
            "runs. Composing the scene at sixteen neighbouring values comes on top, once.",
            table(
                (
                    "scene",
                    "steps",
                    "ms per step",
                    "exact run",
                    "forward",
                    "adjoint",
                    "forward in exact runs",
                    "adjoint in exact runs",
                ),
                rows,
            ),
        )
    )
