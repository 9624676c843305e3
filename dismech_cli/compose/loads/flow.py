"""Drag of a fluid that moves: its velocity as fields over time and space."""

from __future__ import annotations

from ...errors import LawError
from ...laws.expression import ExpressionError, compile_expression
from ...laws.field import SPACE, Field, Spatial, Uniform
from ...model.flow import Drag, DragInFlow
from ...model.term import Term
from ...scenario.values.law import ExpressionLaw, FluidVelocity, LawSpec
from ..laws import ToLaw, vanishes
from ..scene import Scene
from ..structure.structure import Structure
from .vectors import Place


def in_flow(
    scene: Scene, structure: Structure, place: Place, velocity: FluidVelocity | None, drag: Drag
) -> Term:
    """A drag in the fluid that the scenario says; itself where the fluid is still.

    Raises:
        ScenarioError: The fluid leaves the plane of a planar scene, or its velocity has no value or slope
            where the bodies rest.
    """
    if velocity is None:
        return drag
    key = place.key("fluid_velocity")
    try:
        fields = [_field(spec, scene.laws) for spec in velocity]
    except ExpressionError as error:
        raise scene.error(key, str(error)) from error
    axes = structure.dofs.axes
    for axis, one in enumerate(fields):
        if axis not in axes and not (isinstance(one, Uniform) and vanishes(one.law)):
            raise scene.error(key, f"has a part in {'xyz'[axis]}, out of the plane of the scene")
    drag_in_flow = DragInFlow(drag, tuple(fields[axis] for axis in axes), structure.dofs)
    try:
        drag_in_flow.refuse_infinite(structure.rest)
    except LawError as error:
        raise scene.error(key, str(error)) from error
    return drag_in_flow


def _field(spec: LawSpec, laws: ToLaw) -> Field:
    if isinstance(spec, ExpressionLaw):
        compiled = compile_expression(spec.expression, ("t", *SPACE))
        if compiled.variables.intersection(SPACE):
            return Spatial(spec.expression)
    return Uniform(laws(spec))
