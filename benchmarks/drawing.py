"""Time of a picture by phase: what moves is placed, colours of pixels, labels, the encoder."""

from __future__ import annotations

import os
import resource
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .scenes import SCENARIOS
from .table import table, verdict

# Rods, a shell of few triangles that fills the picture, and a cloth over an obstacle; ends of short runs.
SCENES = {"helix_soft": "0.4 s", "jellyfish": "0.2 s", "draped_cloth": "40 ms"}
GROUNDS = {"none": 40.0, "floor": 120.0}
SIZE = "1280x720"
ROUNDS = 3
PHASES = ("place", "draw", "label", "encode")


def run(name: str, folder: Path) -> Path:
    """A short run of a scene."""
    from dismech_cli.session.simulate import simulate

    run_dir = folder / name
    changes = (f"numerics.t_end={SCENES[name]}", "output.render={view: iso}", "expect={}")
    simulate(SCENARIOS / f"{name}.yaml", overrides=changes, out=run_dir, kernels="numpy")
    return run_dir


def milliseconds(run_dir: Path, ground: str, pictures: int, film: Path) -> Sequence[float]:
    """CPU time of one thread for each phase of a picture [ms].

    Of each picture the least of some rounds, of these the median; of the encoder the mean.
    """
    from dismech_cli.output.read import read
    from dismech_cli.render.encode import mp4_file
    from dismech_cli.render.framing import frame_motion
    from dismech_cli.render.job import Job
    from dismech_cli.render.overlay import Labels
    from dismech_cli.render.scene import Scene
    from dismech_cli.render.timeline import shot_at
    from dismech_cli.render.worker import stage_of
    from dismech_cli.session.picturing import asked_of, settings_of

    with read(run_dir) as results:
        settings = settings_of(asked_of(run_dir, (f"ground={ground}",)), results, None)
        shots = tuple(shot_at(results.t, float(t)) for t in np.linspace(0.0, results.t[-1], pictures))
        job = Job(
            run_dir=run_dir,
            renderer="",
            settings=settings,
            framing=frame_motion(results, settings, shots),
            field=None,
            scale=None,
            shots=shots,
            decimals=3,
        )
        scene, labels = (
            Scene(stage_of(job, results)),
            Labels(settings, job.framing.pixel(settings.size), None),
        )
        spent, before = [], resource.getrusage(resource.RUSAGE_CHILDREN)
        with mp4_file(film, settings.size, 25.0) as take:
            for number, shot in (*enumerate(shots),) * ROUNDS:
                ticks = [time.process_time()]
                scene.set(shot)
                ticks.append(time.process_time())
                image = scene.shoot(number)
                ticks.append(time.process_time())
                labels.write(image, shot, job.decimals)
                ticks.append(time.process_time())
                take(image)
                spent.append(np.diff(ticks))
        scene.close()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    encoder = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    least = np.min(np.reshape(spent, (ROUNDS, pictures, 3)), axis=0)
    return [*(1e3 * np.median(least, axis=0)).tolist(), 1e3 * encoder / (ROUNDS * pictures)]


def report(quick: bool) -> str:
    """Pictures of three scenes, with and without effects of the ground."""
    # one thread draws, as in each of the processes that share a film
    os.environ["LP_NUM_THREADS"] = "0"
    pictures = 8 if quick else 25
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in SCENES:
            run_dir = run(name, Path(folder))
            for ground, bar in GROUNDS.items():
                spent = milliseconds(run_dir, ground, pictures, Path(folder) / "film.mp4")
                drawn = verdict(sum(spent[:3]), bar)
                rows.append((name, ground, *(f"{one:.1f}" for one in spent[:3]), drawn, f"{spent[3]:.1f}"))
    head = ("scene", "ground", *PHASES[:3], "a picture", PHASES[3])
    about = f"Milliseconds of CPU for a picture of {SIZE}, others on the same cores:"
    return "\n\n".join(("## Drawing", about, table(head, rows)))
