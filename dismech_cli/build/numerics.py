"""Numerical choices of the scenario."""

from __future__ import annotations

from ..model.driver import Driver
from ..model.numba_driver import NumbaDriver
from ..model.numpy_driver import NumpyDriver
from ..scenario import numerics as said
from ..solve import integrators as made

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


def build_driver(name: str) -> Driver:
    """What runs the kernels."""
    return DRIVERS[name]()
