"""What no shipped scenario uses, for each belongs to a machine, to taste or to a special case.

Each has a small deck that does, and an assertion about where it ends in the simulation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np
from contact_decks import on_floor
from decks import Deck, line, rod_deck
from numpy.testing import assert_allclose, assert_array_equal
from rare_control import EACH, INCREMENTAL, RUN, SENSORS, bends, follows, reads_all
from shell_decks import BELL, RUBBER, SHEET, rod, shell_deck

from dismech_cli.compose.compose import Composition
from dismech_cli.contact.contact import Contact
from dismech_cli.kernels.numba_driver import NumbaDriver
from dismech_cli.kernels.numpy_driver import NumpyDriver
from dismech_cli.laws import laws
from dismech_cli.mesh.topology.shells import shell_edges
from dismech_cli.run.observables.reduce import reduce_series
from dismech_cli.scenario.load import LoadedScenario
from dismech_cli.sections.shells import hinge_stiffness
from dismech_cli.session.report import Report
from dismech_cli.solve.tangents import TANGENTS
from dismech_cli.studies.study.space import with_study
from dismech_cli.studies.sweep.axes import rows

Choice = tuple[str, str]
SHORT: Deck = {"integrator": {"type": "implicit_euler"}, "dt": 0.01, "t_end": 0.02}


@dataclass(frozen=True)
class Rare:
    """A deck for what is rare.

    Attributes:
        deck: The scenario.
        ends: Asserts where it ends in the composition.
        classes: Names of the classes of the language that it uses.
        choices: Keys and what it chooses there.
        files: Files beside the deck, by name.
        profile: Loaded under it.
        steps: Asserts what a run of it gives; None composes only.
    """

    deck: Deck
    ends: Callable[[Composition], None]
    classes: frozenset[str] = frozenset()
    choices: frozenset[Choice] = frozenset()
    files: Mapping[str, str] = field(default_factory=dict)
    profile: str | None = None
    steps: Callable[[LoadedScenario, Report], None] | None = None


def parts_of(value: Any) -> Iterator[Any]:
    """What a composition is made of, depth first."""
    yield value
    if is_dataclass(value):
        for part in fields(value):
            yield from parts_of(getattr(value, part.name))
    elif isinstance(value, Mapping):
        for part in value.values():
            yield from parts_of(part)
    elif isinstance(value, tuple | list):
        for part in value:
            yield from parts_of(part)


def term(made: Composition, name: str) -> Any:
    """A term by name."""
    (found,) = (one for one in made.simulation.model.terms if one.name == name)
    return found


def pulled(law: Any, files: Mapping[str, str], *classes: str, choices: frozenset[Choice], ends: Any) -> Rare:
    """A rod whose end is pulled by a law, which ends in a load as ``ends``."""

    def check(made: Composition) -> None:
        parts = parts_of(made.simulation.model.terms)
        assert any(type(part) is type(ends) and part == ends for part in parts)

    point = {"type": "point", "where": "rod.end", "force": [law, 0.0, 0.0]}
    return Rare(
        rod_deck(line(4), forces=[point], numerics=SHORT),
        check,
        classes=frozenset(classes),
        choices=choices,
        files=files,
    )


WAVE = {"amplitude": 2.0, "frequency": 3.0, "phase": 0.5, "offset": 1.0}
ROWS = [[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]]
NONE: frozenset[Choice] = frozenset()


def table(interpolation: Any) -> Rare:
    return pulled(
        {"table": ROWS, "interpolation": interpolation},
        {},
        choices=frozenset({("interpolation", interpolation)}),
        ends=laws.Table(times=(0.0, 1.0, 2.0), values=(0.0, 2.0, 0.0), interpolation=interpolation),
    )


LAWS = {
    "sine": pulled({"sine": WAVE}, {}, "Sine", "SineLaw", choices=NONE, ends=laws.Sine(**WAVE)),
    "sawtooth": pulled(
        {"sawtooth": WAVE | {"width": 0.5}},
        {},
        "Sawtooth",
        "SawtoothLaw",
        choices=NONE,
        ends=laws.Sawtooth(**WAVE, width=0.5),
    ),
    "step": table("step"),
    "cubic": table("cubic"),
}


# ---------------------------------------------------------------- bodies


def is_round(made: Composition) -> None:
    assert_array_equal(made.simulation.topology.edge_radius, 0.01)


def has_equal_hinges(made: Composition) -> None:
    (stiffness,) = hinge_stiffness(RUBBER.youngs_modulus, RUBBER.thickness, 1)
    assert (term(made, "sheet.bending").parameters == stiffness).all(axis=1).any()


def is_unbent_when_flat(made: Composition) -> None:
    bending = term(made, "sheet.bending")
    assert bending.natural.size
    assert_array_equal(bending.natural, 0.0)


def is_closed(made: Composition) -> None:
    """20 n^2 triangles, of which every edge has two: Euler's count of a sphere."""
    geometry = made.geometry
    assert len(geometry.triangles) == 80
    sides = np.sort(geometry.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert (np.unique(sides, axis=0, return_counts=True)[1] == 2).all()
    assert len(geometry.nodes) - len(sides) // 2 + len(geometry.triangles) == 2


def is_irregular(made: Composition) -> None:
    assert any("unstructured triangles" in note for note in made.geometry.notes)


def bends_freely(made: Composition) -> None:
    turning = made.geometry.turning
    at = made.geometry.edges[np.isin(turning.ends, turning.partial["bending"])]
    assert_array_equal(made.geometry.nodes[np.unique(at)], [[0.1, 0.0, 0.0]])


def turns_as_one(made: Composition) -> None:
    """Six sides of two sheets have one normal for both."""
    (seam,) = made.geometry.seams
    assert seam.shells == (0, 1)
    assert len(seam.sides) == 6
    each = len(shell_edges(made.geometry.triangles[made.geometry.triangle_shell == 0]).edges)
    assert made.simulation.model.dofs.n_normals == 2 * each - 6


def turns_apart(made: Composition) -> None:
    assert made.geometry.seams == ()
    assert "joints[0]: 'sheet' and 'other' hinged along 6 sides, 0.3 m." in made.geometry.notes


def branches_freely(made: Composition) -> None:
    """Each of three triangles has a normal of its own at each side."""
    assert made.simulation.model.dofs.n_normals == 9


def sewn(bending: str) -> Deck:
    """Two sheets side by side, joined along six sides."""
    sheets = [
        {
            "type": "shell",
            "name": name,
            "material": "rubber",
            "thickness": 2e-3,
            "generate": SHEET | {"origin": at},
        }
        for name, at in (("sheet", [0.0, 0.0, 0.0]), ("other", [0.0, 0.2, 0.0]))
    ]
    seam = {"type": "seam", "shells": ["sheet", "other"], "bending": bending}
    return shell_deck(geometry=sheets, joints=[seam])


FINS = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv -1 0 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n"
THREE: Deck = {"type": "shell", "name": "sheet", "material": "rubber", "thickness": 2e-3}


def passes_nothing_but_force(made: Composition) -> None:
    assert [one.passes for one in made.geometry.joined] == [()]


def passes_everything(made: Composition) -> None:
    assert [one.passes for one in made.geometry.joined] == [("bending", "twist")]


def moves(made: Composition) -> None:
    assert_array_equal(made.simulation.start.v.reshape(-1, 2)[:3], [[0, 0], [1, 3], [4, 6]])


def starts_displaced(made: Composition) -> None:
    z = made.simulation.start.q.reshape(-1, 2)[:4, 1]
    assert_allclose(z, [0.0, 0.1, 0.2, 0.3], rtol=1e-15)
    assert_array_equal(made.simulation.model.rest.reshape(-1, 2)[:4, 1], 0.0)


def varies_with_place(made: Composition) -> None:
    (one,) = made.geometry.properties
    x = np.array([1.0, 3.0, 5.0]) / 6.0
    assert_allclose(one.radius, 0.5 * (1e-3 + 1e-3 * x), rtol=1e-12)
    assert_allclose(one.area, (2e-3 + 1e-3 * x) * (1e-3 + 1e-3 * x) + 1e-6 / 12.0 / 9.0, rtol=1e-12)
    assert_allclose(one.mass_per_length[2] / one.area[2], 2e3, rtol=1e-12)


TOUCHING = [rod([0.0, 0.0, 0.0], [0.1, 0.0, 0.0], "a"), rod([0.1, 0.0, 0.0], [0.2, 0.0, 0.0], "b")]

BODIES = {
    "round section": Rare(
        rod_deck(line(4), {"type": "round", "radius": 0.01}), is_round, classes=frozenset({"RoundSection"})
    ),
    "places": Rare(
        rod_deck(
            line(4),
            {
                "type": "rectangular",
                "width": {"of": "arc", "table": [[0.0, 2e-3], [1.0, 3e-3]]},
                "thickness": {"of": "x", "table": [[0.0, 1e-3], [1.0, 2e-3]]},
                "torsion_constant": {"of": "z", "table": [[0.0, 1e-12], [1.0, 2e-12]]},
            },
            materials={
                "m": {
                    "youngs_modulus": {"of": "y", "table": [[0.0, 1e6], [1.0, 2e6]]},
                    "poisson_ratio": 0.5,
                    "density": {"of": "r", "table": [[0.6, 1e3], [0.65, 2e3]]},
                }
            },
        ),
        varies_with_place,
        choices=frozenset(("of", place) for place in ("arc", "x", "y", "z", "r")),
    ),
    "groups": Rare(
        rod_deck(line(4), {"type": "round", "radius": {"value": 1e-2, "groups": {"end": 2e-2}}}),
        lambda made: assert_array_equal(made.simulation.topology.edge_radius, [1e-2, 1e-2, 2e-2]),
        classes=frozenset({"ByGroup"}),
    ),
    "displaced": Rare(
        rod_deck(
            line(4),
            numerics=SHORT,
            motions=[],
            initial={
                "displacements": [{"where": "rod", "displacement": {"file": "d.csv", "columns": [0, 0, 1]}}]
            },
        ),
        starts_displaced,
        classes=frozenset({"PositionFile"}),
        files={"d.csv": "0 0\n0 0.1\n0 0.2\n0 0.3\n"},
    ),
    "equal hinges": Rare(
        shell_deck(SHEET | {"pattern": "alternating"}, body={"bending": "hinge", "hinges": "equal"}),
        has_equal_hinges,
        choices=frozenset({("hinges", "equal")}),
    ),
    "flat": Rare(
        shell_deck(BELL, body={"bending": "hinge", "natural": {"shape": "flat"}}),
        is_unbent_when_flat,
        choices=frozenset({("shape", "flat")}),
    ),
    "unstructured": Rare(
        shell_deck(SHEET | {"pattern": "unstructured"}),
        is_irregular,
        choices=frozenset({("pattern", "unstructured")}),
    ),
    "icosphere": Rare(
        shell_deck({"shape": "icosphere", "center": [0.0, 0.0, 0.0], "radius": 0.1, "divisions": 2}),
        is_closed,
        classes=frozenset({"IcosphereSurface"}),
    ),
    "welded seam": Rare(
        sewn("weld"), turns_as_one, classes=frozenset({"Seam"}), choices=frozenset({("bending", "weld")})
    ),
    "hinged seam": Rare(
        sewn("hinge"), turns_apart, classes=frozenset({"Seam"}), choices=frozenset({("bending", "hinge")})
    ),
    "hinged branches": Rare(
        shell_deck(geometry=[THREE | {"mesh": {"file": "fins.obj", "branches": "hinge"}}]),
        branches_freely,
        choices=frozenset({("branches", "hinge")}),
        files={"fins.obj": FINS},
    ),
    "released bending": Rare(
        shell_deck(
            geometry=[rod([0.0, 0.0, 0.0], [0.1, 0.0, 0.0], "a"), rod([0.1, 0.0, 0.0], [0.2, 0.0, 0.0], "b")],
            joints=[{"type": "rigid", "nodes": ["a.end", "b.start"], "release": "bending"}],
        ),
        bends_freely,
        choices=frozenset({("release", "bending")}),
    ),
    "auto hinge": Rare(
        shell_deck(geometry=TOUCHING, joints=[{"type": "auto", "join": "hinge"}]),
        passes_nothing_but_force,
        choices=frozenset({("join", "hinge")}),
    ),
    "auto rigid": Rare(
        shell_deck(geometry=TOUCHING, joints=[{"type": "auto", "join": "rigid"}]),
        passes_everything,
        choices=frozenset({("join", "rigid")}),
    ),
    "velocity in a file": Rare(
        rod_deck(
            line(3),
            motions=[],
            numerics=SHORT,
            initial_velocity=[{"where": "rod", "velocity": {"file": "v.csv"}}],
        ),
        moves,
        classes=frozenset({"VelocityFile"}),
        files={"v.csv": "x, y, z\n0, 0, 0\n1, 0, 3\n4, 0, 6\n"},
    ),
}


# ---------------------------------------------------------------- numerics


def solved_by(name: str) -> Rare:
    def names_it(made: Composition) -> None:
        assert made.simulation.linear_solver == name

    def hangs(loaded: LoadedScenario, result: Report) -> None:
        assert result.frames[-1].positions[-1, 2] < 0.0

    return Rare(
        rod_deck(
            line(4),
            forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
            numerics=SHORT | {"linear_solver": name},
        ),
        names_it,
        choices=frozenset({("linear_solver", name)}),
        steps=hangs,
    )


def unprojected() -> Rare:
    """Statics driven straight into an unstable balance, as asked."""

    def steps_with(made: Composition) -> None:
        assert made.simulation.newton.factorize is TANGENTS["none"]

    def stays_straight(loaded: LoadedScenario, result: Report) -> None:
        assert_allclose(result.frames[-1].positions[:, 2], 0.0, atol=1e-12)

    pushed = {"type": "pin", "where": "rod.end", "displacement": [-0.1, 0.0, 0.0]}
    return Rare(
        rod_deck(
            line(11),
            motions=[{"type": "pin", "where": "rod.start"}, pushed],
            numerics={
                "integrator": {"type": "static", "load_steps": 2},
                "newton": {"projection": "none"},
            },
        ),
        steps_with,
        choices=frozenset({("projection", "none")}),
        steps=stays_straight,
    )


def turned() -> Rare:
    """A rod from a file, turned about a point of it."""

    def stands(made: Composition) -> None:
        assert_allclose(made.geometry.nodes, [[1, -1, 0], [1, 0, 0], [1, 1, 0]], atol=1e-15)

    quarter = {"axis": [0, 0, 1], "angle": "90 deg", "about": [1, 0, 0]}
    deck = rod_deck({}, rod={"mesh": {"file": "rod.txt", "rotate": quarter}}, dimension=3, numerics=SHORT)
    del deck["geometry"][0]["generate"]
    text = "*Nodes\n0, 0, 0\n1, 0, 0\n2, 0, 0\n*Edges\n1, 2\n2, 3\n"
    return Rare(deck, stands, classes=frozenset({"Rotation"}), files={"rod.txt": text})


def run_by(name: str, driver: type) -> Rare:
    def drives(made: Composition) -> None:
        assert made.plan.kernels == name
        assert isinstance(made.simulation.model.driver, driver)

    def steps(loaded: LoadedScenario, result: Report) -> None:
        assert np.isfinite(result.frames[-1].positions).all()

    return Rare(
        rod_deck(line(4), numerics=SHORT | {"kernels": name}),
        drives,
        choices=frozenset({("kernels", name)}),
        steps=steps,
    )


def under(profile: str) -> Rare:
    """Declared, it replaces the built-in profile of that name."""

    def steps_so(made: Composition) -> None:
        assert_allclose(np.diff(made.simulation.control.grid), 0.005, rtol=1e-12)

    return Rare(
        rod_deck(line(4), numerics=SHORT, profiles={profile: {"numerics": {"dt": 0.005}}}),
        steps_so,
        choices=frozenset({("profiles", profile)}),
        profile=profile,
    )


def starts_at_rest(loaded: LoadedScenario, result: Report) -> None:
    (expectation,) = loaded.scenario.expect.values()
    outcome = result.outcome
    measured = reduce_series(outcome.times, outcome.watched["end"], expectation.reduce)
    assert measured == expectation.value
    assert outcome.watched["end"][-1] != measured


def watches(made: Composition) -> None:
    assert set(made.simulation.watched) == {"end"}


FIRST = Rare(
    rod_deck(
        line(4),
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
        numerics=SHORT,
        expect={
            "end": {
                "probe": {"position": "rod.end", "component": "z"},
                "reduce": "first",
                "value": 0.0,
                "tolerance": 0.0,
                "source": "its rest shape",
            }
        },
    ),
    watches,
    choices=frozenset({("reduce", "first")}),
    steps=starts_at_rest,
)


def has_no_other_field(made: Composition) -> None:
    assert made.simulation.fields == ()


POSITIONS = Rare(
    rod_deck(line(4), numerics=SHORT, output={"fields": ["positions"]}),
    has_no_other_field,
    choices=frozenset({("fields", "positions")}),
    steps=lambda loaded, result: assert_array_equal(
        [frame.positions.shape for frame in result.frames[:2]], [[4, 3], [4, 3]]
    ),
)


def is_what_moved(loaded: LoadedScenario, result: Report) -> None:
    last = result.frames[-1]
    assert_array_equal(last.fields["displacement"], last.positions - result.frames[0].positions)
    assert np.abs(last.fields["displacement"]).max() > 0.0


DISPLACEMENT = Rare(
    rod_deck(
        line(4),
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
        numerics=SHORT,
        output={"fields": ["displacement"]},
    ),
    lambda made: None,
    choices=frozenset({("fields", "displacement")}),
    steps=is_what_moved,
)


def draws_three(loaded: LoadedScenario, result: Report) -> None:
    assert loaded.scenario.sweep is not None
    lots = [dict(row) for row in rows(loaded.scenario.sweep, loaded.directory)]
    assert [lot["numerics.dt"] for lot in lots] == ["0.01", "0.01", "0.01", "0.02", "0.02", "0.02"]
    slices = sorted(int(3.0 * (float(lot["forces[0].acceleration[2]"]) + 10.0)) for lot in lots[:3])
    assert slices == [0, 1, 2]


SAMPLE = Rare(
    rod_deck(
        line(4),
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
        numerics=SHORT,
        sweep={
            "csv": "steps.csv",
            "sample": {"count": 3, "over": {"forces[0].acceleration[2]": {"from": -10, "to": -9}}},
        },
    ),
    lambda made: None,
    classes=frozenset({"Sample", "Between"}),
    files={"steps.csv": "numerics.dt\n0.01\n0.02\n"},
    steps=draws_three,
)


def measures_from_the_finest(loaded: LoadedScenario, result: Report) -> None:
    assert with_study(loaded).reference == "finest"


FINEST = Rare(
    rod_deck(line(4), numerics=SHORT, study={"reference": "finest", "target": 0.01}),
    lambda made: None,
    choices=frozenset({("reference", "finest")}),
    steps=measures_from_the_finest,
)

CONTROL = {
    "sensors": Rare(
        SENSORS,
        lambda made: None,
        classes=frozenset(
            {
                "SensorProbe",
                "StretchSensor",
                "CurvatureSensor",
                "TwistSensor",
                "DihedralSensor",
                "SurfaceCurvatureSensor",
            }
        ),
        choices=frozenset(
            {
                *(
                    ("strain", strain)
                    for strain in ("curvature_1", "curvature_2", "twist", "dihedral", "surface_curvature")
                ),
                *(("measure", measure) for measure in ("mean", "rms", "max", "min")),
            }
        ),
        steps=reads_all,
    ),
    "incremental": Rare(
        INCREMENTAL,
        lambda made: None,
        classes=frozenset({"Incremental", "IncrementalGains"}),
        choices=frozenset({("hold", "step"), ("measure", "reading")}),
        steps=bends,
    ),
    "each": Rare(
        EACH,
        follows(1.0, 2.0),
        choices=frozenset({("interpolation", "linear")}),
        files={"each.csv": "t,a,b\n0,0,0\n0.01,2,4\n"},
    ),
    "run": Rare(
        RUN,
        follows(0.0, 0.0),
        classes=frozenset({"RunTarget"}),
        files={"run.csv": "0,0,0,1,0,2,0,3,0,-1,0\n"},
    ),
}


def kept_by(core: str, pairings: int, walls: int) -> Rare:
    """A rod on a floor, with or without a core under its soft contact."""

    def keeps(composition: Composition) -> None:
        (contact,) = composition.simulation.model.changing
        assert isinstance(contact, Contact)
        assert (len(contact.guards.pairings), len(contact.guards.walls)) == (pairings, walls)

    deck = on_floor()
    deck["contact"] = {"law": {"core": core}}
    return Rare(deck, keeps, choices=frozenset({("core", core)}))


def lagging() -> Rare:
    """Friction by the normal force at the end of the last step, under the family's law of pairs."""

    def keeps(composition: Composition) -> None:
        (contact,) = composition.simulation.model.changing
        assert isinstance(contact, Contact)
        (floor,) = contact.finding(contact, NumpyDriver())
        x = contact.map.space_positions(composition.simulation.model.rest)
        floor.depths(x, 0.0)
        assert "contact.lagged.floor" in floor.memory(x)

    deck = on_floor()
    deck["contact"]["law"] = {"type": "compat", "stiffness": 1e3, "width": 5e-3, "normal_force": "lagged"}
    return Rare(deck, keeps, choices=frozenset({("normal_force", "lagged")}))


RARE: dict[str, Rare] = {
    **CONTROL,
    "lagged": lagging(),
    "core on": kept_by("on", 1, 1),
    "core off": kept_by("off", 0, 0),
    **LAWS,
    **BODIES,
    **{name: solved_by(name) for name in ("banded", "dense", "pardiso", "superlu")},
    "projection none": unprojected(),
    "mesh rotated": turned(),
    "numpy": run_by("numpy", NumpyDriver),
    "numba": run_by("numba", NumbaDriver),
    **{f"profile {name}": under(name) for name in ("draft", "normal", "accurate")},
    "first": FIRST,
    "positions": POSITIONS,
    "displacement": DISPLACEMENT,
    "sample": SAMPLE,
    "finest": FINEST,
}


# ---------------------------------------------------------------- pictures


@dataclass(frozen=True)
class RarePicture:
    """What a run draws, and the file that it makes.

    Attributes:
        render: Choices, each of which no shipped scenario makes.
        other: Choices beside them.
        file: Name of the picture.
    """

    render: Mapping[str, str]
    file: str
    other: Mapping[str, Any] = field(default_factory=dict)


PICTURES = {
    "gif": RarePicture({"view": "yz", "video": "gif", "color_by": "velocity"}, "yz-velocity.gif"),
    "axial force": RarePicture({"color_by": "axial_force"}, "iso-axial_force-000002.png", {"still": True}),
    "displacement": RarePicture(
        {"color_by": "displacement", "background": "transparent", "layout": "panels"},
        "iso-displacement-panels.png",
        {"still": True, "times": [0.0, 0.01]},
    ),
    "stored ends": RarePicture(
        {"background": "grey", "ground": "grid", "ends": "stored", "shading": "flat"},
        "iso-curvature-000002.png",
        {"still": True, "color_by": "curvature"},
    ),
    "dark": RarePicture({"background": "dark"}, "iso-000002.png", {"still": True}),
    "director": RarePicture({"color_by": "director"}, "iso-director-000002.png", {"still": True}),
}


def picture_deck(picture: RarePicture) -> Deck:
    """A framed rod that falls for two frames and is drawn small."""
    render = {**picture.render, **picture.other, "size": [64, 64]}
    return rod_deck(
        line(4),
        dimension=3,
        rod={"bending": "framed"},
        numerics=SHORT,
        output={"every": 0.01, "fields": ["velocity", "axial_force", "director"], "render": render},
    )
