"""The drawing process: reads a job from stdin, writes PNG files, prints a line for each.

It is a process of its own because a missing or broken OpenGL library ends a process by a signal, not
by an exception.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping

import numpy as np

from ..output.read import read
from . import matplotlib_scene, scene
from .job import Job, Renderer
from .overlay import add_labels

RENDERERS: Mapping[str, Renderer] = {"pyvista": scene.draw, "matplotlib": matplotlib_scene.draw}


def work(job: Job) -> None:
    """Draw the frames of ``job``; print the number of each frame when its file is written."""
    from PIL import Image

    with read(job.run_dir) as run:
        times = run.t
        decimals = time_decimals(times)
        images = RENDERERS[job.renderer](run, job.frames, job.settings, job.framing, job.scale)
        for frame, file, image in zip(job.frames, job.files, images, strict=True):
            pixel = job.framing.pixel(job.settings.size)
            labelled = add_labels(image, float(times[frame]), decimals, pixel, job.scale)
            Image.fromarray(labelled).save(file, compress_level=1)
            print(frame, flush=True)


def time_decimals(times: np.ndarray[tuple[int], np.dtype[np.float64]]) -> int:
    """Digits after the point that tell neighbouring frames apart, at most six."""
    if len(times) < 2:
        return 3
    step = float(np.median(np.diff(times)))
    return int(np.clip(np.ceil(-np.log10(step) - 1e-6), 1, 6)) if step > 0 else 3


if __name__ == "__main__":
    work(Job.from_json(sys.stdin.read()))
