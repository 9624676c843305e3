"""The gain of loops, against a formula and against runs that swing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from cli_call import Call
from cli_call import call as call
from control_decks import SCENARIOS, arm, composed, finished
from decks import Deck

from dismech_cli import load
from dismech_cli.compose.compose import compose
from dismech_cli.control.gain import loop_gain
from dismech_cli.control.loop import SampledLoop
from dismech_cli.run.clock import time_grid
from dismech_cli.scenario.load import load_mapping
from dismech_cli.session.loops import look_at_loops
from dismech_cli.solve.step import Stepper


def one_edge(p: float, late: int = 0, **bend: Any) -> Deck:
    """An edge that stretches in thick fluid: the smallest plant there is. No inertia to speak of."""
    deck = arm(bend={"gains": {"p": p}, "period": 0.01, "target": 1e-3, **bend})
    deck["geometry"][0]["generate"]["nodes"] = 2
    deck["motions"] = [{"type": "pin", "where": "arm.start"}]
    deck["materials"]["m"]["density"] = 1e-3
    deck["forces"] = [{"type": "viscous", "coefficient": 1e3}]
    deck["actuation"] = [{"type": "stretch", "rod": "arm", "value": {"controlled_by": "bend"}}]
    deck["output"] = {"every": 0.01, "probes": {"error": {"controller": "bend", "measure": "error"}}}
    if late:
        deck["sensors"] = {"s": {"strain": "stretch", "rod": "arm", "delay": 0.01 * late}}
        deck["controllers"]["bend"]["sensor"] = "s"
    return deck


def gain_of(deck: Deck) -> Any:
    simulation = composed(deck).simulation
    newton = replace(simulation.newton, tolerance=1e-12)
    stepper = Stepper(simulation.model, simulation.integrator, newton, simulation.linear_solver)
    loops = [loop for loop in simulation.controls.loops if isinstance(loop, SampledLoop)]
    return loop_gain(loops, stepper, simulation.start, time_grid(0.01, loops[0].period))


def pull() -> float:
    """Share of the way that the edge goes in a step of implicit Euler: w / (1 + w), w = dt k / c."""
    stiffness = 1e5 * np.pi * 5e-3**2 / 0.1
    drag = 1e3 * 0.05  # half of the edge
    w = 0.01 * stiffness / drag
    return float(w / (1.0 + w))


def test_the_gain_of_one_edge_is_that_of_the_formula() -> None:
    """y' = (1 - g) y + g u with u = -p y is stable up to p = 2/g - 1."""
    g = pull()
    found = gain_of(one_edge(1.0))
    assert found.reach == pytest.approx(g, rel=1e-3)
    # to a hundredth, as it is sought
    assert found.margin == pytest.approx(2.0 / g - 1.0, rel=0.012)


def test_a_period_of_delay_halves_what_may_be_fed_back() -> None:
    """z^2 - (1 - g) z + g p = 0 is stable up to p = 1/g."""
    assert gain_of(one_edge(1.0, late=1)).margin == pytest.approx(1.0 / pull(), rel=0.012)


@pytest.mark.parametrize("late", [0, 1, 2])
def test_a_run_swings_beyond_the_limit_and_not_within(late: int) -> None:
    limit = gain_of(one_edge(1.0, late)).margin
    swings = []
    for p in (0.9 * limit, 1.1 * limit):
        # a small target: what grows does so for long before it is no longer small
        deck = one_edge(p, late, target=1e-9, gains={"p": p, "setpoint_weight": 1.0})
        report = finished(load_mapping(deck))
        error = np.abs(np.diff(report.probes["error"]))
        swings.append(error[-3:].max() / error[2:8].max())
    assert swings[0] < 1.0 < swings[1]


def test_loops_of_one_period_are_looked_at_together() -> None:
    """Bending and stretching act on each other through gravity and pins."""
    (found,) = look_at_loops(compose(load(SCENARIOS / "s_shape.yaml")).simulation, 0.01)
    assert "'bend' and 'length'" in found.text
    # of p = 80: 2/g - 1 with the largest eigenvalue g of the smoothed response to bending alone is 171
    assert "from 2.1" in found.text


def test_a_system_that_falls_by_itself_is_not_the_fault_of_a_loop() -> None:
    """A rod that stands on its clamp and is too slender for that: growth is not that of feedback."""
    deck = arm(bend={"gains": {"p": 0.01}, "target": 0.0, "feed_forward": 0.0})
    deck["geometry"][0]["generate"] = {"shape": "line", "from": [0, 0, 0], "to": [0, 0, 1.0], "nodes": 6}
    deck["forces"] = [{"type": "gravity", "acceleration": [0, 0, -9.81]}]
    (found,) = look_at_loops(composed(deck).simulation, 0.01)
    assert not found.error


def test_check_refuses_what_cannot_be_stable(call: Call) -> None:
    scene = SCENARIOS / "s_shape.yaml"
    done = call("check", scene, "--set", "controllers.bend.gains.p=400")
    assert done.code == 2
    assert "controllers.bend" in done.stderr
    assert "cannot be stable where the run starts" in done.stderr
    done = call("check", scene)
    assert done.code == 0
    assert "gain of 'bend' and 'length'" in done.stdout
    done = call("check", scene, "--set", "controllers.bend.gains.p=120")
    assert done.code == 0
    assert "may swing" in done.stderr
