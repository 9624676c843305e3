"""What a run takes, roughly, and how that depends on what runs its kernels."""

from __future__ import annotations

from typing import Final

from ..frozen import frozen
from ..scenario.language.numerics import Numerics, Static
from .bodies.geometry import Geometry
from .numerics import build_integrator

# Measured on one core of 2.5 GHz: seconds per Newton iteration, fixed, per edge and per triangle,
# linear solve included; factors of a surface fill by a power of its size. Good within a factor of three.
_ITERATION: Final = {"numpy": (1.2e-3, 3.0e-6, 4.0e-6), "numba": (0.2e-3, 1.2e-6, 1.0e-6)}
# Frames of rods cost NumPy this much more in each, mostly in calls.
_FRAMES: Final = 0.8e-3
# Steps that are compiled whole cost this instead: a step, an iteration, an edge, and one with frames more.
_WHOLE_STEP, _WHOLE, _WHOLE_EDGE, _WHOLE_FRAME = 0.08e-3, 0.02e-3, 0.4e-6, 0.8e-6
_FILL, _FILL_POWER = 3.3e-7, 1.35
# Besides its iterations a step costs this, for the account and what is watched, and more where controllers
# act; and contact this in each iteration [s].
_STEP: Final = {"numpy": 0.6e-3, "numba": 0.15e-3}
_CONTROL: Final = 0.25e-3
_CONTACT: Final = {"numpy": 3.0e-3, "numba": 1.0e-3}
# Newton iterations of a load step and of a stage of a time step, and what adaptive steps and contact add.
_OF_STATICS, _OF_STAGE, _OF_ADAPTING, _OF_CONTACT = 5.0, 1.8, 0.2, 0.2
# Steps of runs that choose their own, as a rule.
_ADAPTIVE_STEPS: Final = 500.0


@frozen(kw_only=True)
class Work:
    """What a run has to do.

    Attributes:
        steps: Its steps.
        iterations: Newton iterations that a step usually takes.
        edges: Number of rod edges.
        triangles: Number of triangles.
        touching: Whether bodies may touch.
        framed: Whether rods carry frames.
        controlled: Whether controllers act.
    """

    steps: float
    iterations: float
    edges: int
    triangles: int
    touching: bool
    framed: bool = False
    controlled: bool = False

    @classmethod
    def of(
        cls,
        numerics: Numerics,
        geometry: Geometry,
        *,
        touching: bool,
        framed: bool,
        controlled: bool = False,
        steps: float | None = None,
    ) -> Work:
        """Count it.

        Args:
            numerics: Of the scenario.
            geometry: Its bodies.
            touching: Whether bodies may touch.
            framed: Whether rods carry frames.
            controlled: Whether controllers act, where that is known.
            steps: How many, where that is known better than from the numerics.
        """
        return cls(
            steps=_steps(numerics) if steps is None else steps,
            iterations=_iterations(numerics, touching=touching),
            edges=len(geometry.edges),
            triangles=len(geometry.triangles),
            touching=touching,
            framed=framed,
            controlled=controlled,
        )

    def seconds(self, kernels: str, *, whole: bool = False) -> float:
        """Rough time [s] with ``numpy`` or ``numba``, whose steps may be compiled whole."""
        step = _CONTROL if self.controlled else 0.0
        if whole:
            edge = _WHOLE_EDGE + (_WHOLE_FRAME if self.framed else 0.0)
            return self.steps * (step + _WHOLE_STEP + self.iterations * (_WHOLE + edge * self.edges))
        fixed, edge, triangle = _ITERATION[kernels]
        fixed += _FRAMES if self.framed and kernels == "numpy" else 0.0
        fill: float = _FILL * float(self.triangles) ** _FILL_POWER
        iteration = fixed + edge * self.edges + triangle * self.triangles + fill
        iteration += _CONTACT[kernels] if self.touching else 0.0
        return self.steps * (step + _STEP[kernels] + self.iterations * iteration)


def _steps(numerics: Numerics) -> float:
    if isinstance(numerics.integrator, Static):
        return numerics.integrator.steps
    if numerics.adapts:
        return _ADAPTIVE_STEPS
    return (numerics.t_end or 0.0) / (numerics.dt or 1.0)


def _iterations(numerics: Numerics, *, touching: bool) -> float:
    if isinstance(numerics.integrator, Static):
        return _OF_STATICS
    stage = _OF_STAGE + (_OF_ADAPTING if numerics.adapts else 0.0) + (_OF_CONTACT if touching else 0.0)
    return stage * build_integrator(numerics.integrator).stages
