"""The table of tangents that Newton may step with."""

from __future__ import annotations

from ..arrays import FloatArray
from .assembly import Linearized
from .problem import Factorize, StageProblem, Tangent, exact


def projected_where_indefinite(problem: StageProblem, q: FloatArray, now: Linearized) -> Tangent:
    """The exact one, but an indefinite tangent gives way to the one projected stencil by stencil.

    So steps go downhill past buckling, and the rate is quadratic where the end is stable.
    """
    tangent = exact(problem, q, now)
    if not tangent.factors.indefinite:
        return tangent
    return exact(problem, q, problem.linearize_projected(q))


TANGENTS: dict[str, Factorize] = {"none": exact, "indefinite": projected_where_indefinite}
