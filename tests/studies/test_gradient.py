"""``dismech gradient`` from the command line: numbers against theory, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_call import call
from decks import Deck, line, rod_deck
from pydantic import TypeAdapter
from slope_cases import framed, planar

from dismech_cli import simulate
from dismech_cli.cli.result_schema import GRADIENT, Failure, Gradient
from dismech_cli.scenario.load import load_mapping

__all__ = ["call"]

MODULUS, RUBBER_MODULUS = "materials.m.youngs_modulus", "materials.rubber.youngs_modulus"
TIP: Deck = {"tip": {"displacement": "rod.end", "component": "z"}}


def write(deck: Deck) -> str:
    path = Path("scene.yaml")
    path.write_text(json.dumps(deck))
    return str(path)


def sagging(**keys: Any) -> Deck:
    """A beam under so small a load that theory is linear: tip = -rho g L^4 / (2 E r^2)."""
    rod = {"radius": 2e-3, "section": None, "material": "m"}
    deck = rod_deck(line(41), rod=rod, forces=[{"type": "gravity", "acceleration": [0, 0, -1e-6]}])
    del deck["geometry"][0]["section"]
    return deck | {"output": {"probes": TIP}} | keys


def found(done: Any, code: int = 0) -> Gradient:
    assert done.code == code, done.stderr
    result = GRADIENT.validate_python(json.loads(done.stdout))
    assert isinstance(result, Gradient)
    return result


def test_the_sag_of_a_beam(call):
    paths = (MODULUS, "materials.m.density", "geometry[0].radius", "forces[0].acceleration[2]")
    by = [word for path in paths for word in ("--by", path)]
    result = found(call("gradient", write(sagging()), "--of", "tip", *by, "--json", "-q"))
    assert result.method == "forward"
    powers = [slope.derivative * slope.value / result.value for slope in result.gradient]
    # the model's own tip, whatever the mesh, is a product of powers of its parameters up to the stretch
    assert powers == pytest.approx([-1.0, 1.0, -2.0, 1.0], abs=1e-6)
    assert result.gradient[0].derivative_unit == "m/Pa"
    assert result.check is not None
    assert result.check.agrees
    assert result.check.gradient == pytest.approx(result.check.difference, rel=1e-7)


def test_adjoint_and_forward_and_differences_agree(call):
    deck = planar()
    deck["output"] = {"probes": {"tip": {"position": "arm.end", "component": "magnitude"}}}
    deck["parameters"] = {"stiffness": "1 MPa", "bend": {"default": 6, "unit": "1/m"}}
    deck["materials"]["rubber"] = dict(deck["materials"]["rubber"], youngs_modulus="$stiffness")
    deck["actuation"][0]["value"]["table"][1][1] = "$bend"
    scene = write(deck)
    one, two, three = (
        [
            slope.derivative
            for slope in found(
                call("gradient", scene, "--of", "tip", "--method", method, "--no-check", "--json", "-q")
            ).gradient
        ]
        for method in ("forward", "adjoint", "differences")
    )
    assert one == pytest.approx(two, rel=1e-9)
    assert one == pytest.approx(three, rel=1e-6)


@pytest.mark.parametrize("how", ["mean", "gain", "span", "last"])
def test_an_expectation_is_differentiated_as_it_is_reduced(call, how):
    deck = planar()
    deck["expect"] = {
        "swing": {
            "probe": {"position": "arm.end", "component": "z"},
            "reduce": how,
            "value": 0.0,
            "tolerance": 1.0,
            "source": "nothing",
        }
    }
    scene = write(deck)
    path = "materials.rubber.youngs_modulus"
    result = found(call("gradient", scene, "--of", "swing", "--by", path, "--json", "-q"))
    assert result.check is not None
    assert result.check.agrees
    assert result.check.gradient == pytest.approx(result.check.difference, rel=1e-4)


@pytest.mark.parametrize("energy", ["kinetic", "elastic", "total"])
def test_energies(call, energy):
    deck = planar() | {"output": {"probes": {"e": {"energy": energy}}}}
    by = ("--by", "materials.rubber.density", "--by", "geometry[0].radius")
    result = found(call("gradient", write(deck), "--of", "e", *by, "--json", "-q"))
    assert result.check is not None
    assert result.check.gradient == pytest.approx(result.check.difference, rel=1e-6)


def resting(**contact):
    """A rod that sags onto a floor."""
    deck = sagging(numerics={"integrator": {"type": "static", "load_steps": 1}})
    deck["forces"][0]["acceleration"] = [0, 0, -9.81]
    deck["materials"]["m"]["youngs_modulus"] = 1e8
    deck["obstacles"] = [{"type": "plane", "name": "floor", "point": [0, 0, -0.01], "normal": [0, 0, 1]}]
    deck["contact"] = {"pairs": [{"between": ["rod", "floor"]}]} | contact
    weight = {"contact": ["rod", "floor"], "measure": "normal", "component": "z"}
    return deck | {"output": {"probes": TIP | {"weight": weight}}}


def test_contact_whose_stiffness_adapts_is_differentiated_by_runs_and_said_so(call):
    deck = resting() | {"numerics": {"integrator": {"type": "implicit_euler"}, "dt": 2e-3, "t_end": 0.06}}
    result = found(call("gradient", write(deck), "--of", "tip", "--by", MODULUS, "--json", "-q"))
    assert result.method == "differences"
    assert result.why is not None
    assert "contact" in result.why
    refused = call("gradient", write(deck), "--of", "tip", "--by", MODULUS, "--method", "forward", "-q")
    assert refused.code == 2
    assert "contact.law.stiffness" in refused.stderr


@pytest.mark.parametrize("method", ["forward", "adjoint"])
def test_contact_of_given_stiffness_is_differentiated_exactly(call, method):
    deck = resting(law={"stiffness": 1e4})
    by = ("--by", MODULUS, "--by", "contact.law.stiffness", "--by", "obstacles[0].point[2]")
    result = found(call("gradient", write(deck), "--of", "tip", *by, "--method", method, "--json", "-q"))
    assert result.method == method
    assert result.check is not None
    assert result.check.agrees
    assert result.check.gradient == pytest.approx(result.check.difference, rel=1e-6)


def test_what_a_floor_bears_is_differentiated(call):
    deck = resting(law={"stiffness": 1e4})
    by = ("--by", MODULUS, "--by", "materials.m.density")
    result = found(call("gradient", write(deck), "--of", "weight", *by, "--json", "-q"))
    assert result.method == "forward"
    assert result.check is not None
    assert result.check.gradient == pytest.approx(result.check.difference, rel=1e-6)
    deck["output"]["probes"]["weight"]["measure"] = "places"
    del deck["output"]["probes"]["weight"]["component"]
    assert call("gradient", write(deck), "--of", "weight", *by, "-q").code == 2


SHORT = (
    "numerics.t_end=0.06 s",
    "expect={}",
    "output={probes: {tip: {position: {nodes: {of: arm, indices: [4]}}, component: z}, "
    "pull: {controller: bend, measure: command}}}",
)
SEEN = (
    "sensors={seen: {strain: curvature_1, rod: arm, noise: 0.1 1/m, delay: 10 ms}}",
    "controllers.bend.sensor=seen",
)
INCREMENTAL = (
    "controllers.bend={type: incremental, target: {shape: {file: data/s_shape.csv}}, leak: 0.2, "
    "gains: {p: 10, i: 5}, limits: {rate: 1000}, period: 10 ms}",
)
LOOPS = {
    "sampled": ("s_shape", (), ("controllers.bend.gains.p", "controllers.bend.gains.i")),
    "late and noisy": ("s_shape", SEEN, ("controllers.bend.gains.p", "controllers.bend.gains.i")),
    "held": ("s_shape", ("controllers.bend.hold=step",), ("controllers.bend.gains.p",)),
    "incremental": ("s_shape", INCREMENTAL, ("controllers.bend.gains.p", "controllers.bend.leak")),
    "of stages": ("s_shape", ("numerics.integrator={type: tr_bdf2}",), ("controllers.bend.gains.p",)),
    "ideal": ("s_shape_ideal", (), ("controllers.bend.gains.p", "controllers.bend.gains.i")),
    "ideal stages": ("s_shape_ideal", ("numerics.integrator={type: generalized_alpha}",), ()),
}


@pytest.mark.parametrize("probe", ["tip", "pull"])
@pytest.mark.parametrize("name", LOOPS)
def test_loops_are_differentiated_exactly(call, name, probe):
    """Sampled ones are a map from state to state between steps, ideal ones a law of the state in them."""
    scene, changes, gains = LOOPS[name]
    words = [word for text in (*SHORT, *changes) for word in ("--set", text)]
    paths = ("materials.gel.youngs_modulus", "materials.gel.density", *gains)
    by = [word for path in paths for word in ("--by", path)]
    file = Path(__file__).parents[2] / "scenarios" / f"{scene}.yaml"
    result = found(call("gradient", file, "--of", probe, *by, *words, "--json", "-q"))
    assert result.method == "forward"
    assert all(one.derivative != 0.0 for one in result.gradient)
    assert result.check is not None
    assert result.check.gradient == pytest.approx(result.check.difference, rel=1e-7)


@pytest.mark.slow
def test_what_swings_for_long_is_checked_by_shorter_differences(call):
    """Differences of a thousandth leave 3e-6 of the derivative, as its phase turns, and see little of it."""
    scene = Path(__file__).parents[2] / "scenarios" / "helix_soft.yaml"
    by = ("--by", "materials.rubber.youngs_modulus")
    result = found(call("gradient", str(scene), "--of", "tip", *by, "--json", "-q"))
    assert result.check is not None
    assert result.check.gradient == pytest.approx(0.12098662311, rel=1e-8)
    assert result.check.difference == pytest.approx(result.check.gradient, rel=1e-8)


@pytest.mark.slow
def test_a_run_that_is_unstable_is_not_said_to_agree(call):
    """The loop swings: whatever differences of runs give is as large as what they leave open."""
    deck = framed()
    deck["actuation"] = [{"type": "twist", "rod": "arm", "value": {"controlled_by": "wind"}}]
    gains = {"p": 0.5, "i": "20 1/s"}
    deck["controllers"] = {"wind": {"type": "pi", "target": 20.0, "gains": gains, "period": "15 ms"}}
    deck["output"] = {"probes": {"tip": {"position": "arm.end", "component": "x"}}}
    by = ("--by", "controllers.wind.gains.p")
    result = found(call("gradient", write(deck), "--of", "tip", *by, "--json", "-q"), code=4)
    assert result.check is not None
    assert not result.check.agrees


def test_a_loop_around_a_framed_rod(call):
    """Sensors read frames, which turn as the run does."""
    deck = framed()
    deck["actuation"] = [{"type": "twist", "rod": "arm", "value": {"controlled_by": "wind"}}]
    gains = {"p": 0.05, "i": "1 1/s"}
    deck["controllers"] = {"wind": {"type": "pi", "target": 20.0, "gains": gains, "period": "15 ms"}}
    deck["output"] = {"probes": {"tip": {"position": "arm.end", "component": "x"}}}
    by = [word for path in (RUBBER_MODULUS, "controllers.wind.gains.p") for word in ("--by", path)]
    result = found(call("gradient", write(deck), "--of", "tip", *by, "--json", "-q"))
    assert result.method == "forward"
    assert result.check is not None
    assert result.check.gradient == pytest.approx(result.check.difference, rel=1e-6)


@pytest.mark.parametrize("method", ["auto", "forward", "adjoint"])
def test_loops_have_no_adjoint_and_times_of_samples_no_derivative(call, method):
    file = Path(__file__).parents[2] / "scenarios" / "s_shape.yaml"
    words = [word for text in SHORT for word in ("--set", text)]
    if method == "adjoint":
        done = call(
            *("gradient", file, "--of", "tip", "--by", "materials.gel.density", *words),
            *("--method", method, "--json", "-q"),
        )
        assert done.code == 2
        assert "without controllers" in done.stdout
        return
    done = call(
        *("gradient", file, "--of", "tip", "--by", "controllers.bend.period", *words),
        *("--method", method, "--json", "-q"),
    )
    if method == "forward":
        assert done.code == 2
        assert "changes the times" in done.stdout
        return
    result = found(done)
    assert result.method == "differences"
    assert "changes the times" in str(result.why)


def test_adaptive_steps_are_differentiated_by_runs_and_said_so(call):
    deck = planar() | {"output": {"probes": {"tip": {"position": "arm.end", "component": "z"}}}}
    deck["numerics"] = {"integrator": {"type": "tr_bdf2"}, "t_end": 0.05}
    by = ("--by", "materials.rubber.density")
    result = found(call("gradient", write(deck), "--of", "tip", *by, "--json", "-q"))
    assert result.method == "differences"
    assert "adaptive" in str(result.why)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--of", "tpi", "--by", MODULUS), "did you mean 'tip'"),
        (("--of", "tip", "--by", "materials.m.youngs_moduls"), "did you mean 'materials.m.youngs_modulus'"),
        (("--of", "tip", "--by", "geometry[0].generate.nodes"), "whole number"),
        (("--of", "tip", "--by", "numerics.integrator.load_steps"), "how the scene is computed"),
        (("--of", "tip", "--by", "geometry[0].material"), "needs a number"),
        (
            (
                "--of",
                "tip",
            ),
            "declares no parameters",
        ),
    ],
)
def test_what_has_no_derivative_is_refused(call, arguments, words):
    done = call("gradient", write(sagging()), *arguments, "--json", "-q")
    assert done.code == 2
    failure = GRADIENT.validate_python(json.loads(done.stdout))
    assert isinstance(failure, Failure)
    assert words in failure.errors[0].message


def test_a_value_that_changes_nothing_is_told(call):
    done = call("gradient", write(sagging()), "--of", "tip", "--by", "materials.m.poisson_ratio")
    assert done.code == 0
    assert "changes nothing in the model" in done.stderr


def test_the_schema_of_the_result(call):
    schemas = json.loads(call("schema", "--results").stdout)
    assert schemas["gradient"] == TypeAdapter(Gradient | Failure).json_schema()


@pytest.mark.parametrize("interpolation", ["linear", "step"])
@pytest.mark.parametrize("probe", [{"energy": "elastic"}, {"position": "arm.end", "component": "z"}])
def test_every_value_of_a_table_has_its_own_derivative(call, probe, interpolation):
    """Many of them are varied at once; frames are read at times between their rows and at rows."""
    deck = planar()
    rows = [[0.0, 1.0], [0.004, 4.0], [0.01, -3.0], [0.015, 5.0], [0.02, 2.0], [0.03, -1.0], [0.5, 2.0]]
    deck["actuation"][0]["value"] = {"table": rows, "interpolation": interpolation}
    deck["materials"]["rubber"] = dict(deck["materials"]["rubber"], relaxation_time=5e-3)
    deck["output"] = {"probes": {"e": probe}}
    path = "actuation[0].value.table[*][1]"
    result = found(call("gradient", write(deck), "--of", "e", "--by", path, "--json", "-q"))
    assert len(result.gradient) == len(rows)
    assert result.check is not None
    assert result.check.agrees
    one, other = (
        [
            slope.derivative
            for slope in found(
                call("gradient", write(deck), "--of", "e", "--by", path, *how, "--no-check", "--json", "-q")
            ).gradient
        ]
        for how in ((), ("--method", "differences"))
    )
    size = max(map(abs, other))
    assert one == pytest.approx(other, rel=1e-6, abs=1e-8 * size)


@pytest.mark.parametrize("method", ["forward", "adjoint"])
def test_a_distance_that_is_next_to_nothing_is_differentiated(call, method):
    """Nodes end within micrometres of a shape: steps in which it is read are far shorter than that."""
    deck = sagging()
    deck["forces"][0]["acceleration"] = [0, 0, -9.81]
    there = simulate(load_mapping(deck)).positions
    there[:, 2] *= 1.0001
    np.savetxt("there.csv", there, delimiter=",", header="x,y,z", comments="")
    deck["output"] = {"probes": {"off": {"shape": "rod", "target": {"file": "there.csv"}}}}
    near = write(deck)
    slopes = []
    for factor in (1.0 - 1e-8, 1.0 + 1e-8):
        run = simulate(near, overrides=[f"{MODULUS}={factor * deck['materials']['m']['youngs_modulus']!r}"])
        slopes.append(run.probes["off"][-1])
    by = ("--by", MODULUS, "--method", method, "--no-check")
    result = found(call("gradient", near, "--of", "off", *by, "--json", "-q"))
    value = deck["materials"]["m"]["youngs_modulus"]
    assert result.gradient[0].derivative * value == pytest.approx((slopes[1] - slopes[0]) / 2e-8, rel=1e-3)
