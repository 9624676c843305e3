"""Pictures that the scenario asks for, made after the run."""

from __future__ import annotations

import time
from pathlib import Path

from ..errors import DismechError
from ..scenario.language.output import Render
from .console import Console


def wanted(render: Render) -> bool:
    """Whether the scenario asks for any picture."""
    return render.video != "none" or render.still or bool(render.plots)


def make_pictures(run_dir: Path, render: Render, frames: int, console: Console) -> list[str]:
    """Draw what the scenario of a run asks for; a failure is a warning, as the run itself is done.

    Args:
        run_dir: The run directory.
        render: What is asked for.
        frames: Number of frames of the run.
        console: Says what is drawn and how long it took.

    Returns:
        The files made.
    """
    from ..session.drawing import Wishes, draw

    parts = [f"a video of {frames} frames"] if render.video != "none" else []
    parts += ["a still"] if render.still else []
    parts += ["diagrams"] if render.plots else []
    console.say(f"rendering {', '.join(parts)}")
    tick = time.perf_counter()
    try:
        files = draw(run_dir, Wishes(), console.level)
    except DismechError as error:
        console.warn(f"no pictures: {error}\n  later: dismech render {run_dir}")
        return []
    console.say(f"rendered in {time.perf_counter() - tick:.3g} s")
    return [str(file) for file in files]
