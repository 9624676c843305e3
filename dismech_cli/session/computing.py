"""A field that a run did not store, computed from the states in its frames."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import get_args

import numpy as np

from ..arrays import FloatArray
from ..compose.compose import compose
from ..control.plugin import Dummies
from ..errors import ScenarioError
from ..kinematics.rod_frames import FrameState
from ..model.state import State
from ..output.read import Run
from ..output.run_directory import SCENARIO_FILE
from ..render.coloring import Field
from ..run.account import EnergyAccount
from ..run.observables.rod_fields import Field as Observable
from ..run.observe import Observer
from ..run.simulation import Simulation
from ..scenario.language.render import ContactField
from ..scenario.load import load
from ..solve.step import Stepper


def computed_field(run: Run, name: str, file: Path) -> Field:
    """Compute a field of every frame.

    Args:
        run: The open run.
        name: A field of the scenario language.
        file: Where its values go, a NumPy file.

    Raises:
        ScenarioError: There is no such field in this scene, or the frames do not tell it: how
            cross-sections turn depends on every step, and so does contact.
    """
    if name in get_args(ContactField):
        raise ScenarioError(
            f"cannot colour by {name!r}: it depends on how stiff contact was at every step, which the frames "
            f"of {run.path} do not tell; add it to 'output: fields' and run again"
        )
    wanted = (f"output.fields=[{name}]", "output.render={}")
    loaded = load(run.path / SCENARIO_FILE, overrides=wanted)
    simulation = compose(loaded, kernels="numpy", plugins=Dummies()).simulation
    (observable,) = simulation.fields
    values = _values(run, simulation, observable, name)
    np.save(file, values)
    return Field(spec=observable.spec, file=file)


def _values(run: Run, simulation: Simulation, observable: Observable, name: str) -> FloatArray:
    """Values of each frame, shape (F, ...)."""
    model = simulation.model
    stepper = Stepper(model, simulation.integrator, simulation.newton, simulation.linear_solver)
    account = EnergyAccount(model, simulation.roles, simulation.start)
    observer = Observer(simulation, stepper, account, lambda singular: None)
    turned = _unknown(model.frames.rest(model.rest))
    q, v, times = run.state("q"), run.state("v"), run.t
    nothing, unknown = np.zeros_like(model.rest), np.full_like(simulation.start.inputs, np.nan)
    found = []
    with np.errstate(all="ignore"):
        for frame in range(len(run)):
            state = State(float(times[frame]), q[frame], v[frame], nothing, turned, unknown)
            found.append(observable(observer.snapshot(state, nothing)))
            if np.isfinite(q[frame]).all() and not np.isfinite(found[-1]).all():
                raise ScenarioError(
                    f"cannot colour by {name!r}: it depends on how cross-sections turned at every step, or "
                    f"on what controllers did, which the frames of {run.path} do not tell; add it to "
                    "'output: fields' and run again"
                )
    return np.stack(found)


def _unknown(frames: FrameState) -> FrameState:
    """Frames that spoil whatever asks for them."""
    return FrameState(**{one.name: np.full_like(getattr(frames, one.name), np.nan) for one in fields(frames)})
