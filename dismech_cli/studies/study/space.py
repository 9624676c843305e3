"""The settings of a study: alternatives, each on levels of time and of mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, Final

from ...errors import ScenarioError
from ...frozen import frozen
from ...output.jsonable import dumps
from ...scenario.language.numerics import Static
from ...scenario.language.study import Axis, Levels, Study
from ...scenario.language.sweep import amount
from ...scenario.load import LoadedScenario

TIME_KEYS: Final = ("numerics.dt", "numerics.step.rtol", "numerics.integrator.load_steps")
_INTEGRATOR: Final = "numerics.integrator"
_COARSER, _LEVELS = 4.0, 5
# Orders of the error in rtol: every step may err by it, and their number falls with its cube root.
_RTOL_ORDER: Final = 2.0 / 3.0
_MESH_ORDER: Final = 2.0

Setting = tuple[str, str]
"""A key path and a value, as ``--set`` takes them."""


@frozen
class Line:
    """Levels of refinement.

    Attributes:
        keys: What is set; empty where nothing is refined.
        texts: Values of each level, the coarsest first: one per key.
        ratio: From one level to the next.
    """

    keys: tuple[str, ...] = ()
    texts: tuple[tuple[str, ...], ...] = ((),)
    ratio: float = 2.0

    def __len__(self) -> int:
        return len(self.texts)

    def settings(self, level: int) -> tuple[Setting, ...]:
        """What a level sets."""
        return tuple(zip(self.keys, self.texts[level], strict=True))


@frozen
class Space:
    """All that is tried.

    Attributes:
        methods: Alternatives: what each sets.
        time: Levels of the step.
        mesh: Levels of the mesh.
    """

    methods: tuple[tuple[Setting, ...], ...]
    time: Line
    mesh: Line

    @property
    def count(self) -> int:
        """How many combinations there are."""
        return len(self.methods) * len(self.time) * len(self.mesh)

    def settings(self, method: int, time: int, mesh: int) -> tuple[Setting, ...]:
        """What a point sets."""
        return (*self.methods[method], *self.time.settings(time), *self.mesh.settings(mesh))

    @property
    def finer(self) -> str:
        """The option that adds levels, ready to type where the step alone is refined."""
        if len(self.methods) > 1 or len(self.time.keys) != 1 or len(self.mesh) > 1 or self.time.ratio != 2.0:
            return "--over KEY=FROM:LEVELS"
        return f"--over '{self.time.keys[0]}={self.time.texts[0][0]}:{len(self.time) + 2}'"

    def time_order(self, integrator_order: int) -> float:
        """Order in the time levels that is to be expected."""
        return _RTOL_ORDER if "numerics.step.rtol" in self.time.keys else float(max(integrator_order, 1))

    @property
    def mesh_order(self) -> float:
        """Order in the mesh that is to be expected."""
        return _MESH_ORDER


def make_space(loaded: LoadedScenario, over: Mapping[str, Axis] | None) -> Space:
    """What a study tries.

    Args:
        loaded: The scenario.
        over: Axes by key path; None takes levels of its step.

    Raises:
        ScenarioError: They do not go together.
    """
    axes = over or _default(loaded)
    lists = {key: axis for key, axis in axes.items() if not isinstance(axis, Levels)}
    refined = {key: axis for key, axis in axes.items() if isinstance(axis, Levels)}
    times = [key for key in refined if key in TIME_KEYS]
    if len(times) > 1:
        raise ScenarioError(f"study: {' and '.join(times)} both refine time; give one")
    chosen = [tuple(_choice(key, value) for value in axis) for key, axis in lists.items()]
    meshes = {key: axis for key, axis in refined.items() if key not in TIME_KEYS}
    return Space(
        methods=tuple(product(*chosen)),
        time=_line({key: refined[key] for key in times}),
        mesh=_line(meshes),
    )


def _default(loaded: LoadedScenario) -> Mapping[str, Axis]:
    numerics = loaded.scenario.numerics
    if isinstance(numerics.integrator, Static):
        raise ScenarioError("study: say what is tried, as in --over 'geometry[0].generate.nodes=11:4'")
    if numerics.adapts:
        return {TIME_KEYS[1]: Levels.model_validate({"from": 1e-2, "levels": 4, "factor": 4.0})}
    coarsest = _COARSER * (numerics.dt or 0.0)
    return {TIME_KEYS[0]: Levels.model_validate({"from": f"{coarsest!r} s", "levels": _LEVELS})}


def with_study(loaded: LoadedScenario) -> Study:
    """The section of the scenario, or one of defaults."""
    return loaded.scenario.study or Study()


def _choice(key: str, value: Any) -> Setting:
    """An alternative; integrators by their names."""
    if key == _INTEGRATOR and isinstance(value, str):
        return key, f"{{type: {value}}}"
    return key, value if isinstance(value, str) else dumps(value)


def _line(refined: Mapping[str, Levels]) -> Line:
    if not refined:
        return Line()
    shapes = {(axis.levels, axis.factor) for axis in refined.values()}
    if len(shapes) > 1:
        raise ScenarioError(f"study: {', '.join(refined)} refine together: give equal 'levels' and 'factor'")
    ((levels, factor),) = shapes
    columns = [_texts(key, axis) for key, axis in refined.items()]
    if any(len(set(column)) < levels for column in columns):
        raise ScenarioError("study: two levels are the same; start finer, or with a larger factor")
    return Line(tuple(refined), tuple(zip(*columns, strict=True)), factor)


def _texts(key: str, axis: Levels) -> Sequence[str]:
    number, unit = amount(axis.from_)
    scales = [axis.factor**level for level in range(axis.levels)]
    if isinstance(axis.from_, int) and not isinstance(axis.from_, bool):
        if key.rpartition(".")[2] == "nodes":
            return [str(round((number - 1) * scale) + 1) for scale in scales]
        return [str(round(number * scale)) for scale in scales]
    return [f"{number / scale:.9g} {unit}".rstrip() for scale in scales]


def stretched(settings: tuple[Setting, ...], factor: float) -> tuple[Setting, ...]:
    """The same settings with a longer ``numerics.dt``."""
    return tuple(
        (key, _scaled(text, factor)) if key == TIME_KEYS[0] else (key, text) for key, text in settings
    )


def _scaled(text: str, factor: float) -> str:
    number, unit = amount(text)
    return f"{number * factor:.3g} {unit}".rstrip()
