"""Draws the pictures of the README and of the gallery anew.

    PYTHONPATH=. python docs/images/draw.py RUNS [NAME...]

RUNS holds a run directory for each scene, by its name; scenes that are missing there are run first.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from PIL import Image

HERE = Path(__file__).resolve().parent
SCENES = HERE.parents[1] / "scenarios"
SIZE, TEXT = "800x450", "text=1.5"

PICTURES: dict[str, list[str]] = {
    "cantilever": [],
    "cantilever_dynamic_1e5": ["--times", "0.085"],
    "contortion": ["--set", "ghosts=[0]"],
    "curling_strip": [],
    "curl_grip": ["--set", "ghosts=[0, 0.6]"],
    "dlo_manipulation": ["--set", "ghosts=[0, 12.5, 13.75]"],
    "flagella": ["--times", "2"],
    "folded_cloth": ["--times", "0.3, 0.6, 0.9, 1.2", "--set", "layout=panels"],
    "gait": ["--times", "0.4, 1", "--set", "layout=panels"],
    "heavy_fold": ["--times", "0.8, 1.3, 1.5, 2.6", "--set", "layout=panels"],
    "helix_lead_in": ["--times", "0.1"],
    "helix_soft": ["--times", "0.1"],
    "hemisphere_hang": [],
    "jellyfish": ["--times", "0.6"],
    "jellyfish_tentacles": ["--times", "1"],
    "jellyfish_touch": ["--times", "0.59"],
    "kirigami": [],
    "manta_ray": ["--times", "2"],
    "overhand_knot": [],
    "paddle": [],
    "parachute": ["--camera", "tracking"],
    "plate": [],
    "pneunet_loaded": ["--color-by", "none"],
    "pneunet_semi": ["--color-by", "curvature"],
    "pushed_bowl": ["--times", "1, 1.7", "--set", "layout=panels"],
    "rectangular_fold": ["--times", "0, 0.4, 0.8, 1.6", "--set", "layout=panels"],
    "s_shape_ideal": [],
    "self_twisting_rod": [],
    "shell_cantilever_hinge": [],
    "shell_cantilever_midedge": [],
    "sinking_arc": ["--set", "ghosts=[0, 0.25, 0.5, 0.75]"],
    "slinky": ["--times", "0, 0.06, 0.1, 0.3", "--set", "layout=panels"],
    "snake": ["--color-by", "curvature"],
    "snake_21": ["--color-by", "curvature"],
    "spider": ["--set", "ghosts=[0]"],
    "strip_cantilever_51": [],
    "t_fin": [],
    "worm": ["--times", "0.5, 0.75, 1, 1.5", "--set", "layout=panels", "--set", "range=[-0.3, 0.3]"],
}
FILMS = {
    "jellyfish_tentacles": [],
    "manta_ray": [],
    "worm": [],
    "curl_grip": ["--speed", "0.5"],
}
FRONT = {
    "helix_soft": ["--times", "0.1"],
    "curl_grip": ["--set", "ghosts=[0, 0.6]"],
    "parachute": ["--camera", "tracking", "--color-by", "none"],
    "jellyfish_tentacles": ["--times", "1"],
}


def main() -> None:
    """Draw what the command line names, else everything."""
    runs, names = Path(sys.argv[1]), sys.argv[2:] or [*PICTURES, *(f"{name}.gif" for name in FILMS), "readme"]
    for name in names:
        if name == "readme":
            _front(runs)
        elif name.endswith(".gif"):
            _film(runs, name.removesuffix(".gif"))
        else:
            _draw(runs, name, PICTURES[name], HERE / f"{name}.png")


def _draw(runs: Path, scene: str, options: list[str], file: Path) -> None:
    run_dir = _run(runs, scene)
    _dismech("render", run_dir, "--format", "png", "--size", SIZE, "--set", TEXT, *options, "-o", file, "-q")


def _film(runs: Path, scene: str) -> None:
    """A short film, small enough for a page."""
    run_dir = _run(runs, scene)
    options = ["--format", "gif", "--size", "320x180", "--fps", "8", *FILMS[scene]]
    _dismech("render", run_dir, *options, "-o", HERE / f"{scene}.gif", "-q")


def _run(runs: Path, scene: str) -> Path:
    """The run directory of a scene, made where it is missing."""
    run_dir = runs / scene
    if not run_dir.exists():
        _dismech("run", SCENES / f"{scene}.yaml", "-o", run_dir, "--no-render", "-q")
    return run_dir


def _front(runs: Path) -> None:
    """Four scenes in one picture."""
    pictures = []
    for scene, options in FRONT.items():
        file = HERE / f"front-{scene}.png"
        _draw(runs, scene, options, file)
        with Image.open(file) as picture:
            pictures.append(picture.convert("RGB"))
        file.unlink()
    width, height = pictures[0].size
    front = Image.new("RGB", (2 * width, 2 * height))
    for number, picture in enumerate(pictures):
        front.paste(picture, (number % 2 * width, number // 2 * height))
    front.save(HERE / "readme.png", optimize=True)


def _dismech(*arguments: object) -> None:
    subprocess.run([sys.executable, "-m", "dismech_cli", *map(str, arguments)], check=True)


if __name__ == "__main__":
    main()
