"""Shells from YAML text: the same models as put together by hand, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from shell_cases import shell
from shell_decks import (
    BELL,
    DOWN,
    EULER,
    MIXED,
    RUBBER,
    SHEET,
    STATIC,
    Deck,
    made,
    ran,
    rod,
    shell_deck,
    write,
)

from dismech_cli import load
from dismech_cli.arrays import FloatArray
from dismech_cli.compose.compose import Composition, compose
from dismech_cli.energies.hinge import hinge_angles
from dismech_cli.forces.aerodynamic import aerodynamic_drag
from dismech_cli.forces.hydrodynamic import area_damping, hydrodynamic_drag
from dismech_cli.forces.pressure import pressure
from dismech_cli.forces.thrust import thrust
from dismech_cli.kernels.linearization import all_symmetric
from dismech_cli.laws.laws import Constant
from dismech_cli.laws.signal import NO_INPUTS
from dismech_cli.mesh.generate.rings import hemisphere
from dismech_cli.mesh.generate.sheets import Pattern, sheet
from dismech_cli.mesh.measure import nodal_areas, triangle_areas
from dismech_cli.mesh.topology.shells import shell_edges
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.driven import DrivenEnergy
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy
from dismech_cli.model.term import Term
from dismech_cli.run.loop import End, Limits, run
from dismech_cli.sections.shells import hinge_springs, midedge_springs
from dismech_cli.session.sinks import Memory
from dismech_cli.solve.pattern import SparsityPattern

__all__ = ["made", "ran", "write"]

MEMBRANES = ("cst", "springs")
BENDINGS = ("midedge", "hinge", "averaged")


def residual(model: Model, terms: tuple[Term, ...], q: FloatArray, v: FloatArray) -> FloatArray:
    """Sum of the residuals of terms with the frames of the rest shape."""
    everything = np.ones(model.dofs.n, dtype=np.bool_)
    couplings = [c for t in terms for c in t.couplings]
    pattern = SparsityPattern.build(model.dofs, everything, couplings, symmetric=all_symmetric(couplings))
    c = Configuration(0.01, q, v, model.frames.transport(model.frames.rest(model.rest), q))
    r = np.zeros(model.dofs.n)
    for term in terms:
        term.bind(pattern, model.driver).add_residual(c, r)
    return r


def shaken(model: Model, size: float) -> FloatArray:
    """The rest shape with every DOF moved a little, always the same way."""
    return model.rest + size * np.random.default_rng(1).uniform(-1.0, 1.0, model.dofs.n)


def term(model: Model, name: str) -> Any:
    (found,) = (t for t in model.terms if t.name == name)
    return found


@pytest.mark.parametrize("membrane", MEMBRANES)
@pytest.mark.parametrize("bending", BENDINGS)
def test_same_forces_and_masses_as_by_hand(made: Any, membrane: str, bending: str) -> None:
    """To the last bit: the same functions get the same numbers."""
    built = made(shell_deck(body={"membrane": membrane, "bending": bending}))
    hand = shell(sheet(0.3, 0.2, 6, Pattern.ALTERNATING), bending, membrane, RUBBER).model
    model = built.simulation.model
    q = shaken(hand, 1e-3)
    at_rest = np.zeros_like(q)
    assert np.abs(residual(hand, hand.terms, q, at_rest)).max() > 1e-3
    assert_array_equal(residual(model, model.terms, q, at_rest), residual(hand, hand.terms, q, at_rest))
    assert_array_equal(model.mass, hand.mass)


@pytest.mark.parametrize("membrane", [*MEMBRANES, "family"])
@pytest.mark.parametrize("bending", BENDINGS)
def test_three_steps_conserve_energy(ran: Any, membrane: str, bending: str) -> None:
    """A clamped sheet falls; the midpoint rule at a small step keeps its energy to second order."""
    deck = shell_deck(
        body={"membrane": membrane, "bending": bending},
        motions=[{"type": "clamp", "where": "sheet.left"}],
        forces=[DOWN],
        numerics={"integrator": {"type": "implicit_midpoint"}, "dt": 1e-3, "t_end": 3e-3},
        output={"every": 1e-3},
    )
    frames = ran(deck).frames
    assert len(frames) == 4
    assert frames[-1].positions[:, 2].min() < -1e-5
    last = frames[-1].scalars
    assert last["kinetic"] > 0.0
    fallen = frames[0].scalars["gravitational"] - last["gravitational"]
    assert_allclose(last["error"], 0.0, atol=1e-3 * fallen)


@pytest.mark.parametrize(("bending", "stiffness"), [("hinge", hinge_springs), ("midedge", midedge_springs)])
def test_family_springs_follow_the_bending(made: Any, bending: str, stiffness: Any) -> None:
    model = made(shell_deck(body={"membrane": "family", "bending": bending})).simulation.model
    springs = term(model, "sheet.membrane")
    extra = (1e6,) if bending == "hinge" else (1e6, 0.3)
    assert_array_equal(springs.parameter("EA"), stiffness(*extra, 2e-3, springs.parameter("length")))


@pytest.mark.parametrize("bending", BENDINGS)
def test_natural_shape(made: Any, bending: str) -> None:
    """A bell at rest is free of stress, one that wants to be flat is not; a flat sheet does not care."""
    energies = {}
    for shape in ("rest", "flat"):
        body = {"bending": bending, "natural": {"shape": shape}}
        model = made(shell_deck(BELL, body=body)).simulation.model
        energies[shape] = np.abs(residual(model, model.terms, model.rest, np.zeros(model.dofs.n))).max()
    assert energies["rest"] < 1e-9 * energies["flat"]


def test_clamps_hold_the_slope_of_a_rim(ran: Any) -> None:
    """A disc under pressure: w = q a^4 / (64 D) clamped, (5 + nu) / (1 + nu) times that pinned.

    Second order: 5 % of error with 8 rings, and the deflection is far below the thickness.
    """
    disc = {"shape": "disc", "center": [0, 0, 0], "radius": 0.1, "rings": 8}
    deflections = {}
    for motion in ("clamp", "pin"):
        deck = shell_deck(
            disc,
            motions=[{"type": motion, "where": "sheet.rim"}],
            forces=[{"type": "pressure", "shell": "sheet", "pressure": 0.01}],
            numerics=STATIC,
        )
        deflections[motion] = ran(deck).frames[-1].positions[0, 2]
    clamped = 0.01 * 0.1**4 / (64.0 * RUBBER.rigidity)
    assert_allclose(deflections["clamp"], clamped, rtol=0.06)
    assert_allclose(deflections["pin"], clamped * 5.3 / 1.3, rtol=0.06)


def test_loads_are_those_built_by_hand(made: Any) -> None:
    forces: list[Deck] = [
        {"type": "aerodynamic", "fluid_density": 1.2, "coefficient": 10.0},
        {"type": "hydrodynamic", "shells": ["sheet"], "fluid_density": 1000.0, "coefficient": 0.5},
        {"type": "area_damping", "coefficient": 7.0},
        {"type": "pressure", "shell": "sheet", "pressure": 30.0},
        {"type": "thrust", "shell": "sheet", "coefficient": 40.0, "direction": [0.0, 0.0, 2.0]},
    ]
    model = made(shell_deck(BELL, body={"bending": "hinge"}, forces=forces)).simulation.model
    mesh = hemisphere(0.1, 4)
    dofs, triangles = model.dofs, mesh.triangles
    areas = triangle_areas(mesh.nodes, triangles)
    shares = nodal_areas(dofs.n_nodes, triangles, areas)
    hand = (
        aerodynamic_drag("a", dofs, triangles, areas, fluid_density=1.2, coefficient=10.0),
        hydrodynamic_drag("h", dofs, shares, fluid_density=1000.0, coefficient=0.5),
        area_damping("d", dofs, shares, 7.0),
        pressure("p", dofs, triangles, Constant(30.0)),
        thrust(
            "t", dofs, mesh.nodes, triangles, coefficient=40.0, direction=np.array([0, 0, 1.0]), shares=shares
        ),
    )
    q, v = shaken(model, 1e-3), -10.0 * model.rest
    for index, wanted in enumerate(hand):
        name = f"{forces[index]['type']}[{index}]"
        expected = residual(model, (wanted,), q, v)
        assert np.abs(expected).max() > 1e-4
        got = residual(model, (term(model, name),), q, v)
        assert_allclose(got, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


def test_weight_of_sheet_rod_and_payload(ran: Any) -> None:
    """A rod hangs from the middle of a sheet, a payload from the rod: the rim carries it all."""
    deck = shell_deck(
        SHEET | {"pattern": "right"},
        joints=[{"type": "hinge", "nodes": [{"nodes": {"of": "sheet", "indices": [17]}}, "rod.start"]}],
        motions=[{"type": "pin", "where": "sheet.boundary"}],
        masses=[{"where": "rod.end", "mass": 0.01}],
        forces=[DOWN],
        numerics={"integrator": {"type": "static", "load_steps": 10}},
        output={"probes": {"support": {"reaction": "sheet.boundary", "component": "z"}}},
    )
    middle = [0.15, 0.1, 0.0]
    deck["geometry"] = [*deck["geometry"], rod(middle, [0.15, 0.1, -0.1])]
    result = ran(deck)
    weight = 9.81 * (1000.0 * (0.3 * 0.2 * 2e-3 + 0.1 * np.pi * 4e-6) + 0.01)
    # Newton stops at 1e-8 of the loads
    assert_allclose(result.frames[-1].scalars["support"], weight, rtol=1e-6)
    assert len(result.frames[-1].positions) == 7 * 5 + 4


def test_payloads_have_inertia(made: Any) -> None:
    deck = shell_deck(masses=[{"where": "sheet.left", "mass": 0.5}])
    plain, laden = (made(d).simulation.model for d in (shell_deck(), deck))
    more = (laden.mass - plain.mass)[: plain.dofs.n_positions].reshape(-1, 3)
    assert_allclose(more[plain.rest[: plain.dofs.n_positions : 3] == 0.0], 0.5, rtol=1e-12)
    assert_allclose(more.sum(axis=0), 0.5 * 5, rtol=1e-12)


@pytest.mark.parametrize("order", [1, -1])
def test_bodies_of_one_file_share_their_nodes(made: Any, tmp_path: Path, order: int) -> None:
    (tmp_path / "mixed.txt").write_text(MIXED, encoding="utf-8")
    deck = shell_deck()
    mesh = {"mesh": {"file": "mixed.txt"}}
    bodies = [
        {"type": "shell", "name": "sheet", "material": "rubber", "thickness": 2e-3, **mesh},
        {"type": "rod", "name": "rod", "material": "rubber", "radius": 2e-3, **mesh},
    ]
    built: Composition = made(deck | {"geometry": bodies[::order]})
    geometry = built.geometry
    assert len(geometry.nodes) == 5
    assert len(np.intersect1d(geometry.body_nodes["sheet"], geometry.body_nodes["rod"])) == 1
    topology = built.simulation.topology
    assert [topology.bodies[b] for b in topology.edge_body] == ["rod", "rod"]
    assert [topology.bodies[b] for b in topology.triangle_body] == ["sheet"]
    # the rod bends at its own node only: nothing passes into the sheet
    assert len(term(built.simulation.model, "bending").dofs) == 1


def test_files_in_other_units_are_scaled(made: Any, tmp_path: Path) -> None:
    """A body at another scale shares only the nodes that are where the other has them."""
    (tmp_path / "mixed.txt").write_text(MIXED, encoding="utf-8")
    sheet = {"type": "shell", "name": "sheet", "material": "rubber", "thickness": 2e-3}
    rod = {"type": "rod", "name": "rod", "material": "rubber", "radius": 2e-3}
    small, large = ({"mesh": {"file": "mixed.txt", "scale": scale}} for scale in (0.001, 1.0))
    geometry = made(shell_deck() | {"geometry": [sheet | small, rod | small]}).geometry
    assert_allclose(np.ptp(geometry.nodes, axis=0), [1e-3, 0.8660254e-3, 2e-3], rtol=1e-12)
    assert len(geometry.nodes) == 5
    apart = made(shell_deck() | {"geometry": [sheet | small, rod | large]}).geometry
    assert len(apart.nodes) == 5  # the origin is common to both
    (tmp_path / "mixed.txt").write_text(MIXED.replace("0, 0, 0\n", "0.1, 0, 0\n"), encoding="utf-8")
    apart = made(shell_deck() | {"geometry": [sheet | small, rod | large]}).geometry
    assert len(apart.nodes) == 6


FOLD = SHEET | {"length": 0.2, "width": 0.1, "divisions": 2, "pattern": "right"}


@pytest.mark.parametrize("bending", BENDINGS)
def test_driven_hinges_fold_towards_the_normals(ran: Any, bending: str) -> None:
    """Two plates with a hinge between them take its natural angle without any energy."""
    line = {"plane": {"point": [0.1, 0, 0], "normal": [1, 0, 0], "within": 1e-3}}
    deck = shell_deck(
        FOLD,
        body={"bending": bending},
        motions=[{"type": "pin", "where": {"box": {"min": [0, 0, 0], "max": [0.1, 0.1, 0]}}}],
        actuation=[{"type": "dihedral", "shell": "sheet", "hinges": line, "value": "20 deg"}],
        numerics={"integrator": {"type": "static", "load_steps": 4}},
    )
    result = ran(deck)
    last = result.frames[-1]
    topology = shell_edges(result.composition.geometry.triangles)
    angles = hinge_angles(last.positions, topology.hinges)
    folded = np.ptp(last.positions[topology.hinges[:, :2]][:, :, 0], axis=1) < 1e-9
    assert_allclose(np.abs(angles[folded]), np.radians(20.0), rtol=1e-6)
    assert last.positions[:, 2].max() > 0.03  # 0.1 sin 20 deg
    # against the energy of the rest shape with this natural angle, k theta^2 / 2
    assert last.scalars["elastic"] < 1e-9 * RUBBER.rigidity * np.radians(20.0) ** 2


def test_place_and_order_of_driven_hinges(made: Any) -> None:
    def natural(**keys: Any) -> FloatArray:
        part = {"type": "dihedral", "shell": "sheet", **keys}
        deck = shell_deck(FOLD, body={"bending": "hinge"}, actuation=[part])
        driven = term(made(deck).simulation.model, "sheet.bending")
        assert isinstance(driven, DrivenEnergy)
        out = driven.energy.natural[0].copy()
        for drive in driven.drives:
            out[drive.stencils] += drive.factors * drive.signal.value(2.0, NO_INPUTS, drive.places)
        return out

    mesh = sheet(0.2, 0.1, 2, Pattern.RIGHT)
    hinges = shell_edges(mesh.triangles).hinges
    middle = mesh.nodes[hinges[:, :2]].mean(axis=1)
    placed = natural(value={"expression": "t*x + 10*y + z + r"})
    radius = np.hypot(middle[:, 0], middle[:, 1])
    assert_allclose(placed, 2.0 * middle[:, 0] + 10.0 * middle[:, 1] + radius, rtol=1e-12)
    for sign in (1.0, -1.0):
        ordered = natural(value={"expression": "s"}, order_by=[sign, 0.0, 0.0])
        rank = np.argsort(np.argsort(sign * middle[:, 0], kind="stable"), kind="stable")
        assert_allclose(ordered, rank / (len(hinges) - 1), rtol=1e-12)
    across = natural(value=1.0, tangential={"apex": [0.0, 0.05, 0.0], "min_angle": "60 deg"})
    # the fold runs across the line to the left side, the diagonals at 45 degrees to it
    assert_array_equal(across, np.ptp(mesh.nodes[hinges[:, :2]][:, :, 0], axis=1) == 0.0)


@pytest.mark.parametrize("integrator", ["generalized_alpha", "implicit_euler"])
def test_resumed_run_is_the_same_run(write: Any, integrator: str) -> None:
    """Bit by bit, the frames of mid-edge normals included."""
    deck = shell_deck(
        BELL,
        motions=[{"type": "clamp", "where": "sheet.apex"}],
        forces=[DOWN, {"type": "area_damping", "coefficient": 3.0}],
        numerics={"integrator": {"type": integrator}, "dt": 2e-3, "t_end": 0.02},
    )
    deck["geometry"][0]["thickness"] = 5e-4
    loaded = load(write(deck))
    whole, first, second = Memory(), Memory(), Memory()
    straight = run(compose(loaded).simulation, whole)
    paused = run(compose(loaded).simulation, first, limits=Limits(until=0.009))
    assert paused.end is End.INTERRUPTED
    resumed = run(compose(loaded).simulation, second, resume_from=(first.arrays, first.numbers))
    assert resumed.end is End.DONE
    assert np.abs(straight.state.q - compose(loaded).simulation.model.rest).max() > 1e-3
    for name in ("q", "v", "a"):
        assert_array_equal(getattr(resumed.state, name), getattr(straight.state, name))
    assert_array_equal(resumed.state.frames.edge_normal, straight.state.frames.edge_normal)


def test_massless_normals_do_not_ring(ran: Any) -> None:
    """Average acceleration: a normal's rate is the difference quotient, not a running sign."""
    deck = shell_deck(
        motions=[{"type": "clamp", "where": "sheet.left"}],
        forces=[DOWN],
        numerics={"integrator": {"type": "newmark"}, "dt": 1e-3, "t_end": 1e-2},
        output={"every": 1e-3},
    )
    result = ran(deck)
    last, before = (result.frames[k].state for k in (-1, -2))
    xi = slice(result.composition.simulation.model.dofs.n_positions, None)
    assert np.abs(last["v"][xi]).max() > 1e-3
    assert_allclose(last["v"][xi], (last["q"] - before["q"])[xi] / 1e-3, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("bending", BENDINGS)
def test_fields_of_shells(ran: Any, bending: str) -> None:
    """Densities add up to the account's bending energy; the rod's cells come first and hold none."""
    deck = shell_deck(
        body={"bending": bending},
        motions=[{"type": "clamp", "where": "sheet.left"}],
        forces=[DOWN],
        output={"fields": ["area_strain", "bending_energy_density", "axial_force", "velocity"]},
    )
    deck["geometry"] = [*deck["geometry"], rod([0.0, 0.0, 1.0], [0.0, 0.0, 0.5])]
    deck["motions"] = [*deck["motions"], {"type": "clamp", "where": "rod.start"}]
    result = ran(deck)
    last, geometry = result.frames[-1], result.composition.geometry
    cells = len(geometry.edges) + len(geometry.triangles)
    for name in ("area_strain", "bending_energy_density", "axial_force"):
        assert last.fields[name].shape == (cells,)
    density = last.fields["bending_energy_density"]
    assert_array_equal(density[:4], 0.0)
    assert_allclose(density[4:] @ geometry.areas, last.scalars["elastic_sheet.bending"], rtol=1e-12)
    assert last.scalars["elastic_sheet.bending"] > 0.0
    assert last.fields["axial_force"][0] > 0.0
    assert_array_equal(last.fields["axial_force"][4:], 0.0)
    areas = triangle_areas(last.positions, geometry.triangles)
    assert_allclose(last.fields["area_strain"][4:], areas / geometry.areas - 1.0, atol=1e-12)


def test_framed_rods_beside_free_normals(ran: Any) -> None:
    """Angles of rods and of shells are numbered apart: each moves as it does alone."""
    bent = {"type": "rod", "name": "bow", "material": "rubber", "radius": 2e-3, "generate": {
        "shape": "arc", "center": [0, 0, 0], "radius": 0.1, "normal": [0, 0, 1], "start": [1, 0, 0],
        "angle": "90 deg", "nodes": 6}}  # fmt: skip
    alone = shell_deck(motions=[{"type": "clamp", "where": "sheet.left"}], forces=[DOWN])
    arc = alone | {"geometry": [bent], "motions": [{"type": "clamp", "where": "bow.start"}]}
    both = alone | {
        "geometry": [bent, *alone["geometry"]],
        "motions": [*arc["motions"], *alone["motions"]],
    }
    sheet_alone, arc_alone, together = (ran(deck).frames[-1].positions for deck in (alone, arc, both))
    # both stop at the same relative residual, of different sums
    assert_allclose(together[:6], arc_alone, rtol=0.0, atol=1e-9)
    assert_allclose(together[6:], sheet_alone, rtol=0.0, atol=1e-9)


def test_shell_energies_are_stencils(made: Any) -> None:
    """The names by which results and messages know the energies of a shell."""
    model = made(shell_deck()).simulation.model
    names = [t.name for t in model.terms if isinstance(t, StencilEnergy)]
    assert names == ["sheet.membrane", "sheet.bending"]


@pytest.mark.slow
def test_compiled_kernels_agree(ran: Any) -> None:
    """Both drivers step to where Newton stops, 1e-8 of the loads."""
    deck = shell_deck(motions=[{"type": "clamp", "where": "sheet.left"}], forces=[DOWN])
    ends = [
        ran(deck | {"numerics": EULER | {"kernels": kernels}}).frames[-1].positions
        for kernels in ("numpy", "numba")
    ]
    assert_allclose(ends[0], ends[1], rtol=0.0, atol=1e-9)
