"""Published shell problems: the shipped scenarios on other meshes, materials and thresholds.

Bars and references are those of `scenarios/verification/`; `test_shipped.py` runs these files as they are.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli import load, simulate
from dismech_cli.mesh.generate.rings import disc
from dismech_cli.run.loop import End
from dismech_cli.run.observables.reduce import reduce_series

FOLDER = Path(__file__).parents[2] / "scenarios"
PATTERNS = ["equilateral", "right", "alternating", "unstructured"]


def measured(file: Path, *overrides: str) -> dict[str, tuple[float, float]]:
    """What each expectation of a scenario measures, and what it expects."""
    loaded = load(file, overrides=overrides)
    outcome = simulate(loaded).outcome
    assert outcome.end is End.DONE, outcome.message
    return {
        name: (reduce_series(outcome.times, outcome.watched[name], e.reduce, at=e.at, after=e.after), e.value)
        for name, e in loaded.scenario.expect.items()
    }


def mesh(divisions: int, pattern: str) -> tuple[str, str]:
    generate = "geometry[0].generate"
    return f"{generate}.divisions={divisions}", f"{generate}.pattern={pattern}"


def ratios(name: str, *overrides: str) -> np.ndarray:
    """Measured over expected values of a scenario of `verification/`."""
    pairs = measured(FOLDER / "verification" / f"{name}.yaml", *overrides)
    return np.array([value / expected for value, expected in pairs.values()])


# Cantilever plates


@pytest.mark.parametrize("pattern", PATTERNS)
def test_wide_cantilever(pattern: str) -> None:
    """Bends to a cylinder: within 1.2 / n^2 of plate theory, 0.3 % as shipped, and of second order."""
    (coarse, _), (fine, force) = (ratios("wide_cantilever", *mesh(n, pattern)) - 1.0 for n in (10, 20))
    assert 0.0 < fine < 1.2 / 20**2
    # Rows of equilateral triangles are rounded to whole ones, and random triangles scatter.
    assert_allclose(np.log2(coarse / fine), 2.0, atol=0.1)
    assert abs(force) < 1e-8


@pytest.mark.parametrize("pattern", PATTERNS)
def test_narrow_cantilever(pattern: str) -> None:
    """A beam to 1 %, by which the clamp stiffens it: it hinders the Poisson strain of the root."""
    lift, force = ratios("narrow_cantilever", *mesh(40, pattern)) - 1.0
    assert -0.01 < lift < 0.0
    assert abs(force) < 1e-8


# Curved shells, linear


@pytest.mark.parametrize("pattern", PATTERNS)
def test_roof(pattern: str) -> None:
    """Scordelis-Lo roof: 2 % at 32 divisions, of second order from 16 on."""
    coarse, fine = (abs(ratios("scordelis_lo_roof", *mesh(n, pattern)) - 1.0).item() for n in (16, 32))
    assert fine < 0.02
    # The reference is a limit of refinement known to about 0.1 %: orders are seen above it only.
    assert fine < coarse / 4.0 + 2e-3


@pytest.mark.parametrize("pattern", PATTERNS)
def test_pinched_cylinder(pattern: str) -> None:
    """Pinched cylinder: 10 % at 32 divisions; the dent of a point load converges slowly, from too soft."""
    coarse, fine = (ratios("pinched_cylinder", *mesh(n, pattern)).item() - 1.0 for n in (16, 32))
    assert 0.0 < fine < 0.10
    # Linear triangles promise first order where the solution is singular.
    assert fine < coarse / 2.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("divisions", "pattern"), [*((64, pattern) for pattern in PATTERNS), (128, "alternating")]
)
def test_pinched_cylinder_converges_further(divisions: int, pattern: str) -> None:
    meshes = (divisions // 2, divisions)
    coarse, fine = (ratios("pinched_cylinder", *mesh(n, pattern)).item() - 1.0 for n in meshes)
    assert 0.0 < fine < coarse / 2.0


@pytest.mark.parametrize("pattern", PATTERNS)
def test_hemisphere_answers_linearly(pattern: str) -> None:
    """Hemisphere with a hole, almost without stretching: 3 % of 0.093 and 0.094 alike."""
    for ratio in ratios("hemisphere_linear", *mesh(16, pattern)):
        assert_allclose(ratio * 0.093, [0.093, 0.094], rtol=0.03)


# Large displacements


def test_hemisphere_on_a_coarse_mesh() -> None:
    assert_allclose(ratios("hemisphere", *mesh(16, "alternating")), 1.0, rtol=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("pattern", PATTERNS)
def test_hemisphere(pattern: str) -> None:
    """Hemisphere with a hole under forces of 400: 2 % on any mesh of 32 divisions."""
    assert_allclose(ratios("hemisphere", *mesh(32, pattern)), 1.0, rtol=0.02)


@pytest.mark.parametrize(
    ("divisions", "pattern", "tolerance"),
    [
        (16, "alternating", 0.01),
        (16, "unstructured", 0.02),
        pytest.param(32, "equilateral", 0.01, marks=pytest.mark.slow),
        pytest.param(32, "right", 0.01, marks=pytest.mark.slow),
        pytest.param(32, "unstructured", 0.02, marks=pytest.mark.slow),
    ],
)
def test_strip_under_end_shear(divisions: int, pattern: str, tolerance: float) -> None:
    """Sze, Liu & Lo's cantilever: every point of both curves, on regular and random triangles."""
    assert_allclose(ratios("strip_end_shear", *mesh(divisions, pattern)), 1.0, rtol=tolerance)


@pytest.mark.parametrize(
    ("divisions", "pattern"),
    [
        (100, "right"),
        (100, "unstructured"),
        *(pytest.param(100, p, marks=pytest.mark.slow) for p in ("equilateral", "alternating")),
        *(pytest.param(200, p, marks=pytest.mark.slow) for p in PATTERNS),
    ],
)
def test_heavy_strip(divisions: int, pattern: str) -> None:
    """A strip that hangs under weights of 1 to 1000: 1 % of drop, reach and their ratio, on any triangles.

    It bends within L / Gamma^(1/3) of the clamp: an error of second order goes with Gamma^(2/3).
    """
    found = ratios("heavy_strip", *mesh(divisions, pattern)).reshape(7, 2)
    drop, reach = found.T
    weights = np.array([1.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0])
    errors = np.abs(np.stack((drop, reach, drop / reach)) - 1.0)
    assert (errors < 0.01).all(), errors
    assert (errors < (1.0 + weights ** (2.0 / 3.0)) / divisions**2).all(), errors


@pytest.mark.parametrize("factor", [2.0, 1e3])
@pytest.mark.parametrize("bending", ["midedge", "hinge"])
def test_shape_knows_the_ratio_of_load_and_stiffness_only(bending: str, factor: float) -> None:
    """Twice the modulus under twice the weight: the same shape, to what Newton leaves."""

    def shape(factor: float) -> list[float]:
        probe = (
            "{{probe: {{displacement: strip.right, component: {}}}, value: 0, tolerance: 1, source: none}}"
        )
        pairs = measured(
            FOLDER / "verification" / "heavy_strip.yaml",
            *mesh(30, "unstructured"),
            "geometry[0].generate.width=0.1",
            f"geometry[0].bending={bending}",
            # two rows of nodes, for hinges
            "motions[0].where={box: {min: [-1, -1, -1], max: [0.08, 1, 1]}}",
            f"materials.sheet={{youngs_modulus: {12e6 * factor}, poisson_ratio: 0.3, density: 1000}}",
            f"forces[0].acceleration=[0, 0, {-0.01 * factor}]",
            "numerics.integrator.load_steps=2",
            f"expect={{x: {probe.format('x')}, z: {probe.format('z')}}}",
        )
        return [value for value, _ in pairs.values()]

    assert_allclose(shape(factor), shape(1.0), rtol=1e-7)


@pytest.mark.slow
def test_roll_up_converges_at_second_order() -> None:
    """The strip closes on every mesh; half way its distance across is that of a circle to second order."""
    file = FOLDER / "verification" / "strip_roll_up.yaml"
    errors = []
    for divisions in (18, 36):
        pairs = measured(file, *mesh(divisions, "alternating"))
        assert_allclose([pairs["closed_x"][0], pairs["closed_z"][0]], 0.0, atol=1e-7 * 12.0)
        errors.append(pairs["half_z"][0] - pairs["half_z"][1])
    assert_allclose(np.log2(errors[0] / errors[1]), 2.0, atol=0.1)


@pytest.mark.slow
def test_hinges_are_no_material_for_a_strip() -> None:
    """Between equilateral triangles they are a plate of Poisson's ratio -1/3: a strip bends 9/8 of a beam.

    Nodes are held up to the root, so that it begins to bend half a triangle behind. The clamp hinders the
    root's Poisson strain over about half a width, which stiffens by a fifth of the width over the length.
    """
    divisions = 160
    h = 1.0 / divisions
    pairs = measured(
        FOLDER / "verification" / "heavy_strip.yaml",
        f"geometry[0].generate.divisions={divisions + 1}",
        "geometry[0].generate.pattern=equilateral",
        f"geometry[0].generate.length={1.0 + h}",
        f"geometry[0].generate.width={10.0 * h * np.sqrt(0.75)}",  # ten rows, exactly equilateral
        f"geometry[0].generate.origin=[{-h}, 0, 0]",
        "geometry[0].bending=hinge",
        f"motions[0].where={{box: {{min: [-1, -1, -1], max: [{1e-3 * h}, 1, 1]}}}}",
        # so small a weight that a beam droops Gamma L / 8
        "forces[0].acceleration=[0, 0, -1.0e-5]",
        "numerics.integrator.load_steps=1",
        "expect={drop: {probe: {displacement: strip.right, component: z}, value: -0.00125, "
        "tolerance: 1, source: beam}}",
    )
    value, beam = pairs["drop"]
    assert_allclose(value / beam, 9.0 / 8.0 * (1.0 + 0.5 * h) ** 4, rtol=0.02)


@pytest.mark.slow
def test_hinges_are_no_material_for_a_hemisphere() -> None:
    """A hemisphere of hinges is too stiff by a known factor.

    Without stretching, curvature grows along one direction as it falls along the other, at the cost
    D (1 - nu) k^2: in E h^3 / 12 this is 1 / (1 + nu) for the material and 4/3 for hinges. Hinges need
    the whole hemisphere: without edge normals there is no plane of symmetry.
    """

    def at(x: int, y: int) -> str:
        return f"where: {{nearest: [{x}, {y}, 0]}}"

    held = ((10, 0, "[y, z]"), (-10, 0, "[y, z]"), (0, 10, "[x, z]"))
    pulled = ((10, 0, "[2.0e-3, 0, 0]"), (-10, 0, "[-2.0e-3, 0, 0]"))
    pushed = ((0, 10, "[0, -2.0e-3, 0]"), (0, -10, "[0, 2.0e-3, 0]"))
    motions = ", ".join(f"{{type: pin, {at(x, y)}, components: {axes}}}" for x, y, axes in held)
    forces = ", ".join(f"{{type: point, {at(x, y)}, force: {f}}}" for x, y, f in (*pulled, *pushed))
    found = ratios(
        "hemisphere_linear",
        *mesh(18, "equilateral"),  # 104 rows around: nodes under all four forces
        "geometry[0].generate.angle=360 deg",
        "geometry[0].bending=hinge",
        f"motions=[{motions}]",
        f"forces=[{forces}]",
    )
    # 5 % for triangles that narrow towards the hole, where hinges are not quite that plate any more
    assert_allclose(found, 3.0 / 4.0 * (1.0 - 0.3) / (1.0 - 0.3**2), rtol=0.05)


# Buckling


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.25, 0.3, 0.35, 0.5])
@pytest.mark.parametrize("pattern", ["equilateral", "unstructured"])
def test_lateral_buckling(pattern: str, poisson_ratio: float) -> None:
    """A strip on edge tilts under its own weight: 3 % of 18.178 / sqrt(1 + nu) at a width of L/20."""
    unit = 1e6 * 1e-3**2 / (12.0 * 1000.0)  # E h^2 / (12 rho L^3)
    below, above = (share * unit * 18.178 / np.sqrt(1.0 + poisson_ratio) for share in (0.97, 1.03))
    pairs = measured(
        FOLDER / "verification" / "lateral_buckling.yaml",
        *mesh(40, pattern),
        f"materials.sheet.poisson_ratio={poisson_ratio}",
        f"forces[0].acceleration=[0, 0, {{table: [[0, 0], [0.5, {-below}], [1, {-above}]]}}]",
    )
    assert [value for value, _ in pairs.values()] == [0, 1]


# Plates on random triangles


def scattered(file: Path, radius: float, rings: int) -> None:
    """Write a disc whose inner nodes are moved at random by up to a third of a ring and joined anew."""
    from scipy.spatial import Delaunay

    regular = disc(radius, rings)
    nodes = regular.nodes
    inner = np.setdiff1d(np.arange(1, len(nodes)), regular.node_groups["rim"])
    nodes[inner, :2] += np.random.default_rng(2).uniform(-1.0, 1.0, (len(inner), 2)) * radius / (3.0 * rings)
    rows = ["*Nodes", *(f"{x!r}, {y!r}, {z!r}" for x, y, z in nodes.tolist()), "*Triangles"]
    for corners in Delaunay(nodes[:, :2]).simplices:
        a, b, c = nodes[corners]
        rows.append(
            ", ".join(str(n + 1) for n in (corners if np.cross(b - a, c - a)[2] > 0 else corners[::-1]))
        )
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")


@pytest.mark.parametrize(
    ("motion", "factor", "tolerance"), [("clamp", 1.0 / 64.0, 0.02), ("pin", 0.0637019, 0.005)]
)
def test_disc_of_random_triangles(tmp_path: Path, motion: str, factor: float, tolerance: float) -> None:
    """Clamped and simply supported circles: 2 % and 0.5 % of w D / (p R^4)."""
    scattered(tmp_path / "disc.txt", 0.1, 16)
    text = (FOLDER / "verification" / "supported_disc.yaml").read_text(encoding="utf-8")
    generated = "    generate: {shape: disc, center: [0, 0, 0], radius: 0.1, rings: 24}\n"
    assert generated in text
    text = text.replace(generated, "    mesh: {file: disc.txt}\n").replace(
        "disc.center", "{nearest: [0, 0, 0]}"
    )
    text = text.replace("type: pin, where: disc.rim", f"type: {motion}, where: disc.boundary")
    (tmp_path / "disc.yaml").write_text(text, encoding="utf-8")
    value, _ = measured(tmp_path / "disc.yaml")["bulge"]
    rigidity = 200e9 * 1e-3**3 / (12.0 * (1.0 - 0.3**2))
    assert_allclose(value * rigidity / 0.1**4, factor, rtol=tolerance)


def test_supported_disc_converges_at_second_order() -> None:
    errors = [ratios("supported_disc", f"geometry[0].generate.rings={n}").item() - 1.0 for n in (8, 16)]
    assert_allclose(np.log2(errors[0] / errors[1]), 2.0, atol=0.1)
