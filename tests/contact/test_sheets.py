"""The force between sheets, and between rods and sheets, does not depend on how they are cut."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from touching_sheets import energy, faces, flat, gradient

from dismech_cli.contact.drivers.batches import Batches
from dismech_cli.contact.pairs.surface_pairs import SurfacePairs
from dismech_cli.contact.pairs.surface_search import FaceSearch

H = 1.0
"""Distance at which the bodies touch."""

LAW = (1.0 - 0.9**2) * 0.9
"""Slope of the law at 0.9 H: (H^2 - d^2) d / H^2."""


@pytest.mark.parametrize("edge", [20.0, 5.0, 2.0, 1.0, 0.5])
def test_flat_sheets_carry_the_same_pressure(edge: float) -> None:
    """Force per area of a small sheet above a larger one, at any refinement of both."""
    size = 20.0 if edge >= 2.0 else 8.0
    lower = flat(2.0 * size, edge, jitter=0.2)
    upper = flat(size, edge, turn=23.0, jitter=0.2)
    upper[0][:, 2] = 0.9 * H
    found, x = faces([lower, upper], H)
    force = -gradient(found, x)[len(lower[0]) :].sum(axis=0)
    # what the lines of the lower sheet add that pass the rim of the upper one at less than H
    rim = 0.5 * 0.9 * (2.0 / 3.0) * (1.0 - 0.9**2) ** 1.5
    assert_allclose(force[2] / size**2, LAW + rim * 4.0 / size, rtol=0.06 if edge > 10.0 else 0.02)


def test_a_sheet_on_itself_is_the_sheet_on_another() -> None:
    """Two layers of one body, which hang together nowhere near."""
    lower, upper = flat(8.0, 1.0, jitter=0.2), flat(5.0, 1.0, turn=23.0)
    upper[0][:, 2] = 3.0
    one = np.concatenate((lower[0], upper[0])), np.concatenate((lower[1], upper[1] + len(lower[0])))
    pressed = [faces([lower, upper], H), faces([one], H, own=True)]
    energies = []
    for found, x in pressed:
        moved = x.copy()
        moved[len(lower[0]) :, 2] = 0.9 * H
        energies.append(energy(found, moved))
    assert energies[0] > 0.1
    assert_allclose(energies[1], energies[0], rtol=1e-12)


def test_a_flat_sheet_does_not_touch_itself() -> None:
    for edge in (20.0, 1.0, 0.4, 0.1):
        found, x = faces([flat(max(2.0 * edge, 1.0), edge, jitter=0.2)], H, own=True)
        assert energy(found, x) == 0.0
        assert np.isinf(found.own_reach).all()


def test_a_fold_to_half_the_thickness_touches_itself_beyond_half_a_circle_only() -> None:
    """A strip bent to a radius of H / 2 comes to the distance H of itself without a force; nearer, it has."""
    sheet = flat(12.0, 0.4)
    found, x = faces([sheet], H, own=True)
    energies = []
    for radius in (0.51 * H, 0.45 * H):
        bent = x.copy()
        angle = np.clip(x[:, 0] / radius, -0.5 * np.pi, 0.5 * np.pi)
        rest = x[:, 0] - radius * angle
        bent[:, 0] = radius * np.cos(angle) - np.abs(rest)
        bent[:, 2] = radius * np.sin(angle)
        energies.append(energy(found, bent))
    assert energies[0] < 1e-3 * energies[1]


@pytest.mark.parametrize("edge", [4.0, 1.0, 0.5])
def test_a_rod_along_a_sheet_carries_two_kappa_delta_per_length(edge: float) -> None:
    depth = 0.01
    sheet = flat(16.0, edge, turn=17.0, jitter=0.2)
    s = np.linspace(-3.0, 3.0, 7)
    rod = np.stack((s, 0.0 * s, 0.0 * s + H - depth), axis=1)
    found, x = faces([sheet], H, [rod])
    force = -gradient(found, x)[len(sheet[0]) :, 2].sum()
    assert_allclose(force / 6.0, 2.0 * depth, rtol=2.0 * depth)


def test_a_rod_over_sides_and_corners_has_no_ripple() -> None:
    sheet = flat(16.0, 2.0, jitter=0.2)
    forces = []
    for offset in np.linspace(0.0, 2.0, 9):
        s = np.linspace(-2.0, 2.0, 4)
        rod = np.stack((s + 0.3 * offset, 0.2 * s + offset, 0.0 * s + 0.9 * H), axis=1)
        found, x = faces([sheet], H, [rod])
        forces.append(gradient(found, x)[len(sheet[0]) :, 2].sum())
    assert np.ptp(forces) < 1e-10 * abs(np.mean(forces))


@pytest.mark.parametrize(("turn", "ripple"), [(0.0, 0.64), (23.0, 0.07)])
def test_a_ridge_over_the_edges_of_a_sheet_ripples_as_told(turn: float, ripple: float) -> None:
    """A right-angled fold at the default depth; the guide has the table."""
    edge, lower = 5.0, flat(20.0, 5.0)
    a = np.radians(turn)
    forces = []
    for offset in (-2.5, -1.25, -0.4, -0.2, 0.0, 0.2, 0.4, 1.25):
        (across, along, _), triangles = flat(2.0 * edge, edge)[0].T, flat(2.0 * edge, edge)[1]
        x, y = np.cos(a) * across - np.sin(a) * along, np.sin(a) * across + np.cos(a) * along
        nodes = np.stack((x + offset, y + 0.21 * edge, 0.95 * H + np.abs(across)), axis=1)
        found, places = faces([lower, (nodes, triangles)], H)
        forces.append(-gradient(found, places)[len(lower[0]) :].sum(axis=0))
    lateral, normal = np.linalg.norm(np.array(forces)[:, :2], axis=1), np.array(forces)[:, 2]
    assert 0.3 * ripple < np.ptp(normal) / normal.mean() < 1.1 * ripple
    assert (lateral < 0.065 * normal).all()


def crumpled(seed: int) -> tuple[object, object]:
    rng = np.random.default_rng(seed)
    lower, upper = flat(6.0, 1.5, jitter=0.2), flat(4.0, 1.0, turn=31.0, jitter=0.2)
    s = np.linspace(-2.0, 2.0, 6)
    rod = np.stack((s, s, 0.0 * s - 0.6), axis=1)
    upper[0][:, 2] = 0.7
    sheets = [(nodes + 0.12 * rng.normal(size=nodes.shape), triangles) for nodes, triangles in (lower, upper)]
    return faces(sheets, H, [rod])


@pytest.mark.parametrize("seed", range(3))
def test_forces_are_slopes_of_the_energy_and_have_no_sum(seed: int) -> None:
    found, x = crumpled(seed)
    force = gradient(found, x)
    size = np.abs(force).sum()
    assert size > 1.0
    assert np.abs(force.sum(axis=0)).max() < 1e-14 * size
    assert np.abs(np.cross(x, force).sum(axis=0)).max() < 1e-13 * size
    direction = np.random.default_rng(9).normal(size=x.shape)
    for h in (1e-3, 1e-4, 1e-5):
        slope = (energy(found, x + h * direction) - energy(found, x - h * direction)) / (2.0 * h)
        assert abs(slope - (force * direction).sum()) < 1e3 * h**2 + 1e-9


def test_a_sheet_that_falls_through_another_is_stopped() -> None:
    """The way is cut before any distance falls to half the reach."""
    found, x = faces([flat(8.0, 2.0), flat(4.0, 1.0, turn=20.0)], H)
    start, end = x.copy(), x.copy()
    upper = np.arange(len(x)) >= len(flat(8.0, 2.0)[0])
    start[upper, 2], end[upper, 2] = 2.0, -50.0
    part = SurfacePairs(FaceSearch(found, Batches())).longest_step(start, end, 0.0, 1.0)
    height = 2.0 - 52.0 * part
    assert 0.5 * H <= height < 0.7 * H
    # what moves along is free
    end = start + np.array([1.0, 0.0, 100.0])
    assert SurfacePairs(FaceSearch(found, Batches())).longest_step(start, end, 0.0, 1.0) == 1.0
