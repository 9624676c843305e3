import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.generate.sheets import Pattern, sheet
from dismech_cli.mesh.mesh import Mesh
from dismech_cli.mesh.topology.orient import reversed_triangles
from dismech_cli.mesh.topology.shells import shell_edges
from dismech_cli.mesh.validate import validate

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)


def _mesh(nodes: object, *, edges: object = (), triangles: object = ()) -> Mesh:
    return Mesh(
        nodes=np.array(nodes, dtype=float).reshape(-1, 3),
        edges=np.array(edges, dtype=np.int64).reshape(-1, 2),
        triangles=np.array(triangles, dtype=np.int64).reshape(-1, 3),
    )


def _refused(mesh: Mesh, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        validate(mesh, "m")


def test_a_sound_mesh_passes_unchanged() -> None:
    mesh = _mesh(SQUARE, triangles=[[0, 1, 2], [0, 2, 3]])
    assert validate(mesh, "m") is mesh


def test_nodes() -> None:
    _refused(_mesh([[0, 0, 0], [np.nan, 0, 0]], edges=[[0, 1]]), r"m: node 2 is at \[nan, 0.0, 0.0\]")
    _refused(_mesh([[0, 0, 0], [np.inf, 0, 0]], edges=[[0, 1]]), "m: node 2 is at")
    _refused(_mesh([[0, 0, 0], [1e13, 0, 0]], edges=[[0, 1]]), "up to 1e.12 m")
    _refused(_mesh([[1, 2, 3], [1, 2, 3]], edges=[[0, 1]]), "all nodes are at the same place")
    _refused(_mesh([[0, 0, 0], [1, 0, 0]]), "neither rod edges nor triangles")
    _refused(_mesh(SQUARE, edges=[[0, 4]]), r"edge 1 \(nodes 1, 5\) names a node out of range")
    _refused(_mesh(SQUARE, edges=[[-1, 2]]), r"edge 1 \(nodes 0, 3\) names a node out of range")


@pytest.mark.parametrize("gap", [0.0, 1e-13])
def test_duplicate_nodes_at_any_scale(gap: float) -> None:
    nodes = np.array([[0, 0, 0], [1, 0, 0], [1 + gap, 0, 0], [2, 0, 0]])
    for scale in (1e-6, 1.0, 1e6):
        _refused(
            _mesh(nodes * scale, edges=[[0, 1], [2, 3]]), "m: node 3 is at the same place as node 2; merge"
        )
    nodes[2, 0] = 1 + 1e-9
    validate(_mesh(nodes, edges=[[0, 1], [2, 3]]), "m")


@pytest.mark.parametrize("axes", [(0, 1), (0, 2), (1, 2)])
def test_nodes_are_told_apart_where_their_projections_coincide(axes: tuple[int, int]) -> None:
    """The search looks at projections on (sqrt 2, sqrt 3, sqrt 5) first: these differ by 1e-17 there."""
    across = np.zeros(3)
    across[list(axes)] = np.sqrt((2.0, 3.0, 5.0))[list(axes[::-1])] * (1.0, -1.0)
    nodes = np.outer(np.arange(4), across)
    validate(_mesh(nodes, edges=[[0, 1], [1, 2], [2, 3]]), "m")
    nodes[3] = nodes[1] * (1.0 + 1e-14)
    _refused(_mesh(nodes, edges=[[0, 1], [2, 3]]), "node 4 is at the same place as node 2")


def test_unused_nodes_are_dropped_and_said() -> None:
    nodes = [[0, 0, 0], [5, 5, 5], [1, 0, 0], [0, 0, 0], [2, 0, 0]]
    mesh = _mesh(nodes, edges=[[0, 2], [2, 4]])
    groups = {"ends": np.array([0, 4]), "ghost": np.array([1]), "both": np.array([1, 2])}
    checked = validate(Mesh(nodes=mesh.nodes, edges=mesh.edges, node_groups=groups), "m")
    assert checked.notes == ("2 nodes without an edge or triangle dropped (first: node 2).",)
    assert_array_equal(checked.nodes[:, 0], [0, 1, 2])
    assert_array_equal(checked.edges, [[0, 1], [1, 2]])
    assert {name: group.tolist() for name, group in checked.node_groups.items()} == {
        "ends": [0, 2],
        "both": [1],
    }


def test_messages_count_nodes_as_the_file_does() -> None:
    nodes = [[9, 9, 9], [0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0]]
    _refused(_mesh(nodes, edges=[[1, 2], [3, 4]]), "node 4 is at the same place as node 3")


def test_edges() -> None:
    _refused(_mesh(SQUARE, edges=[[0, 1], [2, 2]]), r"m: edge 2 \(nodes 3, 3\) has zero length")
    _refused(
        _mesh(SQUARE, edges=[[0, 1], [1, 2], [1, 0]]), r"m: edge 3 \(nodes 2, 1\) repeats an earlier edge"
    )


def test_triangles() -> None:
    line = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]]
    _refused(_mesh(line, triangles=[[0, 1, 3], [0, 1, 2]]), r"m: triangle 2 \(nodes 1, 2, 3\) has zero area")
    _refused(_mesh(SQUARE, triangles=[[0, 1, 2], [1, 2, 0]]), "triangle 2 .* repeats an earlier triangle")
    fan = [[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, -1, 0]]
    _refused(
        _mesh(fan, triangles=[[0, 1, 2], [1, 0, 3], [0, 1, 4]]),
        r"at an edge \(such as nodes 1, 2\): not a manifold surface",
    )


def test_a_fold_flat_onto_the_neighbour_is_refused_and_a_sharp_one_is_not() -> None:
    triangles = [[0, 1, 2], [1, 0, 3]]
    corners = [[0, 0, 0], [1, 0, 0], [0.5, 1, 0]]
    _refused(_mesh([*corners, [0.4, 0.8, 0]], triangles=triangles), "triangle 2 .* is folded flat")
    validate(_mesh([*corners, [0.4, 0.8, 1e-3]], triangles=triangles), "m")


def test_area_tolerance_scales_with_the_mesh() -> None:
    # Height over length 1e-10: area 5e-11 of the squared diagonal, well above 1e-14.
    for scale in (1e-9, 1.0, 1e9):
        sliver = np.array([[0, 0, 0], [1, 0, 0], [0.5, 1e-10, 0]]) * scale
        validate(_mesh(sliver, triangles=[[0, 1, 2]]), "m")
        flat = np.array([[0, 0, 0], [1, 0, 0], [0.5, 1e-14, 0]]) * scale
        _refused(_mesh(flat, triangles=[[0, 1, 2]]), "zero area")


def test_winding_is_repaired_with_the_fewest_reversals() -> None:
    good = sheet(1.0, 0.5, 8, Pattern.ALTERNATING)
    rng = np.random.default_rng(3)
    for _ in range(5):
        turned = rng.permutation(len(good.triangles))[: len(good.triangles) // 3]
        triangles = good.triangles.copy()
        triangles[turned] = triangles[turned][:, [0, 2, 1]]
        repaired = validate(Mesh(nodes=good.nodes, triangles=triangles), "m")
        assert_array_equal(repaired.triangles, good.triangles)
        assert repaired.notes[0].startswith(f"{len(turned)} of {len(good.triangles)} triangles reversed")


def test_winding_of_two_patches_is_repaired_apart() -> None:
    nodes = np.vstack([SQUARE, SQUARE + np.array([5, 0, 0])])
    triangles = [[0, 1, 2], [0, 3, 2], [4, 5, 6], [4, 6, 7]]
    mesh = validate(_mesh(nodes, triangles=triangles), "m")
    # A tie keeps the first triangle of a patch as it is.
    assert_array_equal(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    assert mesh.notes[-1] == "The mesh has 2 components that share no node."


def _band(count: int, half_twists: int) -> tuple[np.ndarray, np.ndarray]:
    angle = 2 * np.pi * np.arange(count) / count
    tilt = 0.5 * half_twists * angle
    across = np.column_stack([np.cos(tilt) * np.cos(angle), np.cos(tilt) * np.sin(angle), np.sin(tilt)])
    ring = 3 * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(count)])
    nodes = np.vstack([ring - 0.5 * across, ring + 0.5 * across])
    here = np.arange(count)
    on = (here + 1) % count
    low, high = np.stack([here, on]), np.stack([here, on]) + count
    if half_twists % 2:
        low[1, -1], high[1, -1] = count, 0
    return nodes, np.concatenate(
        [np.stack([low[0], low[1], high[1]], axis=1), np.stack([low[0], high[1], high[0]], axis=1)]
    )


def test_a_moebius_strip_is_refused_and_a_full_twist_is_not() -> None:
    nodes, triangles = _band(24, 2)
    validate(Mesh(nodes=nodes, triangles=triangles), "m")
    nodes, triangles = _band(24, 1)
    with pytest.raises(MeshError, match=r"only one side \(a Moebius strip\)"):
        validate(Mesh(nodes=nodes, triangles=triangles), "m")


def test_after_repair_every_hinge_is_crossed_in_both_directions() -> None:
    good = sheet(1.0, 1.0, 6, Pattern.UNSTRUCTURED)
    triangles = good.triangles.copy()
    triangles[::2] = triangles[::2][:, ::-1]
    wrong = reversed_triangles(triangles, "m")
    triangles[wrong] = triangles[wrong][:, [0, 2, 1]]
    shell = shell_edges(triangles)
    signs = np.zeros(len(shell.edges))
    np.add.at(signs, shell.face_edges.ravel(), shell.face_signs.ravel())
    inner = shell.edge_faces[:, 1] >= 0
    assert_array_equal(signs[inner], 0)


def test_too_many_nodes_are_refused() -> None:
    nodes = np.broadcast_to(np.zeros(3), (6_000_000, 3))
    _refused(Mesh(nodes=nodes, edges=np.array([[0, 1]])), "6000000 nodes; a mesh may have 0 to 2000000")


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_a_branch_that_folds_back_is_refused_and_a_folded_rod_is_not(scale: float) -> None:
    chain = [[0, 1], [1, 2]]
    ahead = np.array([[0, 0, 0], [5, 0, 0]]) * scale
    for edges in (chain, [[0, 1], [2, 1]]):
        validate(_mesh([*ahead, [scale, 0, 0]], edges=edges), "m")
    validate(_mesh([*ahead, [scale, 1e-3 * scale, 0]], edges=chain), "m")
    star = [[0, 1], [0, 2], [0, 3], [0, 4]]
    around = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, 2, 0]]
    _refused(_mesh(np.array(around) * scale, edges=star), r"edge 4 .* folds straight back onto another")
