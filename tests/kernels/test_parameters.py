"""Kernels name their parameters, and mean by the names what they say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cases import NUMPY, TermCase, adapted, configuration, disturbed, term_cases
from derivatives import Probe
from hybrid_cases import hybrid
from numpy.testing import assert_allclose
from shell_cases import shell
from shipped import shipped

from dismech_cli.arrays import FloatArray
from dismech_cli.energies.membrane_neo_hookean import MEMBRANE_NEO_HOOKEAN
from dismech_cli.energies.stretch import STRETCH
from dismech_cli.energies.stretch_neo_hookean import STRETCH_NEO_HOOKEAN, STRETCH_NEO_HOOKEAN_PLANAR
from dismech_cli.kernels.shape import DragKernel, Kernel, LoadKernel, Parameters
from dismech_cli.mesh.generate.rings import hemisphere
from dismech_cli.model.drag import DragForce
from dismech_cli.model.stencil import StencilEnergy


def cases() -> dict[str, TermCase]:
    """An energy of every kernel, in a state where nothing vanishes by chance."""
    out = {name: case for name, case in term_cases().items() if isinstance(case.term, StencilEnergy)}
    for bending in ("hinge", "midedge", "averaged"):
        made = shell(hemisphere(1.0, 2), bending)
        out[bending] = TermCase(made.term("bend"), made.model)
    out["membrane"] = TermCase(made.term("membrane"), made.model)
    rubber = {name: made.term("membrane").parameter(name) for name in ("growth", "A11", "A22", "A12")}
    out["membrane_neo_hookean"] = _like(out["membrane"], MEMBRANE_NEO_HOOKEAN, rubber | {"muV": 0.7})
    for name, kernel in (
        ("stretch", STRETCH_NEO_HOOKEAN),
        ("stretch_planar", STRETCH_NEO_HOOKEAN_PLANAR),
    ):
        values = {"eps": 0.0, "length": _energy(out[name]).parameter("length"), "EA": 1.3, "muA": 0.7}
        out[f"{name}_neo_hookean"] = _like(out[name], kernel, values)
    joined = hybrid(True)
    out["rod_on_face"] = TermCase(joined.on, joined.model)
    out["rod_beside_face"] = TermCase(joined.beside, joined.model)
    return out


def _like(case: TermCase, kernel: Kernel, values: dict[str, FloatArray | float]) -> TermCase:
    """The stencils of another kernel."""
    term = StencilEnergy.of("rubber", kernel, _energy(case).dofs, values)
    return TermCase(term, case.model)


def _energy(case: TermCase) -> StencilEnergy:
    assert isinstance(case.term, StencilEnergy)
    return case.term


CASES = cases()
ENERGIES = {name: kernel for name, kernel in shipped(Kernel).items() if isinstance(kernel, Kernel)}
DRAGS = {name: kernel for name, kernel in shipped(DragKernel).items() if isinstance(kernel, DragKernel)}

LOADS = {name: kernel for name, kernel in shipped(LoadKernel).items() if isinstance(kernel, LoadKernel)}


def energy(case: TermCase, term: StencilEnergy) -> float:
    """Energy of a term at a disturbed state [J]."""
    q = disturbed(case.model, seed=31, size=0.1)
    return Probe.of(term, case.model, NUMPY).energy(
        configuration(case.model, q, 0.0 * q, adapted(case.model, q))
    )


def energy_term(name: str) -> StencilEnergy:
    term = CASES[name].term
    assert isinstance(term, StencilEnergy)
    return term


def test_every_kernel_is_looked_at() -> None:
    assert {energy_term(name).kernel for name in CASES} == set(ENERGIES.values())
    assert set(DRAGS) == {"RESISTIVE", "RESISTIVE_PLANAR", "AERODYNAMIC"}


@pytest.mark.parametrize("name", [*ENERGIES, *DRAGS, *LOADS])
def test_names_are_unique_and_naturals_come_first(name: str) -> None:
    kernel = (ENERGIES | DRAGS | LOADS)[name]
    names = kernel.parameters.names
    assert len(set(names)) == len(names) == len(kernel.parameters)
    assert [kernel.parameters.row(one) for one in names] == list(range(len(names)))
    if isinstance(kernel, Kernel):
        assert names[: len(kernel.naturals)] == kernel.naturals


@pytest.mark.parametrize("name", CASES)
def test_energies_are_linear_in_their_stiffnesses(name: str) -> None:
    """So slopes by the names, here exact differences, add up to the energy: K dE/dK summed is E."""
    case, term = CASES[name], energy_term(name)
    stiffnesses = {one for scale in term.kernel.scales for one in scale}
    # straight rods and welds have no natural strain that would tell them
    stiffnesses |= {"EI", "K_0", "K_1", "K_2"} & set(term.kernel.constants)
    here, shares = energy(case, term), []
    for one in sorted(stiffnesses):
        up, down = (energy(case, term.having({one: f * term.parameter(one)})) for f in (1.5, 0.5))
        shares.append(up - down)
    assert_allclose(sum(shares), here, rtol=1e-12)


@pytest.mark.parametrize("name", [name for name in CASES if energy_term(name).kernel.naturals])
def test_scales_weigh_their_natural_strain(name: str) -> None:
    """Without its stiffnesses a natural strain changes nothing; with them it does."""
    case, term = CASES[name], energy_term(name)
    every = {one for scale in term.kernel.scales for one in scale}
    on = term.having({one: 1.0 for one in every})
    for natural, scale in zip(term.kernel.naturals, term.kernel.scales, strict=True):
        moved: dict[str, FloatArray | float] = {natural: term.parameter(natural) + 0.1}
        off = on.having({one: 0.0 for one in scale})
        assert energy(case, off.having(moved)) == energy(case, off)
        assert abs(energy(case, on.having(moved)) - energy(case, on)) > 1e-6 * energy(case, on)


def test_terms_are_made_by_name() -> None:
    case = CASES["stretch"]
    term = energy_term("stretch")
    values = {name: term.parameter(name) for name in reversed(term.kernel.parameters.names)}
    again = StencilEnergy.of("stretch", term.kernel, term.dofs, values)
    assert np.array_equal(again.parameters, term.parameters)
    assert energy(case, again) == energy(case, term)
    with pytest.raises(KeyError, match="no value for length"):
        StencilEnergy.of("stretch", STRETCH, term.dofs, {"eps": 0.0, "EA": 1.0})
    with pytest.raises(KeyError, match="no parameter EI: the kernel has eps, EA, length"):
        StencilEnergy.of("stretch", STRETCH, term.dofs, values | {"EI": 1.0})
    with pytest.raises(KeyError, match="no parameter EI"):
        term.having({"EI": 1.0})
    with pytest.raises(ValueError, match="broadcast"):
        StencilEnergy.of("stretch", STRETCH, term.dofs, values | {"EA": np.ones(2)})


def test_drags_are_made_by_name() -> None:
    kernel = DRAGS["RESISTIVE"]
    values = {"normal": 3.0, "length": np.arange(2.0), "tangential": 2.0}
    drag = DragForce.of("drag", kernel, np.arange(18).reshape(2, 9), values)
    assert np.array_equal(drag.parameters, [[0.0, 1.0], [2.0, 2.0], [3.0, 3.0]])
    assert np.array_equal(drag.parameter("tangential"), [2.0, 2.0])


def test_kernels_refuse_names_that_mean_nothing() -> None:
    with pytest.raises(ValueError, match="named twice"):
        Parameters(("EA", "EA"))
    with pytest.raises(ValueError, match="every natural strain"):
        replace(STRETCH, scales=())
    with pytest.raises(ValueError, match="EI scales a natural strain"):
        replace(STRETCH, scales=(("EI",),))
