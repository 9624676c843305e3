"""How a solve can end; failing is a result, not an exception."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """Outcome of a step; the value is one line of advice."""

    CONVERGED = "converged"
    MAX_ITERATIONS = "Newton did not converge: reduce numerics.dt, or raise numerics.newton.max_iterations"
    LINE_SEARCH_FAILED = (
        "no step lowers the energy: the state is near a fold or snap-through; reduce numerics.dt, "
        "or use a dynamic integrator to pass it"
    )
    FACTORIZATION_FAILED = (
        "the stiffness matrix is singular: a part is free to move without resistance; clamp it, "
        "or use a dynamic integrator"
    )
    NOT_FINITE = (
        "a residual became infinite or NaN: an edge folded back on itself or collapsed; reduce numerics.dt"
    )

    AMBIGUOUS = "the step has more than one solution, as where something buckles: reduce numerics.dt"
    UNSETTLED = "bodies stay deeper in each other than they may: reduce numerics.dt"
    BRANCHED = "another branch of equilibria leaves the path within the step"
    TURNED = "the path of equilibria turns within the step: reduce numerics.integrator.path.largest"

    @property
    def advice(self) -> str:
        """One line of advice."""
        return self.value
