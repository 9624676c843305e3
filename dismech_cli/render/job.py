"""What a drawing process is told: plain JSON, so that it can be another program."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..output.read import Run
from .coloring import Scale
from .framing import Framing
from .settings import Settings

Image = NDArray[np.uint8]
"""RGB picture, shape (height, width, 3)."""


class Renderer(Protocol):
    """Draws frames of a run without labels."""

    def __call__(
        self, run: Run, frames: Sequence[int], settings: Settings, framing: Framing, scale: Scale | None
    ) -> Iterator[Image]:
        """Yield one picture per frame, in order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """Frames to draw, and where the pictures go.

    Attributes:
        run_dir: The run.
        renderer: ``pyvista`` or ``matplotlib``.
        settings: What the pictures show.
        framing: The camera.
        scale: The colours of the field, or None.
        frames: Frame numbers.
        files: One PNG file per frame.
    """

    run_dir: Path
    renderer: str
    settings: Settings
    framing: Framing
    scale: Scale | None
    frames: tuple[int, ...]
    files: tuple[Path, ...]

    def to_json(self) -> str:
        """Text for :meth:`from_json`."""
        content = asdict(self)
        content["run_dir"] = str(self.run_dir)
        content["files"] = [str(file) for file in self.files]
        content["framing"]["basis"] = self.framing.basis.tolist()
        content["framing"]["centers"] = self.framing.centers.tolist()
        return json.dumps(content)

    @classmethod
    def from_json(cls, text: str) -> Job:
        """Read what :meth:`to_json` wrote."""
        content: dict[str, Any] = json.loads(text)
        settings = content["settings"] | {"size": tuple(content["settings"]["size"])}
        framing = content["framing"]
        for name in ("basis", "centers"):
            framing[name] = np.array(framing[name], dtype=np.float64).reshape(-1, 3)
        return cls(
            run_dir=Path(content["run_dir"]),
            renderer=content["renderer"],
            settings=Settings(**settings),
            framing=Framing(**framing),
            scale=None if content["scale"] is None else Scale(**content["scale"]),
            frames=tuple(content["frames"]),
            files=tuple(Path(file) for file in content["files"]),
        )
