"""Repeated entries: the same scenario as written out, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scenario_folder import SCENE

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import dump_resolved, load_text
from dismech_cli.scenario.text.turning import turn_of_full

ROTATE = "{axis: [0, 0, 1], full: true}"


def arms(repeat: str, shape: str = "{shape: line, from: [1, 0, 0], to: [2, 0, 0.5], nodes: 3}") -> str:
    text = SCENE.replace("name: beam", f"name: beam_$i\n    repeat: {repeat}")
    text = text.replace("{shape: line, from: [0, 0, 0], to: [100 mm, 0, 0], nodes: 11}", shape)
    return text.replace("where: beam.start", "where: beam_$i.start, repeat: 4")


def test_four_arms() -> None:
    scene = load_text(arms(f"{{count: 4, rotate: {ROTATE}}}")).scenario
    assert [body.name for body in scene.geometry] == ["beam_0", "beam_1", "beam_2", "beam_3"]
    ends = [body.generate.end for body in scene.geometry]
    assert ends == [(2.0, 0.0, 0.5), (0.0, 2.0, 0.5), (-2.0, 0.0, 0.5), (0.0, -2.0, 0.5)]
    assert [motion.where.group for motion in scene.motions] == [f"beam_{i}.start" for i in range(4)]


def test_the_same_as_written_out() -> None:
    """So the frames are the same bit by bit."""
    repeated = load_text(arms("{count: 4, rotate: {axis: [1, 2, 3], angle: 20 deg, center: [1, 0, 0]}}"))
    written = load_text(dump_resolved(repeated.scenario))
    assert written.scenario == repeated.scenario
    assert written.text_hash == repeated.text_hash


def test_translate_and_index() -> None:
    text = arms("{count: 4, translate: [0, 5 cm, 0]}").replace("radius: 1 mm", 'radius: "($i + 1)*1 mm"')
    scene = load_text(text).scenario
    assert_allclose([body.generate.start[1] for body in scene.geometry], [0.0, 0.05, 0.1, 0.15])
    assert_allclose([body.radius for body in scene.geometry], [1e-3, 2e-3, 3e-3, 4e-3])


def test_turns_keep_their_symmetry() -> None:
    for count in (3, 4, 7, 12):
        turns = np.array([turn_of_full(i, count) for i in range(count)])
        angles = 2.0 * math.pi * np.arange(count) / count
        assert_allclose(turns, np.column_stack([np.cos(angles), np.sin(angles)]), atol=1e-15)
        assert np.array_equal(turns[1:, 0], turns[:0:-1, 0])
        assert np.array_equal(turns[1:, 1], -turns[:0:-1, 1])


def test_an_arc_turns_with_its_directions() -> None:
    turned = "normal: [0, 1, 0], start: [1, 0, 0]"
    shape = f"{{shape: arc, center: [1, 0, 0], radius: 1, {turned}, angle: 90 deg, nodes: 5}}"
    arc = load_text(arms(f"{{count: 4, rotate: {ROTATE}}}", shape)).scenario.geometry[1].generate
    assert (arc.center, arc.normal, arc.start) == ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def test_probes_and_expectations() -> None:
    probes = "output: {probes: {tip_$i: {repeat: 4, displacement: beam_$i.end, component: z}}}\n"
    scene = load_text(arms("4").replace("from: [1, 0, 0]", "from: [1, $i, 0]") + probes).scenario
    assert list(scene.output.probes) == ["tip_0", "tip_1", "tip_2", "tip_3"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("name: beam_$i", "name: beam", ["geometry[0].name", "write beam_$i"]),
        ("count: 4", "count: 0", ["from 1 to 10000"]),
        ("count: 4", "count: 2.5", ["whole number"]),
        ("count: 4", "cont: 4", ["did you mean 'count'"]),
        ("full: true", "full: true, angle: 3", ["exactly one"]),
        ("full: true", "angle: 3 mm", ["expected an angle"]),
        ("axis: [0, 0, 1]", "axis: [0, 0, 0]", ["must not be zero"]),
        ("repeat: 4", "repeat: {count: 4, translate: [1, 0, 0]}", ["bodies and joints"]),
        ("radius: 1 mm", "radius: $j", ["geometry[0].radius", "unknown parameter $j"]),
        ("radius: 1 mm", "radius: 1 s", ["geometry[0].radius", "a time"]),
        ("radius: 1 mm", "section: {type: rectangular, width: 1 mm, height: 2 mm}", ["'director'"]),
        ("{shape: line,", "{shape: csv, file: a.csv} #", ["cannot be turned or moved"]),
    ],
)
def test_what_is_refused(old: str, new: str, words: list[str]) -> None:
    text = arms(f"{{count: 4, rotate: {ROTATE}}}")
    assert old in text
    with pytest.raises(ScenarioError) as error:
        load_text(text.replace(old, new))
    for word in words:
        assert word in str(error.value), str(error.value)
    # one fault of an entry is told once, whatever the number of copies
    assert str(error.value).count("<text>:") == 1


def test_copies_are_bounded() -> None:
    table = "[" + ", ".join(f"[{k}, 1 mm]" for k in range(100)) + "]"
    text = arms("{count: 9999}").replace("radius: 1 mm", f"radius: {{of: x, table: {table}}}")
    with pytest.raises(ScenarioError, match="more than 100000 values"):
        load_text(text)


def test_entries_are_counted_as_written() -> None:
    text = arms("{count: 4, translate: [0, 1, 0]}") + "masses: []\n"
    extra = "motions:\n  - {type: clamp, where: beam_0.end}\n  - {type: clamp, where: beam_9.end}\n"
    with pytest.raises(ScenarioError, match=r"motions\[1\]"):
        load_text(text.replace("motions:\n", extra))
    with pytest.raises(ScenarioError, match=r"motions\[1\]"):
        load_text(
            text.replace("repeat: 4}", "repeat: 4}\n  - {type: clamp, where: gone.end}"),
        )
