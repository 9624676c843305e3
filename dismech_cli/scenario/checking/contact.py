"""Contradictions and doubts of contact."""

from __future__ import annotations

from collections.abc import Iterator

from ...words import hint
from ..language.contact import BarrierLaw, CompatLaw, Contact, PenaltyLaw
from ..language.numerics import GeneralizedAlpha, ImplicitEuler, ImplicitMidpoint, Integrator, Newmark, Static
from ..language.obstacle import PlaneObstacle
from ..language.probe import ContactProbe
from ..language.scenario import Scenario
from ..views.walk import probes
from .finding import Finding


def contact_findings(scenario: Scenario) -> Iterator[Finding]:
    """What cannot be meant."""
    yield from _obstacles(scenario)
    if scenario.contact is None:
        for path, probe in probes(scenario):
            if isinstance(probe, ContactProbe):
                yield path, "the scene has no `contact`"
        return
    yield from _pairs(scenario, scenario.contact)
    match scenario.contact.law:
        case PenaltyLaw(stiffness=float()) if scenario.shells:
            yield (
                ("contact", "law", "stiffness"),
                "is one per length of rods, but the scene has shells; give a tolerance",
            )
        case BarrierLaw() if _balances_within(scenario.numerics.integrator):
            yield (
                ("numerics", "integrator"),
                "balances within the step: its end may lie nearer than a barrier allows; take "
                "generalized_alpha with spectral_radius: 0, implicit_euler, tr_bdf2 or newmark",
            )
        case CompatLaw(normal_force=normal):
            for i, one in enumerate(scenario.obstacles):
                if not isinstance(one, PlaneObstacle):
                    yield ("obstacles", i, "type"), "the law `compat` knows planes only; take type: penalty"
            if normal == "lagged" and scenario.contact.friction is None:
                yield ("contact", "law", "normal_force"), "needs `contact.friction`, which goes by it"
        case _:
            pass
    friction, law = scenario.contact.friction, scenario.contact.law
    if friction is not None and friction.stick == "anchored" and not isinstance(law, PenaltyLaw):
        yield ("contact", "friction", "stick"), "anchors know soft contact alone; take type: penalty"
    if isinstance(scenario.numerics.integrator, Static) and _rubs(scenario.contact):
        yield ("contact", "friction"), "nothing slips in a static run: friction would do nothing"


def _balances_within(integrator: Integrator) -> bool:
    match integrator:
        case ImplicitMidpoint():
            return True
        case GeneralizedAlpha(spectral_radius=radius):
            return radius > 0.0
        case _:
            return False


def contact_doubts(scenario: Scenario) -> Iterator[Finding]:
    """Integrators that lose what contact promises."""
    if scenario.contact is None:
        return
    path = ("numerics", "integrator")
    remedy = "take generalized_alpha with spectral_radius: 0, or implicit_euler for what must come to rest"
    if isinstance(scenario.contact.law, BarrierLaw) and not isinstance(
        scenario.numerics.integrator, ImplicitEuler | Static
    ):
        yield (
            path,
            "may make energy where impacts on a barrier cut steps; implicit_euler makes none",
        )
        return
    match scenario.numerics.integrator:
        case ImplicitMidpoint() | Newmark():
            yield path, f"makes energy in impacts, or lets frames lie within others; {remedy}"
        case GeneralizedAlpha(spectral_radius=radius) if radius > 0.0:
            yield path, f"spectral_radius {radius:g} lets frames lie within others after impacts; {remedy}"
        case _:
            pass


def _obstacles(scenario: Scenario) -> Iterator[Finding]:
    seen = {body.name for body in scenario.geometry}
    for i, one in enumerate(scenario.obstacles):
        if one.name in seen:
            yield ("obstacles", i, "name"), f"the name {one.name!r} is taken by another"
        seen.add(one.name)
        if scenario.dimension == 2 and isinstance(one, PlaneObstacle):
            inside = [one.normal["xyz".index(axis)] for axis in scenario.plane]
            if not any(inside):
                yield (
                    ("obstacles", i, "normal"),
                    f"points out of plane {scenario.plane}: nothing can touch it",
                )
    if scenario.obstacles and scenario.contact is None:
        yield ("obstacles",), "nothing touches them: the scene has no `contact`, such as `contact: {}`"


def _pairs(scenario: Scenario, contact: Contact) -> Iterator[Finding]:
    bodies = [body.name for body in scenario.geometry]
    obstacles = [one.name for one in scenario.obstacles]
    named: set[str] = set()
    seen: set[frozenset[str]] = set()
    for i, pair in enumerate(contact.pairs or ()):
        path = ("contact", "pairs", i, "between")
        for k, name in enumerate(pair.between):
            if name not in bodies and name not in obstacles:
                near = hint(name, [*bodies, *obstacles])
                yield (*path, k), f"no body and no obstacle is named {name!r}{near}"
        if all(name in obstacles for name in pair.between):
            yield path, "two obstacles never touch"
        if frozenset(pair.between) in seen:
            yield path, "this pair is given twice"
        if pair.friction and contact.friction is None:
            yield (
                ("contact", "pairs", i, "friction"),
                "needs `contact.friction`, which says from which speed on friction is full",
            )
        seen.add(frozenset(pair.between))
        named.update(pair.between)
    if contact.pairs is not None:
        for i, name in enumerate(obstacles):
            if name not in named:
                yield ("obstacles", i), "no pair of `contact.pairs` names it: nothing touches it"


def _rubs(contact: Contact) -> bool:
    """Whether any coefficient of friction is above zero."""
    common = 0.0 if contact.friction is None else contact.friction.coefficient
    if contact.pairs is None:
        return common > 0.0
    return any(common if pair.friction is None else pair.friction for pair in contact.pairs)
