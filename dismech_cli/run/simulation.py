"""Everything a run needs, built without a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any

from numpy.typing import NDArray

from ..control.loop import UNCONTROLLED, Controls
from ..frozen import frozen
from ..model.model import Model
from ..model.state import State
from ..output.frame import Topology
from ..solve.integrators import Integrator
from ..solve.problem import NewtonSettings
from ..solve.step import Advance, through_stages
from .looks import Looks, at_ends
from .observables.probes import Probe
from .observables.rod_fields import Field
from .roles import Roles
from .step_control import StepControl
from .touched import Touched
from .validity import Check


@frozen(kw_only=True)
class Simulation:
    """A scene ready to step.

    Attributes:
        name: Name of the scene.
        model: The semi-discrete system.
        roles: Place of each term in the energy account.
        integrator: Time integrator.
        newton: Newton's stopping rule.
        linear_solver: Key of the solver table, or ``auto``.
        control: Decides how far each step goes; here, as the run starts.
        frame_every: Time between frames [s].
        looks: When it is looked at.
        start: The state at t = 0.
        topology: What the writers need to know once.
        fields: Fields of every frame.
        probes: Extra columns of the scalar table.
        watched: Probes read after every step, for expectations.
        places: A word for where each visible node lies: object and arc length.
        advance: How steps go.
        checks: Limits of its models.
        touched: Reads what contact leaves in states; None without contact.
        controls: What acts on the state before every step.
        structure: What its states are states of, by name: kept with them.
    """

    name: str
    model: Model
    roles: Roles
    integrator: Integrator
    newton: NewtonSettings
    linear_solver: str
    control: StepControl
    frame_every: float
    start: State
    topology: Topology
    fields: tuple[Field, ...]
    probes: Mapping[str, Probe]
    watched: Mapping[str, Probe]
    places: Sequence[str]
    advance: Advance = through_stages
    checks: tuple[Check, ...] = ()
    touched: Touched | None = None
    controls: Controls = UNCONTROLLED
    structure: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    looks: Looks = at_ends
