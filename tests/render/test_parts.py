"""The parts of a picture that need no drawing: chains, shell solids, cameras, colours, choices."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from output_cases import cantilever, chain, helix, hybrid_topology, sheet, write_run

from dismech_cli.errors import RenderError, ScenarioError
from dismech_cli.output.read import read
from dismech_cli.render import child, probe
from dismech_cli.render.chains import find_chains, find_junctions
from dismech_cli.render.coloring import Scale, cells_to_nodes, make_scale
from dismech_cli.render.framing import frame_motion, view_basis
from dismech_cli.render.ground import grid_lines
from dismech_cli.render.job import Job
from dismech_cli.render.movie import render
from dismech_cli.render.overlay import round_length
from dismech_cli.render.selection import real_time_fps, select_frames
from dismech_cli.render.settings import Settings, make_settings
from dismech_cli.render.shell_solid import make_shells
from dismech_cli.render.worker import time_decimals


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
    assert find_junctions([loop])[0].size == 0


def test_a_star_and_a_change_of_body_end_chains_with_a_ball_between():
    star = chains_of([[0, 1], [0, 2], [0, 3], [3, 4]])
    assert sorted(len(part.nodes) for part in star) == [2, 2, 3]
    nodes, radius, _ = find_junctions(star)
    assert nodes.tolist() == [0]
    assert radius.tolist() == [3.0]
    two = chains_of(chain(5), [0, 0, 1, 1])
    assert [part.body for part in two] == [0, 1]
    assert find_junctions(two)[0].tolist() == [2]


def test_every_edge_is_drawn_once():
    generator = np.random.default_rng(7)
    pairs = {tuple(sorted(generator.choice(30, 2, replace=False).tolist())) for _ in range(60)}
    found = chains_of(sorted(pairs))
    drawn = [tuple(sorted(pair)) for part in found for pair in zip(part.nodes, part.nodes[1:], strict=False)]
    assert sorted(drawn) == sorted(pairs)


def test_a_shell_solid_is_closed_and_has_the_volume_of_the_shell():
    topology = hybrid_topology()
    (solid,) = make_shells(topology)
    vertices, normals = solid.vertices(topology.rest_positions, 0.0)
    a, b, c = (vertices[solid.faces[:, corner]] for corner in range(3))
    # Flux of x/3 through a closed surface: area 0.08^2 times thickness 6e-4; rounding is 1e-14.
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    assert_allclose(volume, 0.08**2 * 6e-4, rtol=1e-10)
    assert_allclose(np.linalg.norm(normals, axis=1), 1.0, rtol=1e-14)
    outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals[solid.faces[:, 0]])
    assert (outward > 0).all()
    assert len(solid.rim) == 4 * 8


@pytest.mark.parametrize("view", ["xy", "xz", "yz", "iso"])
@pytest.mark.parametrize("camera", ["fixed", "tracking"])
@pytest.mark.parametrize("color_by", [None, "strain"])
def test_the_whole_motion_is_in_the_picture(tmp_path, view, camera, color_by):
    settings = Settings(view=view, camera=camera, color_by=color_by, size=(640, 360))
    with read(write_run(tmp_path, helix(frames=4, nodes=40))) as run:
        framing = frame_motion(run, settings)
        seen = np.stack([(run.positions[i] - framing.centers[i]) @ framing.basis.T for i in range(4)])
    assert_allclose(framing.basis @ framing.basis.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(framing.basis) > 0
    half_width = framing.half_height * 640 / 360
    assert np.abs(seen[..., 0]).max() < half_width
    assert np.abs(seen[..., 1]).max() < framing.half_height
    # Filled in one direction up to the margin, the labels and the radius.
    assert (
        max(np.abs(seen[..., 0]).max() / half_width, np.abs(seen[..., 1]).max() / framing.half_height) > 0.7
    )
    if color_by:
        assert seen[..., 0].min() > -half_width + 0.16 * 2 * framing.half_height
    if camera == "fixed":
        assert_array_equal(framing.centers, np.broadcast_to(framing.centers[0], (4, 3)))


def test_views_look_along_the_named_planes():
    assert_array_equal(view_basis("xy"), np.eye(3))
    assert_array_equal(view_basis("xz")[:2], [[1, 0, 0], [0, 0, 1]])
    assert_array_equal(view_basis("yz")[:2], [[0, 1, 0], [0, 0, 1]])


def test_the_grid_lies_below_the_robot(tmp_path):
    with read(write_run(tmp_path, sheet(frames=2))) as run:
        framing = frame_motion(run, Settings())
        lowest = np.asarray(run.positions)[..., 2].min()
    lines = grid_lines(framing)
    assert (lines[..., 2] < lowest).all()
    assert_allclose(np.ptp(lines[0, :, 1]), 48 * round_length(framing.half_height / 4), rtol=1e-12)


def test_scales_cover_the_run_and_centre_signed_fields(tmp_path):
    topology, frames = sheet(frames=3)
    frames[1].fields["velocity"][0] = np.nan
    with read(write_run(tmp_path, (topology, frames))) as run:
        signed, speed = make_scale(run, "strain"), make_scale(run, "velocity")
        with pytest.raises(ScenarioError, match="velocity, strain"):
            make_scale(run, "colour")
    assert (signed.lower, signed.upper) == (-1.2, 1.2)
    fastest = max(np.nanmax(np.linalg.norm(frame.fields["velocity"], axis=1)) for frame in frames)
    assert speed.upper == fastest
    assert speed.label == "node velocity [m/s]"
    colors = signed.colors(np.array([-1.2, 0.0, 1.2, np.nan]))
    assert colors[0, 2] > colors[0, 0]
    assert colors[2, 0] > colors[2, 2]
    assert colors[1].min() > 240
    assert colors[3].tolist() == [160, 160, 160]


def test_a_constant_field_has_a_range(tmp_path):
    topology, frames = cantilever(frames=2)
    for frame in frames:
        frame.fields["strain"][:] = 3.0
    with read(write_run(tmp_path, (topology, frames))) as run:
        scale = make_scale(run, "strain")
    assert scale.lower < 3.0 < scale.upper


def test_cell_values_are_averaged_to_nodes():
    values = cells_to_nodes(np.array([1.0, 3.0]), chain(3), 4)
    assert_array_equal(values, [1.0, 2.0, 3.0, 0.0])


def test_a_job_survives_the_way_to_another_process(tmp_path):
    with read(write_run(tmp_path, helix(frames=2))) as run:
        framing = frame_motion(run, Settings())
    scale = Scale(field="strain", label="s [1]", lower=-1.0, upper=1 / 3, colormap="viridis")
    job = Job(
        run_dir=tmp_path,
        renderer="pyvista",
        settings=Settings(size=(64, 64)),
        framing=framing,
        scale=scale,
        frames=(0, 1),
        files=(tmp_path / "0.png", tmp_path / "1.png"),
    )
    back = Job.from_json(job.to_json())
    for field in dataclasses.fields(Job):
        if field.name != "framing":
            assert getattr(back, field.name) == getattr(job, field.name)
    assert_array_equal(back.framing.centers, framing.centers)
    assert_array_equal(back.framing.basis, framing.basis)
    assert back.framing.half_height == framing.half_height


def test_choices_are_checked():
    choices = {"view": "iso", "color_by": None, "size": (1281, 719), "camera": "fixed"}
    assert make_settings(**choices).size == (1282, 720)
    for wrong, match in (
        ({"view": "xyz"}, "xy, xz, yz, iso"),
        ({"camera": "drone"}, "fixed, tracking"),
        ({"size": (10, 10)}, "between 64 and 7680"),
        ({"size": (64, 100_000)}, "between 64 and 7680"),
    ):
        with pytest.raises(ScenarioError, match=match):
            make_settings(**(choices | wrong))


def test_wrong_formats_and_speeds_are_refused_before_any_work(tmp_path):
    with pytest.raises(ScenarioError, match="mp4, gif, png"):
        render(tmp_path, formats=["avi"])
    with pytest.raises(ScenarioError, match="fps"):
        render(tmp_path, fps=0)


def test_frames_are_chosen_by_time():
    times = np.array([0.0, 0.1, 0.2, 0.3])
    assert select_frames(times, "png", None) == [3]
    assert select_frames(times, "png", "first") == [0]
    assert select_frames(times, "mp4", None) == [0, 1, 2, 3]
    assert select_frames(times, "png", [0.29, 0.0, 0.31, 9.0]) == [0, 3]
    with pytest.raises(ScenarioError, match="middle"):
        select_frames(times, "png", "middle")


def test_speed_and_time_label_follow_the_frames():
    assert real_time_fps(np.arange(5) * 0.04) == 25.0
    assert real_time_fps(np.arange(5) * 1e-4) == 60.0
    assert real_time_fps(np.zeros(1)) == 30.0
    assert [time_decimals(np.arange(3) * step) for step in (1.0, 0.1, 0.02, 1e-3, 1e-9)] == [1, 1, 2, 3, 6]


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
    (file,) = render(run_dir, formats=["png"], size=(160, 90))
    assert file.stat().st_size > 0


def test_a_still_and_a_video_share_their_frames(tmp_path, monkeypatch):
    monkeypatch.setattr("dismech_cli.render.drawing._PREFERRED", "matplotlib")
    run_dir = write_run(tmp_path / "run", cantilever(frames=3))
    drawn = []
    still, video = render(
        run_dir,
        formats=["png", "gif"],
        size=(160, 90),
        progress=lambda done, total: drawn.append((done, total)),
    )
    assert (still.name, video.name) == ("iso-000002.png", "iso.gif")
    assert drawn == [(1, 3), (2, 3), (3, 3)]
    with pytest.raises(ScenarioError, match="takes one format"):
        render(run_dir, formats=["png", "gif"], output=tmp_path / "one.png")


def test_a_process_that_dies_while_drawing_is_an_error_here(broken_vtk, tmp_path, monkeypatch):
    monkeypatch.setattr("dismech_cli.render.drawing.find_renderer", lambda: "pyvista")
    run_dir = write_run(tmp_path / "run", cantilever(frames=2))
    with pytest.raises(RenderError, match="drawing ended with signal SIGSEGV"):
        render(run_dir, formats=["png"])


def test_exits_are_described():
    assert child.describe_exit(3) == "exit code 3"
    assert child.describe_exit(-9) == "signal SIGKILL"
