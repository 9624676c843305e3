"""The run file: ParaView reads it, it comes back exactly, and it can be cut and continued."""

from __future__ import annotations

import subprocess
import sys

import h5py
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from output_cases import cantilever, sheet, write_all, write_run

from dismech_cli.errors import OutputError
from dismech_cli.output.hdf5.writer import Hdf5Writer
from dismech_cli.output.read import read


def vtk_steps(path):
    """Yield (time, points, point data, cell data, cell sizes) of every step, as vtkHDFReader sees them."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    key = type(reader.GetExecutive()).TIME_STEPS()
    information = reader.GetOutputInformation(0)
    times = [information.Get(key, i) for i in range(information.Length(key))]
    for step, t in enumerate(times):
        reader.SetStep(step)
        reader.Update()
        data = reader.GetOutput()
        arrays = [
            {
                group.GetArrayName(i): vtk_to_numpy(group.GetArray(i)).copy()
                for i in range(group.GetNumberOfArrays())
            }
            for group in (data.GetPointData(), data.GetCellData())
        ]
        sizes = [data.GetCell(i).GetNumberOfPoints() for i in range(data.GetNumberOfCells())]
        ids = [
            [data.GetCell(i).GetPointId(k) for k in range(sizes[i])] for i in range(data.GetNumberOfCells())
        ]
        yield t, vtk_to_numpy(data.GetPoints().GetData()).copy(), *arrays, ids


def count_steps_elsewhere(path):
    """Steps that vtkHDFReader sees from another process, as ParaView would."""
    code = (
        "import sys; from vtkmodules.vtkIOHDF import vtkHDFReader; r = vtkHDFReader();"
        "r.SetFileName(sys.argv[1]); r.UpdateInformation(); r.SetStep(r.GetNumberOfSteps() - 1); r.Update();"
        "assert r.GetOutput().GetNumberOfPoints() > 0; print(r.GetNumberOfSteps())"
    )
    done = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, check=True)
    return int(done.stdout)


@pytest.mark.parametrize("case", [cantilever, sheet])
def test_paraview_reader_returns_every_step(tmp_path, case):
    topology, frames = case(frames=4)
    write_all(Hdf5Writer(tmp_path / "run.vtkhdf"), topology, frames)
    steps = list(vtk_steps(tmp_path / "run.vtkhdf"))
    assert len(steps) == len(frames)
    cells = [*topology.edges.tolist(), *topology.triangles.tolist()]
    for frame, (t, points, point_data, cell_data, ids) in zip(frames, steps, strict=True):
        assert t == frame.t
        assert_array_equal(points, frame.positions)
        assert_array_equal(point_data["velocity [m s^-1]"], frame.fields["velocity"])
        assert_array_equal(cell_data["body"], [*topology.edge_body, *topology.triangle_body])
        assert_array_equal(cell_data["radius [m]"][: len(topology.edges)], topology.edge_radius)
        assert_array_equal(cell_data["thickness [m]"][len(topology.edges) :], topology.triangle_thickness)
        assert_array_equal(cell_data["strain"], frame.fields["strain"])
        assert ids == cells


@pytest.mark.parametrize("case", [cantilever, sheet])
def test_read_returns_what_was_written(tmp_path, case):
    topology, frames = case(frames=5)
    with read(write_run(tmp_path, (topology, frames))) as run:
        assert len(run) == 5
        assert_array_equal(run.t, [frame.t for frame in frames])
        assert run.positions.shape == (5, *topology.rest_positions.shape)
        for index, frame in enumerate(frames):
            assert_array_equal(run.positions[index], frame.positions)
            assert_array_equal(run.field("strain")[index], frame.fields["strain"])
            assert_array_equal(run.state("theta")[index], frame.state["theta"])
        assert_array_equal(np.asarray(run.field("velocity")), [f.fields["velocity"] for f in frames])
        assert_array_equal(run.positions[1:3], [f.positions for f in frames[1:3]])
        assert_array_equal(run.positions[-1], frames[-1].positions)
        assert run.topology.fields == topology.fields
        assert run.topology.state == topology.state
        assert list(run.topology.scalars.items()) == list(topology.scalars.items())
        assert run.topology.bodies == topology.bodies
        assert_array_equal(run.topology.edge_radius, topology.edge_radius)
        assert_array_equal(run.topology.triangle_body, topology.triangle_body)
        assert run.metadata == {"name": "synthetic", "plan": "none\nnone\nnone\n"}
        assert_array_equal(run.scalars["kinetic_energy"], np.arange(5.0))
        assert run.scalar_units["kinetic_energy"] == "J"


def test_an_older_file_without_units_in_its_names_is_read(tmp_path):
    topology, frames = cantilever(frames=2)
    write_run(tmp_path, (topology, frames))
    with h5py.File(tmp_path / "run.vtkhdf", "r+") as file:
        for group in ("PointData", "Steps/PointDataOffsets"):
            file["VTKHDF"][group].move("velocity [m s^-1]", "velocity")
    with read(tmp_path) as run:
        assert run.topology.fields == topology.fields
        assert_array_equal(run.field("velocity")[1], frames[1].fields["velocity"])


def test_scalars_come_from_the_frames_without_a_table(tmp_path):
    with read(write_run(tmp_path, cantilever(frames=3), names=["hdf5"])) as run:
        assert_array_equal(run.scalars["newton_iterations"], [1.0, 2.0, 3.0])
        assert_array_equal(run.scalars["t"], run.t)


def test_every_physical_dataset_has_units_and_a_name(tmp_path):
    write_run(tmp_path, sheet(frames=1), names=["hdf5"])
    seen = []

    def visit(name, item):
        physical = not name.startswith("VTKHDF") or "Data/" in name or name.endswith(("/Points", "/Values"))
        if isinstance(item, h5py.Dataset) and physical:
            assert item.attrs["units"], name
            assert item.attrs["long_name"], name
            seen.append(name)

    with h5py.File(tmp_path / "run.vtkhdf") as file:
        file.visititems(visit)
    assert {"VTKHDF/Points", "dismech/state/theta", "dismech/scalars/kinetic_energy"} <= set(seen)


def contents(path):
    found = {}
    with h5py.File(path) as file:
        file.visititems(
            lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None
        )
        found["NSteps"] = file["VTKHDF/Steps"].attrs["NSteps"]
    return found


def test_a_resumed_file_equals_a_straight_one(tmp_path):
    topology, frames = sheet(frames=9)
    write_all(Hdf5Writer(tmp_path / "straight.vtkhdf"), topology, frames)
    write_all(Hdf5Writer(tmp_path / "resumed.vtkhdf"), topology, frames[:7])
    write_all(Hdf5Writer(tmp_path / "resumed.vtkhdf", resume_at=frames[3].t), topology, frames[4:])
    straight, resumed = contents(tmp_path / "straight.vtkhdf"), contents(tmp_path / "resumed.vtkhdf")
    assert straight.keys() == resumed.keys()
    for name, value in straight.items():
        assert_array_equal(resumed[name], value, err_msg=name)


def test_frames_written_together_are_those_written_alone(tmp_path):
    topology, frames = sheet(frames=9)
    write_all(Hdf5Writer(tmp_path / "alone.vtkhdf"), topology, frames)
    writer = Hdf5Writer(tmp_path / "together.vtkhdf")
    writer.open(topology, {})
    writer.write(*frames[:2])
    writer.write(*frames[2:])
    writer.close()
    alone, together = contents(tmp_path / "alone.vtkhdf"), contents(tmp_path / "together.vtkhdf")
    assert alone.keys() == together.keys()
    for name, value in alone.items():
        assert_array_equal(together[name], value, err_msg=name)


def test_a_ragged_tail_is_left_out_and_cut_by_resume(tmp_path):
    topology, frames = cantilever(frames=5)
    write_run(tmp_path, (topology, frames))
    path = tmp_path / "run.vtkhdf"
    with h5py.File(path, "r+") as file:
        file["VTKHDF/PointData/velocity [m s^-1]"].resize(4 * len(topology.rest_positions) - 3, axis=0)
    with read(tmp_path) as run:
        assert len(run) == 3
        assert_array_equal(run.t, [frame.t for frame in frames[:3]])
    write_all(Hdf5Writer(path, resume_at=1e9), topology, frames[3:])
    with read(tmp_path) as run:
        assert_array_equal(run.field("velocity")[4], frames[4].fields["velocity"])
        assert len(run) == 5


def test_a_file_is_read_while_it_is_written(tmp_path):
    topology, frames = cantilever(frames=3)
    writer = Hdf5Writer(tmp_path / "run.vtkhdf")
    writer.open(topology, {})
    for number, frame in enumerate(frames, start=1):
        writer.write(frame)
        with read(tmp_path) as run:
            assert len(run) == number
            assert_array_equal(run.positions[-1], frame.positions)
        assert count_steps_elsewhere(tmp_path / "run.vtkhdf") == number
    writer.close()


def test_a_run_without_frames_is_read(tmp_path):
    with read(write_run(tmp_path, (cantilever()[0], []))) as run:
        assert len(run) == 0
        assert np.asarray(run.positions).shape == (0, 41, 3)


def test_an_existing_file_is_never_overwritten(tmp_path):
    write_run(tmp_path, cantilever(frames=1))
    with pytest.raises(OutputError, match=r"run\.vtkhdf"):
        Hdf5Writer(tmp_path / "run.vtkhdf").open(cantilever()[0], {})


def test_resume_refuses_another_model_and_a_missing_file(tmp_path):
    write_run(tmp_path, cantilever(frames=2))
    with pytest.raises(OutputError, match="another model"):
        Hdf5Writer(tmp_path / "run.vtkhdf", resume_at=0.1).open(sheet()[0], {})
    with pytest.raises(OutputError, match="cannot resume"):
        Hdf5Writer(tmp_path / "none.vtkhdf", resume_at=0.1).open(sheet()[0], {})


def test_a_wrong_field_shape_is_a_bug_not_a_broadcast(tmp_path):
    topology, frames = cantilever(frames=1)
    writer = Hdf5Writer(tmp_path / "run.vtkhdf")
    writer.open(topology, {})
    frames[0].fields["strain"] = np.zeros(1)
    with pytest.raises(ValueError, match="reshape"):
        writer.write(frames[0])
    writer.close()


def test_unknown_names_list_the_known_ones(tmp_path):
    with read(write_run(tmp_path, cantilever(frames=1))) as run:
        with pytest.raises(OutputError, match="velocity, strain"):
            run.field("colour")
        with pytest.raises(OutputError, match="theta"):
            run.state("colour")
        with pytest.raises(IndexError):
            run.positions[1]


def test_a_folder_without_a_run_file_and_a_damaged_one_are_named(tmp_path):
    with pytest.raises(OutputError, match="no such run directory"):
        read(tmp_path / "nowhere")
    with pytest.raises(OutputError, match="no such file"):
        _ = read(tmp_path).t
    (tmp_path / "run.vtkhdf").write_bytes(b"not HDF5")
    with pytest.raises(OutputError, match="damaged"):
        _ = read(tmp_path).t
