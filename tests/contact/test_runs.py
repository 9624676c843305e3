"""Runs with contact: closed forms, tunnelling, what is told, and that a resumed run is the straight one."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from contact_decks import MASS, crossing, on_floor
from numpy.testing import assert_allclose, assert_array_equal

import dismech_cli
from dismech_cli.run.loop import Limits
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.resume import proceed


@pytest.mark.parametrize("force", [4.0, -5.0, 8.0, 10.5, -10.5])
@pytest.mark.parametrize(("tangent", "most"), [("full", 8), ("symmetric", 11)])
def test_a_rod_pulled_over_a_floor(force: float, tangent: str, most: int) -> None:
    deck = on_floor(force)
    deck["contact"]["friction"]["tangent"] = tangent
    report = dismech_cli.simulate(deck)
    expected = (abs(force) - 0.4 * MASS * 9.8) ** 2 / (2.0 * MASS)
    assert_allclose(report.scalars["kinetic"][-1], expected, rtol=0.02)
    assert report.outcome.counters["iterations"] <= most * report.outcome.counters["steps"]
    assert report.warnings == ()


@pytest.mark.parametrize("law", [{"stiffness": 1e4}, {"tolerance": 0.05}])
def test_below_the_threshold_it_stays(law: dict[str, float]) -> None:
    deck = on_floor(3.5)
    deck["contact"]["law"] = law
    if "tolerance" in law:
        # it starts higher than that stiffness holds it: let it settle
        deck["numerics"]["integrator"] = {"type": "implicit_euler"}
    report = dismech_cli.simulate(deck)
    counters = report.outcome.counters
    assert report.scalars["kinetic"][-1] < 1e-4
    assert counters["cuts"] == 0
    assert counters["iterations"] <= 3 * counters["steps"]


@pytest.mark.parametrize("r", [0.999, 1.001])
def test_the_threshold_of_a_slope(r: float) -> None:
    """A thousandth below tan a = mu it creeps as the law says, a thousandth above it slides away."""
    deck = on_floor()
    deck["forces"] = [{"type": "gravity", "acceleration": [9.8 * 0.4 * r, 0, -9.8]}]
    deck["numerics"] = {"integrator": {"type": "implicit_euler"}, "dt": 1e-2, "t_end": 2.0}
    deck["output"] = {"every": 1.0, "probes": {"speed": {"velocity": "rod", "component": "x"}}}
    _, middle, end = dismech_cli.simulate(deck).scalars["speed"]
    if r < 1.0:
        assert_allclose(end, 1e-3 * np.log((1.0 + r) / (1.0 - r)) / 15.0, rtol=1e-3)
    else:
        assert_allclose(end - middle, 0.4 * 9.8 * (r - 1.0), rtol=1e-2)


@pytest.mark.parametrize("tangent", ["full", "symmetric"])
def test_sticks_that_come_to_stick(tangent: str) -> None:
    """A pile of three falls on the floor: Newton's method is slow there, but neither gives up nor doubts."""
    deck = {
        "schema_version": 1,
        "name": "pile",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000}},
        "geometry": [
            {
                "type": "rod",
                "name": "stick_$i",
                "material": "m",
                "radius": 3e-3,
                "repeat": {
                    "count": 3,
                    "translate": [3e-3, 2e-3, 1e-2],
                    "rotate": {"axis": [0, 0, 1], "angle": "77 deg"},
                },
                "generate": {"shape": "line", "from": [-0.05, 0, 0.01], "to": [0.05, 0, 0.01], "nodes": 11},
            }
        ],
        "obstacles": [{"name": "floor", "type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}],
        "contact": {"friction": {"coefficient": 0.4, "slip_speed": 1e-3, "tangent": tangent}},
        "forces": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "numerics": {"dt": 4e-3, "t_end": 0.08},
    }
    counters = dismech_cli.simulate(deck).outcome.counters
    # with turns counted as slow convergence: 56 cuts, 20 iterations per step
    assert counters["cuts"] <= 1
    assert counters["iterations"] <= 10 * counters["steps"]


def test_friction_turns_kinetic_energy_into_heat() -> None:
    deck = on_floor(initial_velocity=[{"where": "rod", "velocity": [1.0, 0.0, 0.0]}])
    deck["numerics"]["t_end"] = 0.4
    deck["output"]["probes"] = {"way": {"displacement": "rod.start", "component": "x"}}
    report = dismech_cli.simulate(deck)
    assert_allclose(report.scalars["way"][-1], 1.0 / (2.0 * 0.4 * 9.8), rtol=1e-3)
    assert_allclose(report.scalars["friction"][-1], 0.5 * MASS, rtol=1e-3)
    assert abs(report.scalars["error"]).max() < 1e-3 * 0.5 * MASS


def test_a_moving_floor_takes_the_rod_along() -> None:
    deck = on_floor()
    deck["obstacles"][0]["motion"] = {"displacement": [{"expression": "0.5*t"}, 0, 0]}
    deck["output"]["probes"] = {"speed": {"velocity": "rod", "component": "x"}}
    report = dismech_cli.simulate(deck)
    assert_allclose(report.scalars["speed"][-1], 0.5, rtol=1e-5)
    # of the work of the floor one half moves the rod and the other is rubbed away
    energy = 0.5 * MASS * 0.5**2
    assert_allclose(report.scalars["friction"][-1], energy, rtol=0.02)
    assert_allclose(report.scalars["external_work"][-1], 2.0 * energy, rtol=0.02)


def test_a_rising_floor_lifts_the_rod() -> None:
    """Its work is booked: the account closes to what the integrator loses."""
    deck = on_floor()
    deck["obstacles"][0]["motion"] = {
        "displacement": [0, 0, {"expression": "0.05*(1 - cos(pi*clip((t - 0.2)/0.6, 0, 1)))"}]
    }
    deck["output"]["probes"] = {"height": {"position": "rod", "component": "z"}}
    report = dismech_cli.simulate(deck)
    assert_allclose(report.scalars["height"].max(), 0.1 + 0.02451, rtol=0.1)
    work = MASS * 9.8 * 0.1
    assert_allclose(report.scalars["external_work"][-1], work, rtol=0.05)
    assert abs(report.scalars["error"]).max() < 0.02 * work


@pytest.mark.parametrize("dt", [1e-1, 1e-2, 1e-3, 1e-4])
def test_nothing_tunnels_at_fifty_radii_a_step(dt: float) -> None:
    """Caught, or the run fails and says so: never through in silence."""
    report = dismech_cli.simulate(crossing(dt, 0.1 / dt, tolerance=0.05))
    if report.exit == 0:
        assert (report.scalars["high"] > report.scalars["low"]).all()
    else:
        assert report.exit == 3
        assert report.message


def test_momentum_passes_from_one_to_the_other() -> None:
    report = dismech_cli.simulate(crossing(1e-3, 1.0, tolerance=0.05))
    state, model = report.outcome.state, report.composition.simulation.model
    momentum = (model.mass * state.v)[: model.dofs.n_positions].reshape(-1, 3)
    total = 1000.0 * np.pi * 0.002**2 * 0.5
    assert_allclose(momentum.sum(axis=0), [0.0, 0.0, -total], atol=1e-10 * total)
    assert momentum[:6, 2].sum() < -0.2 * total
    assert report.scalars["error"].max() < 1e-3 * 0.5 * total
    assert state.memory["contact.deepest"].max() <= 0.05


def test_steps_that_grow_after_an_impact_make_no_energy() -> None:
    """An impact cuts the step; what generalised-alpha still owes of it must not grow with later steps."""
    deck = crossing(1e-3, 1.0, tolerance=0.005)
    deck["contact"]["friction"] = {"coefficient": 1.0, "slip_speed": 1e-3}
    deck["initial_velocity"][0]["velocity"] = [0.3, 0.2, -1.0]
    deck["numerics"]["t_end"] = 0.06
    report = dismech_cli.simulate(deck)
    assert report.outcome.counters["cuts"] > 0
    assert report.scalars["error"].max() < 1e-3 * report.scalars["kinetic"][0]
    assert report.warnings == ()


def test_statics_and_what_settles_agree() -> None:
    """A rod clamped above a floor sags on it: the load is that after all motion has died out."""
    deck = on_floor()
    rod = deck["geometry"][0]
    rod["radius"] = 2e-3
    rod["generate"] = {"shape": "line", "from": [0, 0, 0], "to": [0.3, 0, 0], "nodes": 16}
    deck["obstacles"][0]["point"] = [0, 0, -0.02]
    deck["contact"] = {}
    deck["materials"]["m"] = {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1e3}
    deck["motions"] = [{"type": "clamp", "where": "rod.start"}]
    deck["forces"] = [deck["forces"][0], {"type": "viscous", "coefficient": 0.1}]
    probes = {"probes": {"load": {"contact": ["rod", "floor"], "measure": "load"}}}
    loads = []
    for numerics in (
        {"integrator": {"type": "static", "load_steps": 10}},
        {"integrator": {"type": "implicit_euler"}, "dt": 1e-2, "t_end": 2.0},
    ):
        report = dismech_cli.simulate(deck | {"numerics": numerics, "output": probes})
        assert report.outcome.state.memory["contact.deepest"].max() <= 0.05
        loads.append(report.scalars["load"][-1])
    assert loads[0] > 0.01
    assert_allclose(loads[0], loads[1], rtol=0.01)


def test_too_soft_is_told() -> None:
    report = dismech_cli.simulate(crossing(1e-3, 1.0, stiffness=1.0))
    assert any("press into each other" in line for line in report.warnings)


def test_a_resumed_run_is_the_straight_run(tmp_path: Path) -> None:
    """Through the raise of the stiffness and the pairs that come: stopped before, within and after."""
    deck = crossing(1e-3, 1.0, tolerance=0.05)
    deck["contact"]["friction"] = {"coefficient": 0.3, "slip_speed": 1e-2}
    deck["initial_velocity"][0]["velocity"] = [0.3, 0.2, -1.0]
    file = tmp_path / "deck.yaml"
    file.write_text(json.dumps(deck))

    def table(folder: Path) -> np.ndarray:
        rows = [line.split(",") for line in (folder / "scalars.csv").read_text().splitlines()]
        keep = [i for i, name in enumerate(rows[0]) if not name.startswith("wall")]
        return np.array([[float(row[i]) for i in keep] for row in rows[1:]])

    dismech_cli.simulate(file, out=tmp_path / "straight")
    dismech_cli.simulate(file, limits=Limits(until=0.03), out=tmp_path / "run")
    for until in ("0.047 s", "0.049 s", "0.06 s", None):
        assert proceed(tmp_path / "run", Pause(until, None, 60.0), Silent(), ()).record.ending.code == 0
    assert_array_equal(table(tmp_path / "run"), table(tmp_path / "straight"))


def test_a_scene_without_contact_loads_none_of_it(tmp_path: Path) -> None:
    code = (
        "import sys, dismech_cli\n"
        "from pathlib import Path\n"
        "from dismech_cli.output.read import read\n"
        "from dismech_cli.session.picturing import asked_of, settings_of\n"
        f"run = Path({str(tmp_path / 'run')!r})\n"
        "dismech_cli.simulate('scenarios/cantilever_small.yaml', out=run)\n"
        "settings_of(asked_of(run), read(run), None)\n"
        "assert not [name for name in sys.modules if '.contact' in name and 'scenario' not in name]\n"
    )
    root = Path(__file__).parents[2]
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
