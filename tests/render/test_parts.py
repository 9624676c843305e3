"""The parts of a picture that need no drawing: chains, shell solids, cameras, colours, choices."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from output_cases import cantilever, chain, helix, hybrid_topology, sheet, write_run

from dismech_cli.errors import RenderError, ScenarioError
from dismech_cli.output.frame import FieldSpec
from dismech_cli.output.read import read
from dismech_cli.render import child, probe
from dismech_cli.render.balls import make_balls
from dismech_cli.render.chains import find_chain_ends, find_chains
from dismech_cli.render.coloring import Field, Painter, Scale, find_ends, stored_field
from dismech_cli.render.framing import frame_motion, view_basis
from dismech_cli.render.ground import grid_lines
from dismech_cli.render.job import Job
from dismech_cli.render.movie import Wanted, render, time_decimals
from dismech_cli.render.overlay import round_length
from dismech_cli.render.panels import side_by_side
from dismech_cli.render.parts import make_bodies, make_parts
from dismech_cli.render.scales import exponent, make_scale, pretty, ticks, written
from dismech_cli.render.settings import Camera, Settings
from dismech_cli.render.shell_solid import cells_to_nodes, make_shells
from dismech_cli.render.timeline import Shot, film, shot_at, stills, stored
from dismech_cli.render.tubes import make_tubes


def chains_of(edges, bodies=None):
    edges = np.asarray(edges, dtype=np.int64)
    bodies = np.zeros(len(edges), dtype=np.int64) if bodies is None else np.asarray(bodies)
    return find_chains(edges, np.arange(1.0, len(edges) + 1), bodies)


def test_edges_in_any_order_and_direction_make_one_chain():
    (only,) = chains_of([[3, 2], [0, 1], [2, 1]])
    assert only.nodes.tolist() in ([0, 1, 2, 3], [3, 2, 1, 0])
    assert not only.closed
    by_node = dict(zip(only.nodes.tolist(), only.radius, strict=True))
    assert by_node == {0: 2.0, 1: 2.5, 2: 2.0, 3: 1.0}


def test_a_loop_is_closed():
    (loop,) = chains_of([[0, 1], [1, 2], [2, 0]])
    assert loop.closed
    assert sorted(loop.nodes[:-1].tolist()) == [0, 1, 2]
    assert find_chain_ends([loop], 1)[0].size == 0


def test_a_star_and_a_change_of_body_end_chains_with_a_ball_between():
    star = chains_of([[0, 1], [0, 2], [0, 3], [3, 4]])
    assert sorted(len(part.nodes) for part in star) == [2, 2, 3]
    nodes, radius, _ = find_chain_ends(star, 2)
    assert nodes.tolist() == [0]
    assert radius.tolist() == [3.0]
    two = chains_of(chain(5), [0, 0, 1, 1])
    assert [part.body for part in two] == [0, 1]
    assert find_chain_ends(two, 2)[0].tolist() == [2]


def test_every_edge_is_drawn_once():
    generator = np.random.default_rng(7)
    pairs = {tuple(sorted(generator.choice(30, 2, replace=False).tolist())) for _ in range(60)}
    found = chains_of(sorted(pairs))
    drawn = [tuple(sorted(pair)) for part in found for pair in zip(part.nodes, part.nodes[1:], strict=False)]
    assert sorted(drawn) == sorted(pairs)


def volume(part, positions):
    """Flux of x/3 through the surface of a part."""
    vertices, _ = part.place(0.0, positions)
    a, b, c = (vertices[part.faces[:, corner]] for corner in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def is_closed(part, positions):
    """Whether each side of a triangle is met once from the other side, where vertices lie together."""
    vertices, _ = part.place(0.0, positions)
    places = {tuple(v): k for k, v in enumerate(vertices.round(12).tolist())}
    at = np.array([places[tuple(v)] for v in vertices.round(12).tolist()])[part.faces]
    sides = [
        pair for k in range(3) for pair in zip(at[:, k].tolist(), at[:, (k + 1) % 3].tolist(), strict=True)
    ]
    sides = [pair for pair in sides if pair[0] != pair[1]]
    return sorted(sides) == sorted((b, a) for a, b in sides)


def test_a_shell_solid_is_closed_and_has_the_volume_of_the_shell():
    topology = hybrid_topology()
    (solid,) = make_shells(topology, 0.0)
    vertices, normals = solid.place(0.0, topology.rest_positions)
    a, b, c = (vertices[solid.faces[:, corner]] for corner in range(3))
    # Area 0.08^2 times thickness 6e-4; rounding is 1e-14.
    assert_allclose(volume(solid, topology.rest_positions), 0.08**2 * 6e-4, rtol=1e-10)
    assert is_closed(solid, topology.rest_positions)
    assert_allclose(np.linalg.norm(normals, axis=1), 1.0, rtol=1e-14)
    outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals[solid.faces[:, 0]])
    assert (outward > 0).all()
    assert len(solid.rim) == 4 * 8


def test_a_tube_is_closed_and_does_not_twist():
    angle = np.linspace(0.0, 4 * np.pi, 81)
    points = np.column_stack([np.cos(angle), np.sin(angle), 0.1 * angle])
    tubes = make_tubes(chains_of(chain(81)), points, 0.0, 16)
    normals = tubes.place(0.0, points)[1]
    assert is_closed(tubes, points)
    assert_allclose(np.linalg.norm(normals, axis=1), 1.0, rtol=1e-13)
    rings = normals[: 81 * 16].reshape(81, 16, 3)
    step = np.diff(points, axis=0)
    step /= np.linalg.norm(step, axis=1)[:, None]
    # Normals that are carried along without twist differ by the bend alone: at 81 nodes in two turns the
    # tangent turns by 0.157 between rings, and so does the normal at most.
    turned = np.arccos(np.clip((rings[1:] * rings[:-1]).sum(axis=2), -1.0, 1.0))
    assert turned.max() < 0.16


def test_a_straight_tube_has_the_volume_of_its_polygon():
    points = np.column_stack([np.linspace(0.0, 1.0, 6), np.zeros(6), np.zeros(6)])
    tubes = make_tubes(find_chains(chain(6), np.full(5, 0.1), np.zeros(5, dtype=int)), points, 0.0, 24)
    assert_allclose(volume(tubes, points), 12 * 0.1**2 * np.sin(2 * np.pi / 24), rtol=1e-12)


def test_a_loop_has_no_lids():
    angle = 2 * np.pi * np.arange(12) / 12
    points = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    edges = np.column_stack([np.arange(12), np.roll(np.arange(12), -1)])
    tubes = make_tubes(find_chains(edges, np.full(12, 0.1), np.zeros(12, dtype=int)), points, 0.0, 8)
    assert len(tubes.ends) == 0
    assert is_closed(tubes, points)


def test_balls_stand_where_rods_meet():
    star = chains_of([[0, 1], [0, 2], [0, 3]])
    (balls,) = make_balls(star, 0.0, 12, 2)
    points = np.random.default_rng(3).normal(size=(4, 3))
    vertices, _ = balls.place(0.0, points)
    assert_allclose(np.linalg.norm(vertices - points[0], axis=1), 3.0, rtol=1e-12)
    assert is_closed(balls, points)
    assert volume(balls, points) > 0.0
    assert make_balls(chains_of(chain(4)), 0.0, 12, 2) == []


@pytest.mark.parametrize("view", ["xy", "xz", "yz", "iso"])
@pytest.mark.parametrize("follow", [None, (), (7,)])
@pytest.mark.parametrize("color_by", [None, "strain"])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_the_whole_motion_is_in_the_picture(tmp_path, view, follow, color_by, angle):
    camera = Camera(view=view, follow=follow, angle=angle)
    settings = Settings(camera=camera, color_by=color_by, size=(640, 360))
    with read(write_run(tmp_path, helix(frames=4, nodes=40))) as run:
        framing = frame_motion(run, settings, [stored(run.t, k) for k in range(4)])
        seen = np.stack([framing.seen(run.positions[k], k) for k in range(4)])
    assert_allclose(framing.basis @ framing.basis.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(framing.basis) > 0
    half_width = framing.half_height * 640 / 360
    assert np.abs(seen[..., 0]).max() < half_width
    assert np.abs(seen[..., 1]).max() < framing.half_height
    # Filled in one direction up to the margin, the labels and the radius; a view that widens, or a node
    # that is followed, leaves more room.
    filled = max(np.abs(seen[..., 0]).max() / half_width, np.abs(seen[..., 1]).max() / framing.half_height)
    assert filled > (0.65 if angle == 0.0 and not follow else 0.3)
    if color_by:
        assert seen[..., 0].min() > -half_width + 0.2 * 2 * framing.half_height
    if follow is None:
        assert_allclose(framing.centers, np.broadcast_to(framing.centers[0], (4, 3)), rtol=1e-14)


def test_a_still_frames_what_it_shows(tmp_path):
    with read(write_run(tmp_path, cantilever(frames=5))) as run:
        first, last = stored(run.t, 0), stored(run.t, 4)
        look = Settings(camera=Camera(view="xz"), text=0.0)
        heights = [
            frame_motion(run, settings, shots).half_height
            for settings, shots in (
                (look, [first]),
                (look, [first, last]),
                (dataclasses.replace(look, ghosts=(0.4,)), [first]),
                (dataclasses.replace(look, trails=(40,)), [last]),
            )
        ]
    # A straight rod of 0.1 m fills the width of 16:9, with its radius and a margin of a tenth.
    assert_allclose(heights[0], (0.05 + 1.5e-3) * 9 / 16 * 1.1, rtol=1e-6)
    assert heights[1] > 1.05 * heights[0]
    assert heights[1] == heights[2] == heights[3]


def test_a_free_camera_stands_where_it_is_put(tmp_path):
    camera = Camera(eye=(3.0, 0.0, 0.0), target=(1.0, 0.0, 0.0), angle=np.pi / 2)
    with read(write_run(tmp_path, helix(frames=2))) as run:
        framing = frame_motion(run, Settings(camera=camera), [stored(run.t, 0)])
        assert_allclose(framing.distance, 2.0, rtol=1e-12)
        assert_allclose(framing.centers, [[1.0, 0.0, 0.0]], atol=1e-15)
        assert_allclose(framing.half_height, 2.0, rtol=1e-12)
        assert_allclose(framing.basis, [[0, 1, 0], [0, 0, 1], [1, 0, 0]], atol=1e-15)
        # A point half way to the eye looks twice as large.
        assert_allclose(framing.seen(np.array([[2.0, 0.5, 0.25]]), 0)[0, :2], [1.0, 0.5], rtol=1e-12)
        turned = dataclasses.replace(camera, up=(0.0, 1.0, 0.0))
        assert_allclose(view_basis(turned, np.array([1.0, 0.0, 0.0]))[1], [0, 1, 0], atol=1e-15)
        along = dataclasses.replace(camera, up=(1.0, 0.0, 0.0))
        assert_allclose(np.linalg.norm(view_basis(along, np.zeros(3)), axis=1), 1.0, rtol=1e-14)


def test_a_followed_node_stays_in_the_middle(tmp_path):
    topology, frames = cantilever(frames=5)
    with read(write_run(tmp_path, (topology, frames))) as run:
        settings = Settings(camera=Camera(view="xz", follow=(40,)), text=0.0)
        framing = frame_motion(run, settings, [stored(run.t, k) for k in range(5)])
        for k in range(5):
            assert_allclose(framing.seen(run.positions[k][40], k)[:2], 0.0, atol=1e-15)


def test_views_look_along_the_named_planes():
    views = {view: view_basis(Camera(view=view), np.zeros(3)) for view in ("xy", "xz", "yz")}
    assert_array_equal(views["xy"], np.eye(3))
    assert_array_equal(views["xz"][:2], [[1, 0, 0], [0, 0, 1]])
    assert_array_equal(views["yz"][:2], [[0, 1, 0], [0, 0, 1]])


def test_the_grid_lies_below_the_robot(tmp_path):
    with read(write_run(tmp_path, sheet(frames=2))) as run:
        framing = frame_motion(run, Settings(), [stored(run.t, 1)])
        lowest = np.asarray(run.positions)[..., 2].min()
    lines = grid_lines(framing)
    assert (lines[..., 2] < lowest).all()
    assert_allclose(np.ptp(lines[0, :, 1]), 48 * round_length(framing.half_height / 4), rtol=1e-12)


SPEC = FieldSpec(name="x", unit="J/m^2", long_name="energy", location="node")


def test_scales_cover_the_run_and_centre_signed_fields(tmp_path):
    topology, frames = sheet(frames=3)
    frames[1].fields["velocity"][0] = np.nan
    with read(write_run(tmp_path, (topology, frames))) as run:
        strain, velocity = (stored_field(run, name) for name in ("strain", "velocity"))
        signed = make_scale(strain.spec, strain.values(run))
        speed = make_scale(velocity.spec, velocity.values(run))
        with pytest.raises(ScenarioError, match="velocity, strain"):
            stored_field(run, "colour")
    assert (signed.lower, signed.upper) == (-1.2, 1.2)
    fastest = max(np.nanmax(np.linalg.norm(frame.fields["velocity"], axis=1)) for frame in frames)
    assert (speed.lower, speed.upper) == (0.0, fastest)
    assert speed.label == "node velocity [m/s]"
    colors = signed.colors(np.array([-1.2, 0.0, 1.2, np.nan]))
    assert colors[0, 2] > colors[0, 0]
    assert colors[2, 0] > colors[2, 2]
    assert colors[1].min() > 240
    assert colors[3].tolist() == [160, 160, 160]


def test_a_transient_does_not_spoil_the_colours():
    quiet = [np.array([0.0, 1.0 + 0.1 * np.sin(k)]) for k in range(100)]
    shock = [*quiet[:50], np.array([0.0, 40.0]), *quiet[50:]]
    scale = make_scale(SPEC, shock)
    assert 1.0 < scale.upper < 1.1
    assert scale.largest == 40.0
    # What grows all the time is no transient, nor is a peak at one place.
    growing = make_scale(SPEC, [np.array([0.0, float(k)]) for k in range(100)])
    assert growing.upper == growing.largest == 99.0
    local = make_scale(SPEC, [np.concatenate((np.ones(999), [50.0]))] * 20)
    assert local.upper == 50.0
    chosen = make_scale(SPEC, shock, (0.0, 2.0))
    assert (chosen.lower, chosen.upper) == (0.0, 2.0)


@pytest.mark.parametrize(
    ("values", "limits"),
    [([3.0, 3.0], (0.0, 3.0)), ([0.0, 0.0], (0.0, 1.0)), ([-3.0, -2.0], (-3.0, 0.0)), ([np.nan], (0.0, 1.0))],
)
def test_zero_is_in_every_range(values, limits):
    scale = make_scale(SPEC, [np.array(values)])
    assert (scale.lower, scale.upper) == limits
    assert len(ticks(scale)) >= 2


@pytest.mark.parametrize(
    ("upper", "shown", "power", "labels"),
    [
        (5.56e-5, np.arange(6) * 1e-5, -6, ["0", "10", "20", "30", "40", "50"]),
        (47.1, np.arange(5) * 10.0, 0, ["0", "10", "20", "30", "40"]),
        (2.68, np.arange(6) * 0.5, 0, ["0.0", "0.5", "1.0", "1.5", "2.0", "2.5"]),
    ],
)
def test_ticks_are_round(upper, shown, power, labels):
    scale = make_scale(SPEC, [np.array([0.0, upper])])
    assert_allclose(ticks(scale), shown, rtol=1e-12, atol=1e-20)
    assert exponent(scale) == power
    assert written(ticks(scale), power) == labels


def test_units_are_set():
    assert [pretty(unit) for unit in ("N m", "J/m^2", "1/m", "m^-1")] == ["N·m", "J/m²", "1/m", "m⁻¹"]


def test_ends_have_the_colour_beside_them_unless_as_stored():
    topology = dataclasses.replace(cantilever(frames=1)[0], edge_body=np.zeros(40, dtype=np.int64))
    values = np.ones(41)
    values[[0, -1]] = 0.0
    field = Field(spec=dataclasses.replace(SPEC, components=1))
    scale = make_scale(field.spec, [values])
    (tube,) = (
        make_tubes(
            find_chains(topology.edges, topology.edge_radius, topology.edge_body),
            topology.rest_positions,
            0.0,
            8,
        ),
    )
    shot = Shot(0.0, 0, 0, 0.0)
    looks = {}
    for ends in ("extended", "stored", "marked"):
        painter = Painter(topology, [values], field, scale, {}, ends)
        looks[ends] = painter.colors(tube, shot)
    assert (looks["extended"] == looks["extended"][0]).all()
    at_start = tube.source == 0
    assert (looks["stored"][at_start] != looks["extended"][at_start]).any(axis=1).all()
    start, end = looks["marked"][at_start][0], looks["marked"][tube.source == 40][0]
    assert start.max() < 80
    assert end[0] > 200
    starts, ends, _, beside = find_ends(topology.edges)
    assert (starts.tolist(), ends.tolist(), beside.tolist()) == ([0], [40], [1, 39])


def test_what_a_field_does_not_know_is_grey():
    topology = hybrid_topology()
    values = np.concatenate((np.zeros(8), np.ones(128)))
    field = Field(spec=dataclasses.replace(SPEC, location="cell"))
    painter = Painter(topology, [values], field, make_scale(field.spec, [values]), {}, "extended", "shells")
    (solid,) = make_shells(topology, 0.0)
    chains = find_chains(topology.edges, topology.edge_radius, topology.edge_body)
    tubes = make_tubes(chains, topology.rest_positions, 0.0, 8)
    assert (painter.colors(tubes, Shot(0.0, 0, 0, 0.0)) == 178).all()
    assert (painter.colors(solid, Shot(0.0, 0, 0, 0.0)).std(axis=1) > 20).all()


def test_bodies_have_the_colours_asked_for():
    topology = hybrid_topology()
    painter = Painter(topology, [], None, None, {1: (1, 2, 3)}, "extended")
    (solid,) = make_shells(topology, 0.0)
    assert (painter.colors(solid, Shot(0.0, 0, 0, 0.0)) == [0x2E, 0x7D, 0xA6]).all()
    tubes = make_tubes(
        find_chains(topology.edges, topology.edge_radius, topology.edge_body), topology.rest_positions, 0.0, 8
    )
    assert (painter.colors(tubes, Shot(0.0, 0, 0, 0.0)) == [1, 2, 3]).all()


def test_cell_values_are_averaged_to_nodes():
    values = cells_to_nodes(np.array([1.0, 3.0]), chain(3), 4)
    assert_array_equal(values, [1.0, 2.0, 3.0, 0.0])


def test_a_job_survives_the_way_to_another_process(tmp_path):
    settings = Settings(
        size=(64, 64), camera=Camera(follow=(1, 2), eye=(1.0, 2.0, 3.0)), colors={1: (1, 2, 3)}, ghosts=(0.0,)
    )
    with read(write_run(tmp_path, helix(frames=2))) as run:
        shots = (stored(run.t, 0), shot_at(run.t, 0.05))
        framing = frame_motion(run, settings, shots)
    table = np.arange(768, dtype=np.uint8).reshape(256, 3)
    job = Job(
        run_dir=tmp_path,
        renderer="pyvista",
        settings=settings,
        framing=framing,
        field=Field(spec=SPEC, file=tmp_path / "field.npy"),
        scale=Scale(label="s", lower=-1.0, upper=1 / 3, least=-2.0, largest=3.0, table=table),
        shots=shots,
        decimals=2,
    )
    back = Job.from_json(job.to_json())
    for field in dataclasses.fields(Job):
        if field.name not in ("framing", "scale"):
            assert getattr(back, field.name) == getattr(job, field.name)
    assert_array_equal(back.framing.centers, framing.centers)
    assert_array_equal(back.framing.basis, framing.basis)
    assert back.framing.half_height == framing.half_height
    assert back.scale is not None
    assert_array_equal(back.scale.table, table)
    assert (back.scale.upper, back.scale.largest) == (1 / 3, 3.0)


def test_what_does_not_go_together_is_refused_before_any_work(tmp_path):
    with pytest.raises(ScenarioError, match="films cannot be transparent"):
        render(tmp_path, Settings(background="transparent"), Wanted(formats=("gif",)))
    with pytest.raises(ScenarioError, match="takes one format"):
        render(tmp_path, Settings(), Wanted(formats=("png", "gif"), output=tmp_path / "one.png"))


def test_stills_are_stored_frames():
    times = np.array([0.0, 0.1, 0.2, 0.3])
    assert [shot.lower for shot in stills(times, ())] == [3]
    assert [shot.lower for shot in stills(times, (0.29, 0.0, 0.31, 9.0))] == [0, 3]


def test_a_film_runs_as_fast_as_the_motion():
    # A frame every 20 ms and 25 pictures per second: every second frame as it is.
    movie = film(np.arange(101) * 0.02, 25.0, None)
    assert movie.speed == 1.0
    assert [shot.lower for shot in movie.shots] == list(range(0, 101, 2))
    assert not any(shot.weight for shot in movie.shots)
    assert movie.notes == ()
    # Between frames that are far apart it is interpolated, and said.
    sparse = film(np.arange(5) * 0.5, 10.0, None)
    assert len(sparse.shots) == 21
    assert_allclose([shot.t for shot in sparse.shots], np.arange(21) * 0.1, atol=1e-12)
    middle = sparse.shots[7]
    assert (middle.lower, middle.upper) == (1, 2)
    assert_allclose(middle.weight, 0.4, rtol=1e-9)
    assert_allclose(middle.between([np.array([10.0 * k]) for k in range(5)]), [14.0], rtol=1e-9)
    assert "interpolated" in sparse.notes[0]


@pytest.mark.parametrize(
    ("end", "asked", "speed", "note"),
    [
        (0.01, None, 0.002, "500 times slower"),
        (600.0, None, 5.0, "5 times faster"),
        (2.0, 0.5, 0.5, "2 times slower"),
        (30.0, None, 1.0, ""),
    ],
)
def test_a_film_that_is_no_real_time_says_so(end, asked, speed, note):
    movie = film(np.linspace(0.0, end, 751), 25.0, asked)
    assert_allclose(movie.speed, speed, rtol=1e-12)
    assert_allclose((len(movie.shots) - 1) / 25.0, end / speed, rtol=0.02)
    assert movie.shots[-1].t == end
    assert any(note in one for one in movie.notes) if note else not movie.notes


def test_a_run_of_one_frame_is_a_film_of_one_picture():
    assert len(film(np.zeros(1), 25.0, None).shots) == 1


def test_time_labels_tell_frames_apart():
    assert [time_decimals(np.arange(3) * step) for step in (1.0, 0.1, 0.02, 1e-3, 1e-9)] == [1, 1, 2, 3, 6]


def test_panels_stand_in_rows_of_three():
    pictures = [np.full((2, 4, 3), k, dtype=np.uint8) for k in range(5)]
    figure = side_by_side(pictures)
    assert figure.shape == (4, 12, 3)
    assert figure[:, ::4, 0].tolist() == [[0, 1, 2]] * 2 + [[3, 4, 0]] * 2
    assert side_by_side(pictures[:4]).shape == (4, 8, 3)
    assert side_by_side(pictures[:1]).shape == (2, 4, 3)


def test_ends_of_rods_that_touch_are_round(tmp_path):
    topology, frames = cantilever(frames=1)
    with read(write_run(tmp_path / "free", (topology, frames))) as run:
        flat = make_bodies(run, 0.0, 8)
    touching = dataclasses.replace(topology, scalars={**topology.scalars, "contact": "J"})
    frames = [dataclasses.replace(frame, scalars={**frame.scalars, "contact": 0.0}) for frame in frames]
    with read(write_run(tmp_path / "touching", (touching, frames))) as run:
        (*bodies, caps) = make_bodies(run, 0.0, 8)
    assert len(bodies) == len(flat)
    ends = [topology.edges[0, 0], topology.edges[-1, 1]]
    assert caps.nodes.tolist() == ends
    assert_allclose(caps.radius, topology.edge_radius[[0, -1]])


def test_extras_are_drawn_beside_the_bodies(tmp_path, monkeypatch):
    topology, frames = cantilever(frames=1)
    with read(write_run(tmp_path, (topology, frames))) as run:
        (mark,) = make_balls(chains_of([[0, 1], [0, 2], [0, 3]]), 0.0, 8, 2)
        monkeypatch.setattr("dismech_cli.render.parts.EXTRAS", (lambda run, least: [mark],))
        assert make_parts(run, 0.0, 8)[-1] is mark


def test_round_lengths():
    assert [round_length(x) for x in (1.0, 1.99, 4.9, 0.05, 730.0)] == [1.0, 1.0, 2.0, 0.05, 500.0]


@pytest.fixture
def broken_vtk(tmp_path, monkeypatch):
    """A pyvista that dies as VTK does without OpenGL libraries."""
    folder = tmp_path / "broken"
    folder.mkdir()
    (folder / "pyvista.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n")
    monkeypatch.setenv("PYTHONPATH", str(folder))
    probe.find_renderer.cache_clear()
    yield
    probe.find_renderer.cache_clear()


def test_a_machine_without_opengl_falls_back_then_names_the_packages(broken_vtk, monkeypatch):
    assert probe.find_renderer() == "matplotlib"
    probe.find_renderer.cache_clear()
    monkeypatch.setattr(probe, "find_spec", lambda name: None)
    with pytest.raises(RenderError, match=r"SIGSEGV.*libegl1 libgl1-mesa-dri.*libosmesa6") as caught:
        probe.find_renderer()
    assert caught.value.exit_code == 6


def test_drawing_falls_back_where_vtk_dies(broken_vtk, tmp_path):
    run_dir = write_run(tmp_path / "run", cantilever(frames=2))
    drawn = render(run_dir, Settings(size=(160, 90)), Wanted(formats=("png",)))
    assert drawn.files[0].stat().st_size > 0
    assert "plain renderer" in drawn.notes[0]


def test_a_still_and_a_film_share_their_pictures(tmp_path, monkeypatch):
    monkeypatch.setattr("dismech_cli.render.drawing._PREFERRED", "matplotlib")
    run_dir = write_run(tmp_path / "run", cantilever(frames=3, dt=0.5))
    seen = []
    drawn = render(
        run_dir,
        Settings(size=(160, 90)),
        Wanted(formats=("png", "gif"), fps=2.0),
        progress=lambda done, total: seen.append((done, total)),
    )
    assert [file.name for file in drawn.files] == ["iso-000002.png", "iso.gif"]
    assert seen == [(1, 3), (2, 3), (3, 3)]


def test_a_process_that_dies_while_drawing_is_an_error_here(broken_vtk, tmp_path, monkeypatch):
    monkeypatch.setattr("dismech_cli.render.drawing.find_renderer", lambda: "pyvista")
    run_dir = write_run(tmp_path / "run", cantilever(frames=2))
    with pytest.raises(RenderError, match="drawing ended with signal SIGSEGV"):
        render(run_dir, Settings(), Wanted(formats=("png",)))
    assert not (run_dir / "render").exists() or not list((run_dir / "render").iterdir())


def test_exits_are_described():
    assert child.describe_exit(3) == "exit code 3"
    assert child.describe_exit(-9) == "signal SIGKILL"
