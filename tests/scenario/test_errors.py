"""Messages: what is wrong, where, and what would be right."""

from __future__ import annotations

import pytest
from scenario_folder import SCENE, TOML, Folder, folder

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.language.numerics import Numerics
from dismech_cli.scenario.load import load, load_text

__all__ = ["folder"]


def _message(folder: Folder, text: str, *overrides: str, profile: str | None = None) -> str:
    with pytest.raises(ScenarioError) as error:
        folder.load(text, *overrides, profile=profile)
    return str(error.value)


def _first(message: str) -> str:
    return message.splitlines()[0]


def test_golden_unknown_key(folder: Folder) -> None:
    assert _message(folder, SCENE.replace("density", "densty")) == (
        "scene.yaml:4:57: materials.silicone.densty: unknown key; did you mean 'density'?\n"
        "  4 |   silicone: {youngs_modulus: 2 MPa, poisson_ratio: 0.5, densty: 1.2 g/cm^3}\n"
        "    |                                                         ^^^^^^"
    )


def test_golden_toml(folder: Folder) -> None:
    folder.write("scene.toml", TOML.replace('"1 mm"', '"1 MPa"'))
    with pytest.raises(ScenarioError) as error:
        load("scene.toml")
    assert str(error.value) == (
        "scene.toml:15:10: geometry[0].radius: expected a length such as '1 m', got a pressure, '1 MPa'\n"
        '  15 | radius = "1 MPa"\n'
        "     |          ^^^^^^^"
    )


def test_golden_override(folder: Folder) -> None:
    assert _message(folder, SCENE, "numerics.dt=-1 ms") == (
        "--set 'numerics.dt=-1 ms': numerics.dt: must be greater than 0, got -1 ms\n"
        "   | numerics.dt=-1 ms\n"
        "   |             ^^^^^"
    )


@pytest.mark.parametrize(
    ("added", "told"),
    [
        ("dt: 1 ms\n", "dt: unknown key here, a key of 'numerics'; known: 'actuation'"),
        (
            "contact: {obstacles: []}\n",
            "contact.obstacles: unknown key here, a key of the scenario itself; known:",
        ),
        (
            "contact: {friction: 0.5}\n",
            "contact.friction: expected a mapping with 'coefficient', 'slip_length'",
        ),
    ],
)
def test_a_key_elsewhere_and_keys_of_a_mapping_are_told(folder: Folder, added: str, told: str) -> None:
    assert told in _first(_message(folder, SCENE + added))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("poisson_ratio: 0.5, ", "", ".poisson_ratio: missing key"),
        (", to: [100 mm, 0, 0]", "", ".generate.to: missing key (last node)"),
        ("from: [0, 0, 0]", "from: 3", ".from: expected a list, got 3 (first node)"),
    ],
)
def test_what_a_key_is_for_is_told(folder: Folder, old: str, new: str, told: str) -> None:
    """Unless its name says as much."""
    assert old in SCENE
    assert _first(_message(folder, SCENE.replace(old, new))).endswith(told)


def test_all_faults_at_once_in_order(folder: Folder) -> None:
    text = SCENE.replace("2 MPa", "2 Mpa").replace("radius: 1 mm", "radius: -1 mm").replace("t_end", "tend")
    lines = [line for line in _message(folder, text).splitlines() if line.startswith("scene")]
    assert lines == [
        "scene.yaml:4:30: materials.silicone.youngs_modulus: "
        "unknown unit 'Mpa' in '2 Mpa'; did you mean 'MPa'?",
        "scene.yaml:9:13: geometry[0].radius: must be greater than 0, got -1 mm",
        "scene.yaml:17:3: numerics.tend: unknown key; did you mean 't_end'?",
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "type: rod",
            "type: rodd",
            "6:11: geometry[0]: expected 'rod', 'shell', got 'rodd'; did you mean 'rod'?",
        ),
        ("density: 1.2 g/cm^3", "", "4:3: materials.silicone.density: missing key"),
        (
            "shape: line",
            "shape: lin",
            "10:23: geometry[0].generate: expected 'line', 'arc', 'helix', 'polyline', ",
        ),
        ("[0, 0, 0]", "[0, 0]", "10:29: geometry[0].generate.from: expected at least 3 items, got 2"),
        (
            "[0, 0, 0]",
            "[0, 0, x]",
            "10:42: geometry[0].generate.from[2]: expected a length such as '1 m', got 'x'",
        ),
        ("nodes: 11", "nodes: 11.5", "10:73: geometry[0].generate.nodes: expected a whole number, got 11.5"),
        ("nodes: 11", "nodes: 1", "10:73: geometry[0].generate.nodes: must be at least 2, got 1"),
        (
            "nodes: 11",
            "nodes: 1000000000000",
            "10:73: geometry[0].generate.nodes: must be at most 10000000, got",
        ),
        (
            "where: beam.start",
            "where: {gruop: beam}",
            "motions[0].where: expected one of group, nodes, edges, box, ",
        ),
        ("where: beam.start", "where: {gruop: beam}", "did you mean 'group'?"),
        (
            "where: beam.start",
            "where: {group: beam, nearest: [0, 0, 0]}",
            "only one of 'group' and 'nearest'",
        ),
        (
            "where: beam.start",
            "where: bean.start",
            "motions[0].where: no rod is named 'bean'; did you mean 'beam'?",
        ),
        (
            "where: beam.start",
            "where: beam.strt",
            "has the groups 'start' and 'end' only, not 'strt'; did you mean",
        ),
        (
            "where: beam.start",
            "where: {nodes: {of: b, indices: [0]}}",
            "motions[0].where.nodes.of: no rod is named",
        ),
        (
            "where: beam.start",
            "where: {nodes: {of: beam}}",
            "expected exactly one of 'indices', 'range'; got none",
        ),
        ("where: beam.start", "where: {nodes: {of: beam, range: [4, 2]}}", "a range goes from first to last"),
        (
            "material: silicone",
            "material: silicon",
            "8:15: geometry[0].material: no material is named 'silicon'; did",
        ),
        ("radius: 1 mm", "section: {type: round, radius: 1 mm}\n    radius: 1", "got 'radius' and 'section'"),
        (
            "radius: 1 mm",
            "section: {type: tube, outer_radius: 1, inner_radius: 2}",
            "the inner radius of a tube",
        ),
        ("type: gravity", "type: gravty", "14:12: forces[0]: expected 'gravity', 'buoyancy', "),
        ("[0, 0, -9.81]", "[0, 0, '-9.81 m']", "expected an acceleration such as '1 m/s^2', got a length"),
        (
            "[0, 0, -9.81]",
            "[0, 0, {expression: 'sn(t)'}]",
            "unknown function 'sn'; did you mean 'sin'? (at column 1",
        ),
        ("[0, 0, -9.81]", "[0, 0, {expression: 's*t'}]", "'s' has no meaning here; known: 't'"),
        (
            "[0, 0, -9.81]",
            "[0, 0, {ramp: {from: 0, to: 1, start: 2, end: 1}}]",
            "a ramp must end after its start",
        ),
        ("[0, 0, -9.81]", "[0, 0, {table: [[0, 1], [0, 2]]}]", "times of a table must increase"),
        (
            "[0, 0, -9.81]",
            "[0, 0, {table: [[0, 1, 2]]}]",
            "table[0]: expected a time and a value, got a list of 3",
        ),
        ("[0, 0, -9.81]", "[0, 0, {table: {file: none.csv}}]", "cannot open 'none.csv': no such file"),
        (
            "[0, 0, -9.81]",
            "[0, 0, {sine: {amplitude: 1, frequency: 1 rad/s}}]",
            "expected a frequency such as '1 Hz'",
        ),
        ("dt: 5 ms", "step: {adaptive: false}", "15:1: numerics.dt: missing key: fixed steps need it"),
        ("dt: 5 ms", "dt: 5 s", "16:7: numerics.dt: longer than the run of 2 s"),
        ("dt: 5 ms", "dt: yes", "16:7: numerics.dt: expected a time such as '1 s', got 'yes'"),
        ("dt: 5 ms", "dt: true", "16:7: numerics.dt: expected a time, got true"),
        (
            "dt: 5 ms",
            "dt: 5 ms\n  integrator: {type: static}",
            "numerics.dt: a static run goes over pseudo-time",
        ),
        (
            "schema_version: 1",
            "schema_version: 2",
            "1:17: schema_version: schema version 2 is newer than this program",
        ),
        (
            "schema_version: 1",
            "schema_version: 0",
            "1:17: schema_version: schema version 0 is no longer read",
        ),
        ("schema_version: 1", "", "2:1: schema_version: missing key"),
        ("schema_version: 1", "schema_version: 1\nplane: xy", "only a scene of dimension 2 has a plane"),
        ("schema_version: 1", "schema_version: 1\nwho: me", "2:1: who: unknown key"),
        ("silicone: {", "bad name: {", "materials.bad name: not a usable name: 'bad name'"),
    ],
)
def test_single_faults(folder: Folder, old: str, new: str, message: str) -> None:
    assert message in _message(folder, SCENE.replace(old, new, 1))


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        ("output: {fields: [position]}", "18:19: output.fields[0]: expected 'positions', 'velocity', "),
        ("output: {fields: [twist, twist]}", "18:10: output.fields: each name at most once"),
        ("output: {render: {color_by: twist}}", "output.render.color_by: needs 'twist' in output.fields"),
        ("output: {render: {plots: [tip]}}", "output.render.plots[0]: no probe is named 'tip'"),
        (
            "dimension: 2\noutput: {fields: [director]}",
            "19:19: output.fields[0]: a planar scene has no material directors",
        ),
        ("output: {every: 3}", "output.every: longer than the run of 2 s"),
        (
            "actuation: [{type: stretch, rod: beam, value: {expression: sqrt(1.89 - t) + s}}]",
            "18:60: actuation[0].value.expression: 'sqrt(1.89 - t) + s' has no finite value at t = 1.9 s",
        ),
        (
            "output: {probes: {p: {negative_eigenvalues: true}}}",
            "eigenvalues are computed in static runs only",
        ),
        (
            "output: {probes: {p: {mean_position: bem, component: x}}}",
            "no rod is named 'bem'; did you mean 'beam'?",
        ),
        ("actuation: [{type: stretch, rod: x, value: 0.1}]", "actuation[0].rod: no rod is named 'x'"),
        (
            "actuation: [{type: twist, rod: beam, value: 3 N}]",
            "expected a twist per length such as '1 rad/m', got a",
        ),
        (
            "joints: [{type: hinge, nodes: [beam.start, beam.end], release: twist}]",
            "joints[0]: 'release' has a meaning with 'where'; two nodes take type: rigid with it",
        ),
        ("joints: [{type: hinge}]", "joints[0]: expected exactly one of 'nodes', 'where'; got none"),
        (
            "initial_velocity: [{where: beam, velocity: [1 m, 0, 0]}]",
            "expected a velocity such as '1 m/s', got a",
        ),
        ("initial_velocity: [{where: beam, velocity: {file: v.csv}}]", "cannot open 'v.csv'"),
        ("dimension: 4", "18:12: dimension: expected 2 or 3, got 4"),
        ("include: base.yaml", "18:10: include: expected a list of files, got 'base.yaml'"),
        ("profiles: {drft: {}}", "profiles.drft: unknown profile; did you mean 'draft'?"),
        ("profiles: {draft: {numerics: {dtt: 1}}}", "18:31: numerics.dtt: unknown key; did you mean 'dt'?"),
        ("profiles: {draft: {include: [x]}}", "profiles.draft.include: has no place in a profile"),
    ],
)
def test_faults_in_added_sections(folder: Folder, extra: str, message: str) -> None:
    assert message in _message(folder, SCENE + extra + "\n")


@pytest.mark.parametrize(
    ("expectation", "message"),
    [
        (
            "probe: {energy: total}, value: 3 mm, tolerance: 1 %",
            "value: expected an energy such as '1 J', got a length",
        ),
        (
            "probe: {energy: total}, reduce: period, value: 3 mm, tolerance: 1 %",
            "expected a time such as '1 s'",
        ),
        (
            "probe: {energy: total}, value: 3, tolerance: 1 mm",
            "tolerance: expected an energy such as '1 J', got a length",
        ),
        (
            "probe: {energy: total}, value: 3, tolerance: -1 %",
            "tolerance: a tolerance must not be negative, got '-1 %'",
        ),
        ("probe: {energy: total}, value: 0, tolerance: 1 %", "relative to the value 0 nothing is allowed"),
        ("probe: {energy: total}, value: 1, tolerance: 1 %, at: 3", "at: after the end of the run at 2 s"),
        (
            "probe: {energy: total}, value: 1, tolerance: 1 %, at: 1, reduce: max",
            "reduce: has no meaning beside 'at'",
        ),
        ("probe: {enrgy: total}, value: 1, tolerance: 1 mm", "got enrgy; did you mean 'energy'?"),
    ],
)
def test_faults_in_expectations(folder: Folder, expectation: str, message: str) -> None:
    assert message in _message(folder, SCENE + f"expect: {{e: {{{expectation}, source: x}}}}\n")


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("numerics.dt", "expected KEY=VALUE such as numerics.dt=5ms"),
        ("numerics.dt=", "expected a value after '='"),
        ("numerics..dt=1", "cannot read the key; write it as numerics.dt or geometry[0].radius"),
        ("[0].a=1", "cannot read the key"),
        ("geometry[3].radius=1", "geometry has no item 3: it holds 1, counted from 0"),
        ("geometry.radius=1", "geometry not a mapping but a list of 1"),
        ("numerics[0]=1", "numerics not a list but a mapping"),
        ("numerics.dt.x=1", "numerics.dt not a mapping but '5 ms'"),
        ("numerics.dt=[1", "not valid YAML"),
        ("numerics.dtt=1", "numerics.dtt: unknown key; did you mean 'dt'?"),
        ("include=[a.yaml]", "'include' belongs to the file and cannot be set here"),
        ("numerics.dt=.nan", "expected a finite number, got .nan"),
    ],
)
def test_faults_in_overrides_point_to_the_argument(folder: Folder, override: str, message: str) -> None:
    text = _message(folder, SCENE, override)
    assert message in _first(text)
    assert text.startswith(f"--set {override!r}: ")
    assert text.splitlines()[1] == f"   | {override}"


def test_caret_of_an_override_stands_under_the_wrong_part(folder: Folder) -> None:
    lines = _message(folder, SCENE, "numerics.integrator={type: newmark, beta: 9}").splitlines()
    assert lines[1].index("9}") == lines[2].index("^")


def test_unknown_profile(folder: Folder) -> None:
    assert _message(folder, SCENE, profile="drft") == (
        "unknown profile 'drft'; did you mean 'draft'? (there are draft, normal, accurate)"
    )


def test_fault_in_an_included_file_names_that_file(folder: Folder) -> None:
    folder.write("base.yaml", "numerics: {newton: {tolerance: 2}}\n")
    message = _message(folder, SCENE + "include: [base.yaml]\n")
    assert _first(message) == "base.yaml:1:32: numerics.newton.tolerance: must be less than 1, got 2"


def test_same_name_twice(folder: Folder) -> None:
    rod = "  - {type: rod, name: beam, material: silicone, radius: 1, mesh: {file: scene.yaml}}\n"
    message = _message(folder, SCENE.replace("motions:", rod + "motions:"))
    assert _first(message) == "scene.yaml:11:23: geometry[1].name: the name 'beam' is taken by another body"


def test_planar_scene_has_no_twist(folder: Folder) -> None:
    text = SCENE.replace(
        "{type: clamp, where: beam.start}", "{type: twist, where: beam.start, angle: 90 deg}"
    )
    assert "motions[0].type: a planar scene has no twist" in _message(folder, text + "dimension: 2\n")


def test_long_lines_are_shown_around_the_fault(folder: Folder) -> None:
    text = SCENE.replace("density: 1.2 g/cm^3}", "density: -1}" + " " * 200 + "# long")
    lines = _message(folder, text).splitlines()
    assert len(lines[1]) < 110
    assert lines[1][lines[2].index("^")] == "-"


def test_control_characters_do_not_reach_the_terminal(folder: Folder) -> None:
    assert "\x1b" not in _message(folder, SCENE.replace("radius: 1 mm", 'radius: "\\e[31m1"'))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "name: arm, ",
            "name: arm, natural: {curvature_1: soft}, ",
            "natural.curvature_1: expected a curvature",
        ),
        (
            "name: arm, ",
            "name: arm, natural: {curvature_1: [1, x]}, ",
            "natural.curvature_1[1]: expected a curv",
        ),
        (
            "END",
            "output: {render: {color_by: velocty}}",
            "output.render.color_by: expected 'none', 'speed', 'vel",
        ),
    ],
)
def test_a_wrong_value_that_may_be_of_several_kinds_is_one_fault(old: str, new: str, expected: str) -> None:
    text = (
        "schema_version: 1\nname: one\n"
        "materials: {m: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}\n"
        "geometry: [{type: rod, name: arm, material: m, radius: 1 mm, generate: "
        "{shape: line, from: [0, 0, 0], to: [0.1, 0, 0], nodes: 3}}]\n"
        "numerics: {dt: 1 ms, t_end: 10 ms}\nEND"
    )
    with pytest.raises(ScenarioError) as error:
        load_text(text.replace(old, new).removesuffix("END"))
    faults = [line for line in str(error.value).splitlines() if line.startswith("<text>")]
    assert len(faults) == 1
    assert expected in faults[0]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("щупальце", "'щ' is none of them: use the letters a to z and A to Z, digits, '_' and '-'"),
        ("café", "'é' is none of them"),
        ("a b", "' ' is none of them"),
        ("x" * 300, "at most 100 characters, got 300"),
    ],
)
def test_what_is_wrong_with_a_name_is_said(name: str, message: str) -> None:
    with pytest.raises(ScenarioError, match="not a usable name") as error:
        load_text(f"schema_version: 1\nname: '{name}'\n")
    assert message in str(error.value)


def test_a_value_inside_the_default_integrator_can_be_set() -> None:
    text = (
        "schema_version: 1\nname: one\n"
        "materials: {m: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}\n"
        "geometry: [{type: rod, name: arm, material: m, radius: 1 mm, generate: "
        "{shape: line, from: [0, 0, 0], to: [0.1, 0, 0], nodes: 3}}]\n"
        "numerics: {dt: 1 ms, t_end: 10 ms}\n"
    )
    assert Numerics.model_fields["integrator"].default.type == "tr_bdf2"
    with pytest.raises(
        ScenarioError, match="spectral_radius: unknown key here: it is one of 'generalized_alpha'"
    ):
        load_text(text, overrides=["numerics.integrator.spectral_radius=0.5"])
    other = ["numerics.integrator.beta=0.3", "numerics.integrator.type=newmark"]
    assert load_text(text, overrides=other).scenario.numerics.integrator.type == "newmark"
    with pytest.raises(ScenarioError, match=r"integrator\.beta: unknown key here: it is one of 'newmark'"):
        load_text(text, overrides=["numerics.integrator.beta=0.3"])
