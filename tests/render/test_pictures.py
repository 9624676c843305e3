"""Pictures and videos, looked at by numbers: where the robot is, what colour it has."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from output_cases import cantilever, sheet, write_run
from PIL import Image

from dismech_cli.errors import OutputError, RenderError, ScenarioError
from dismech_cli.render import drawing, movie, probe
from dismech_cli.render.encode import write_mp4
from dismech_cli.render.plot import plot_scalars

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


def test_a_rod_is_where_it_should_be(tmp_path, renderer):
    topology, frames = cantilever(frames=3)
    frames[2].positions[7] = np.nan  # what a failed run may leave must not stop the picture
    run_dir = write_run(tmp_path, (topology, frames))
    files = movie.render(run_dir, view="xz", formats=["png"], size=SIZE, times=[0.0, 0.1, 0.2])
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
    # In front of a pale background, brighter at the top than at the bottom.
    image = open_image(files[0])
    assert image.shape == (180, 320, 3)
    assert image[2, SIZE[0] // 2].min() > image[-3, SIZE[0] // 2].min() > 200


def test_colours_follow_the_field(tmp_path, renderer):
    run_dir = write_run(tmp_path, sheet(frames=2))
    (file,) = movie.render(run_dir, formats=["png"], size=SIZE, color_by="strain", ground="grid")
    assert file == run_dir / "render" / "iso-strain-000001.png"
    robot = open_image(file)[:, SIZE[0] // 4 :].astype(int)
    assert (robot[..., 2] - robot[..., 0] > 40).sum() > 100, "low values are blue"
    assert (robot[..., 0] - robot[..., 2] > 40).sum() > 100, "high values are red"


def test_several_processes_draw_one_video_and_report_progress(tmp_path, monkeypatch):
    monkeypatch.setattr(drawing, "_PREFERRED", "matplotlib")
    monkeypatch.setattr(drawing, "_MANY_FRAMES", 4)
    monkeypatch.setattr(drawing.os, "cpu_count", lambda: 2)
    run_dir = write_run(tmp_path, cantilever(frames=6))
    calls = []
    (file,) = movie.render(
        run_dir, formats=["gif"], size=(161, 91), progress=lambda done, total: calls.append((done, total))
    )
    assert file == run_dir / "render" / "iso.gif"
    assert calls == [(done, 6) for done in range(1, 7)]
    with Image.open(file) as picture:
        assert picture.n_frames == 6
        assert picture.size == (162, 92)
        assert picture.info["duration"] == 100


def test_mp4_is_h264_that_every_player_shows(tmp_path):
    import imageio_ffmpeg

    pictures = []
    for number in range(6):
        pictures.append(tmp_path / f"{number}.png")
        Image.new("RGB", (162, 92), (40 * number, 80, 120)).save(pictures[-1])
    file = tmp_path / "video.mp4"
    write_mp4(pictures, file, 25.0)
    assert imageio_ffmpeg.count_frames_and_secs(str(file))[0] == 6
    video = imageio_ffmpeg.read_frames(str(file))
    about = next(video)
    video.close()
    assert about["size"] == (162, 92)
    assert about["fps"] == 25.0
    assert about["codec"] == "h264"
    assert about["pix_fmt"].startswith("yuv420p")
    with pytest.raises(OutputError, match=r"nowhere.video\.mp4"):
        write_mp4(pictures, tmp_path / "nowhere" / "video.mp4", 25.0)


def test_outputs_go_where_they_are_told(tmp_path, monkeypatch):
    def draw_nothing(jobs, progress):
        for job in jobs:
            for file in job.files:
                Image.new("RGB", job.settings.size).save(file)

    monkeypatch.setattr(drawing, "_PREFERRED", "matplotlib")
    monkeypatch.setattr(drawing, "_draw_all", draw_nothing)
    run_dir = write_run(tmp_path / "run", cantilever(frames=3))
    one = tmp_path / "one.png"
    assert movie.render(run_dir, formats=["png"], size=SIZE, output=one) == [one]
    folder = tmp_path / "stills"
    several = movie.render(run_dir, formats=["png"], size=SIZE, output=folder, times=[0.0, 0.1])
    assert several == [folder / "iso-000000.png", folder / "iso-000001.png"]
    video = tmp_path / "deep" / "video.mp4"
    assert movie.render(run_dir, size=SIZE, output=video) == [video]
    assert all(file.stat().st_size for file in [one, *several, video])


def test_no_encoder_and_no_frames_are_told(tmp_path, monkeypatch):
    run_dir = write_run(tmp_path / "run", (cantilever()[0], []))
    with pytest.raises(RenderError, match="no frames"):
        movie.render(run_dir, formats=["png"])
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(RenderError, match=r"pip install \"dismech\[video\]\""):
        movie.render(run_dir, formats=["mp4"])
    with pytest.raises(OutputError, match="no such run"):
        movie.render(tmp_path / "none", formats=["png"])


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
