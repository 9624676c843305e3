"""Pictures and videos, looked at by numbers: where the robot is, what colour it has."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from output_cases import cantilever, sheet, write_run
from PIL import Image

from dismech_cli.errors import OutputError, RenderError, ScenarioError
from dismech_cli.render import drawing, movie, probe
from dismech_cli.render.encode import mp4_file
from dismech_cli.render.movie import Wanted
from dismech_cli.render.plot import plot_scalars
from dismech_cli.render.settings import Camera, Settings

SIZE = (320, 180)
RENDERERS = ["pyvista", "matplotlib"]


@pytest.fixture(params=RENDERERS)
def renderer(request, monkeypatch):
    if request.param == "pyvista" and probe.find_renderer() != "pyvista":
        pytest.skip("this machine has no OpenGL library")
    monkeypatch.setattr(drawing, "_PREFERRED", request.param)
    return request.param


def inked(image):
    """Pixels of strong colour: the robot, not the grey labels and the pale background."""
    return np.ptp(image.astype(int), axis=2) > 45


def open_image(path):
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"))


def draw(run_dir, formats=("png",), times=(), output=None, progress=None, **settings):
    """Files of small pictures."""
    wanted = Wanted(formats=formats, fps=10.0, times=times, output=output)
    return movie.render(run_dir, Settings(size=SIZE, **settings), wanted, progress=progress).files


def test_a_rod_is_where_it_should_be(tmp_path, renderer):
    topology, frames = cantilever(frames=3)
    frames[2].positions[7] = np.nan  # what a failed run may leave must not stop the picture
    run_dir = write_run(tmp_path, (topology, frames))
    files = draw(run_dir, camera=Camera(view="xz"), times=(0.0, 0.1, 0.2))
    assert [file.name for file in files] == [f"xz-{frame:06d}.png" for frame in range(3)]
    straight, bent = (inked(open_image(file)) for file in files[:2])
    rows, columns = np.nonzero(straight)
    # 100 mm long, 3 mm thick: one row of that share in the picture, up to a pixel at each end.
    assert np.ptp(rows) + 1 == pytest.approx(0.03 * (np.ptp(columns) + 1), abs=2)
    bent_rows, bent_columns = np.nonzero(bent)
    scale = (np.ptp(columns) + 1) / 0.1
    tip = frames[1].positions[-1]
    assert np.ptp(bent_rows) + 1 == pytest.approx((0.003 - tip[2]) * scale, abs=4)
    assert bent_columns.max() < columns.max()
    # In front of plain paper: no gradient, no noise.
    image = open_image(files[0])
    assert image.shape == (180, 320, 3)
    assert (image[60:140] == 255).all()


def test_colours_follow_the_field(tmp_path, renderer):
    run_dir = write_run(tmp_path, sheet(frames=2))
    (file,) = draw(run_dir, color_by="strain", ground="grid", mesh=True, smooth=False)
    assert file == run_dir / "render" / "iso-strain-000001.png"
    robot = open_image(file)[:, SIZE[0] // 4 :].astype(int)
    assert (robot[..., 2] - robot[..., 0] > 40).sum() > 100, "low values are blue"
    assert (robot[..., 0] - robot[..., 2] > 40).sum() > 100, "high values are red"


def test_a_transparent_picture_covers_the_robot_alone(tmp_path, renderer):
    run_dir = write_run(tmp_path, cantilever(frames=2))
    view = Camera(view="xz")
    (clear,) = draw(run_dir, background="transparent", text=0.0, camera=view, output=tmp_path / "a.png")
    (white,) = draw(run_dir, text=0.0, camera=view, output=tmp_path / "b.png")
    with Image.open(clear) as picture:
        assert picture.mode == "RGBA"
        image = np.asarray(picture).astype(float)
    opacity = image[..., 3:] / 255
    assert (opacity[inked(open_image(white))] > 0.0).all()
    assert (opacity < 1.0).mean() > 0.9
    if renderer == "matplotlib":
        return  # whose edges are painted over each other
    # On white paper it is the picture with white paper, up to rounding of colours and opacity.
    composed = opacity * image[..., :3] + (1.0 - opacity) * 255
    assert np.abs(composed - open_image(white)).max() <= 3.0


def test_ghosts_are_pale_and_trails_are_lines(tmp_path, renderer):
    run_dir = write_run(tmp_path, cantilever(frames=3))
    eye = Camera(eye=(0.05, -0.3, -0.04), target=(0.05, 0.0, -0.04), angle=0.5)
    look = {"camera": eye, "text": 0.0}
    (plain,) = draw(run_dir, output=tmp_path / "a.png", **look)
    (haunted,) = draw(run_dir, output=tmp_path / "b.png", ghosts=(0.0,), **look)
    (traced,) = draw(run_dir, output=tmp_path / "c.png", trails=(40,), **look)
    alone, with_ghost, with_trail = (open_image(file).astype(int) for file in (plain, haunted, traced))
    drawn = (with_ghost < 250).any(axis=2) & (alone > 250).all(axis=2)
    # The straight rod of 0.1 m is still seen, in a colour near that of the paper.
    assert np.ptp(np.nonzero(drawn)[1]) > 0.8 * np.ptp(np.nonzero(inked(alone))[0])
    assert with_ghost[drawn].mean() > 180
    line = (with_trail < 128).all(axis=2) & (alone > 250).all(axis=2)
    assert line.sum() > 20


def test_a_floor_has_a_shadow_and_corners_are_dark(tmp_path):
    if probe.find_renderer() != "pyvista":
        pytest.skip("this machine has no OpenGL library")
    run_dir = write_run(tmp_path, sheet(frames=2))
    (lit,) = draw(run_dir, text=0.0, output=tmp_path / "a.png")
    (shaded,) = draw(run_dir, text=0.0, ground="floor", output=tmp_path / "b.png")
    before, after = open_image(lit).astype(int), open_image(shaded).astype(int)
    paper = (before > 250).all(axis=2)
    shadow = paper & (after < 235).all(axis=2)
    assert shadow.sum() > 500
    # It is grey and soft: many tones between paper and the darkest.
    assert np.ptp(after[shadow], axis=1).max() < 12
    assert len(np.unique(after[shadow][:, 0])) > 20
    robot = ~paper
    assert (after[robot] <= before[robot] + 2).all()
    assert after[robot].mean() < before[robot].mean()


def test_processes_are_as_many_as_cores_and_worth_their_start(monkeypatch):
    monkeypatch.setattr(drawing, "_cores", lambda: 4)
    assert [drawing.processes_for(count) for count in (0, 1, 59, 60, 119, 120, 10_000)] == [
        1,
        1,
        1,
        2,
        3,
        4,
        4,
    ]
    monkeypatch.setattr(drawing, "_cores", lambda: 1)
    assert drawing.processes_for(10_000) == 1


def test_pictures_are_the_same_however_many_processes_draw(tmp_path, monkeypatch):
    if probe.find_renderer() != "pyvista":
        pytest.skip("this machine has no OpenGL library")
    run_dir = write_run(tmp_path / "run", cantilever(frames=4))
    monkeypatch.setattr(drawing, "_WORTH", 2)
    drawn = []
    for cores in (1, 2):
        monkeypatch.setattr(drawing, "_cores", lambda cores=cores: cores)
        files = draw(run_dir, times=(0.0, 0.1, 0.2, 0.3), output=tmp_path / str(cores), ground="floor")
        drawn.append([file.read_bytes() for file in files])
    assert len(drawn[0]) == 4
    assert drawn[0] == drawn[1]


def test_several_processes_draw_one_film_and_report_progress(tmp_path, monkeypatch):
    monkeypatch.setattr(drawing, "_PREFERRED", "matplotlib")
    monkeypatch.setattr(drawing, "_WORTH", 4)
    monkeypatch.setattr(drawing, "_cores", lambda: 2)
    run_dir = write_run(tmp_path, cantilever(frames=11))
    calls = []
    (file,) = draw(run_dir, formats=("gif",), progress=lambda done, total: calls.append((done, total)))
    assert file == run_dir / "render" / "iso.gif"
    assert calls == [(done, 11) for done in range(1, 12)]
    heights = []
    with Image.open(file) as picture:
        assert picture.n_frames == 11
        assert picture.size == SIZE
        assert picture.info["duration"] == 100
        for frame in range(11):
            picture.seek(frame)
            rows = np.nonzero(inked(np.asarray(picture.convert("RGB"))))[0]
            heights.append(np.ptp(rows))
    assert heights[-1] > heights[0]
    # In order: it bends farther and farther.
    assert (np.diff(heights[3:]) >= -1).all()


def test_mp4_is_h264_that_every_player_shows(tmp_path):
    import imageio_ffmpeg

    file = tmp_path / "video.mp4"
    with mp4_file(file, (162, 92), 25.0) as take:
        for number in range(6):
            take(np.full((92, 162, 3), 40 * number, dtype=np.uint8))
    assert imageio_ffmpeg.count_frames_and_secs(str(file))[0] == 6
    video = imageio_ffmpeg.read_frames(str(file))
    about = next(video)
    video.close()
    assert about["size"] == (162, 92)
    assert about["fps"] == 25.0
    assert about["codec"] == "h264"
    assert about["pix_fmt"].startswith("yuv420p")
    nowhere = tmp_path / "nowhere" / "video.mp4"
    with pytest.raises(OutputError, match=r"nowhere.video\.mp4"), mp4_file(nowhere, (162, 92), 25.0):
        pass


def test_a_gif_shows_the_times_that_its_rate_allows(tmp_path, draw_nothing):
    run_dir = write_run(tmp_path / "run", cantilever(frames=11, dt=0.12))
    # 1.2 s in steps of 30, 20 and 140 ms, and the last frame.
    for fps, duration in ((30.0, 41 * 30), (60.0, 61 * 20), (7.0, 10 * 140)):
        wanted = Wanted(formats=("gif",), fps=fps, output=tmp_path / "a.gif")
        movie.render(run_dir, Settings(size=SIZE), wanted)
        with Image.open(tmp_path / "a.gif") as picture:
            # Pictures that are all the same are kept as one.
            assert picture.info["duration"] * picture.n_frames == duration
    rates = [1000 / movie.rate_of("gif", fps) for fps in (30.0, 60.0, 7.0)]
    assert rates == pytest.approx([30.0, 20.0, 140.0], rel=1e-14)
    assert movie.rate_of("mp4", 30.0) == 30.0


@pytest.fixture
def draw_nothing(monkeypatch):
    def nothing(job):
        return (np.zeros((*job.settings.size[::-1], 3), dtype=np.uint8) for _ in job.shots)

    monkeypatch.setattr(drawing, "_draw_all", nothing)


def test_outputs_go_where_they_are_told(tmp_path, draw_nothing):
    run_dir = write_run(tmp_path / "run", cantilever(frames=3))
    one = tmp_path / "one.png"
    assert draw(run_dir, output=one) == [one]
    folder = tmp_path / "stills"
    several = draw(run_dir, output=folder, times=(0.0, 0.1))
    assert several == [folder / "iso-000000.png", folder / "iso-000001.png"]
    video = tmp_path / "deep" / "video.mp4"
    assert draw(run_dir, formats=("mp4",), output=video) == [video]
    assert all(file.stat().st_size for file in [one, *several, video])
    panels = Wanted(formats=("png",), times=(0.0, 0.1), layout="panels")
    (figure,) = movie.render(run_dir, Settings(size=SIZE), panels).files
    assert figure == run_dir / "render" / "iso-panels.png"
    assert open_image(figure).shape == (SIZE[1], 2 * SIZE[0], 3)


def test_a_failed_drawing_leaves_no_file(tmp_path, monkeypatch):
    def fails(job):
        yield np.zeros((*job.settings.size[::-1], 3), dtype=np.uint8)
        raise RenderError("drawing ended")

    monkeypatch.setattr(drawing, "_draw_all", fails)
    run_dir = write_run(tmp_path / "run", cantilever(frames=3))
    for format in ("mp4", "gif", "png"):
        with pytest.raises(RenderError, match="drawing ended"):
            draw(run_dir, formats=(format,), times=(0.0, 0.1))
    assert not list((run_dir / "render").iterdir())


def test_no_encoder_and_no_frames_are_told(tmp_path, monkeypatch):
    run_dir = write_run(tmp_path / "run", (cantilever()[0], []))
    with pytest.raises(RenderError, match="no frames"):
        draw(run_dir)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(RenderError, match=r"pip install \"dismech\[video\]\""):
        draw(run_dir, formats=("mp4",))
    with pytest.raises(OutputError, match="no such run"):
        draw(tmp_path / "none")


def test_scalars_are_plotted(tmp_path):
    run_dir = write_run(tmp_path, cantilever(frames=20))
    file = plot_scalars(run_dir)
    assert file == run_dir / "render" / "scalars.png"
    image = open_image(file).astype(int)
    # The blue lines rise from the lower left to the upper right of their diagrams.
    rows, columns = np.nonzero(image[..., 2] - image[..., 0] > 80)
    left = columns < image.shape[1] // 2
    assert np.corrcoef(rows[left], columns[left])[0, 1] < -0.9
    vector = plot_scalars(run_dir, ["kinetic_energy"], tmp_path / "energy.svg")
    assert vector.read_text().startswith("<?xml")
    with pytest.raises(ScenarioError, match="kinetic_energy, newton_iterations"):
        plot_scalars(run_dir, ["entropy"])
