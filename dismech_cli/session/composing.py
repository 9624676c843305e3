"""A scenario composed while its narrator is told what is made of it."""

from __future__ import annotations

from ..compose.compose import Composition, compose
from ..compose.numerics import DRIVERS
from ..compose.structure.kernels import Repays, among_many
from ..compose.structure.plan import Plan
from ..control.plugin import NONE, Plugins
from ..errors import ScenarioError
from ..kernels.availability import numba_fault
from ..scenario.load import LoadedScenario
from ..words import listed
from .garbage import search
from .narrator import Narrator


def composed(
    loaded: LoadedScenario,
    kernels: str | None,
    narrator: Narrator,
    plugins: Plugins = NONE,
    repays: Repays = among_many,
) -> Composition:
    """Compose a scenario and tell its plan.

    Args:
        loaded: The scenario.
        kernels: Overrides the plan's choice of kernels.
        narrator: Told the plan before anything is built, which may take long to compile.
        plugins: Where controllers of plugins come from.
        repays: What compiling kernels must save where the plan chooses them.

    Raises:
        ScenarioError: It cannot be composed, or there are no such kernels.
    """
    # compiling makes much garbage, and so may large models
    search()
    if kernels is not None and kernels not in DRIVERS:
        raise ScenarioError(f"unknown kernels {kernels!r}: expected {listed(DRIVERS)}")
    if kernels == "numba" and (fault := numba_fault()):
        raise ScenarioError(f"kernels by numba, which {fault.text}")
    return compose(
        loaded, kernels, planned=lambda plan: tell_plan(plan, narrator), plugins=plugins, repays=repays
    )


def tell_doubts(composition: Composition, narrator: Narrator) -> None:
    """Tell what was made of the meshes, and what the plan doubts; a resumed run has told it before."""
    for note in composition.geometry.notes:
        narrator.say(note)
    for warning in composition.plan.warnings:
        narrator.warn(warning)


def tell_plan(plan: Plan, narrator: Narrator) -> None:
    """Tell the plan, and why nothing happens while kernels are compiled."""
    narrator.say("plan: " + "; ".join(d.what.partition(":")[0] for d in plan.decisions))
    for decision in plan.decisions:
        narrator.detail(f"  {decision.what}: {decision.why}")
    if plan.compiling:
        narrator.say(f"compiling {plan.compiling} kernels, once")
