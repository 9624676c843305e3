"""Inputs that users brought and that once ended in a traceback, in silence or in a wrong number.

What `check` tells of each is in the table here; what takes a run is tested where its room is tested.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from pathlib import Path

import pytest
from cli_call import call
from cli_process import Done

from dismech_cli.compose import sizes
from dismech_cli.session.simulate import simulate

__all__ = ["call"]

TESTS = Path(__file__).parent
CASES = TESTS / "data" / "cases"

# What `check` says on stderr, with the place, and exit code 2.
REFUSED = {
    "hash_in_name/scene.yaml": "scene.yaml:5:32: motions[0].where: no group 's.Material'; did you mean 's.",
    "gmsh_40/scene.yaml": "g.msh:2: gmsh format 4; expected 2.2 or 4.1: 'gmsh FILE -save -format msh41",
    "unwelded/scene.yaml": "u.obj:5: node 5 is at the same place as node 2; merge them ('weld' does so)",
    "git_lfs_pointer/scene.yaml": "l.msh:1: a Git LFS pointer stands in place of the file; fetch it",
    "tetrahedra/scene.yaml": "t.msh:17: a solid element (gmsh type 4, tetrahedron); rods and shells need",
    "unit_hints/scene.yaml": "scene.yaml:3:33: materials.m.youngs_modulus: unknown unit 'mpa' in '1 mpa';",
    "set_inside_default_integrator/scene.yaml": "numerics.integrator.spectral_radius: unknown key here: it",
    "comma_decimals/scene.yaml": "scene.yaml:3:55: materials.m.poisson_ratio: a comma parts keys; write 0.",
    "names/scene.yaml": "scene.yaml:2:7: name: not a usable name: 'щупальце'; 'щ' is none of them: use the",
    "sizes_before_allocation/dt_denormal.yaml": ":10:16: numerics.dt: too small to compute with: 5e-324",
    "sizes_before_allocation/hang_a.yaml": ":6:70: geometry[0].generate: sheet: 5.72e+05 triangles;",
    "sizes_before_allocation/range_2e62.yaml": ":8:25: motions[0].where: node 4611686018427387904 of 'arm'",
    "sizes_before_allocation/range_int64_max.toml": ":10:36: expect.height.probe.displacement: node 922337",
    "sizes_before_allocation/steps_1e12.yaml": ":10:16: numerics.dt: 1e+12 steps to the end of the run",
    "sizes_before_allocation/steps_2e8.yaml": ":10:16: numerics.dt: 2e+08 steps to the end of the run",
    "overflow/every_denormal.yaml": ":11:17: output.every: too small to compute with: 1e-320",
    "overflow/given_radius.yaml": ":6:221: geometry[0].section.radius: too large to compute with: 1e+200",
    "overflow/plausibility_overflow.yaml": ":7:244: geometry[0].section.radius: too large to compute with",
    "overflow/quoted_merge_key.yaml": ":12:1: <<: unknown key; known: 'actuation'",
    "overflow/radius_1e80.yaml": ":6:56: geometry[0].radius: too large to compute with: 1e+80",
    "overflow/thickness_1e120.yaml": ":5:63: geometry[0].thickness: too large to compute with: 1e+120",
    "overflow/tube_1e80.yaml": ":6:84: geometry[0].section.outer_radius: too large to compute with",
    "overflow/unit_overflow.yaml": ":10:16: numerics.dt: the unit of '1 ((Ts^9)^9)^9' is too large or too",
    "overflow/unit_zero_division.yaml": ":10:16: numerics.dt: the unit of '1 1/((nHz^9)^9)' is too large o",
    "colour_typo/color_by_typo.yaml": ":11:29: output.render.color_by: expected 'none', 'speed', 'velocity",
}
# What `check` says on stdout, with exit code 0.
TAKEN = {
    "dotted_group/scene.yaml": "s: 4 triangles",
    "csv_header/scene.yaml": "r: 2 edges, 0.2 x 0 x 0.01 m",
    "csv_header/header_curve.yaml": "b: 2 edges, 1 x 0 x 0 m",
    "csv_header/header_curve_named.yaml": "b: 2 edges, 1 x 0 x 0 m",
    "csv_blanks_semicolons/scene.yaml": "r: 2 edges, 0.2 x 0 x 0.01 m",
    "fold_back/scene.yaml": "r: 2 edges, 0.05 x 0 x 0 m",
    "old_dismech_text/scene.yaml": "s: 1 triangles, 0.1 x 0.1 x 0 m",
    "other_half_unused/scene.yaml": "u.obj: 2 lines are in no body",
    "cr_line_ends/scene.yaml": "s: 2 triangles, 0.1 x 0.1 x 0 m",
    "utf16/scene.yaml": "s: 1 triangles, 0.1 x 0.1 x 0 m",
    "inward_shell/scene.yaml": "s: Normals of the closed surface point inward",
    "2d_obj/scene.yaml": "s: The nodes have two coordinates; z = 0.",
}
# What takes a run or a mesh of its own: the tests of each.
ELSEWHERE = {
    "draft profile blows up": ("extremes/test_defaults.py", "test_it_finishes_without_energy_from_nowhere"),
    "default integrator blows up": (
        "extremes/test_defaults.py",
        "test_it_finishes_without_energy_from_nowhere",
    ),
    "kirigami slit": ("mesh/test_validate.py", "test_nodes_are_told_apart_where_their_projections_coincide"),
    "t fin": ("compose/test_seams.py", "test_a_welded_fin_turns_as_the_frame_of_beams_does"),
    "joint beside shell": ("compose/test_joints.py", "test_a_rigid_joint_counts_beside_a_shell"),
    "actuation skips welds": ("verification/test_welds.py", "test_two_halves_are_one_rod"),
    "hinged crossing counts as curved": (
        "compose/test_joints.py",
        "test_a_hinged_crossing_of_straight_rods_is_not_curved",
    ),
    "straight column never buckles": ("run/test_unstable.py", "test_a_straight_column_beyond_eulers_load"),
    "large stretch": ("run/test_validity.py", "test_a_membrane_out_of_its_strains"),
    "resume cannot go on": (
        "session/test_resume_changed.py",
        "test_a_finished_run_gets_a_later_end_bit_by_bit",
    ),
    "crushed past itself": ("test_cases.py", "test_a_crushed_sheet_gives_up_in_time"),
    "shell converges without moving": ("extremes/test_slender_statics.py", "test_slender_plates"),
    "unstable column": ("run/test_unstable.py", "test_a_straight_column_beyond_eulers_load"),
    "stability probe singular": (
        "run/test_singular_probe.py",
        "test_it_is_nan_with_one_warning_that_says_where_and_when",
    ),
    "false energy alarm": ("extremes/test_extremes_cases.py", "test_nothing_moves_without_forces"),
    "infinite frame": ("run/test_runaway.py", "test_a_frame_without_finite_energies_is_never_written"),
    "twist softens bending": (
        "verification/test_twisted_bending.py",
        "test_a_round_cantilever_bends_alike_at_any_natural_twist",
    ),
    "driven end": ("verification/test_driven_column.py", "test_it_buckles_into_the_elastica"),
    "joints first order": ("verification/test_corners.py", "test_work_converges_to_that_of_beams"),
}


def _check(call: Callable[..., Done], case: str) -> Done:
    more = ("--set", "numerics.integrator.spectral_radius=0.5") if "default_integrator" in case else ()
    return call("check", CASES / case, *more)


@pytest.mark.parametrize("case", REFUSED)
def test_it_is_refused_with_its_place(
    call: Callable[..., Done], monkeypatch: pytest.MonkeyPatch, case: str
) -> None:
    monkeypatch.setattr(sizes, "machine_memory", lambda: 1e9)
    done = _check(call, case)
    assert done.code == 2
    first = done.stderr.splitlines()[0]
    assert REFUSED[case] in first, first
    assert not done.stdout


@pytest.mark.parametrize("case", TAKEN)
def test_it_is_taken_for_what_it_is(call: Callable[..., Done], case: str) -> None:
    done = _check(call, case)
    assert done.code == 0, done.stderr
    assert any(line.lstrip().startswith(TAKEN[case]) for line in done.stdout.splitlines()), done.stdout


def test_a_crushed_sheet_gives_up_in_time() -> None:
    scene = CASES / "crushed_past_itself" / "scene.yaml"
    report = simulate(scene, overrides=["numerics.newton.max_iterations=20", "numerics.step.max_cuts=1"])
    assert report.exit == 3
    assert "gave up" in report.message


@pytest.mark.parametrize("case", ELSEWHERE)
def test_what_takes_a_run_is_tested_where_its_room_is(case: str) -> None:
    file, name = ELSEWHERE[case]
    tree = ast.parse((TESTS / file).read_text(encoding="utf-8"))
    assert any(isinstance(node, ast.FunctionDef) and node.name == name for node in tree.body)


def test_every_input_is_looked_at() -> None:
    found = {str(file.relative_to(CASES)) for file in CASES.glob("*/*.[yt][ao]ml")}
    assert found == {*REFUSED, *TAKEN, "crushed_past_itself/scene.yaml"}
