"""``dismech gradient`` from the command line: numbers against theory, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from cli_call import call
from decks import Deck, line, rod_deck
from pydantic import TypeAdapter
from slope_cases import planar

from dismech_cli.cli.result_schema import GRADIENT, Failure, Gradient

__all__ = ["call"]

MODULUS = "materials.m.youngs_modulus"
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


def test_contact_is_differentiated_by_runs_and_said_so(call):
    deck = sagging(numerics={"integrator": {"type": "static", "load_steps": 1}})
    deck["forces"][0]["acceleration"] = [0, 0, -9.81]
    deck["materials"]["m"]["youngs_modulus"] = 1e8
    deck["obstacles"] = [{"type": "plane", "name": "floor", "point": [0, 0, -0.01], "normal": [0, 0, 1]}]
    deck["contact"] = {"pairs": [{"between": ["rod", "floor"]}]}
    result = found(call("gradient", write(deck), "--of", "tip", "--by", MODULUS, "--json", "-q"))
    assert result.method == "differences"
    assert result.why is not None
    assert "contact" in result.why
    refused = call("gradient", write(deck), "--of", "tip", "--by", MODULUS, "--method", "forward", "-q")
    assert refused.code == 2


def test_controllers_are_differentiated_by_runs_and_said_so(call):
    scene = Path(__file__).parents[2] / "scenarios" / "s_shape.yaml"
    sets = ("numerics.t_end=0.05 s", "expect={}", "output={probes: {tip: {position: arm.end, component: z}}}")
    words = [word for text in sets for word in ("--set", text)]
    by = ("--by", "materials.gel.density")
    done = call("gradient", scene, "--of", "tip", *by, *words, "--json", "-q")
    result = found(done)
    assert result.method == "differences"
    assert "controllers" in str(result.why)


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
