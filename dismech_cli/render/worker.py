"""Draws the shots of a job: run as a program of its own.

The pictures go to stdout, one after another, as bytes.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterator, Mapping

import numpy as np

from ..arrays import FloatArray
from ..output.read import Run, read
from . import matplotlib_scene, scene
from .coloring import Painter
from .job import Job, Renderer, Stage
from .overlay import Labels
from .settings import Image
from .timeline import shot_at

RENDERERS: Mapping[str, Renderer] = {"pyvista": scene.draw, "matplotlib": matplotlib_scene.draw}


def work(job: Job) -> Iterator[Image]:
    """The pictures of a job, with labels."""
    settings, framing = job.settings, job.framing
    pixel = None if framing.angle else framing.pixel(settings.size)
    labels = Labels(settings, pixel, job.scale)
    with read(job.run_dir) as run:
        images = RENDERERS[job.renderer](stage_of(job, run))
        for shot, image in zip(job.shots, images, strict=True):
            labels.write(image, shot, job.decimals)
            yield image


def stage_of(job: Job, run: Run) -> Stage:
    """What a renderer works with."""
    settings, times = job.settings, run.t
    painter = Painter(
        run.topology,
        [] if job.field is None else job.field.values(run),
        job.field,
        job.scale,
        settings.colors,
        settings.ends,
        settings.known,
    )
    return Stage(
        run=run,
        shots=job.shots,
        settings=settings,
        framing=job.framing,
        painter=painter,
        ghosts=[shot_at(times, t) for t in settings.ghosts],
        times=times,
        paths=_paths(run, settings.trails),
    )


def _paths(run: Run, nodes: tuple[int, ...]) -> FloatArray:
    """Positions of some nodes in all frames [m], shape (F, K, 3)."""
    if not nodes:
        return np.empty((len(run), 0, 3))
    return np.stack([run.positions[frame][list(nodes)] for frame in range(len(run))])


def main() -> None:
    """Read a job from stdin and write its pictures to stdout, which nothing else may write to."""
    # pictures leave no cycles behind, and what is loaded stays
    gc.disable()
    with os.fdopen(os.dup(1), "wb") as pictures:
        os.dup2(2, 1)
        for image in work(Job.from_json(sys.stdin.read())):
            pictures.write(np.ascontiguousarray(image).data)
            pictures.flush()
    # leave memory to the system: taking the libraries apart takes as long as three pictures
    os._exit(0)


if __name__ == "__main__":
    main()
