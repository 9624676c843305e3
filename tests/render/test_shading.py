"""Light and shadow against what they replace: VTK's own shader, and a Gaussian."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli.render import child, probe
from dismech_cli.render.balls import balls_at
from dismech_cli.render.floor import _blur
from dismech_cli.render.occlusion import _sums_of_nine
from dismech_cli.render.polydata import make_actor, surface
from dismech_cli.render.shading import add_lights, shade
from dismech_cli.render.window import Window


def test_light_is_that_of_vtk():
    if probe.find_renderer() != "pyvista":
        pytest.skip("this machine has no OpenGL library")
    ball = balls_at(np.array([0]), np.array([1.0]), np.array([0]), 48)
    points, normals = ball.place(0.0, np.zeros((1, 3)))
    data = surface(points.astype(np.float32), ball.faces)
    data.point_data.active_normals = normals.astype(np.float32)
    data.point_data.set_scalars(np.full((len(points), 3), 120, dtype=np.uint8), "rgb")
    window = Window((160, 120), (255, 255, 255))
    add_lights(window.renderer)
    actor = make_actor(data)
    shade(actor, smooth=True, parallel=False)
    window.renderer.AddActor(actor)
    window.aim(np.eye(3), np.zeros(3), 1.2, 4.0, 2.0, 0.6)
    ours, place = window.shoot()
    actor.GetShaderProperty().ClearAllFragmentShaderReplacements()
    theirs, same_place = window.shoot()
    window.close()
    assert place == same_place
    # It has a highlight, a dark side and nothing of the paper but around it; eight bits may round otherwise.
    assert np.ptp(ours[ours[..., 3] == 255][:, 0]) > 80
    assert np.abs(ours.astype(int) - theirs.astype(int)).max() <= 1


def test_a_shadow_is_blurred_by_a_gaussian():
    blur = _blur(101, 5.0)
    point = np.zeros((101, 101), dtype=np.float32)
    point[50, 40] = 1.0
    soft = blur @ point @ blur.T
    y, x = np.mgrid[:101, :101]
    expected = np.exp(-((x - 40) ** 2 + (y - 50) ** 2) / 50.0) / (50.0 * np.pi)
    # single precision: 1e-7 of the largest
    assert_allclose(soft, expected, atol=1e-7 * expected.max() * 4)
    assert soft.sum() == pytest.approx(1.0, abs=1e-5)


def test_neighbours_are_summed():
    values = np.arange(12, dtype=np.float32).reshape(3, 4)
    sums = _sums_of_nine(values)
    assert sums[1, 1] == values[:3, :3].sum()
    assert sums[0, 0] == 4 * 0 + 2 * 1 + 2 * 4 + 5


def test_what_fills_the_last_corner_is_read():
    if probe.find_renderer() != "pyvista":
        pytest.skip("this machine has no OpenGL library")
    window = Window((64, 64), (255, 255, 255), oversampling=2)
    corner = np.array([[0.2, 0.2, 0.0], [3.0, 0.2, 0.0], [0.2, 3.0, 0.0]], dtype=np.float32)
    for points in (corner, -corner):
        actor = make_actor(surface(points, np.array([[0, 1, 2]])))
        window.renderer.AddActor(actor)
        window.aim(np.eye(3), np.zeros(3), 1.0, 4.0, 2.0)
        part, (rows, columns) = window.shoot()
        assert part.shape == (rows.stop - rows.start, columns.stop - columns.start, 4)
        # from 0.2 of the half to the edge of a picture that is 32 pixels in the half
        assert (part[..., 3] == 255).sum() == pytest.approx(25.6**2, rel=0.05)
        window.renderer.RemoveActor(actor)
    window.close()


def test_drawing_loads_no_plotting_of_pyvista():
    if probe.find_renderer() != "pyvista":
        pytest.skip("this machine has no OpenGL library")
    # these take longer to load than a dozen pictures to draw
    code = (
        "import sys\n"
        "from dismech_cli.render.probe import draw_triangle\n"
        "draw_triangle()\n"
        "assert 'vtkmodules.vtkRenderingOpenGL2' in sys.modules\n"
        "assert not {'pyvista.plotting', 'matplotlib.pyplot'} & set(sys.modules)\n"
    )
    environment = child.environment()
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
