from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from cli_call import call
from cli_process import environment, swing

from dismech_cli.errors import RenderError
from dismech_cli.scenario.load import load
from dismech_cli.session import gallery

__all__ = ["call", "swing"]


def test_check_shows_plan_and_cost_and_writes_nothing(call, swing):
    before = sorted(swing.rglob("*"))
    done = call("check", "swing.yaml")
    assert done.code == 0, done.stderr
    for text in (
        "swing.yaml: ok",
        "  beam: 10 edges, 0.1 x 0 x 0 m, 0.000377 kg",
        "planar",
        "because: dimension 2",
        "20 free of 24 DOFs",
        "100 steps, 101 frames",
    ):
        assert text in done.stdout
    assert sorted(swing.rglob("*")) == before


def test_check_estimates_the_size_of_the_run_file(call, swing):
    (cost,) = (entry["cost"] for entry in json.loads(call("check", "swing.yaml", "--json").stdout))
    call("run", "swing.yaml", "-o", "out")
    # Chunks round the file up, and the topology comes on top.
    assert 0.5 * (swing / "out" / "run.vtkhdf").stat().st_size < cost["disk"] + 3e5
    assert cost["disk"] < (swing / "out" / "run.vtkhdf").stat().st_size
    assert cost["frames"] == 101


def test_check_of_several_tells_all_and_fails_if_one_is_bad(call, swing):
    (swing / "bad.yaml").write_text((swing / "swing.yaml").read_text().replace("density", "densty"))
    done = call("check", "bad.yaml", "swing.yaml", "--json")
    assert done.code == 2
    bad, good = json.loads(done.stdout)
    assert (bad["ok"], good["ok"]) == (False, True)
    assert "did you mean 'density'" in bad["error"]
    assert "bad.yaml:5" in done.stderr


def test_check_of_many_bodies_is_short_enough_to_read(call, tmp_path):
    (tmp_path / "many.yaml").write_text(
        "schema_version: 1\nname: many\njoints: auto\n"
        "materials: {m: {youngs_modulus: 1 MPa, poisson_ratio: 0.5, density: 1100}}\n"
        "geometry: [{type: rod, name: part_$i, material: m, radius: 1 mm,\n"
        "            repeat: {count: 30, translate: [0.1, 0, 0]},\n"
        "            generate: {shape: line, from: [0, 0, 0], to: [0.1, 0, 0], nodes: 3}}]\n"
        "motions: [{type: clamp, where: part_0.start}]\nnumerics: {integrator: {type: static}}\n"
    )
    told = call("check", tmp_path / "many.yaml").stdout
    assert "  part_19: 2 edges" in told
    assert "  part_20: " not in told
    assert "and 10 more bodies: all are listed by --json" in told
    assert "and 9 more joints: all are listed by --json" in told
    (found,) = json.loads(call("check", tmp_path / "many.yaml", "--json").stdout)
    assert (len(found["bodies"]), len(found["joints"])) == (30, 29)


def test_check_warns_of_what_is_implausible(call, swing):
    done = call("check", "swing.yaml", "--set", "materials.silicone.youngs_modulus=2")
    assert done.code == 0
    assert "warning: " in done.stderr
    assert "softer than jelly" in done.stderr


def test_check_and_run_say_what_was_made_of_a_mesh(call, swing):
    (swing / "sheet.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    (swing / "sheet.yaml").write_text(
        "schema_version: 1\nname: sheet\n"
        "materials: {m: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}\n"
        "geometry: [{type: shell, name: sheet, material: m, thickness: 1 cm, mesh: {file: sheet.obj}}]\n"
        "numerics: {integrator: {type: implicit_euler}, dt: 0.1, t_end: 0.1}\n"
    )
    checked = call("check", "sheet.yaml")
    assert checked.code == 0, checked.stderr
    assert "  sheet: 1 quads split into triangles.\n" in checked.stdout
    run = call("run", "sheet.yaml", "-o", "out")
    assert "sheet: 1 quads split into triangles.\n" in run.stderr


def test_explain_says_who_set_what(call, swing):
    done = call("explain", "swing.yaml", "--set", "numerics.dt=1 ms")
    lines = {line.split()[0]: line for line in done.stdout.splitlines()}
    assert "2000000.0 Pa" in lines["materials.silicone.youngs_modulus"]
    assert lines["materials.silicone.youngs_modulus"].endswith("swing.yaml:5:30")
    assert lines["numerics.dt"].split()[1:3] == ["0.001", "s"]
    assert "--set 'numerics.dt=1 ms'" in lines["numerics.dt"]
    assert lines["numerics.newton.max_iterations"].split()[1:] == ["100", "default"]


def test_explain_one_key_and_what_is_below(call, swing):
    found = json.loads(call("explain", "swing.yaml", "geometry[0].generate", "--json").stdout)
    assert len(found) > 3
    assert all(key.startswith("geometry[0].generate") for key in found)
    assert list(json.loads(call("explain", "swing.yaml", "numerics.dt", "--json").stdout)) == ["numerics.dt"]
    done = call("explain", "swing.yaml", "numerics.td")
    assert done.code == 2
    assert "did you mean" in done.stderr


@pytest.fixture
def ran(call, swing):
    assert call("run", "swing.yaml", "--set", "numerics.t_end=0.01", "-o", "out").code == 0
    return swing / "out"


@pytest.mark.parametrize(
    ("to", "file"), [("vtu", "series.pvd"), ("csv", "nodes.csv"), ("npz", "run.npz"), ("obj", "000000.obj")]
)
def test_export(call, ran, to, file):
    done = call("export", "out", "--to", to)
    assert done.code == 0, done.stderr
    assert str(ran.relative_to(ran.parent) / f"export-{to}" / file) in done.stdout.splitlines()
    assert (ran / f"export-{to}" / file).stat().st_size > 0


def test_exported_numbers_are_those_of_the_run(call, ran):
    call("export", "out", "--to", "npz", "-o", "there")
    with np.load(ran.parent / "there" / "run.npz") as file:
        np.testing.assert_allclose(file["t"], np.arange(6) * 0.002, rtol=1e-12)
        assert file["positions"].shape == (6, 11, 3)


def test_a_moving_body_is_exported(call, ran):
    done = call("export", "out", "--to", "glb", "-o", "there")
    assert done.code == 0, done.stderr
    assert done.stdout == "there/run.glb\n"
    assert (ran.parent / "there" / "run.glb").read_bytes().startswith(b"glTF")


def test_render_makes_a_picture(call, ran, monkeypatch):
    import dismech_cli.render.drawing

    monkeypatch.setattr(dismech_cli.render.drawing, "_PREFERRED", "matplotlib")
    done = call("render", "out", "--format", "png", "--size", "160x120", "--view", "xz", "-o", "end.png")
    assert done.code == 0, done.stderr
    assert done.stdout == "end.png\n"
    assert (ran.parent / "end.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--size", "big"), "WIDTHxHEIGHT"),
        (("--format", "png", "--size", "1x1"), "at least 64"),
        (("--color-by", "mood", "--format", "png"), "output.render.color_by: expected 'none', 'speed'"),
        (("--color-by", "area_strain", "--format", "png"), "is a field of shells"),
        (("-o", "x.png"), "needs --format"),
        (("--times", "0", "--format", "gif"), "--times are of stills"),
        (("--view", "top"), "output.render.view: expected 'auto', 'xy'"),
        (("--speed", "-1"), "output.render.speed: must be greater than 0"),
        (("--times", "0, 2 kg"), "output.render.times[1]"),
        (("--camera", "drone"), "expected 'fixed', 'tracking' or a mapping"),
        (("--camera", "{follow: nobody}"), "no body is named 'nobody'"),
        (("--camera", "{from: [1, 0, 0], to: [1, 0, 0]}"), "must be different points"),
        (("--background", "transparent"), "films cannot be transparent"),
        (("--set", "colors={beam: red}"), "output.render.colors.beam"),
        (("--set", "range=[0, 1]"), "has no meaning without 'color_by'"),
        (("--set", "ghosts=[9 s]"), "after the end of the run"),
        (("--set", "trails=[tail]"), "output.render.trails[0]"),
    ],
)
def test_render_refuses_what_does_not_exist(call, ran, options, message):
    done = call("render", "out", *options)
    assert done.code == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr


@pytest.fixture
def no_renderer(monkeypatch):
    """A machine on which drawing fails and nothing else draws."""
    import dismech_cli.render.drawing

    def fails(*_):
        raise RenderError("no picture can be made on this machine: apt-get install libegl1")

    monkeypatch.setattr(dismech_cli.render.drawing, "_draw_all", fails)
    monkeypatch.setattr(dismech_cli.render.drawing, "find_renderer", fails)


def test_render_without_a_renderer_ends_with_6(call, ran, no_renderer):
    done = call("render", "out", "--format", "png")
    assert done.code == 6
    assert "apt-get install libegl1" in done.stderr


PLOT = ("--set", "output.render={plots: [tip]}")


@pytest.mark.parametrize(
    ("asked", "kinds"),
    [
        ({}, ("mp4",)),
        ({"still": True}, ("png",)),
        ({"video": "gif", "still": True}, ("png", "gif")),
        ({"plots": ["tip"]}, ()),
    ],
)
def test_render_follows_the_scenario(asked, kinds):
    from dismech_cli.scenario.language.render import Render
    from dismech_cli.session.picturing import formats_of

    assert formats_of(Render.model_validate(asked)) == kinds


def test_pictures_of_the_scenario_are_made_after_the_run(call, swing):
    done = call("run", "swing.yaml", "--set", "numerics.t_end=0.01", *PLOT, "-o", "out", "--json")
    assert done.code == 0, done.stderr
    pictures = json.loads(done.stdout)["pictures"]
    assert sorted(path.rpartition("/")[2] for path in pictures) == ["scalars.png"]
    assert all((swing / path).is_file() for path in pictures)


def test_a_run_without_a_renderer_succeeds_with_a_warning(call, swing, no_renderer):
    still = ("--set", "output.render={still: true}")
    done = call("run", "swing.yaml", "--set", "numerics.t_end=0.01", *still, "-o", "out")
    assert done.code == 0, done.stderr
    assert "warning: no pictures: no picture can be made on this machine" in done.stderr
    assert "dismech render out" in done.stderr


def test_init_makes_a_scenario_that_checks(call, tmp_path):
    done = call("init")
    assert done.code == 0, done.stderr
    assert done.stdout.splitlines()[0] == "cantilever.yaml"
    assert done.stdout.splitlines()[-1] == "dismech.schema.json"
    assert call("check", "cantilever.yaml").code == 0
    again = call("init")
    assert again.code == 2
    assert "exists already" in again.stderr
    assert call("init", "--output", "sub/arm.yaml").code == 0
    assert load(tmp_path / "sub" / "arm.yaml").scenario.name == "cantilever"
    assert call("init", "-o", "arm.toml").code == 2
    done = call("init", "cantilver")
    assert done.code == 2
    assert "did you mean 'cantilever'" in done.stderr


def test_init_brings_the_files_that_an_example_names(call, swing, monkeypatch):
    shipped = swing / "shipped"
    (shipped / "data").mkdir(parents=True)
    (shipped / "data" / "g.csv").write_text("0,0\n1,-9.81\n")
    text = (swing / "swing.yaml").read_text()
    (shipped / "base.yaml").write_text(text.replace("-9.81]", "{table: {file: data/g.csv}}]"))
    (shipped / "tilt.yaml").write_text("include: [base.yaml]\nschema_version: 1\nname: tilt\n")
    monkeypatch.setattr(gallery, "folder", lambda: shipped)
    done = call("init", "tilt", "-o", "new/tilt.yaml")
    assert done.code == 0, done.stderr
    assert sorted(done.stdout.split()) == [
        "new/base.yaml",
        "new/data/g.csv",
        "new/dismech.schema.json",
        "new/tilt.yaml",
    ]
    first, second, *_ = (swing / "new" / "tilt.yaml").read_text().splitlines()
    assert first == "# yaml-language-server: $schema=dismech.schema.json"
    assert second == "include: [base.yaml]"
    schema = swing / "new" / "dismech.schema.json"
    written = schema.read_text()
    assert json.loads(written) == json.loads(call("schema").stdout)
    schema.write_text(written.replace("2020-12", "older", 1))
    assert call("init", "tilt", "-o", "new/other.yaml").code == 2  # for the files that it names
    (swing / "new" / "data" / "g.csv").unlink()
    (swing / "new" / "base.yaml").unlink()
    assert call("init", "tilt", "-o", "new/other.yaml").code == 0
    assert schema.read_text() == written
    schema.write_text("{}")
    refused = call("init", "base", "-o", "new/arm.yaml")
    assert refused.code == 2
    assert "dismech.schema.json: exists already" in refused.stderr
    schema.write_text(written)
    assert call("check", "new/tilt.yaml").code == 0


def test_examples_are_listed_with_their_descriptions(call):
    found = json.loads(call("examples", "--json").stdout)
    names = [entry["name"] for entry in found]
    assert "cantilever" in names
    assert names == sorted(names)
    text = call("examples").stdout
    for entry in found:
        assert entry["description"], entry["name"]
        assert f"{entry['name']} " in text


def test_schema_is_json_schema_and_markdown(call):
    schema = json.loads(call("schema").stdout)
    assert schema["properties"]["geometry"]["type"] == "array"
    assert call("schema", "--markdown").stdout.startswith("# Scenario reference")


def test_doctor_tells_what_the_machine_can_do(call):
    facts = json.loads(call("doctor", "--json").stdout)
    assert facts["numpy"] == np.__version__
    for name in (
        "dismech",
        "cores",
        "threads",
        "sparse solver",
        "compiled kernels",
        "pictures",
        "mp4 videos",
        "disk",
    ):
        assert facts[name]


def test_the_module_is_the_program():
    command = [sys.executable, "-m", "dismech_cli", "--version"]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=True)
    assert done.stdout.startswith("dismech ")
