"""The benchmarks by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi, sqrt
from typing import Final

from .promises import Promises
from .row import Case
from .thresholds import Threshold


@dataclass(frozen=True, slots=True)
class Benchmark:
    """Cases that belong together.

    Attributes:
        title: What it is.
        cases: What is run.
    """

    title: str
    cases: tuple[Case, ...]


_V: Final = "verification/"
_CLAMP: Final = "{type: clamp, where: column.start}"
_PIN: Final = "{type: pin, where: column.end, components: [y]}"
_UNSTRUCTURED: Final = ("geometry[0].generate.pattern=unstructured",)


def _pushed(*motions: str) -> Callable[[float], tuple[str, ...]]:
    """A column of length and stiffness 1 under a force at its end."""

    def loaded(load: float) -> tuple[str, ...]:
        held = (f"motions=[{', '.join(motions)}]",) if motions else ()
        return (*held, f"forces[0].force=[0, 0, {-load}]")

    return loaded


def _squeezed(load: float) -> tuple[str, ...]:
    """A column of axial stiffness 1e6 between clamps, the upper of which comes down."""
    upper = f"{{type: clamp, where: column.end, displacement: [0, 0, {-1e-6 * load:.9g}]}}"
    return (f"motions=[{_CLAMP}, {upper}]", "forces=[]")


def _heavy_column(load: float) -> tuple[str, ...]:
    return (f"motions=[{_CLAMP}]", f"forces=[{{type: gravity, acceleration: [0, 0, {-load}]}}]")


def _rod_on_edge(load: float) -> tuple[str, ...]:
    """A rod that is clamped at one end, soft across its weight only."""
    return (
        "motions=[{type: clamp, where: rod.start}]",
        "geometry[0].director=[0, 1, 0]",
        "geometry[0].section.axial_stiffness=1e8",
        "geometry[0].section.bending_stiffness_2=1e4",
        f"forces=[{{type: gravity, acceleration: [0, 0, {-load}]}}]",
    )


def _strip_on_edge(poisson_ratio: float) -> Callable[[float], tuple[str, ...]]:
    """Loads rho g A L^3 / EI: E h^2 / (12 rho L^3) is the unit of gravity."""

    def loaded(load: float) -> tuple[str, ...]:
        gravity = -load * 1e6 * 1e-3**2 / (12.0 * 1000.0)
        return (
            f"materials.sheet.poisson_ratio={poisson_ratio}",
            f"forces[0].acceleration=[0, 0, {gravity:.9g}]",
        )

    return loaded


def _column(
    quantity: str, value: float, loaded: Callable[[float], tuple[str, ...]], source: str = "Euler"
) -> Threshold:
    return Threshold(
        file=f"{_V}euler_column",
        loaded=loaded,
        quantity=quantity,
        value=value,
        tolerance=5e-4,
        source=source,
    )


BENCHMARKS: Final[dict[str, Benchmark]] = {
    "elastica": Benchmark("Cantilever under a tip force", (Promises(f"{_V}elastica"),)),
    "heavy_rod": Benchmark("Heavy cantilever, a rod", (Promises(f"{_V}heavy_cantilever"),)),
    "heavy_strip": Benchmark(
        "Heavy cantilever, a shell; on random triangles",
        (Promises(f"{_V}heavy_strip"), Promises(f"{_V}heavy_strip", changes=_UNSTRUCTURED)),
    ),
    "columns": Benchmark(
        "Euler's columns, P L^2/EI",
        (
            _column("fixed-free", 2.467401, _pushed(_CLAMP)),
            _column("pinned", 9.869604, _pushed()),
            _column("fixed-pinned", 20.190729, _pushed(_CLAMP, _PIN)),
            _column("fixed-fixed", 39.478418, _squeezed),
        ),
    ),
    "self_weight": Benchmark(
        "Column under its own weight, q L^3/EI",
        (_column("fixed-free", 7.837347, _heavy_column, "Greenhill 1881"),),
    ),
    "lateral": Benchmark(
        "Lateral buckling under self weight",
        (
            Threshold(
                file=f"{_V}twisted_clamped_rod",
                loaded=_rod_on_edge,
                quantity="rod, q L^3/sqrt(EI GJ)",
                value=12.853763,
                tolerance=1e-3,
                source="Prandtl; infinitely stiff in its plane",
            ),
            *(
                Threshold(
                    file=f"{_V}lateral_buckling",
                    loaded=_strip_on_edge(nu),
                    quantity=f"strip, nu = {nu}, rho g A L^3/EI",
                    value=18.178 / sqrt(1.0 + nu),
                    tolerance=0.05,
                    source="Prandtl; Romero et al. 2021, narrow strip",
                )
                for nu in (0.0, 0.25, 0.35, 0.5)
            ),
        ),
    ),
    "ring": Benchmark(
        "Michell's and Zajac's ring",
        (
            Threshold(
                file=f"{_V}michell_ring",
                loaded=lambda load: (f"actuation[0].value={load / (2.0 * pi):.9g}",),
                quantity="twist angle, in EI/GJ",
                value=2.0 * pi * sqrt(3.0),
                tolerance=5e-3,
                source="Michell 1889, Zajac 1962",
            ),
        ),
    ),
    "twisted_rod": Benchmark(
        "Greenhill's twisted rod between clamps",
        (
            Threshold(
                file=f"{_V}twisted_clamped_rod",
                loaded=lambda load: (f"motions[1].twist={load}",),
                quantity="M L/EI",
                value=8.986819,
                tolerance=2e-3,
                source="Greenhill 1883",
            ),
        ),
    ),
    "postbuckling": Benchmark(
        "Columns, arches and strips beyond buckling",
        (
            Promises(f"{_V}pinned_column_by_load"),
            Promises(f"{_V}pinned_column_by_displacement"),
            Promises(f"{_V}shallow_arch"),
            Promises("buckled_strip", ("height",)),
        ),
    ),
    "localised_helix": Benchmark(
        "Localised buckling of a twisted rod",
        (
            Promises(f"{_V}localised_helix_static", ("tension",)),
            Promises(f"{_V}localised_helix_dynamic", ("tension",)),
        ),
    ),
    "pulled_spring": Benchmark("Helix under a wrench", (Promises(f"{_V}pulled_spring"),)),
    "roll_up": Benchmark(
        "Roll-up by an end moment, a shell; a rod",
        (Promises(f"{_V}strip_roll_up"), Promises("roll_up")),
    ),
    "princeton": Benchmark("Princeton beam, at 0 and 90 degrees", (Promises(f"{_V}princeton_beam"),)),
    "follower": Benchmark(
        "Follower forces: bent across, Beck's column",
        (Promises(f"{_V}follower_cantilever"), Promises("becks_column")),
    ),
    "frequencies": Benchmark(
        "Frequencies of beams",
        (Promises(f"{_V}beam_modes"), Promises("cantilever_dynamic_1e6", ("period", "swing"))),
    ),
    "momentum": Benchmark("Momentum of a thrown sheet", (Promises(f"{_V}thrown_sheet"),)),
    "end_shear": Benchmark(
        "Cantilever under end shear; on random triangles",
        (Promises(f"{_V}strip_end_shear"), Promises(f"{_V}strip_end_shear", changes=_UNSTRUCTURED)),
    ),
    "hemisphere": Benchmark(
        "Hemisphere with a hole of 18 degrees",
        (Promises(f"{_V}hemisphere_linear"), Promises(f"{_V}hemisphere")),
    ),
    "roof": Benchmark("Scordelis-Lo roof", (Promises(f"{_V}scordelis_lo_roof"),)),
    "pinched_cylinder": Benchmark("Pinched cylinder with diaphragms", (Promises(f"{_V}pinched_cylinder"),)),
    "plates": Benchmark(
        "Plates: clamped and simply supported discs, square, ring; a square of hinges",
        (
            Promises("pressed_disc"),
            Promises(f"{_V}supported_disc"),
            Promises("plate", ("center",)),
            Promises("drooping_ring", ("rim",)),
            Promises(f"{_V}hinged_plate"),
        ),
    ),
    "rubber": Benchmark("Rubber pulled to twice its length", (Promises(f"{_V}rubber_strip"),)),
    "heavy_fold": Benchmark(
        "Heavy fold on a floor",
        (Promises("heavy_fold", ("height", "overhang", "bent", "carried")),),
    ),
    "friction": Benchmark(
        "Friction: sliding stop, inclines, capstan",
        (
            Promises("sliding_stop", ("way", "friction", "heat")),
            Promises("incline"),
            Promises("incline_anchored", ("slides", "held")),
            Promises("capstan"),
        ),
    ),
    "stream": Benchmark("Cantilever in a stream that grows along it", (Promises(f"{_V}reed_in_current"),)),
    "other_codes": Benchmark(
        "Numbers of other codes",
        (
            Promises(f"{_V}rod_drop_family"),
            Promises("contortion"),
            Promises("helix_soft_static", ("sag",)),
            Promises("helix_stiff_static", ("sag",)),
        ),
    ),
}
