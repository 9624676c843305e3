"""Numerical choices of the scenario."""

from __future__ import annotations

from ..kernels.driver import Driver
from ..kernels.numba_driver import NumbaDriver
from ..kernels.numpy_driver import NumpyDriver
from ..run.tolerance import RTOL
from ..scenario.language import numerics
from ..scenario.load import LoadedScenario
from ..solve import integrators
from ..solve.linear.pardiso import pardiso_available
from ..solve.problem import NewtonSettings
from ..solve.tangents import TANGENTS

DRIVERS: dict[str, type[NumpyDriver] | type[NumbaDriver]] = {"numpy": NumpyDriver, "numba": NumbaDriver}


def build_integrator(spec: numerics.Integrator) -> integrators.Integrator:
    """The time integrator."""
    match spec:
        case numerics.Static():
            return integrators.Static()
        case numerics.ImplicitEuler():
            return integrators.ImplicitEuler()
        case numerics.ImplicitMidpoint():
            return integrators.ImplicitMidpoint()
        case numerics.Newmark():
            return integrators.Newmark(spec.beta, spec.gamma)
        case numerics.GeneralizedAlpha():
            return integrators.GeneralizedAlpha(spec.spectral_radius)
        case numerics.TrBdf2():
            return integrators.TrBdf2()


# Of what Newton leaves, statics keeps all and dynamics a part that time steps bury: measured on 28 scenes,
# 1e-5 changes 0.3 % of the error in time and saves a fifth of the iterations.
_STATIC_TOLERANCE, _DYNAMIC_TOLERANCE = 1e-8, 1e-5
# Adaptive steps need a balance as good as a part of their own error: it changes that by 3 % at most. What
# touches is balanced as in fixed steps: a barrier is stiffer than all else.
_PART_OF_ERROR, _LOOSEST = 0.1, 1e-4


def _dynamic_tolerance(spec: numerics.Numerics, *, touching: bool) -> float:
    if not spec.adapts:
        return _DYNAMIC_TOLERANCE
    loosest = _DYNAMIC_TOLERANCE if touching else _LOOSEST
    return min(_PART_OF_ERROR * (spec.step.rtol or RTOL), loosest)


def build_newton(spec: numerics.Numerics, *, driven: bool, touching: bool) -> NewtonSettings:
    """The nonlinear solver.

    Args:
        spec: Numerics of the scenario.
        driven: Whether motions move what they hold: such statics may buckle.
        touching: Whether bodies may touch: what holds them apart pushes them aside too.
    """
    newton = spec.newton
    if not isinstance(spec.integrator, numerics.Static):
        return NewtonSettings(
            tolerance=newton.tolerance or _dynamic_tolerance(spec, touching=touching),
            max_iterations=newton.max_iterations,
            patience=spec.step.patience,
            factorize=TANGENTS[newton.projection or ("indefinite" if touching else "none")],
        )
    return NewtonSettings(
        tolerance=newton.tolerance or _STATIC_TOLERANCE,
        max_iterations=newton.max_iterations,
        patience=newton.max_iterations,
        factorize=TANGENTS[newton.projection or ("indefinite" if driven or touching else "none")],
    )


def follows_path(loaded: LoadedScenario) -> bool:
    """Whether the load factor is an unknown."""
    integrator = loaded.scenario.numerics.integrator
    return isinstance(integrator, numerics.Static) and integrator.path is not None


def build_driver(name: str) -> Driver:
    """What runs the kernels."""
    return DRIVERS[name]()


def check_linear_solver(loaded: LoadedScenario) -> None:
    """Refuse a linear solver that is not installed.

    Raises:
        ScenarioError: pointing to the choice.
    """
    if loaded.scenario.numerics.linear_solver == "pardiso" and not pardiso_available():
        raise loaded.error(
            ("numerics", "linear_solver"),
            "pypardiso with its MKL library is not installed: pip install pypardiso, or choose auto",
        )
