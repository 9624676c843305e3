"""Shells whose thickness changes from triangle to triangle: faced at the distance of each, without jumps."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli import Limits, simulate
from dismech_cli.arrays import FloatArray
from dismech_cli.contact.pieces.surface import Junctions
from dismech_cli.kernels.driver import Driver
from dismech_cli.kernels.numba_driver import NumbaDriver
from dismech_cli.kernels.numpy_driver import NumpyDriver
from dismech_cli.model.configuration import Configuration

THICK, THIN, LONG = 2e-3, 1e-3, 0.2
HEIGHT, RADIUS = 1.6e-3, 1e-3


def deck(thickness: Any, divisions: int = 16) -> dict[str, Any]:
    """A rod that lies along a sheet."""
    plan = {"shape": "sheet", "origin": [0, 0, 0], "length": LONG, "width": 0.05, "divisions": divisions}
    sheet = {"type": "shell", "name": "sheet", "material": "m", "thickness": thickness, "bending": "hinge"}
    rod = {"shape": "line", "from": [0.02, 0.023, HEIGHT], "to": [0.12, 0.027, HEIGHT], "nodes": 8}
    return {
        "schema_version": 1,
        "name": "uneven",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000.0}},
        "geometry": [
            sheet | {"generate": plan | {"pattern": "alternating"}},
            {"type": "rod", "name": "rod", "material": "m", "radius": RADIUS, "generate": rod},
        ],
        "contact": {"pairs": [{"between": ["sheet", "rod"]}]},
        "numerics": {"dt": 1e-3, "t_end": 1e-3},
    }


WEDGE = {"of": "x", "table": [[0, THICK], [LONG, THIN]]}
BUMPS = {"expression": "1.5e-3 + 0.5e-3*sin(400*x)"}


class Sliding:
    """The energy of contact, and its forces, with the rod moved along the sheet."""

    def __init__(self, scene: dict[str, Any], driver: type[Driver] = NumpyDriver) -> None:
        self.model = simulate(scene, limits=Limits(until=0.0)).composition.simulation.model
        contact = self.model.changing[0]
        self.contact = contact
        self.contacts = contact.start(driver())
        self.normal = self.contacts.terms[0]
        along = np.zeros_like(self.model.rest)
        self.rod = np.arange(self.model.dofs.n_nodes - 8, self.model.dofs.n_nodes)
        along[self.model.dofs.of_nodes(self.rod)[:, 0]] = 1.0
        self.along = along

    def _at(self, way: float) -> Configuration:
        q = self.model.rest + way * self.along
        c = Configuration(0.0, q, np.zeros_like(q), self.model.frames.transport(self.model.frames.rest(q), q))
        self.contacts.detect(c)
        return c

    def energy(self, way: float) -> float:
        potential = self.normal.potential
        assert potential is not None
        return float(potential.energy(self._at(way)).sum())

    def force(self, way: float) -> float:
        residual = np.zeros_like(self.model.rest)
        self.normal.add_residual(self._at(way), residual)
        return float(residual @ self.along)


@pytest.mark.parametrize("driver", [NumpyDriver, NumbaDriver])
@pytest.mark.parametrize("thickness", [WEDGE, BUMPS])
def test_forces_are_those_of_the_energy_wherever_the_rod_is(
    driver: type[NumpyDriver | NumbaDriver], thickness: Any
) -> None:
    """Simpson's rule over the force is what the energy changes by: it nowhere jumps."""
    sliding = Sliding(deck(thickness), driver)
    ways = np.linspace(0.0, 0.03, 121)
    energies = np.array([sliding.energy(way) for way in ways])
    works = np.array(
        [
            (b - a) / 6.0 * (sliding.force(a) + 4.0 * sliding.force(0.5 * (a + b)) + sliding.force(b))
            for a, b in pairwise(ways.tolist())
        ]
    )
    scale = np.abs(energies).max()
    assert scale > 0.0
    # forces are continuous, with kinks: the rule is of second order at those
    assert_allclose(np.diff(energies), works, atol=1e-4 * scale)


def test_a_wedge_presses_as_its_thickness_at_each_place_asks_for() -> None:
    length, s = np.hypot(0.1, 0.004), (np.arange(2000) + 0.5) / 2000

    def expected(way: float) -> float:
        reach = RADIUS + 0.5 * (THICK + (THIN - THICK) * (0.02 + way + 0.1 * s) / LONG)
        return float(length * (np.maximum(reach**2 - HEIGHT**2, 0.0) ** 2 / (4.0 * reach**2)).mean())

    sliding = Sliding(deck(WEDGE, 32))
    for way in (0.0, 0.011, 0.027):
        # where the rod is 0.3 mm deep, the rim of what is thicker reaches sqrt(H^2 - d^2) = 1 mm downhill:
        # there the half thickness is up to 2.5 um more, and the energy 2 * 2.5 / 300 = 1.7 %
        assert_allclose(sliding.energy(way) / sliding.contact.faces.stiffness[1, 0], expected(way), rtol=0.02)


def test_layers_are_what_junctions_count() -> None:
    """A ring of triangles about a corner, thick and thin by turns: each layer is a surface of its own."""
    count = 6
    ring = np.array([[0, 1 + k, 1 + (k + 1) % count] for k in range(count)])
    levels = np.array([0, 2, 0, 2, 1, 2])
    junctions = Junctions.of(
        np.zeros(count, dtype=np.int64), np.zeros((count, 2), dtype=np.int64), ring, levels
    )
    sides, corners = junctions.coefficients(np.arange(count))

    def times(values: FloatArray, nodes: Any, at: tuple[int, ...], of: Any) -> dict[int, float]:
        """Coefficient by level."""
        found: dict[int, float] = {}
        for k in range(count):
            for item in of[k]:
                if item >= 0 and tuple(nodes[item, 2:]) == at:
                    found[int(levels[k])] = float(values[item])
        return found

    # all about the middle: whole at the least; at the next (levels 1, 2) triangles 3, 4, 5 are one fan, 1 is
    # another; at the last 1, 3, 5 stand alone
    assert times(corners, junctions.corners, (0,), junctions.corners_of) == {0: 2.0, 1: 1.0, 2: -2.0}
    # triangles 0 and 1 share the side from the middle to 2: off once, at the lesser level
    assert times(sides, junctions.sides, (0, 2), junctions.sides_of) == {0: -1.0, 2: 0.0}
    some = np.array([1, 3, 4, 5])
    _, corners = junctions.coefficients(some)
    assert times(corners, junctions.corners, (0,), junctions.corners_of) == {0: 0.0, 1: 1.0, 2: -2.0}


def tapered(radius: Any) -> dict[str, Any]:
    """A rod that lies along another, whose radius varies."""
    other = {"shape": "line", "from": [0, 0, 0], "to": [LONG, 0, 0], "nodes": 17}
    rod = {"shape": "line", "from": [0.02, 2e-4, 2.6e-3], "to": [0.12, -3e-4, 2.6e-3], "nodes": 8}
    return {
        "schema_version": 1,
        "name": "tapered",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000.0}},
        "geometry": [
            {"type": "rod", "name": "arm", "material": "m", "radius": radius, "generate": other},
            {"type": "rod", "name": "rod", "material": "m", "radius": RADIUS, "generate": rod},
        ],
        "contact": {"pairs": [{"between": ["arm", "rod"]}]},
        "numerics": {"dt": 1e-3, "t_end": 1e-3},
    }


@pytest.mark.parametrize("driver", [NumpyDriver, NumbaDriver])
@pytest.mark.parametrize(
    "radius",
    [
        {"of": "x", "table": [[0, 2.2e-3], [LONG, 1.4e-3]]},
        {"expression": "1.9e-3 + 0.4e-3*sin(150*x)"},
    ],
)
def test_rods_whose_radius_varies(driver: type[NumpyDriver | NumbaDriver], radius: Any) -> None:
    """Thin parts feel the end of thick ones beside them; the energy nowhere jumps."""
    sliding = Sliding(tapered(radius), driver)
    ways = np.linspace(0.0, 0.03, 121)
    energies = np.array([sliding.energy(way) for way in ways])
    works = np.array(
        [
            (b - a) / 6.0 * (sliding.force(a) + 4.0 * sliding.force(0.5 * (a + b)) + sliding.force(b))
            for a, b in pairwise(ways.tolist())
        ]
    )
    scale = np.abs(energies).max()
    assert scale > 0.0
    assert_allclose(np.diff(energies), works, atol=1e-4 * scale)
