"""What a failure advises has not been tried already."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from decks import line, rod_deck

import dismech_cli
from dismech_cli.compose.compose import compose
from dismech_cli.model.state import State
from dismech_cli.run.failure import Attempt, describe_failure
from dismech_cli.run.simulation import Simulation
from dismech_cli.solve.integrators import ImplicitEuler, ImplicitMidpoint, Integrator, Static
from dismech_cli.solve.status import Status
from dismech_cli.solve.step_result import StepResult

ROD_AT_REST = Path(__file__).parents[1] / "data" / "rod_at_rest.yaml"


@pytest.fixture(scope="module")
def simulation() -> Simulation:
    return compose(dismech_cli.load(ROD_AT_REST)).simulation


def failed(simulation: Simulation, status: Status) -> list[Attempt]:
    q = np.zeros(simulation.model.dofs.n)
    state = State(0.0, q, q, q, simulation.model.frames.rest(simulation.model.rest))
    return [Attempt.of(0.0, 1e-3, StepResult(state, status, 7, 1.0, q, 5))]


@pytest.mark.parametrize("integrator", [Static(), ImplicitEuler(), ImplicitMidpoint()])
@pytest.mark.parametrize("status", [Status.MAX_ITERATIONS, Status.LINE_SEARCH_FAILED, Status.NOT_FINITE])
def test_no_shorter_steps_after_the_last_cut(
    simulation: Simulation, status: Status, integrator: Integrator
) -> None:
    simulation = replace(simulation, integrator=integrator)
    failure = describe_failure(simulation, failed(simulation, status), cut=True)
    assert "halving the step down to 0.001" in failure.message
    assert "reduce" not in failure.message
    assert "load_steps" not in failure.message
    assert "node 2 (rod 'arm'" in failure.message
    assert "numerics.dt" not in failure.remedy


def test_shorter_steps_where_none_were_tried(simulation: Simulation) -> None:
    failure = describe_failure(simulation, failed(simulation, Status.MAX_ITERATIONS), cut=False)
    assert failure.remedy == "numerics.dt=0.00025 s"


RETRIED = {Status.CONVERGED, Status.AMBIGUOUS, Status.UNSETTLED}
"""How no run ends: steps that may yet be cut end so."""


@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.parametrize(
    "status", sorted(set(Status) - {Status.CONVERGED, Status.AMBIGUOUS, Status.UNSETTLED}, key=str)
)
def test_a_path_is_told_of_its_own_steps(tmp_path: Path, status: Status, cut: bool) -> None:
    deck = rod_deck(
        line(5),
        forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.0, 1.0]}],
        numerics={"integrator": {"type": "static", "path": {}}},
    )
    file = tmp_path / "path.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    simulation = compose(dismech_cli.load(file)).simulation
    failure = describe_failure(simulation, failed(simulation, status), cut=cut)
    for other in ("load_steps", "numerics.dt", "relax", "integrator.path follows", "dynamic integrator"):
        assert other not in failure.message
    assert failure.remedy == ""
    assert ("from the start" in failure.message) == (not cut and status is not Status.FACTORIZATION_FAILED)
