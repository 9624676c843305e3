from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.generate.curves import arc, helix, line
from dismech_cli.mesh.generate.polyline import polyline

EPS = np.finfo(float).eps


def test_line() -> None:
    mesh = line([0, 0, 1], [0.1, 0, 1], 101)
    assert_array_equal(mesh.nodes[[0, -1]], [[0, 0, 1], [0.1, 0, 1]])
    assert_allclose(np.diff(mesh.nodes[:, 0]), 1e-3, rtol=100 * EPS)
    assert_array_equal(mesh.edges, np.column_stack([np.arange(100), np.arange(1, 101)]))
    assert mesh.node_groups["start"].tolist() == [0]
    assert mesh.node_groups["end"].tolist() == [100]


def test_helix_gives_the_benchmark_nodes() -> None:
    with np.load(Path(__file__).parents[1] / "data" / "helix_nodes.npz") as file:
        want = file["nodes"]
    mesh = helix([0, 0, 0], [0, 0, -1], 0.02, 0.05, 3.7, 100, phase=-np.pi / 2)
    # Cosines of angles up to 25 rad, each rounded to 25 eps or so, times 0.02 m; z to one rounding of 0.185.
    assert_allclose(mesh.nodes, want, rtol=0, atol=25 * EPS * 0.02)
    # The same curve from the closed formula of the benchmark, to which the file belongs.
    t = np.linspace(0, 1, 100)
    phi = np.pi / 2 - 2 * np.pi * 3.7 * t
    formula = np.column_stack([0.02 * np.cos(phi), 0.02 * np.sin(phi), -0.185 * t])
    assert_allclose(mesh.nodes, formula, rtol=0, atol=25 * EPS * 0.02)


@pytest.mark.parametrize("axis", [[0, 0, 1], [0, 0, -1], [1, 0, 0], [1, 2, 3], [0, 1, 0], [1, 1e-9, 0]])
@pytest.mark.parametrize("handedness", ["left", "right"])
def test_helix_about_any_axis(axis: list[float], handedness: str) -> None:
    origin = np.array([0.3, -0.2, 0.1])
    mesh = helix(origin, axis, 0.02, 0.05, 2.5, 51, handedness=handedness, phase=0.4)
    along = np.array(axis) / np.linalg.norm(axis)
    offset = mesh.nodes - origin
    height = offset @ along
    across = offset - np.outer(height, along)
    assert_allclose(height, 0.125 * np.linspace(0, 1, 51), rtol=0, atol=10 * EPS)
    assert_allclose(np.linalg.norm(across, axis=1), 0.02, rtol=0, atol=10 * EPS)
    turn = np.cross(across[:-1], across[1:]) @ along
    assert (turn > 0).all() if handedness == "right" else (turn < 0).all()
    # Polygon of 50 chords: each spans pi / 10 of a turn and 2.5 mm of height.
    chord = np.hypot(2 * 0.02 * np.sin(np.pi / 20), 0.0025)
    assert_allclose(np.linalg.norm(np.diff(mesh.nodes, axis=0), axis=1), chord, rtol=1e-12)


@pytest.mark.parametrize(
    ("axis", "zero", "quarter"),
    [
        ([0, 0, 1], [1, 0, 0], [0, 1, 0]),
        ([0, 0, -2], [1, 0, 0], [0, -1, 0]),
        ([1, 0, 0], [0, 1, 0], [0, 0, 1]),
    ],
)
def test_zero_direction_of_the_helix_phase(
    axis: list[float], zero: list[float], quarter: list[float]
) -> None:
    for phase, direction in ((0.0, zero), (np.pi / 2, quarter)):
        start = helix([0, 0, 0], axis, 1.0, 0.5, 1.0, 9, phase=phase).nodes[0]
        assert_allclose(start, direction, rtol=0, atol=EPS)


def test_arc_and_ring() -> None:
    mesh = arc([0, 0, 1], 2.0, [0, 0, 1], [1, 0, 5], np.pi / 2, 31)
    phi = np.linspace(0, np.pi / 2, 31)
    want = np.column_stack([2 * np.cos(phi), 2 * np.sin(phi), np.ones(31)])
    assert_allclose(mesh.nodes, want, rtol=0, atol=4 * EPS)
    ring = arc([0, 0, 0], 1.0, [0, 1, 0], [1, 0, 0], -2 * np.pi, 12, closed=True)
    assert len(ring.nodes) == len(ring.edges) == 12
    assert ring.node_groups == {}
    lengths = np.linalg.norm(np.diff(ring.nodes[ring.edges], axis=1)[:, 0], axis=1)
    assert_allclose(lengths, 2 * np.sin(np.pi / 12), rtol=1e-13)
    # Negative about +y: from +x towards +z.
    assert ring.nodes[1, 2] > 0


def test_polyline_keeps_or_resamples_its_points() -> None:
    corners = [[0, 0, 0], [1, 0, 0], [1, 2, 0]]
    assert_array_equal(polyline(corners).nodes, corners)
    even = polyline(corners, nodes=7)
    # Multiples of 1/2 along whole lengths are exact up to interpolation.
    assert_allclose(even.nodes[:, 0], [0, 0.5, 1, 1, 1, 1, 1], rtol=0, atol=2 * EPS)
    assert_allclose(even.nodes[:, 1], [0, 0, 0, 0.5, 1, 1.5, 2], rtol=0, atol=2 * EPS)
    assert len(polyline(corners, spacing=0.4).edges) == 8
    assert len(polyline(corners, spacing=100.0).edges) == 1
    loop = polyline([*corners, corners[0]], closed=True)
    assert_array_equal(loop.edges, [[0, 1], [1, 2], [2, 0]])
    assert len(polyline(corners, spacing=0.1, closed=True).nodes) == round((3 + np.sqrt(5)) / 0.1)


def test_messages_name_the_place_of_the_points() -> None:
    with pytest.raises(MeshError, match=r"s.csv: node 3 is at the same place as node 2"):
        polyline([[0, 0, 0], [1, 1, 1], [1, 1, 1]], where="s.csv")
    with pytest.raises(MeshError, match=r"s.csv: 1 nodes; expected at least 2"):
        polyline([[0, 0, 0]], where="s.csv")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: line([0, 0, 0], [1, 0, 0], 1), "line: 1 nodes; expected at least 2"),
        (lambda: line([0, 0, 0], [1, 0, 0], 10**12), "line: 1000000000000 nodes"),
        (lambda: line([0, 0, 0], [0, 0, 0], 5), "line: all nodes are at the same place"),
        (lambda: line([0, 0], [1, 0, 0], 5), "line: start .* expected three finite numbers"),
        (lambda: line([0, 0, 0], [1e308, 0, 0], 5), "line: end .* expected three finite numbers"),
        (lambda: polyline([[-1e308, 0, 0], [1e308, 0, 0]]), "polyline: points of shape"),
        (lambda: helix([0, 0, 0], [0, 0, 1], np.inf, 1, 1, 9), "helix: radius inf"),
        (lambda: helix([0, 0, 0], [0, 0, 0], 1, 1, 1, 9), "helix: axis has no direction"),
        (lambda: helix([0, 0, 0], [0, 0, 1], -1, 1, 1, 9), "helix: radius -1; expected a positive number"),
        (lambda: helix([0, 0, 0], [0, 0, 1], 1, 0, 2, 21), "helix: node .* is at the same place as node"),
        (lambda: helix([0, 0, 0], [0, 0, 1], 1, np.nan, 2, 21), "helix: pitch nan"),
        (lambda: helix([0, 0, 0], [0, 0, 1], 1, 1, 2, 9, handedness="both"), "handedness 'both'"),
        (lambda: arc([0, 0, 0], 1, [0, 0, 1], [0, 0, 2], 1.0, 9), "across the normal has no direction"),
        (lambda: arc([0, 0, 0], 1, [0, 0, 1], [1, 0, 0], 7.0, 9), "expected between 0 and 2 pi"),
        (lambda: arc([0, 0, 0], 1, [0, 0, 1], [1, 0, 0], 3.0, 9, closed=True), "a closed ring needs 2 pi"),
        (lambda: arc([0, 0, 0], 0, [0, 0, 1], [1, 0, 0], 1.0, 9), "arc: radius 0"),
        (lambda: polyline([[0, 0, 0]]), "polyline: 1 nodes"),
        (lambda: polyline([[0, 0], [1, 1]]), r"polyline: points of shape \(2, 2\)"),
        (lambda: polyline([[0, 0, 0], [1, 0, 0]], nodes=5, spacing=0.1), "both nodes and spacing"),
        (lambda: polyline([[0, 0, 0], [1, 0, 0]], spacing=1e-12), "1000000000001 nodes"),
        (lambda: polyline([[0, 0, 0], [1, 0, 0]], spacing=1e-300), "spacing 1e-300 m over a length"),
        (lambda: polyline([[0, 0, 0], [1, 0, 0]], spacing=0.0), "spacing 0.0; expected a positive"),
        (lambda: polyline([[0, 0, 0], [1, 0, 0]], closed=True), "2 nodes; expected at least 3"),
    ],
)
def test_impossible_curves(make, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        make()
