"""The frames of a run in the formats of others."""

from __future__ import annotations

from pathlib import Path

from ..errors import OutputError
from ..output.durable import output_errors
from ..output.export import EXPORTERS
from ..output.export import export as write
from ..output.read import read
from ..render.gltf import write_glb
from .narrator import Narrator

GLB = "glb"
FORMATS = (*EXPORTERS, GLB)
"""All formats: tables and meshes of the model, and the surfaces that pictures show."""


def export(run_dir: Path, to: str, output: Path | None, narrator: Narrator) -> list[Path]:
    """Write the frames of a run in another format.

    Args:
        run_dir: The run directory.
        to: One of :data:`FORMATS`.
        output: Folder to write into; default ``<run_dir>/export-<format>``.
        narrator: Told what is left out.

    Returns:
        The files to open.

    Raises:
        ScenarioError: If the format is unknown.
        OutputError: If the run cannot be read, has no frames, or the files cannot be written.
    """
    if to != GLB:
        return write(run_dir, to, output)
    folder = run_dir / f"export-{GLB}" if output is None else output
    with read(run_dir) as run:
        if not len(run):
            raise OutputError(f"{run_dir} has no frames to export")
        with output_errors(folder, "create"):
            folder.mkdir(parents=True, exist_ok=True)
        file = folder / "run.glb"
        written = write_glb(run, file)
        if written < len(run):
            narrator.say(f"{written} of {len(run)} frames, in even steps and whole ones only")
    return [file]
