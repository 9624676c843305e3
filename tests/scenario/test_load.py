"""Loading: precedence, overrides, includes, profiles, origins, round trip."""

from __future__ import annotations

from time import perf_counter

import pytest
from numpy.testing import assert_allclose
from scenario_folder import SCENE, TOML, Folder, folder

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import dump_resolved, load

__all__ = ["folder"]


def test_values_are_si(folder: Folder) -> None:
    scene = folder.load().scenario
    assert_allclose(scene.materials["silicone"].youngs_modulus, 2e6)
    assert_allclose(scene.materials["silicone"].density, 1200.0, rtol=4e-16)
    assert scene.numerics.dt == 0.005
    assert scene.geometry[0].cross_section.type == "round"
    assert scene.numerics.integrator.type == "tr_bdf2"
    assert scene.output.fields == ("velocity",)


def test_plain_file_loads_fast(folder: Folder) -> None:
    folder.load()
    start = perf_counter()
    load("scene.yaml")
    assert perf_counter() - start < 0.15


def test_precedence(folder: Folder) -> None:
    folder.write("base.yaml", "numerics: {dt: 1 ms, t_end: 9 s, linear_solver: dense, kernels: numpy}\n")
    text = SCENE + "  linear_solver: banded\ninclude: [base.yaml]\n"
    plain = folder.load(text)
    assert plain.scenario.numerics.dt == 0.005  # the file over the include
    assert plain.scenario.numerics.kernels == "numpy"  # the include over the default
    draft = folder.load(text, profile="draft")
    assert draft.scenario.numerics.dt == 0.02  # the profile over the file
    last = folder.load(text, "numerics.dt=3 ms", profile="draft")
    assert last.scenario.numerics.dt == 0.003  # --set over the profile
    assert last.scenario.numerics.newton.tolerance == 1e-5


def test_built_in_profiles(folder: Folder) -> None:
    text = SCENE + "  newton: {tolerance: 1e-7, max_iterations: 7}\n"
    for profile, dt, tolerance in (
        (None, 5e-3, 1e-7),
        ("normal", 5e-3, 1e-7),
        ("draft", 2e-2, 1e-5),
        ("accurate", 1.25e-3, 1e-10),
    ):
        numerics = folder.load(text, profile=profile).scenario.numerics
        assert (numerics.dt, numerics.newton.tolerance) == (dt, tolerance)
        assert numerics.newton.max_iterations == 7


def test_declared_profile_replaces_the_built_in_one(folder: Folder) -> None:
    text = SCENE + "profiles: {draft: {numerics: {t_end: 1 s}}}\n"
    numerics = folder.load(text, profile="draft").scenario.numerics
    assert (numerics.dt, numerics.t_end, numerics.newton.tolerance) == (5e-3, 1.0, None)
    assert folder.load(text).scenario.numerics.t_end == 2.0


def test_profile_of_a_static_scene_changes_the_tolerance_only(folder: Folder) -> None:
    text = SCENE.replace("  dt: 5 ms\n  t_end: 2 s\n", "  integrator: {type: static}\n")
    numerics = folder.load(text, profile="accurate").scenario.numerics
    assert (numerics.dt, numerics.newton.tolerance) == (None, 1e-10)


def test_includes_merge_deeply_and_lists_replace(folder: Folder) -> None:
    folder.write(
        "a.yaml", "numerics: {dt: 1, newton: {max_iterations: 3}}\nforces: []\ninclude: [sub/b.toml]\n"
    )
    folder.write("sub/b.toml", "description = 'from b'\nnumerics.newton.max_iterations = 4\n")
    loaded = folder.load(SCENE + "include: [a.yaml]\n")
    assert loaded.scenario.numerics.newton.max_iterations == 3
    assert loaded.scenario.description == "from b"
    assert len(loaded.scenario.forces) == 1
    assert loaded.provenance["description"].origin == "sub/b.toml:1:15 (include)"


def test_another_type_replaces_the_whole_mapping(folder: Folder) -> None:
    folder.write("base.yaml", "numerics: {integrator: {type: newmark, beta: 0.3}}\n")
    text = SCENE + "  integrator: {type: implicit_euler}\ninclude: [base.yaml]\n"
    assert folder.load(text).scenario.numerics.integrator.type == "implicit_euler"


@pytest.mark.parametrize(
    ("override", "path", "value"),
    [
        ("numerics.dt=1ms", "numerics.dt", 1e-3),
        ("geometry[0].radius=2 mm", "geometry[0].radius", 2e-3),
        ("geometry[0].generate.to[2]=0.5", "geometry[0].generate.to[2]", 0.5),
        ("numerics.newton.max_iterations=5", "numerics.newton.max_iterations", 5),
        ("numerics.integrator={type: newmark, beta: 0.3}", "numerics.integrator.beta", 0.3),
        ("name=no", "name", "no"),
    ],
)
def test_overrides(folder: Folder, override: str, path: str, value: object) -> None:
    loaded = folder.load(SCENE, override)
    assert loaded.provenance[path].value == value
    assert loaded.provenance[path].origin == f"--set {override!r}"


def test_provenance_names_value_unit_and_origin(folder: Folder) -> None:
    loaded = folder.load(SCENE, profile="draft")
    origin = loaded.provenance
    assert (origin["geometry[0].radius"].unit, origin["geometry[0].radius"].origin) == (
        "m",
        "scene.yaml:9:13",
    )
    assert origin["motions[0].where.group"].origin == "scene.yaml:12:26"
    assert origin["numerics.dt"].origin == "scene.yaml:16:7 (profile draft, dt x 4)"
    assert origin["numerics.newton.tolerance"].origin == "profile draft"
    assert origin["numerics.newton.max_iterations"].origin == "default"
    assert origin["forces[0].acceleration[2]"].unit == "m/s^2"


def test_units_inside_laws_are_those_of_the_field(folder: Folder) -> None:
    laws = (
        "[{sine: {amplitude: 1 mm, frequency: 2 Hz}}, {table: [[0, 0], [1 s, 5 mm]]}, "
        "{ramp: {from: 0, to: 1 cm, end: 1}}]"
    )
    loaded = folder.load(SCENE.replace("where: beam.start}", f"where: beam.start, displacement: {laws}}}"))
    unit = {path: part.unit for path, part in loaded.provenance.items()}
    assert unit["motions[0].displacement[0].sine.amplitude"] == "m"
    assert unit["motions[0].displacement[0].sine.frequency"] == "Hz"
    assert unit["motions[0].displacement[1].table[1][0]"] == "s"
    assert unit["motions[0].displacement[1].table[1][1]"] == "m"
    assert unit["motions[0].displacement[2].ramp.to"] == "m"


def test_locate_and_error_point_to_the_key(folder: Folder) -> None:
    loaded = folder.load()
    assert loaded.locate("numerics.dt") == "scene.yaml:16:7"
    assert loaded.locate("geometry[0].generate.nodes") == "scene.yaml:10:73"
    assert loaded.excerpt("numerics.dt") == "  16 |   dt: 5 ms\n     |       ^^^^"
    assert str(loaded.error(("geometry", 0, "radius"), "too thin")) == (
        "scene.yaml:9:13: geometry[0].radius: too thin\n  9 |     radius: 1 mm\n    |             ^^^^"
    )
    assert isinstance(loaded.error("numerics.dt", "x"), ScenarioError)


def test_hash_is_that_of_the_meaning(folder: Folder) -> None:
    same = folder.load(SCENE.replace("2 MPa", "2.0e+6").replace("5 ms", "0.005 s"))
    other = folder.load(SCENE.replace("2 MPa", "3 MPa"))
    plain = folder.load()
    assert plain.text_hash == same.text_hash != other.text_hash
    assert len(plain.text_hash) == 64


def test_toml_and_yaml_mean_the_same(folder: Folder) -> None:
    folder.write("scene.toml", TOML)
    loaded = load("scene.toml")
    assert loaded.text_hash == folder.load(SCENE.replace("1.2 g/cm^3", "1200")).text_hash
    assert loaded.locate("geometry[0].generate.nodes") == "scene.toml:16:74"
    assert loaded.locate("forces[0].acceleration[2]") == "scene.toml:26:3"
    assert loaded.locate("materials.silicone.density") == "scene.toml:9:11"
    assert loaded.locate("numerics.dt") == "scene.toml:3:15"


RICH = (
    SCENE
    + """\
  integrator: {type: static, load_steps: 5}
dimension: 2
plane: xy
description: "2e6"
joints: [{type: hinge, where: {nodes: {of: beam, indices: [3]}}}]
actuation:
  - {type: curvature_1, rod: beam, joints: [0, 4], value: {expression: "0.1*sin(2*pi*t + s)"}}
output:
  every: 0.1
  probes:
    tip: {displacement: {nearest: [0.1, 0, 0]}, component: z}
    gap: {distance: [beam.start, {box: {min: [0, 0, 0], max: [1, 1, 1]}}]}
  render: {plots: [tip]}
expect:
  tip: {probe: {displacement: beam.end, component: z}, value: -84.95 mm, tolerance: 7 %, source: "yes"}
  early: {probe: {displacement: beam.end, component: z}, at: 0.5, value: 0, tolerance: 1, source: theory}
  stable: {probe: {negative_eigenvalues: true}, value: 0, tolerance: 0.5, source: theory}
"""
).replace("  dt: 5 ms\n  t_end: 2 s\n", "")


@pytest.mark.parametrize("text", [SCENE, RICH], ids=["plain", "rich"])
def test_resolved_scenario_reads_back_equal(folder: Folder, text: str) -> None:
    first = folder.load(text)
    again = folder.load(dump_resolved(first.scenario))
    assert again.scenario == first.scenario
    assert again.text_hash == first.text_hash
    assert dump_resolved(again.scenario) == dump_resolved(first.scenario)


def test_tolerances(folder: Folder) -> None:
    expect = folder.load(RICH).scenario.expect
    relative, absolute = expect["tip"].tolerance, expect["stable"].tolerance
    assert (relative.kind, relative.size) == ("relative", 0.07)
    assert (absolute.kind, absolute.size) == ("absolute", 0.5)
    assert relative.allows(-0.0905, -0.08495)
    assert not relative.allows(-0.0915, -0.08495)
    assert not absolute.allows(float("nan"), 0.0)


def test_plausibility_warnings(folder: Folder) -> None:
    text = SCENE.replace("2 MPa", "2").replace("1.2 g/cm^3", "1.2").replace("radius: 1 mm", "radius: 20 mm")
    warnings = folder.load(text.replace("-9.81", "-981")).warnings
    assert warnings == (
        "scene.yaml:4:30: materials.silicone.youngs_modulus: "
        "E = 2 Pa: softer than jelly; did you mean 2 MPa?",
        "scene.yaml:4:62: materials.silicone.density: "
        "density 1.2 kg/m^3: light as foam; did you mean 1.2 g/cm^3?",
        "scene.yaml:9:13: geometry[0].radius: thickness 0.04 m on a length of 0.1 m: too stout for a rod",
        "scene.yaml:14:21: forces[0].acceleration: gravity of 981 m/s^2 is stronger than that of the sun",
    )
    assert folder.load().warnings == ()
