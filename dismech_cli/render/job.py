"""What a drawing process is told: plain JSON, so that it can be another program."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..output.frame import FieldSpec
from ..output.read import Run
from .coloring import Field, Painter, Scale
from .framing import Framing
from .settings import Camera, Image, Settings, Solid
from .timeline import Shot


@frozen(kw_only=True)
class Stage:
    """What a renderer works with.

    Attributes:
        run: The open run.
        shots: To draw, in order.
        settings: What the pictures show.
        framing: The camera of each shot.
        painter: Colours.
        ghosts: Earlier shapes.
        times: Of all frames [s], shape (F,).
        paths: Of the nodes that leave a line, by frame [m], shape (F, K, 3).
    """

    run: Run
    shots: Sequence[Shot]
    settings: Settings
    framing: Framing
    painter: Painter
    ghosts: Sequence[Shot]
    times: FloatArray
    paths: FloatArray

    def trails(self, shot: Shot) -> FloatArray:
        """Paths of the nodes that leave a line, up to a shot [m], shape (K, points, 3)."""
        past = self.paths[: np.searchsorted(self.times, shot.t)]
        return np.concatenate((past, shot.between(self.paths)[None])).swapaxes(0, 1)


class Renderer(Protocol):
    """Draws the shots of a stage without labels."""

    def __call__(self, stage: Stage) -> Iterator[Image]:
        """Yield one picture per shot, in order: RGBA on a transparent background, else RGB."""


@frozen(kw_only=True)
class Job:
    """Shots to draw; the pictures go to stdout, one after another.

    Attributes:
        run_dir: The run.
        renderer: ``pyvista`` or ``matplotlib``.
        settings: What the pictures show.
        framing: The camera of each shot.
        field: The field that colours the bodies, or None.
        scale: Its colours, or None.
        shots: In order.
        decimals: Digits of the time after the point.
    """

    run_dir: Path
    renderer: str
    settings: Settings
    framing: Framing
    field: Field | None
    scale: Scale | None
    shots: tuple[Shot, ...]
    decimals: int

    def share(self, part: slice) -> Job:
        """The same for some of the shots."""
        framing = replace(self.framing, centers=self.framing.centers[part])
        return replace(self, framing=framing, shots=self.shots[part])

    @property
    def channels(self) -> int:
        """Numbers of a pixel."""
        return 4 if self.settings.background == "transparent" else 3

    def to_json(self) -> str:
        """Text for :meth:`from_json`."""
        return json.dumps(asdict(self), default=_plain)

    @classmethod
    def from_json(cls, text: str) -> Job:
        """Read what :meth:`to_json` wrote."""
        content: dict[str, Any] = json.loads(text)
        framing, field = content["framing"], content["field"]
        for name in ("basis", "centers"):
            framing[name] = np.array(framing[name], dtype=np.float64).reshape(-1, 3)
        if field is not None:
            file = None if field["file"] is None else Path(field["file"])
            field = Field(spec=FieldSpec(**field["spec"]), file=file)
        return cls(
            run_dir=Path(content["run_dir"]),
            renderer=content["renderer"],
            settings=_settings(content["settings"]),
            framing=Framing(**framing),
            field=field,
            scale=None if content["scale"] is None else _scale(content["scale"]),
            shots=tuple(Shot(**shot) for shot in content["shots"]),
            decimals=content["decimals"],
        )


def _plain(value: Any) -> Any:
    return str(value) if isinstance(value, Path) else value.tolist()


def _scale(content: dict[str, Any]) -> Scale:
    return Scale(**{**content, "table": np.array(content["table"], dtype=np.uint8)})


def _settings(content: dict[str, Any]) -> Settings:
    """Lists were tuples, and keys numbers."""
    colors = {int(body): tuple(color) for body, color in content.pop("colors").items()}
    camera = Camera(**_tuples(content.pop("camera")))
    joints = tuple((node, bends) for node, bends in content.pop("joints"))
    obstacles = tuple(_solid(one) for one in content.pop("obstacles"))
    return Settings(camera=camera, colors=colors, joints=joints, obstacles=obstacles, **_tuples(content))


def _solid(content: dict[str, Any]) -> Solid:
    arrays = {name: np.array(content[name]) for name in ("times", "origins", "turns", "triangles")}
    arrays["triangles"] = arrays["triangles"].reshape(-1, 3, 3)
    return Solid(**{**_tuples(content), **arrays})


def _tuples(content: dict[str, Any]) -> dict[str, Any]:
    return {key: tuple(value) if isinstance(value, list) else value for key, value in content.items()}
