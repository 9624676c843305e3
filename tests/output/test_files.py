"""Tables, VTU series, events, manifest, checkpoints, run directories, exports."""

from __future__ import annotations

import json
import math
import multiprocessing
from dataclasses import replace

import meshio
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from output_cases import cantilever, sheet, write_all, write_run

from dismech_cli.errors import OutputError, ScenarioError
from dismech_cli.output import checkpoint, run_directory
from dismech_cli.output.durable import output_errors, staged
from dismech_cli.output.events import EventLog, read_events
from dismech_cli.output.export import EXPORTERS, export
from dismech_cli.output.frame import FieldSpec
from dismech_cli.output.manifest import Manifest, load_manifest
from dismech_cli.output.table import CsvWriter, read_table
from dismech_cli.output.viewer import array_name
from dismech_cli.output.vtu import VtuWriter
from dismech_cli.output.writers import WRITERS, make_writer


def files_of(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.mark.parametrize("name", ["vtu", "csv"])
def test_a_resumed_output_equals_a_straight_one(tmp_path, name):
    topology, frames = sheet(frames=8)
    for folder in ("straight", "resumed"):
        (tmp_path / folder).mkdir()
    write_all(make_writer(name, tmp_path / "straight"), topology, frames)
    write_all(make_writer(name, tmp_path / "resumed"), topology, frames[:6])
    write_all(make_writer(name, tmp_path / "resumed", frames[2].t), topology, frames[3:])
    assert files_of(tmp_path / "resumed") == files_of(tmp_path / "straight")


@pytest.mark.parametrize("name", sorted(WRITERS))
def test_new_writers_never_overwrite_and_resuming_ones_need_a_file(tmp_path, name):
    topology, frames = sheet(frames=1)
    with pytest.raises(OutputError, match="cannot resume"):
        make_writer(name, tmp_path, 0.0).open(topology, {})
    write_all(make_writer(name, tmp_path), topology, frames)
    with pytest.raises(OutputError, match="never overwritten"):
        make_writer(name, tmp_path).open(topology, {})


@pytest.mark.parametrize("name", sorted(WRITERS))
def test_writers_say_what_they_make(tmp_path, name):
    write_all(make_writer(name, tmp_path), *sheet(frames=1))
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(WRITERS[name].products)


@pytest.mark.parametrize("name", sorted(WRITERS))
def test_a_missing_folder_is_an_output_error(tmp_path, name):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="not a folder"):
        make_writer(name, tmp_path / "file").open(sheet()[0], {})


def test_an_unknown_writer_lists_the_known_ones(tmp_path):
    with pytest.raises(ScenarioError, match="csv, hdf5, vtu"):
        make_writer("xdmf", tmp_path)


@pytest.mark.parametrize("case", [cantilever, sheet])
def test_vtu_frames_come_back(tmp_path, case):
    topology, frames = case(frames=2)
    write_all(VtuWriter(tmp_path), topology, frames)
    mesh = meshio.read(tmp_path / "frames" / "000001.vtu")
    assert_array_equal(mesh.points, frames[1].positions)
    assert_array_equal(mesh.point_data["velocity [m s^-1]"], frames[1].fields["velocity"])
    moved = frames[1].positions - topology.rest_positions
    assert_array_equal(mesh.point_data["displacement [m]"], moved)
    bodies = np.concatenate([topology.edge_body, topology.triangle_body])
    assert_array_equal(np.concatenate(mesh.cell_data["body"]), bodies)
    edges = len(topology.edges)
    assert_array_equal(np.concatenate(mesh.cell_data["radius [m]"])[:edges], topology.edge_radius)
    thickness = np.concatenate(mesh.cell_data["thickness [m]"])[edges:]
    assert_array_equal(thickness, topology.triangle_thickness)
    assert_array_equal(np.concatenate(mesh.cell_data["strain"]), frames[1].fields["strain"])
    assert_array_equal(mesh.cells_dict["line"], topology.edges)
    if len(topology.triangles):
        assert_array_equal(mesh.cells_dict["triangle"], topology.triangles)


@pytest.mark.parametrize(
    ("unit", "name"),
    [
        ("1", "x"),
        ("m", "x [m]"),
        ("m/s", "x [m s^-1]"),
        ("1/m", "x [m^-1]"),
        ("rad/m", "x [rad m^-1]"),
        ("J/m^2", "x [J m^-2]"),
        ("N m", "x [N m]"),
    ],
)
def test_units_stand_in_names_without_a_stroke(unit, name):
    assert array_name(FieldSpec(name="x", unit=unit, long_name="x", location="node")) == name


def test_the_table_has_units_and_exact_numbers(tmp_path):
    topology, _ = cantilever(frames=1)
    writer = CsvWriter(tmp_path / "scalars.csv")
    writer.open(topology, {})
    writer.write_row(0.1, {"kinetic_energy": 1 / 3, "newton_iterations": 4})
    writer.write_row(0.2, {"kinetic_energy": math.nan, "newton_iterations": 5})
    writer.close()
    writer.close()
    lines = (tmp_path / "scalars.csv").read_text().splitlines()
    assert lines[0] == "t [s],kinetic_energy [J],newton_iterations [1]"
    table, units = read_table(tmp_path / "scalars.csv")
    assert_array_equal(table["kinetic_energy"], [1 / 3, math.nan])
    assert units == {"t": "s", "kinetic_energy": "J", "newton_iterations": "1"}


def test_a_cut_last_line_is_left_out_and_mended(tmp_path):
    topology, frames = cantilever(frames=3)
    path = tmp_path / "scalars.csv"
    write_all(CsvWriter(path), topology, frames)
    whole = path.read_bytes()
    path.write_bytes(whole[:-5])
    assert len(read_table(path)[0]["t"]) == 2
    write_all(CsvWriter(path, resume_at=10.0), topology, frames[2:])
    assert path.read_bytes() == whole


def test_a_damaged_table_names_the_line(tmp_path):
    path = tmp_path / "scalars.csv"
    path.write_text("t [s],a [1]\n0.0,1.0\n0.1,one\n")
    with pytest.raises(OutputError, match=r"scalars\.csv:3: expected 2 numbers"):
        read_table(path)


def test_events_are_one_strict_json_object_per_line(tmp_path):
    path = tmp_path / "events.jsonl"
    log = EventLog(path)
    log.add("step_rejected", 0.1, residual=np.float64(math.inf), dof=np.int64(3), nodes=np.array([1, 2]))
    log.add("contact", 0.2, pair=("a", "b"))
    log.close()
    assert read_events(path) == [
        {"t": 0.1, "kind": "step_rejected", "residual": "inf", "dof": 3, "nodes": [1, 2]},
        {"t": 0.2, "kind": "contact", "pair": ["a", "b"]},
    ]
    with path.open("a") as file:
        file.write('{"t": 0.3, "ki')
    assert len(read_events(path)) == 2
    log = EventLog(path, resume_at=0.1)
    log.add("resumed", 0.1)
    log.close()
    assert [event["kind"] for event in read_events(path)] == ["step_rejected", "resumed"]


def test_the_manifest_comes_back_and_is_replaced_whole(tmp_path):
    manifest = Manifest(name="beam", run_id="r1", argv=("dismech", "run"), hashes={"beam.yaml": "ab" * 32})
    manifest.save(tmp_path)
    assert load_manifest(tmp_path) == manifest
    assert manifest.status == "running"
    assert manifest.versions["numpy"] == np.__version__
    done = replace(manifest, status="done", exit_code=0, counters={"steps": 7}, seconds={"solve": 1.5})
    done.save(tmp_path)
    assert load_manifest(tmp_path) == done
    assert json.loads((tmp_path / "manifest.json").read_text())["seconds"]["solve"] == 1.5
    assert [entry.name for entry in tmp_path.iterdir()] == ["manifest.json"]


@pytest.mark.parametrize("text", ["", "{", "[]", '{"name": "beam"}'])
def test_a_damaged_manifest_is_named(tmp_path, text):
    (tmp_path / "manifest.json").write_text(text)
    with pytest.raises(OutputError, match=r"manifest\.json: it is damaged"):
        load_manifest(tmp_path)


ARRAYS = {
    "q": np.array([1 / 3, -0.0, math.nan, math.inf]),
    "pairs": np.array([[1, 2]]),
    "held": np.array([True]),
    "none": np.empty((0, 3)),
}
META = {"t": 0.1 + 0.2, "dt": math.inf, "controller": {"integral": [1e-300, None]}, "steps": 12}


def test_a_checkpoint_comes_back_bit_by_bit(tmp_path):
    checkpoint.save(tmp_path / "checkpoints", ARRAYS, META)
    arrays, meta = checkpoint.load_latest(tmp_path / "checkpoints")
    assert meta == META
    assert arrays.keys() == ARRAYS.keys()
    for name, array in ARRAYS.items():
        assert arrays[name].tobytes() == array.tobytes()
        assert (arrays[name].dtype, arrays[name].shape) == (array.dtype, array.shape)


def test_the_last_two_checkpoints_are_kept(tmp_path):
    for step in range(5):
        checkpoint.save(tmp_path, ARRAYS, {"step": step})
    assert sorted(p.name for p in tmp_path.iterdir()) == ["checkpoint-000004.npz", "checkpoint-000005.npz"]
    assert checkpoint.load_latest(tmp_path)[1] == {"step": 4}


def test_any_damage_to_a_checkpoint_is_found(tmp_path):
    """Flip one bit, or cut the file, anywhere: the one before is used, or the file is named."""
    checkpoint.save(tmp_path, {"q": np.arange(6.0)}, {"step": 1})
    path = checkpoint.save(tmp_path, {"q": np.arange(6.0) + 1}, {"step": 2})
    whole = path.read_bytes()
    damaged = 0
    for position in range(0, len(whole), 7):
        path.write_bytes(whole[:position] + bytes([whole[position] ^ 0x10]) + whole[position + 1 :])
        arrays, meta = checkpoint.load_latest(tmp_path)
        # A flip in a date stamp of the archive harms nothing; whatever loads must be one of the two.
        assert_array_equal(arrays["q"], np.arange(6.0) + (meta["step"] - 1))
        damaged += meta["step"] == 1
        path.write_bytes(whole[:position])
        assert checkpoint.load_latest(tmp_path)[1] == {"step": 1}
    assert damaged > len(whole) / 7 / 2
    for file in tmp_path.iterdir():
        file.write_bytes(b"")
    with pytest.raises(OutputError, match=r"checkpoint-000002\.npz.*checkpoint-000001\.npz"):
        checkpoint.load_latest(tmp_path)


def test_no_checkpoint_and_no_objects(tmp_path):
    with pytest.raises(OutputError, match="no checkpoint in"):
        checkpoint.load_latest(tmp_path)
    with pytest.raises(ValueError, match="not Python objects"):
        checkpoint.save(tmp_path, {"q": np.array([{}])}, {})
    with pytest.raises(ValueError, match="reserved"):
        checkpoint.save(tmp_path, {"__meta__": np.zeros(1)}, {})


def test_runs_get_different_folders_that_sort_by_time(tmp_path):
    made = [run_directory.create(tmp_path, "beam", "abcdef0123") for _ in range(30)]
    assert len(set(made)) == 30
    assert sorted(made) == made
    assert all(path.parent == tmp_path / "beam" and "abcdef" in path.name for path in made)


@pytest.mark.parametrize("name", ["../beam", "", ".", "..", "a/b", "-rf", "a\0b", "x" * 101])
def test_a_name_cannot_leave_the_results(tmp_path, name):
    with pytest.raises(OutputError, match="folder name"):
        run_directory.create(tmp_path, name, "abcdef")
    assert list(tmp_path.iterdir()) == []


def test_a_named_folder_must_be_empty_and_only_runs_are_replaced(tmp_path):
    folder = run_directory.create_at(tmp_path / "out")
    assert run_directory.create_at(folder) == folder
    (folder / "thesis.tex").write_text("precious")
    with pytest.raises(OutputError, match="not empty"):
        run_directory.create_at(folder)
    with pytest.raises(OutputError, match="not a run"):
        run_directory.replace_at(folder)
    assert (folder / "thesis.tex").exists()
    write_run(folder, cantilever(frames=1), ("vtu",))
    assert list(run_directory.replace_at(folder).iterdir()) == []


def _try_lock(run_dir, answers):
    try:
        with run_directory.RunLock(run_dir):
            answers.put("got it")
    except OutputError as error:
        answers.put(str(error))


def test_one_process_at_a_time_writes_into_a_run(tmp_path):
    spawn = multiprocessing.get_context("spawn")

    def ask():
        answers = spawn.Queue()
        process = spawn.Process(target=_try_lock, args=(tmp_path, answers))
        process.start()
        answer = answers.get(timeout=30)
        process.join()
        answers.close()
        answers.join_thread()
        return answer

    with run_directory.RunLock(tmp_path):
        assert "another process" in ask()
        with pytest.raises(OutputError, match="another process"):
            run_directory.RunLock(tmp_path).__enter__()
    assert ask() == "got it"


def test_a_staged_file_appears_whole_or_not_at_all(tmp_path):
    path = tmp_path / "file.txt"
    path.write_text("old")

    def half_write():
        with staged(path) as temporary:
            temporary.write_text("half")
            raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="disk is full"):
        half_write()
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["file.txt"]


def test_failures_of_hdf5_are_told_by_the_system_reason(tmp_path):
    text = "Unable to flush file (file write failed: errno = 28, error message = 'No space left')"
    with pytest.raises(OutputError, match="disk is full"), output_errors(tmp_path):
        raise RuntimeError(text)
    with pytest.raises(NotImplementedError), output_errors(tmp_path):
        raise NotImplementedError


@pytest.mark.parametrize("case", [cantilever, sheet])
@pytest.mark.parametrize("to", sorted(EXPORTERS))
def test_exports_hold_the_frames(tmp_path, case, to):
    topology, frames = case(frames=3)
    run_dir = write_run(tmp_path / "run", (topology, frames))
    files = export(run_dir, to)
    assert export(run_dir, to) == files, "a second export replaces the first"
    last = frames[-1]
    if to == "vtu":
        mesh = meshio.read(run_dir / "export-vtu" / "frames" / "000002.vtu")
        assert_array_equal(mesh.points, last.positions)
    elif to == "npz":
        with np.load(files[0]) as content:
            assert_array_equal(content["positions"][2], last.positions)
            assert_array_equal(content["field_strain"][2], last.fields["strain"])
            assert_array_equal(content["state_theta"][2], last.state["theta"])
            assert_array_equal(content["t"], [frame.t for frame in frames])
    elif to == "csv":
        nodes = np.loadtxt(files[0], delimiter=",", skiprows=1)
        count = len(last.positions)
        assert_array_equal(nodes[2 * count :, 2:5], last.positions)
        assert_array_equal(nodes[2 * count :, 5:8], last.fields["velocity"])
        cells = np.loadtxt(files[1], delimiter=",", skiprows=1)
        assert_array_equal(cells[-len(last.fields["strain"]) :, 2], last.fields["strain"])
        assert [file.name for file in files] == ["nodes.csv", "cells.csv", "scalars.csv"]
    else:
        lines = files[2].read_text().splitlines()
        vertices = np.array([line.split()[1:] for line in lines if line.startswith("v ")], dtype=float)
        assert_array_equal(vertices, last.positions)
        assert sum(line.startswith("l ") for line in lines) == len(topology.edges)
        assert sum(line.startswith("f ") for line in lines) == len(topology.triangles)


def test_an_unknown_export_lists_the_known_ones(tmp_path):
    with pytest.raises(ScenarioError, match="csv, npz, obj, vtu"):
        export(tmp_path, "stl")


def test_a_run_without_frames_has_nothing_to_export(tmp_path):
    run_dir = write_run(tmp_path / "run", (cantilever()[0], []))
    with pytest.raises(OutputError, match="has no frames to export"):
        export(run_dir, "vtu")
    assert not (run_dir / "export-vtu").exists()
