"""The semi-discrete system M a + r(q, v, t) = 0 of a scene."""

from __future__ import annotations

from ..arrays import FloatArray
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kinematics.dofs import DofMap
from ..kinematics.motion import Prescribed
from ..kinematics.rod_frames import Frames
from .term import ChangingTerm, Term


@frozen
class Model:
    """Everything physical about a scene; frozen.

    Attributes:
        dofs: Numbering of the DOFs.
        rest: Rest configuration q [m, rad], shape (n,).
        mass: Diagonal of the mass matrix [kg, kg m^2], shape (n,); zero in static scenes.
        terms: Energies and forces.
        motions: Prescribed DOFs.
        frames: Kinematics of material frames, or their absence.
        driver: Runs the kernels.
        length: Characteristic edge length [m]: relates forces to moments in tolerances.
        changing: Energies and forces whose stencils come and go.
    """

    dofs: DofMap
    rest: FloatArray
    mass: FloatArray
    terms: tuple[Term, ...]
    motions: tuple[Prescribed, ...]
    frames: Frames
    driver: Driver
    length: float
    changing: tuple[ChangingTerm, ...] = ()
