"""A state of another run: what it was a state of, and where everything was."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ...arrays import FloatArray
from ...errors import DismechError, OutputError, ScenarioError
from ...frozen import frozen
from ...geometry.rotation import orthonormal_to, rotate_about
from ...kinematics.rod_frames import FrameState
from ...model.saved import within
from ...output import checkpoint
from ...output.manifest import FILE_NAME, load_manifest
from ...output.read import Run, read
from ...output.run_directory import CHECKPOINT_FOLDER
from ...scenario.language.initial import FromRun

_STRUCTURE: Final = "structure"
# Times of frames are told apart by more than this share of the last one.
_SAME_TIME: Final = 1e-9

Arrays = dict[str, NDArray[Any]]


@frozen
class Known:
    """A state as it was kept.

    Attributes:
        t: Time at which it was taken [s].
        frame: Number of the frame it is from; -1 for a checkpoint.
        structure: What it is a state of, by the names of :func:`.signature.signature`.
        q: Positions and angles there.
        v: Their rates.
        frames: Frames there; without reference twists where a frame does not hold them.
    """

    t: float
    frame: int
    structure: Arrays
    q: FloatArray
    v: FloatArray
    frames: FrameState

    def packed(self) -> bytes:
        """As a file that stands for the run."""
        arrays = {f"{_STRUCTURE}.{name}": array for name, array in self.structure.items()}
        arrays |= {"state.q": self.q, "state.v": self.v}
        arrays |= {f"state.frames.{name}": getattr(self.frames, name) for name in _FRAMES}
        return checkpoint.packed(arrays, {"numbers": {"state.t": self.t}, "frame": self.frame})


_FRAMES: Final = (
    "tangent",
    "director",
    "reference_twist",
    "edge_tangent",
    "edge_normal",
    "edge_angle",
)


def known_state(path: Path, asked: FromRun) -> Known:
    """The state that a scenario asks for.

    Args:
        path: Folder of a run, or a file that was kept of one.
        asked: Which state of it.

    Raises:
        ScenarioError: The run has no such state, or not enough of it.
    """
    try:
        if path.is_dir():
            return _of_run(path, asked)
        return _chosen(_of_file(path), asked, path)
    except OutputError as error:
        raise ScenarioError(str(error)) from error


def _of_file(path: Path) -> Known:
    arrays, meta = checkpoint.load(path)
    structure = within(_STRUCTURE, arrays)
    if not structure:
        raise ScenarioError(f"{path} does not say what it is a state of: run the scenario again")
    try:
        state = within("state", arrays)
        frames = within("frames", state)
        return Known(
            t=float(meta["numbers"]["state.t"]),
            frame=int(meta.get("frame", -1)),
            structure=structure,
            q=state["q"],
            v=state["v"],
            frames=FrameState(**{name: frames[name] for name in _FRAMES}),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise ScenarioError(f"{path} holds no state of a run ({error})") from error


def _chosen(known: Known, asked: FromRun, path: Path) -> Known:
    """The state of a file, which has but one."""
    if asked.frame is not None and asked.frame != known.frame:
        raise ScenarioError(f"{path} holds one state only, and not that of frame {asked.frame}")
    if asked.at != "last" and abs(asked.at - known.t) > _SAME_TIME * max(known.t, asked.at):
        raise ScenarioError(f"{path} holds the state at t = {known.t:g} only, not at {asked.at:g}")
    return known


def _of_run(path: Path, asked: FromRun) -> Known:
    if not (path / FILE_NAME).is_file():
        raise ScenarioError(f"{path} is no run directory: it has no {FILE_NAME}")
    newest = checkpoint.newest(path / CHECKPOINT_FOLDER)
    last = _of_file(newest)
    if asked.frame is None and asked.at == "last":
        status = load_manifest(path).status
        if status != "done":
            raise ScenarioError(
                f"{path} is not done but {status}, at t = {last.t:g}: end it, or say at which time to start"
            )
        return last
    if asked.frame is None and asked.at == last.t:
        return last
    with read(path) as run:
        return _of_frame(run, _number(run, asked), last)


def _number(run: Run, asked: FromRun) -> int:
    """Number of the frame that is asked for."""
    times = run.t
    if asked.frame is not None:
        if asked.frame >= len(times):
            raise ScenarioError(f"{run.path} has {len(times)} frames, counted from 0")
        return asked.frame
    assert asked.at != "last"
    number = int(np.argmin(np.abs(times - asked.at)))
    if abs(times[number] - asked.at) > _SAME_TIME * times[-1]:
        raise ScenarioError(f"{run.path} has no frame at {asked.at:g}; the nearest is at {times[number]:g}")
    return number


def _of_frame(run: Run, number: int, last: Known) -> Known:
    """The state of a frame; where sections have directors, from the field that shows them."""
    q = np.asarray(run.state("q")[number])
    frames = last.frames
    if last.structure["normals"].size:
        raise ScenarioError(
            f"{run.path}: frames hold no mid-edge normals of its shells; only 'at: last' has them"
        )
    if last.structure["angles"].any():
        try:
            field = run.field("director")
        except DismechError as error:
            raise ScenarioError(
                f"{run.path}: its frames hold no directors of the rods; run it with the output field "
                "'director', or take 'at: last'"
            ) from error
        frames = _frames(run, np.asarray(field[number]), q, last)
    return Known(
        t=float(run.t[number]),
        frame=number,
        structure=last.structure,
        q=q,
        v=np.asarray(run.state("v")[number]),
        frames=frames,
    )


def _frames(run: Run, material: FloatArray, q: FloatArray, last: Known) -> FrameState:
    """Frames by the material directors of the rods; walls, which no field shows, must not have turned."""
    structure, edges = last.structure, len(last.structure["edges"])
    ends, nodes = structure["rods"], len(structure["rest"]) + len(structure["walls"])
    x = q[: 3 * nodes].reshape(-1, 3)
    along = (x[ends[:, 1]] - x[ends[:, 0]]).T
    tangent = along / np.sqrt((along * along).sum(axis=0))
    angle = q[3 * nodes :][: len(ends)]
    director = last.frames.director.copy()
    if np.abs(tangent - last.frames.tangent)[:, edges:].max(initial=0.0) > _SAME_TIME:
        raise ScenarioError(
            f"{run.path}: a clamp has turned, whose directors frames do not hold; only 'at: last' has them"
        )
    here = tangent[:, :edges]
    across = np.stack(orthonormal_to(material[:edges].T, here))
    director[:, :edges] = rotate_about(across, here, -angle[:edges])
    # twists are those of less than half a turn from edge to edge: found with the joints
    return FrameState(tangent, director, np.empty(0))
