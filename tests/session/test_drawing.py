"""What is drawn of a run: fields that it did not store, runs that did not end, cameras and trails by name."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import dismech_cli
from dismech_cli.errors import OutputError, ScenarioError
from dismech_cli.output.manifest import load_manifest
from dismech_cli.output.read import read
from dismech_cli.output.run_directory import LOG_FILE, SCENARIO_FILE
from dismech_cli.render import movie
from dismech_cli.run.loop import Limits
from dismech_cli.scenario.language.render import Render
from dismech_cli.scenario.load import load
from dismech_cli.session.computing import computed_field
from dismech_cli.session.conduct import Record
from dismech_cli.session.drawing import Wishes, draw, draw_asked
from dismech_cli.session.ending import Ending
from dismech_cli.session.exit_codes import Exit
from dismech_cli.session.narrator import Silent
from dismech_cli.session.picturing import asked_of, settings_of

DECK = """
schema_version: 1
name: drawn
{dimension}
materials: {{m: {{youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}}}
geometry:
  - {{type: rod, name: arm, material: m, radius: 1 mm, bending: {bending},
     generate: {{shape: line, from: [0, 0, 0], to: [0.1, 0, 0], nodes: 6}}}}
  - {{type: rod, name: leg, material: m, radius: 1 mm, bending: {bending},
     generate: {{shape: line, from: [0, 0, -0.05], to: [0.05, 0, -0.05], nodes: 4}}}}
motions: [{{type: clamp, where: arm.start}}, {{type: clamp, where: leg.start}}]
forces: [{{type: gravity, acceleration: [0, 0, -9.81]}}]
numerics: {{dt: 10 ms, t_end: 0.1 s}}
output: {{every: 20 ms, fields: [{fields}], writers: [hdf5], render: {{still: true, size: [64, 64]}}}}
"""


def ran(folder: Path, fields: str = "", *, planar: bool = True, until: float = np.inf) -> Path:
    deck = folder / "deck.yaml"
    dimension, bending = ("dimension: 2", "auto") if planar else ("dimension: 3", "framed")
    deck.write_text(DECK.format(dimension=dimension, bending=bending, fields=fields))
    dismech_cli.simulate(deck, limits=Limits(until=until), out=folder / "run")
    return folder / "run"


PLANAR = ("velocity", "displacement", "curvature", "axial_strain", "axial_force", "bending_moment", "twist")


@pytest.mark.parametrize("name", PLANAR)
def test_a_field_computed_afterwards_is_that_of_the_run(tmp_path: Path, name: str) -> None:
    with read(ran(tmp_path, ", ".join(PLANAR))) as run:
        field = computed_field(run, name, tmp_path / "field.npy")
        values = field.values(run)
        stored = run.field(name)
        assert field.spec == next(spec for spec in run.topology.fields if spec.name == name)
        assert len(values) == len(run) == 6
        for frame in range(6):
            # The same formula on the same numbers.
            assert_allclose(values[frame], stored[frame], rtol=1e-12, atol=1e-12)


def test_what_positions_do_not_tell_is_refused(tmp_path: Path) -> None:
    with read(ran(tmp_path, planar=False)) as run:
        for name in ("velocity", "displacement", "curvature", "axial_strain", "axial_force"):
            values = computed_field(run, name, tmp_path / "field.npy").values(run)
            assert np.isfinite(values[len(run) - 1]).all()
        for name in ("twist", "bending_moment", "director"):
            with pytest.raises(ScenarioError, match=f"'{name}'.*add it to 'output: fields'"):
                computed_field(run, name, tmp_path / "field.npy")
        with pytest.raises(ScenarioError, match="is a field of shells"):
            computed_field(run, "area_strain", tmp_path / "field.npy")


@pytest.fixture
def jobs(monkeypatch):
    """What would be drawn."""
    seen = []

    def nothing(job, plain):
        seen.append(job)
        return (np.zeros((*job.settings.size[::-1], job.channels), dtype=np.uint8) for _ in job.shots)

    monkeypatch.setattr(movie, "draw", nothing)
    return seen


class Heard(Silent):
    """Remembers what is said."""

    def __init__(self) -> None:
        object.__setattr__(self, "lines", [])

    def say(self, text: str) -> None:
        self.lines.append(text)  # type: ignore[attr-defined]


def test_a_run_that_did_not_end_is_drawn_as_far_as_it_goes(tmp_path: Path, jobs) -> None:
    run_dir = ran(tmp_path, until=0.05)
    manifest = load_manifest(run_dir)
    assert manifest.status == "interrupted"
    for status in ("running", "failed"):
        dataclasses.replace(manifest, status=status).save(run_dir)
        (file,) = draw(run_dir, Wishes(color_by="curvature"), Silent())
        assert file.name == "xz-curvature-000002.png"
    assert jobs[0].shots[0].t == pytest.approx(0.04)
    (run_dir / SCENARIO_FILE).unlink()
    with pytest.raises(OutputError, match="it has no scenario"):
        draw(run_dir, Wishes(), Silent())


def test_wishes_go_before_the_scenario(tmp_path: Path, jobs) -> None:
    run_dir = ran(tmp_path)
    heard = Heard()
    wishes = Wishes(
        changes=(
            "times=[0, 40 ms]",
            "layout=panels",
            "trails=[arm.end]",
            "camera={follow: leg}",
            "ghosts=[20 ms]",
        ),
        format="png",
        output=tmp_path / "two.png",
    )
    assert draw(run_dir, wishes, heard) == [tmp_path / "two.png"]
    (job,) = jobs
    assert [shot.lower for shot in job.shots] == [0, 2]
    assert job.settings.trails == (5,)
    assert job.settings.camera.follow == (6, 7, 8, 9)
    assert job.settings.ghosts == (0.02,)
    assert job.settings.camera.view == "xz"
    draw(run_dir, Wishes(format="gif"), heard)
    # 0.1 s is too short to see: a round speed makes some four seconds of it.
    assert {shot.speed for shot in jobs[1].shots} == {0.02}
    assert any("50 times slower" in line for line in heard.lines)  # type: ignore[attr-defined]


def test_times_alone_ask_for_stills(tmp_path: Path, jobs) -> None:
    assert Render(times=(0.04,)).stills
    assert not Render().stills
    run_dir = ran(tmp_path)
    (file,) = draw(run_dir, Wishes(changes=("still=false", "times=[40 ms]")), Silent())
    assert file.name == "xz-000002.png"
    assert [shot.lower for shot in jobs[0].shots] == [2]


def test_cameras_are_placed_as_written(tmp_path: Path) -> None:
    run_dir = ran(tmp_path)
    with read(run_dir) as run:
        loaded = asked_of(
            run_dir, ("camera={from: [1 m, 0, 50 cm], up: [0, 1, 0]}", "colors={leg: '#010203'}")
        )
        settings = settings_of(loaded, run, None)
        assert settings.camera.eye == (1.0, 0.0, 0.5)
        assert settings.camera.up == (0.0, 1.0, 0.0)
        assert settings.camera.angle == pytest.approx(np.pi / 6)
        assert settings.colors == {1: (1, 2, 3)}
        still = settings_of(asked_of(run_dir, ("camera=fixed", "view=iso")), run, None)
        assert (still.camera.view, still.camera.follow, still.camera.angle) == ("iso", None, 0.0)
        tracked = settings_of(asked_of(run_dir, ("camera=tracking", "size=[65, 64]")), run, None)
        assert tracked.camera.follow == ()
        assert_array_equal(tracked.size, (66, 64))


def test_whoever_stops_the_drawing_is_told_how_to_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*asked: object, **named: object) -> None:
        raise KeyboardInterrupt

    run_dir = ran(tmp_path)
    record = Record(run_dir=run_dir, manifest=load_manifest(run_dir), ending=Ending(Exit.DONE, ""))
    monkeypatch.setattr("dismech_cli.session.drawing.render", stopped)
    with pytest.raises(KeyboardInterrupt):
        draw_asked(record, load(run_dir / SCENARIO_FILE), Silent())
    assert f"no pictures; later: dismech render {run_dir}" in (run_dir / LOG_FILE).read_text()
