"""Values that are allowed but look like a slip: a wrong prefix, a forgotten unit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

from ..language.force import Gravity
from ..language.geometry import Rod, Shell
from ..language.numerics import Static
from ..language.scenario import Scenario
from ..language.section import GivenSection, RectangularSection, RoundSection, TubeSection
from ..language.shape import Arc, CsvCurve, Helix, Line, Polyline
from ..language.surface import (
    AnnulusSurface,
    CylinderSurface,
    DiscSurface,
    HemisphereSurface,
    IcosphereSurface,
    SheetSurface,
    SphereSurface,
)
from ..values.varying import written
from .contact import contact_doubts
from .control import control_doubts
from .finding import Finding

SOFTEST, STIFFEST = 1e3, 1.3e12  # [Pa] jelly, diamond
LIGHTEST, HEAVIEST = 1.0, 23e3  # [kg/m^3] aerogel, osmium
STRONGEST_GRAVITY = 300.0  # [m/s^2] about that of the sun
LEAST_INERTIA = 1e-3  # rotary inertia over that of a solid round rod
STOUTEST = 0.2  # thickness over length at which a rod is no rod any more, a shell no shell


def doubts(scenario: Scenario) -> Iterator[Finding]:
    """Implausible values of a scenario, as key path and message."""
    yield from _materials(scenario)
    yield from _slenderness(scenario)
    yield from _thinness(scenario)
    yield from contact_doubts(scenario)
    yield from control_doubts(scenario)
    if not isinstance(scenario.numerics.integrator, Static):
        yield from _inertia(scenario)
    else:
        for name, material in scenario.materials.items():
            if material.relaxation_time > 0.0:
                message = "damping depends on velocity: it does nothing in a static run"
                yield ("materials", name, "relaxation_time"), message
    for i, force in enumerate(scenario.forces):
        if isinstance(force, Gravity):
            numbers = [a for a in force.acceleration if isinstance(a, float)]
            size = math.hypot(*numbers)
            if size > STRONGEST_GRAVITY:
                yield (
                    ("forces", i, "acceleration"),
                    f"gravity of {size:g} m/s^2 is stronger than that of the sun",
                )
        still = force.velocity_dependent and not force.acts_at_rest
        if still and isinstance(scenario.numerics.integrator, Static):
            message = f"{force.type} depends on velocity: it does nothing in a static run"
            yield ("forces", i, "type"), message


def _materials(scenario: Scenario) -> Iterator[Finding]:
    for name, material in scenario.materials.items():
        moduli, densities = written(material.youngs_modulus), written(material.density)
        path = ("materials", name)
        yield from (((*path, "youngs_modulus"), what) for what in modulus_doubts(*_ends(moduli)))
        yield from (((*path, "density"), what) for what in density_doubts(*_ends(densities)))


def _ends(values: tuple[float, ...]) -> tuple[float, ...]:
    """The least and the largest of some values, one of them where they are equal."""
    return tuple(sorted({min(values), max(values)})) if values else ()


def modulus_doubts(*moduli: float) -> Iterator[str]:
    """What is odd about Young's moduli [Pa]."""
    for modulus in moduli:
        if modulus < SOFTEST:
            guess = f"; did you mean {modulus:g} MPa?" if SOFTEST <= modulus * 1e6 <= STIFFEST else ""
            yield f"E = {modulus:g} Pa: softer than jelly{guess}"
        if modulus > STIFFEST:
            yield f"E = {modulus:g} Pa: stiffer than diamond"


def density_doubts(*densities: float) -> Iterator[str]:
    """What is odd about densities [kg/m^3]."""
    for density in densities:
        if density < LIGHTEST:
            guess = "; did you mean g/cm^3?" if LIGHTEST <= density * 1e3 <= HEAVIEST else ""
            yield f"density {density:g} kg/m^3: lighter than aerogel{guess}"
        elif density < 30.0:
            yield f"density {density:g} kg/m^3: light as foam; did you mean {density:g} g/cm^3?"
        if density > HEAVIEST:
            yield f"density {density:g} kg/m^3: heavier than osmium"


def _slenderness(scenario: Scenario) -> Iterator[Finding]:
    for i, rod in scenario.rods.items():
        length, thickness = _length(rod), _thickness(rod)
        if length is not None and thickness > STOUTEST * length:
            key = "radius" if rod.radius is not None else "section"
            message = f"thickness {thickness:g} m on a length of {length:g} m: too stout for a rod"
            yield ("geometry", i, key), message


def _inertia(scenario: Scenario) -> Iterator[Finding]:
    for i, rod in scenario.rods.items():
        match rod.section:
            case GivenSection(
                mass_per_length=float(mass), radius=float(radius), rotary_inertia_per_length=float(inertia)
            ):
                solid = 0.5 * mass * radius**2
                if inertia < LEAST_INERTIA * solid:
                    yield (
                        ("geometry", i, "section", "rotary_inertia_per_length"),
                        f"{inertia:g} kg m is far below that of a solid round rod, {solid:.2g} kg m: "
                        "its twist will swing too fast for any step",
                    )
            case _:
                pass


def _thinness(scenario: Scenario) -> Iterator[Finding]:
    for i, shell in scenario.shells.items():
        size = _size(shell)
        thickness = max(written(shell.thickness), default=0.0)
        if size is not None and thickness > STOUTEST * size:
            message = f"thickness {thickness:g} m on a size of {size:g} m: too stout for a shell"
            yield ("geometry", i, "thickness"), message


def _size(shell: Shell) -> float | None:
    """Smallest extent of a generated surface [m]; None if it comes from a file."""
    match shell.generate:
        case SheetSurface(length=length, width=width):
            return min(length, width)
        case DiscSurface(radius=radius) | HemisphereSurface(radius=radius) | IcosphereSurface(radius=radius):
            return 2 * radius
        case AnnulusSurface(inner_radius=inner, outer_radius=outer):
            return outer - inner
        case CylinderSurface(length=length, radius=radius, angle=angle):
            return min(length, radius * angle)
        case SphereSurface(radius=radius, polar=polar, angle=angle):
            return radius * min(polar[1] - polar[0], angle)
        case None:
            return None


def _thickness(rod: Rod) -> float:
    """Largest thickness that is written [m]; 0 if an expression makes it."""
    match rod.cross_section:
        case RoundSection(radius=radius) | GivenSection(radius=radius) | TubeSection(outer_radius=radius):
            return 2 * max(written(radius), default=0.0)
        case RectangularSection(thickness=thickness, width=width):
            return min(max(written(side), default=0.0) for side in (thickness, width))


def _length(rod: Rod) -> float | None:
    """Length of a generated centreline [m]; None if it comes from a file."""
    match rod.generate:
        case Line(start=start, end=end):
            return math.dist(start, end)
        case Arc(radius=radius, angle=angle):
            return radius * abs(angle)
        case Helix(radius=radius, pitch=pitch, turns=turns):
            return turns * math.hypot(2 * math.pi * radius, pitch)
        case Polyline(points=points):
            return sum(math.dist(a, b) for a, b in pairwise(points))
        case CsvCurve() | None:
            return None
