"""Bodies that vary along their length, against bars and beams of varying section."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, line, rod_deck, solve, tip
from derivatives import dense
from numpy.testing import assert_allclose
from order import observed_order
from scipy.linalg import eigh

from dismech_cli import load
from dismech_cli.compose.compose import Composition, compose
from dismech_cli.kinematics.motion import held_dofs
from dismech_cli.model.state import State
from dismech_cli.solve.integrators import Static
from dismech_cli.solve.system import System

ROOT, TIP = 2e-3, 0.5e-3
LENGTH, MODULUS, DENSITY = 0.1, 1e6, 1000.0
TAPER: dict[str, Any] = {"of": "s", "table": [[0.0, ROOT], [1.0, TIP]]}
ONE_STEP: Deck = {"integrator": {"type": "static", "load_steps": 1}}
MESHES = np.array([20, 40, 80])


def arm(edges: int, section: Deck, **keys: Any) -> Deck:
    return rod_deck(line(edges + 1, (LENGTH, 0.0, 0.0)), section, **{"numerics": ONE_STEP} | keys)


def composed(folder: Path, deck: Deck) -> Composition:
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    return compose(load(file))


def lift(folder: Path, edges: int, section: Deck, **keys: Any) -> float:
    """Of the tip under a small force across the rod [m]."""
    force = {"type": "point", "where": "rod.end", "force": [0.0, 0.0, 1e-8]}
    return float(tip(solve(folder, arm(edges, section, forces=[force], **keys)))[2])


ROUND: Deck = {"type": "round", "radius": TAPER}
CONE = 1e-8 * LENGTH**3 / (3.0 * MODULUS * np.pi * ROOT**4 / 4.0) * ROOT / TIP


@pytest.mark.parametrize("keys", [{}, {"dimension": 3}, {"dimension": 3, "rod": {"bending": "framed"}}])
def test_bent_cone(tmp_path: Path, keys: Deck) -> None:
    """F l^3 / (3 E I) of the root times the ratio of the radii, to second order in the edge."""
    errors = np.array([lift(tmp_path, int(n), ROUND, **keys) / CONE - 1.0 for n in MESHES])
    assert observed_order(1.0 / MESHES, np.abs(errors)) > 1.95
    assert abs(errors[-1]) < 2e-3


@pytest.mark.parametrize(
    "radius",
    [
        {"expression": f"{ROOT} + {TIP - ROOT}*s"},
        {"expression": f"{ROOT} + {TIP - ROOT}*arc/{LENGTH}"},
        {"expression": f"{ROOT} + {TIP - ROOT}*x/{LENGTH}"},
        {"of": "arc", "table": [[0.0, "2 mm"], ["100 mm", "0.5 mm"]]},
        {"of": "x", "table": [[0.0, "2 mm"], ["100 mm", "0.5 mm"]], "interpolation": "cubic"},
    ],
)
def test_laws_of_one_cone(tmp_path: Path, radius: Deck) -> None:
    one = composed(tmp_path, arm(20, ROUND)).geometry.properties[0]
    other = composed(tmp_path, arm(20, {"type": "round", "radius": radius})).geometry.properties[0]
    for name in ("axial", "bending_1", "torsional", "mass_per_length", "radius"):
        assert_allclose(getattr(other, name), getattr(one, name), rtol=1e-13)


def test_a_cone_weighs_what_it_should(tmp_path: Path) -> None:
    made = composed(tmp_path, arm(7, ROUND, numerics={"dt": 0.01, "t_end": 0.01}))
    volume = np.pi * LENGTH / 3.0 * (ROOT**2 + ROOT * TIP + TIP**2)
    mass = made.simulation.model.mass[made.simulation.model.dofs.of_nodes(np.arange(8))[:, 0]]
    assert_allclose(mass.sum(), DENSITY * volume, rtol=1e-14)


def test_pulled_cone(tmp_path: Path) -> None:
    """Parts of an edge stretch in series: no error but that of the quadrature."""
    pull = {"type": "point", "where": "rod.end", "force": [1e-6, 0.0, 0.0]}
    stretched = tip(solve(tmp_path, arm(20, ROUND, forces=[pull])))[0] - LENGTH
    assert_allclose(stretched, 1e-6 * LENGTH / (MODULUS * np.pi * ROOT * TIP), rtol=1e-5)


def test_twisted_cone(tmp_path: Path) -> None:
    """Of a moment T about its axis: T l / (3 G pi/2) (1/r1^3 - 1/r0^3) / (r0 - r1)."""
    angles = []
    for edges in MESHES:
        deck = arm(
            int(edges),
            ROUND,
            dimension=3,
            forces=[{"type": "moment", "where": "rod.end", "moment": [1e-9, 0.0, 0.0]}],
        )
        result = solve(tmp_path, deck)
        dofs = result.composition.simulation.model.dofs
        angles.append(result.frames[-1].state["q"][dofs.n_positions + edges - 1])
    # the last angle is that of the middle of its edge
    last = TIP + 0.5 * (ROOT - TIP) / MESHES
    exact = 1e-9 * LENGTH * (1.0 / last**3 - 1.0 / ROOT**3) / (ROOT - TIP) / (0.5 * np.pi * MODULUS)
    errors = np.abs(np.array(angles) / exact - 1.0)
    assert observed_order(1.0 / MESHES, errors) > 1.9
    assert errors[-1] < 3e-3


@pytest.mark.parametrize("by", ["table", "group of edges"])
def test_stepped_beam(tmp_path: Path, by: str) -> None:
    """A half of 2 mm and one of 1 mm: the joint on the step bends each half edge as its own."""
    if by == "table":
        radius: Any = {"of": "s", "table": [[0.0, 2e-3], [0.5, 1e-3]], "interpolation": "step"}
        body: Deck = {}
    else:
        radius, body = {"value": 2e-3, "groups": {"thin": 1e-3}}, {}
    thick, thin = (MODULUS * np.pi * r**4 / 4.0 for r in (2e-3, 1e-3))
    half = 0.5 * LENGTH
    exact = 1e-8 * (half**3 / (3.0 * thin) + 7.0 * half**3 / (3.0 * thick))
    errors = []
    for edges in MESHES:
        deck_line = line(int(edges) + 1, (LENGTH, 0.0, 0.0))
        deck = rod_deck(deck_line, {"type": "round", "radius": radius}, numerics=ONE_STEP, rod=body)
        if by != "table":
            mesh = tmp_path / "line.obj"
            points = "\n".join(f"v {LENGTH * k / edges} 0 0" for k in range(edges + 1))
            parts = (range(1, edges // 2 + 1), range(edges // 2 + 1, edges + 1))
            lines = [[f"l {k} {k + 1}" for k in part] for part in parts]
            mesh.write_text("\n".join([points, "g thick", *lines[0], "g thin", *lines[1]]), encoding="utf-8")
            rod = deck["geometry"][0]
            del rod["generate"]
            rod["mesh"] = {"file": "line.obj"}
        deck["forces"] = [{"type": "point", "where": "rod.end", "force": [0.0, 0.0, 1e-8]}]
        errors.append(abs(tip(solve(tmp_path, deck))[2] / exact - 1.0))
    assert observed_order(1.0 / MESHES, np.array(errors)) > 1.95
    assert errors[-1] < 1e-3


def first_frequency(made: Composition) -> float:
    """Of small motions about rest [rad/s]."""
    model = made.simulation.model
    nothing = np.zeros(model.dofs.n)
    state = State(0.0, model.rest, nothing, nothing, model.frames.rest(model.rest))
    system = System(model, ~held_dofs(model.motions, model.dofs.n, 0.0))
    found = system.linearize(Static().stage(0, state, state, 0.0), model.rest, state.frames)
    mass = np.diag(model.mass[system.pattern.free])
    return float(np.sqrt(eigh(dense(system.pattern, found.values), mass, eigvals_only=True)[0]))


def ritz(taper: float, area: int, inertia: int) -> float:
    """First frequency of a beam clamped at x = 0 by polynomials, times l^2 sqrt(rho A / (E I)) at the root.

    Its size falls as 1 - taper x along it, area and second moment with some powers of it.
    """
    x, w = np.polynomial.legendre.leggauss(40)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    size, powers = 1.0 - taper * x, np.arange(2, 16)[:, None]
    # orthogonal about the middle would be better conditioned; twice the digits of the tolerance are left
    shape, curved = x**powers, powers * (powers - 1) * x ** (powers - 2)
    stiffness = (curved * w * size**inertia) @ curved.T
    mass = (shape * w * size**area) @ shape.T
    low, high = np.linalg.eigh(mass)
    kept = low > 1e-13 * low[-1]
    base = high[:, kept] / np.sqrt(low[kept])
    return float(np.sqrt(np.linalg.eigvalsh(base.T @ stiffness @ base)[0]))


def test_reference_of_frequencies() -> None:
    """A prism, a wedge and a cone to a point (Kirchhoff 1879)."""
    known = [3.51602, 5.31510, 8.71926]
    assert_allclose([ritz(0.0, 2, 4), ritz(1.0, 1, 3), ritz(1.0, 2, 4)], known, rtol=2e-5)


@pytest.mark.parametrize("shape", ["cone", "wedge"])
def test_frequency(tmp_path: Path, shape: str) -> None:
    taper = 0.8
    size: dict[str, Any] = {"of": "s", "table": [[0.0, ROOT], [1.0, (1.0 - taper) * ROOT]]}
    if shape == "cone":
        section: Deck = {"type": "round", "radius": size}
        exact, inertia_over_area = ritz(taper, 2, 4), ROOT**2 / 4.0
    else:
        # the director of a planar rod lies in the plane
        section = {"type": "rectangular", "thickness": size, "width": 5e-3}
        exact, inertia_over_area = ritz(taper, 1, 3), ROOT**2 / 12.0
    scale = LENGTH**2 / np.sqrt(MODULUS * inertia_over_area / DENSITY)
    timed = {"dt": 0.01, "t_end": 0.01}
    bodies = [arm(int(n), section, numerics=timed, rod={"director": [0.0, 0.0, 1.0]}) for n in MESHES]
    errors = np.array([first_frequency(composed(tmp_path, body)) * scale / exact - 1.0 for body in bodies])
    assert observed_order(1.0 / MESHES, np.abs(errors)) > 1.9
    assert abs(errors[-1]) < 2e-3


def test_modulus_and_density_vary_too(tmp_path: Path) -> None:
    """E as the fourth power of the radius bends as the cone does."""
    section = {"type": "round", "radius": ROOT}
    law = {"expression": f"{MODULUS}*(1 + ({TIP / ROOT} - 1)*s)**4"}
    light = {"of": "x", "table": [[0.0, 1500.0], [LENGTH, "500 kg/m^3"]]}
    materials = {"m": {"youngs_modulus": law, "poisson_ratio": 0.5, "density": light}}
    assert_allclose(lift(tmp_path, 80, section, materials=materials) / CONE, 1.0, atol=2e-3)
    made = composed(tmp_path, arm(9, section, materials=materials))
    (extent,) = (made.geometry.per_edge("mass_per_length") * made.geometry.lengths).reshape(1, -1)
    assert_allclose(extent.sum(), 1000.0 * np.pi * ROOT**2 * LENGTH, rtol=1e-13)


def test_thickness_of_a_strip(tmp_path: Path) -> None:
    """A tapered strip sags by as much more than a uniform one as a beam does."""

    def sag(thickness: Any, divisions: int) -> float:
        deck: Deck = {
            "schema_version": 1,
            "name": "strip",
            "materials": {"m": {"youngs_modulus": 1e9, "poisson_ratio": 0.0, "density": 1000.0}},
            "geometry": [
                {
                    "type": "shell",
                    "name": "strip",
                    "material": "m",
                    "thickness": thickness,
                    "generate": {
                        "shape": "sheet",
                        "origin": [0, 0, 0],
                        "length": 1.0,
                        "width": 0.1,
                        "divisions": divisions,
                        "pattern": "equilateral",
                    },
                }
            ],
            "motions": [{"type": "clamp", "where": "strip.left"}],
            "forces": [{"type": "line", "where": "strip.right", "force_per_length": [0.0, 0.0, 0.01]}],
            "numerics": ONE_STEP,
            "output": {"probes": {"z": {"displacement": "strip.right", "component": "z"}}},
        }
        return float(solve(tmp_path, deck).frames[-1].scalars["z"])

    tapered = {"expression": "0.01*(1 - 0.5*x)"}
    meshes = np.array([10, 20, 40])
    ratios = np.array([sag(tapered, int(n)) / sag(0.01, int(n)) for n in meshes])
    errors = np.abs(ratios / (3.0 * (8.0 * np.log(2.0) - 5.0)) - 1.0)
    assert errors[-1] < 2e-3
    assert errors[-1] < 0.5 * errors[0]
