"""Small scenes in large motion, with the values that runs of them are differentiated by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dismech_cli.arrays import FloatArray
from dismech_cli.compose.compose import compose
from dismech_cli.run.course import Course
from dismech_cli.run.simulation import Simulation
from dismech_cli.scenario.load import load_mapping
from dismech_cli.session.sinks import Latest
from dismech_cli.solve.differentiated import Differentiated
from dismech_cli.solve.neighbours import DIFFERENCES, Neighbours
from dismech_cli.solve.status import Status
from dismech_cli.solve.tape import Tape, TapedStep

Deck = dict[str, Any]

RUBBER: Deck = {"youngs_modulus": 1e6, "poisson_ratio": 0.4, "density": 1000.0}
DOWN: Deck = {"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}
CLAMP: Deck = {"type": "clamp", "where": "arm.start"}


def dynamics(kind: str, dt: float = 0.015, steps: int = 8) -> Deck:
    return {"integrator": {"type": kind}, "dt": dt, "t_end": steps * dt, "step": {"patience": 100}}


STATIC: Deck = {"integrator": {"type": "static", "load_steps": 5}}
ALPHA = dynamics("generalized_alpha")


def arm(nodes: int = 9, **keys: Any) -> Deck:
    return {
        "type": "rod",
        "name": "arm",
        "material": "rubber",
        "radius": 5e-3,
        "generate": {"shape": "line", "from": [0, 0, 0], "to": [0.3, 0, 0], "nodes": nodes},
    } | keys


def scene(**keys: Any) -> Deck:
    return {
        "schema_version": 1,
        "name": "slopes",
        "materials": {"rubber": RUBBER},
        "geometry": [arm()],
        "motions": [CLAMP],
        "forces": [DOWN],
        "numerics": ALPHA,
    } | keys


def planar(numerics: Deck = ALPHA) -> Deck:
    """A flat arm that bends itself, in drag, its clamp shaken."""
    shaken: Deck = {
        "type": "clamp",
        "where": "arm.start",
        "displacement": [0, 0, {"sine": {"amplitude": 0.02, "frequency": 3.0}}],
    }
    bent: Deck = {
        "type": "curvature_1",
        "rod": "arm",
        "value": {"table": [[0.0, 0.0], [0.06, 6.0], [0.2, -4.0]]},
    }
    drag: Deck = {"type": "viscous", "coefficient": 0.3}
    still = numerics["integrator"]["type"] == "static"
    forces = [DOWN] if still else [DOWN, drag]
    motions = [CLAMP] if still else [shaken]
    return scene(dimension=2, motions=motions, forces=forces, actuation=[bent], numerics=numerics)


SPIRAL: Deck = {
    "shape": "helix",
    "origin": [0, 0, 0],
    "handedness": "right",
    "axis": [0, 0, -1],
    "radius": 0.05,
    "pitch": 0.08,
    "turns": 1.0,
    "nodes": 11,
}


def framed(numerics: Deck = ALPHA, **keys: Any) -> Deck:
    """A helix that hangs and swings, with viscous stresses and a natural twist that grows."""
    twisted: Deck = {"type": "twist", "rod": "arm", "value": {"table": [[0.0, 0.0], [0.2, 20.0]]}}
    rubber = RUBBER if numerics is STATIC else RUBBER | {"relaxation_time": 0.01}
    body = arm(generate=SPIRAL, section={"type": "rectangular", "width": 8e-3, "thickness": 4e-3})
    del body["radius"]
    deck = scene(materials={"rubber": rubber}, geometry=[body], actuation=[twisted], numerics=numerics)
    return deck | keys


def sheet(bending: str, numerics: Deck = ALPHA, **keys: Any) -> Deck:
    """A flag clamped along a side, falling."""
    body: Deck = {
        "type": "shell",
        "name": "flag",
        "material": "rubber",
        "thickness": 2e-3,
        "bending": bending,
        "generate": {
            "shape": "sheet",
            "origin": [0.0, 0.0, 0.0],
            "length": 0.1,
            "width": 0.06,
            "divisions": 2,
        },
    } | keys
    return scene(geometry=[body], motions=[_wall(numerics)], numerics=numerics)


def _wall(numerics: Deck) -> Deck:
    """A clamp of a side; in statics of its triangles too, about which they would be free to turn."""
    within = 0.055 if numerics is STATIC else 2e-3
    return {"type": "clamp", "where": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0], "within": within}}}


def isotropic(numerics: Deck = ALPHA) -> Deck:
    """A straight arm that is thrown sideways and sags."""
    aside: Deck = {"type": "point", "where": "arm.end", "force": [0, {"table": [[0, 0.0], [0.1, 0.02]]}, 0]}
    drag: Deck = {"type": "viscous", "coefficient": 0.3}
    still = numerics["integrator"]["type"] == "static"
    return scene(forces=[DOWN, aside] if still else [DOWN, aside, drag], numerics=numerics)


def hybrid(bending: str = "midedge", numerics: Deck = ALPHA) -> Deck:
    """A flag whose pole is a rod that twists."""
    flag = sheet(bending)["geometry"][0]
    pole = arm(
        generate={"shape": "line", "from": [0.1, 0, 0], "to": [0.25, 0.02, 0.1], "nodes": 5},
        bending="framed",
    )
    joints: list[Deck] = [{"type": "auto"}]
    motions = [_wall(numerics)]
    if numerics is STATIC:  # the pole would turn about where it meets the flag
        motions.append({"type": "clamp", "where": "arm.end"})
    return scene(geometry=[flag, pole], joints=joints, motions=motions, numerics=numerics)


@dataclass(frozen=True)
class Case:
    """A scene and a value of it."""

    deck: Deck
    path: str
    value: float

    def simulation(self, part: float = 0.0) -> Simulation:
        """The scene with its value greater by a part, every balance solved to rounding."""
        value = float(self.value * (1.0 + part))
        found = compose(load_mapping(self.deck, overrides=[f"{self.path}={value!r}"]), "numpy").simulation
        return replace(found, newton=replace(found.newton, tolerance=1e-11))

    def run(self, part: float = 0.0) -> FloatArray:
        """The last shape, shape (n,)."""
        return last_shape(self.simulation(part))

    def taped(self) -> tuple[Simulation, list[TapedStep]]:
        """The scene, and the steps of its run."""
        simulation = self.simulation()
        tape = Tape(simulation.advance)
        last_shape(replace(simulation, advance=tape))
        return simulation, tape.steps

    def neighbours(self, step: float = 1e-4) -> Neighbours:
        near = [self.simulation(offset * step) for offset in DIFFERENCES[0].offsets]
        return Neighbours(
            step * self.value,
            DIFFERENCES[0],
            tuple(one.model for one in near),
            tuple(one.start for one in near),
        )


def last_shape(simulation: Simulation) -> FloatArray:
    """Where a run ends, shape (n,); the steps do not depend on what is run."""
    course = Course.of(simulation, Latest())
    course.begin()
    while not course.control.done:
        result = course.step()
        assert result.status is Status.CONVERGED, result.status
        course.accept(result)
    return course.state.q


def differentiated(
    cases: list[Case], simulation: Simulation, steps: Sequence[TapedStep] = ()
) -> Differentiated:
    """A scene with its slopes to the values of cases that are all of it, along what it did if it touches."""
    near = [case.neighbours() for case in cases]
    return Differentiated(simulation.model, simulation.integrator, near, steps=steps)


def central(case: Case, part: float) -> FloatArray:
    """Difference quotient of runs, shape (n,)."""
    return np.asarray((case.run(part) - case.run(-part)) / (2.0 * part * case.value))
