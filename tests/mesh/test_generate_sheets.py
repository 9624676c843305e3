import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.generate.icosphere import icosphere
from dismech_cli.mesh.generate.rings import annulus, disc, hemisphere
from dismech_cli.mesh.generate.sheets import Pattern, sheet
from dismech_cli.mesh.mesh import Mesh
from dismech_cli.mesh.topology.shells import shell_edges

SHAPES = [
    (0.1, 0.02165, 40),
    (0.1, 0.02165, 20),
    (1.0, 1.0, 12),
    (0.3, 1.0, 4),
    (1.0, 0.2, 20),
    (1.0, 1.0, 1),
]
FINE_SHAPES = [(0.1, 0.1, 30), (1.0, 0.1, 60), (2.0, 3.0, 25)]


def _normals(mesh: Mesh) -> np.ndarray:
    a, b, c = (mesh.nodes[mesh.triangles[:, k]] for k in range(3))
    return 0.5 * np.cross(b - a, c - a)


def _smallest_angle(mesh: Mesh) -> float:
    corners = mesh.nodes[mesh.triangles]
    angles = []
    for k in range(3):
        u, v = corners[:, k - 2] - corners[:, k], corners[:, k - 1] - corners[:, k]
        angles.append(np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(axis=1)))
    return float(np.degrees(np.min(angles)))


def _rim(mesh: Mesh) -> np.ndarray:
    shell = shell_edges(mesh.triangles)
    return np.unique(shell.edges[shell.edge_faces[:, 1] < 0])


@pytest.mark.parametrize("pattern", Pattern)
@pytest.mark.parametrize(("length", "width", "divisions"), SHAPES)
def test_sheets_cover_the_rectangle_exactly(
    pattern: Pattern, length: float, width: float, divisions: int
) -> None:
    mesh = sheet(length, width, divisions, pattern)
    normals = _normals(mesh)
    assert (normals[:, 2] > 0).all()
    # Sums of up to thousands of areas, each exact to a few roundings.
    assert_allclose(normals[:, 2].sum(), length * width, rtol=1e-13)
    assert_array_equal(mesh.nodes.min(axis=0), [0, 0, 0])
    assert_array_equal(mesh.nodes.max(axis=0), [length, width, 0])
    assert_array_equal(_rim(mesh), mesh.node_groups["rim"])
    assert len(mesh.nodes) - len(shell_edges(mesh.triangles).edges) + len(mesh.triangles) == 1
    for name, column, value in (("left", 0, 0), ("right", 0, length), ("bottom", 1, 0), ("top", 1, width)):
        assert len(mesh.node_groups[name]) >= 2
        assert_array_equal(mesh.nodes[mesh.node_groups[name], column], value)


def test_equilateral_sheet_has_the_counts_of_the_cantilever_benchmark() -> None:
    mesh = sheet(0.1, 10 * 0.0025 * np.sqrt(3) / 2, 40)
    assert (len(mesh.nodes), len(mesh.triangles)) == (446, 800)
    edges = shell_edges(mesh.triangles).edges
    lengths = np.linalg.norm(np.diff(mesh.nodes[edges], axis=1)[:, 0], axis=1)
    filling = 10
    # All edges but those along the notches of the short sides are equal.
    assert np.sum(np.abs(lengths - 0.0025) < 1e-12) == len(edges) - filling
    assert_allclose(_smallest_angle(mesh), 30.0, rtol=1e-10)


@pytest.mark.parametrize(("length", "width", "divisions"), [*SHAPES, *FINE_SHAPES])
def test_unstructured_triangles_are_well_shaped(length: float, width: float, divisions: int) -> None:
    mesh = sheet(length, width, divisions, Pattern.UNSTRUCTURED)
    assert _smallest_angle(mesh) > 20.0
    assert mesh.notes == (
        f"The smallest angle of the unstructured triangles is {_smallest_angle(mesh):.1f} degrees.",
    )
    again = sheet(length, width, divisions, Pattern.UNSTRUCTURED)
    assert_array_equal(mesh.nodes, again.nodes)
    assert_array_equal(mesh.triangles, again.triangles)


def test_unstructured_sheet_has_no_preferred_direction() -> None:
    mesh = sheet(1.0, 1.0, 30, Pattern.UNSTRUCTURED)
    shell = shell_edges(mesh.triangles)
    inner = shell.edges[shell.edge_faces[:, 1] >= 0]
    along = np.diff(mesh.nodes[inner], axis=1)[:, 0]
    angle = np.arctan2(along[:, 1], along[:, 0])
    # Means of exp(k i angle) over about 3000 edges: 1 if all edges lie in k / 2 directions, as in a
    # net; 3000 ** -0.5 = 0.02 for independent ones, which neighbouring edges are not quite.
    assert len(along) > 2500
    for k in (2, 4, 6):
        assert abs(np.exp(1j * k * angle).mean()) < 0.1
    net = shell_edges(sheet(1.0, 1.0, 30).triangles).edges
    along = np.diff(sheet(1.0, 1.0, 30).nodes[net], axis=1)[:, 0]
    assert abs(np.exp(6j * np.arctan2(along[:, 1], along[:, 0])).mean()) > 0.9


def test_discs() -> None:
    mesh = disc(2.0, 5)
    assert (len(mesh.nodes), len(mesh.triangles)) == (91, 150)
    assert_array_equal(mesh.node_groups["center"], [0])
    assert_array_equal(mesh.nodes[0], 0)
    assert_array_equal(_rim(mesh), mesh.node_groups["rim"])
    # The outline is a regular 30-gon.
    assert_allclose(_normals(mesh).sum(axis=0), [0, 0, 0.5 * 30 * 4 * np.sin(np.pi / 15)], rtol=0, atol=1e-12)
    assert _smallest_angle(mesh) > 40.0
    benchmark = disc(1.0, 5, counts=(6, 12, 18, 24, 31))
    assert (len(benchmark.nodes), len(benchmark.triangles)) == (92, 151)
    denser = disc(1.0, 10, counts=(6, 12, 18, 24, 31, 37, 43, 49, 55, 62))
    assert (len(denser.nodes), len(denser.triangles)) == (338, 612)


def test_annuli() -> None:
    mesh = annulus(0.5, 1.0, 4)
    rims = np.union1d(mesh.node_groups["inner"], mesh.node_groups["outer"])
    assert_array_equal(_rim(mesh), rims)
    inner, outer = len(mesh.node_groups["inner"]), len(mesh.node_groups["outer"])
    want = 0.5 * outer * np.sin(2 * np.pi / outer) - 0.125 * inner * np.sin(2 * np.pi / inner)
    assert_allclose(_normals(mesh).sum(axis=0), [0, 0, want], rtol=0, atol=1e-12)
    assert (_normals(mesh)[:, 2] > 0).all()
    assert _smallest_angle(mesh) > 30.0


def test_hemispheres() -> None:
    bell = hemisphere(1.0, 6, counts=(8, 13, 20, 27, 34, 41))
    assert (len(bell.nodes), len(bell.triangles)) == (144, 245)
    assert len(shell_edges(bell.triangles).hinges) == 347
    assert_allclose(np.linalg.norm(bell.nodes, axis=1), 1.0, rtol=4 * np.finfo(float).eps)
    assert_array_equal(bell.nodes[bell.node_groups["apex"]], [[0, 0, 1]])
    assert_array_equal(bell.nodes[bell.node_groups["rim"], 2], 0.0)
    assert_array_equal(_rim(bell), bell.node_groups["rim"])
    centers = bell.nodes[bell.triangles].mean(axis=1)
    assert ((_normals(bell) * centers).sum(axis=1) > 0).all()
    rings = np.unique(np.round(np.degrees(np.arccos(bell.nodes[:, 2])), 9))
    assert_allclose(rings, [0, 15, 30, 45, 60, 75, 90], rtol=0, atol=1e-8)


def test_hemisphere_area_converges_to_that_of_the_sphere() -> None:
    errors = [
        1 - np.linalg.norm(_normals(hemisphere(1.0, rings)), axis=1).sum() / (2 * np.pi)
        for rings in (5, 10, 20, 40)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    # Inscribed flat triangles: second order, within the scatter of rounded ring counts.
    assert_allclose(orders, 2.0, rtol=0, atol=0.15)


def test_caps_with_chosen_rings() -> None:
    cap = hemisphere(2.0, 2, polar_angles=(0.1, 0.3), counts=(6, 12))
    assert_allclose(cap.nodes[cap.node_groups["rim"], 2], 2 * np.cos(0.3), rtol=1e-15)
    assert len(cap.triangles) == 24


@pytest.mark.parametrize("n", [1, 2, 7])
def test_whole_spheres(n: int) -> None:
    ball = icosphere(2.0, n)
    assert (len(ball.nodes), len(ball.triangles)) == (10 * n * n + 2, 20 * n * n)
    edges = shell_edges(ball.triangles)
    assert len(edges.hinges) == 30 * n * n
    assert_allclose(np.linalg.norm(ball.nodes, axis=1), 2.0, rtol=4 * np.finfo(float).eps)
    assert_allclose(ball.nodes[ball.node_groups["top"]], [[0, 0, 2]], rtol=0, atol=1e-15)
    assert_allclose(ball.nodes[ball.node_groups["bottom"]], [[0, 0, -2]], rtol=0, atol=1e-15)
    centers = ball.nodes[ball.triangles].mean(axis=1)
    assert ((_normals(ball) * centers).sum(axis=1) > 0).all()
    assert _smallest_angle(ball) > 45.0
    assert_allclose(_normals(ball).sum(axis=0), 0.0, rtol=0, atol=1e-14 * len(ball.triangles))


def test_area_of_whole_spheres_converges() -> None:
    errors = [
        1 - np.linalg.norm(_normals(icosphere(1.0, n)), axis=1).sum() / (4 * np.pi) for n in (8, 16, 32)
    ]
    assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, rtol=0, atol=0.02)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sheet(0.0, 1.0, 4), "sheet: length 0.0; expected a positive number"),
        (lambda: sheet(1.0, np.nan, 4), "sheet: width nan"),
        (lambda: sheet(1.0, 1.0, 0), "sheet: 0 divisions"),
        (lambda: sheet(1.0, 1.0, 10**9), "sheet: .* triangles; a generated surface may have 500000"),
        (lambda: sheet(1e-9, 1e9, 4), "triangles; a generated surface may"),
        (lambda: sheet(1.0, 2e5, 1), "sheet: 2e\\+05 rows of triangles; expected at most 100000"),
        (lambda: sheet(1.0, 1.0, 400, Pattern.UNSTRUCTURED), "sheet: over 100000 unstructured nodes"),
        (lambda: disc(-1.0, 4), "disc: radius -1.0"),
        (lambda: icosphere(0.0, 4), "icosphere: radius 0.0"),
        (lambda: icosphere(1.0, 0), "icosphere: 0 divisions"),
        (lambda: icosphere(1.0, 10**9), "icosphere: .* triangles; a generated surface may have 500000"),
        (lambda: disc(1.0, 10**7), "disc: 6e\\+14 triangles"),
        (lambda: disc(1.0, 2, counts=(6,)), r"disc: counts \[6\]; expected 2 numbers of at least 3"),
        (lambda: disc(1.0, 2, counts=(6, 2)), "expected 2 numbers of at least 3"),
        (lambda: annulus(1.0, 1.0, 2), "annulus: inner radius 1.0 m is not below"),
        (lambda: annulus(0.5, 1.0, 10**5), "annulus: .* triangles; a generated surface may"),
        (lambda: hemisphere(1.0, 2, polar_angles=(0.5, 0.4)), "expected 2 between 0 and pi, ascending"),
        (lambda: hemisphere(1.0, 2, polar_angles=(0.5, 4.0)), "expected 2 between 0 and pi, ascending"),
        (lambda: hemisphere(1.0, 10**12), "hemisphere: 1000000000000 rings"),
    ],
)
def test_impossible_shells(make, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        make()
