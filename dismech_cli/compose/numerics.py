"""Numerical choices of the scenario."""

from __future__ import annotations

from ..kernels.driver import Driver
from ..kernels.numba_driver import NumbaDriver
from ..kernels.numpy_driver import NumpyDriver
from ..scenario.language import numerics as said
from ..scenario.load import LoadedScenario
from ..solve import integrators as made
from ..solve.linear.pardiso import pardiso_available
from ..solve.newton import NewtonSettings
from ..solve.tangents import TANGENTS

DRIVERS: dict[str, type[NumpyDriver] | type[NumbaDriver]] = {"numpy": NumpyDriver, "numba": NumbaDriver}


def build_integrator(spec: said.Integrator) -> made.Integrator:
    """The time integrator."""
    match spec:
        case said.Static():
            return made.Static()
        case said.ImplicitEuler():
            return made.ImplicitEuler()
        case said.ImplicitMidpoint():
            return made.ImplicitMidpoint()
        case said.Newmark():
            return made.Newmark(spec.beta, spec.gamma)
        case said.GeneralizedAlpha():
            return made.GeneralizedAlpha(spec.spectral_radius)
        case said.TrBdf2():
            return made.TrBdf2()


def build_newton(spec: said.Newton) -> NewtonSettings:
    """The nonlinear solver."""
    return NewtonSettings(spec.tolerance, spec.max_iterations, TANGENTS[spec.projection])


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
