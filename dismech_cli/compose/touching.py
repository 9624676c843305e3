"""Who may touch whom, by names: asked by contact, by probes and by checks, also where there is none."""

from __future__ import annotations

from ..scenario.language.scenario import Scenario


def named_pairs(scenario: Scenario) -> dict[tuple[str, str], float]:
    """Coefficient of friction of each pair: bodies in the order of the scenario, obstacles after them."""
    spec = scenario.contact
    if spec is None:
        return {}
    common = 0.0 if spec.friction is None else spec.friction.coefficient
    bodies = [one.name for one in scenario.geometry]
    obstacles = [one.name for one in scenario.obstacles]
    if spec.pairs is None:
        return {
            (one, other): common
            for index, one in enumerate(bodies)
            for other in (*bodies[index:], *obstacles)
        }
    order = {name: place for place, name in enumerate((*bodies, *obstacles))}
    found = {}
    for pair in spec.pairs:
        first, second = sorted(pair.between, key=order.__getitem__)
        found[first, second] = common if pair.friction is None else pair.friction
    return found
