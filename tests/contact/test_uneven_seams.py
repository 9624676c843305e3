"""Seams and steps of thickness: what lies across them has forces that are those of its energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli import Limits, simulate
from dismech_cli.arrays import FloatArray
from dismech_cli.kernels.numba_driver import NumbaDriver
from dismech_cli.kernels.numpy_driver import NumpyDriver
from dismech_cli.model.configuration import Configuration


def deck(thickness: float) -> dict[str, Any]:
    def sheet(name: str, x: float, thick: float) -> dict[str, Any]:
        plan = {"shape": "sheet", "origin": [x, 0.0, 0.0], "length": 0.1, "width": 0.1, "divisions": 2}
        body = {"type": "shell", "name": name, "material": "m", "thickness": thick, "bending": "hinge"}
        return body | {"generate": plan | {"pattern": "alternating"}}

    rod = {"shape": "line", "from": [0.031, 0.047, 1.66e-3], "to": [0.171, 0.053, 1.62e-3], "nodes": 5}
    return {
        "schema_version": 1,
        "name": "seam",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000.0}},
        "geometry": [
            sheet("one", 0.0, 2e-3),
            sheet("other", 0.1, thickness),
            {"type": "rod", "name": "rod", "material": "m", "radius": 1e-3, "generate": rod},
        ],
        "joints": [{"type": "seam", "shells": ["one", "other"], "bending": "weld"}],
        "contact": {"pairs": [{"between": ["one", "rod"]}, {"between": ["other", "rod"]}]},
        "numerics": {"dt": 1e-3, "t_end": 1e-3},
    }


def stepped() -> dict[str, Any]:
    """The same as one shell with a step."""
    scene = deck(2e-3)
    one, _, rod = scene["geometry"]
    one["thickness"] = {"of": "x", "table": [[0, 2e-3], [0.1, 2e-3], [0.10001, 1.5e-3], [0.2, 1.5e-3]]}
    one["generate"] |= {"length": 0.2, "divisions": 4}
    scene["geometry"], scene["joints"] = [one, rod], []
    scene["contact"] = {"pairs": [{"between": ["one", "rod"]}]}
    return scene


@pytest.mark.parametrize("driver", [NumpyDriver, NumbaDriver])
@pytest.mark.parametrize("scene", [deck(2e-3), deck(1.5e-3), stepped()], ids=["even", "seam", "step"])
def test_forces_are_those_of_the_energy(
    driver: type[NumpyDriver | NumbaDriver], scene: dict[str, Any]
) -> None:
    model = simulate(scene, limits=Limits(until=0.0)).composition.simulation.model
    contacts = model.changing[0].start(driver())
    normal = contacts.terms[0]
    potential = normal.potential
    assert potential is not None

    def at(q: FloatArray) -> Configuration:
        c = Configuration(0.0, q, np.zeros_like(q), model.frames.transport(model.frames.rest(q), q))
        contacts.detect(c)
        return c

    def energy(q: FloatArray) -> float:
        return float(potential.energy(at(q)).sum())

    q = model.rest
    residual = np.zeros_like(q)
    normal.add_residual(at(q), residual)
    assert energy(q) > 0.0
    # the rod as a whole along the sheets, so that places on the seam move along it
    positions = model.dofs.positions(np.zeros_like(q)).copy()
    along = np.zeros_like(q)
    count = len(positions)
    for node in range(count - 5, count):
        along[model.dofs.of_nodes(np.array([node]))[0, 0]] = 1.0
    h = 1e-6
    slope = (energy(q + h * along) - energy(q - h * along)) / (2.0 * h)
    scale = np.abs(residual).max()
    assert scale > 0.0
    assert_allclose(residual @ along, slope, atol=1e-7 * scale)
