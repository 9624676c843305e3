"""The binary glTF file: read back by the rules of the format, and its shapes are those of the run."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from output_cases import cantilever, sheet, write_run

from dismech_cli.errors import OutputError
from dismech_cli.output.read import read
from dismech_cli.render.gltf import MOST_FRAMES, write_glb
from dismech_cli.render.parts import make_parts

_TYPES = {5126: np.float32, 5125: np.uint32, 5121: np.uint8}
_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


class Glb:
    """A file, taken apart."""

    def __init__(self, path):
        content = path.read_bytes()
        magic, version, length = struct.unpack_from("<4sII", content)
        assert (magic, version, length) == (b"glTF", 2, len(content))
        size, kind = struct.unpack_from("<I4s", content, 12)
        assert kind == b"JSON"
        assert size % 4 == 0
        self.document = json.loads(content[20 : 20 + size])
        rest, kind = struct.unpack_from("<I4s", content, 20 + size)
        assert kind == b"BIN\0"
        self.data = content[28 + size :]
        assert len(self.data) == rest == self.document["buffers"][0]["byteLength"]

    def array(self, number):
        accessor = self.document["accessors"][number]
        view = self.document["bufferViews"][accessor["bufferView"]]
        assert view["byteOffset"] % 4 == 0
        width = _WIDTHS[accessor["type"]]
        values = np.frombuffer(
            self.data, _TYPES[accessor["componentType"]], accessor["count"] * width, view["byteOffset"]
        ).reshape(-1, width)
        if "min" in accessor:
            assert_array_equal(accessor["min"], values.min(axis=0))
            assert_array_equal(accessor["max"], values.max(axis=0))
        return values


@pytest.mark.parametrize("case", [cantilever, sheet])
def test_the_shapes_are_those_of_the_run(tmp_path, case):
    topology, frames = case(frames=4)
    with read(write_run(tmp_path / "run", (topology, frames))) as run:
        assert write_glb(run, tmp_path / "run.glb") == 4
        parts = make_parts(run, 0.0, 12)
        glb = Glb(tmp_path / "run.glb")
        assert len(glb.document["meshes"]) == len(parts)
        for part, mesh, node in zip(parts, glb.document["meshes"], glb.document["nodes"], strict=False):
            (primitive,) = mesh["primitives"]
            assert_array_equal(glb.array(primitive["indices"]).reshape(-1, 3), part.faces)
            first = glb.array(primitive["attributes"]["POSITION"])
            for number, frame in enumerate(frames):
                expected, _ = part.place(frame.t, frame.positions)
                target = primitive["targets"][number - 1]["POSITION"] if number else None
                moved = first if target is None else first + glb.array(target)
                # Single precision of lengths below 0.2 m, twice rounded.
                assert_allclose(moved + node["translation"], expected, atol=0.2 * 2**-23)
        (animation,) = glb.document["animations"]
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            assert_allclose(glb.array(sampler["input"])[:, 0], run.t - run.t[0], rtol=1e-7)
            assert_array_equal(glb.array(sampler["output"]).reshape(4, 3), np.eye(4)[:, 1:])


def test_what_is_not_whole_is_left_out_and_many_frames_are_thinned(tmp_path):
    topology, frames = cantilever(frames=MOST_FRAMES + 40, nodes=4)
    frames[-1].positions[2] = np.nan
    with read(write_run(tmp_path / "run", (topology, frames))) as run:
        assert write_glb(run, tmp_path / "run.glb") == MOST_FRAMES
    times = Glb(tmp_path / "run.glb")
    last = times.array(times.document["animations"][0]["samplers"][0]["input"])[-1]
    assert_allclose(last, frames[-2].t, rtol=1e-6)
    one = cantilever(frames=1)
    with read(write_run(tmp_path / "one", one)) as run:
        write_glb(run, tmp_path / "one.glb")
    assert "animations" not in Glb(tmp_path / "one.glb").document
    one[1][0].positions[0] = np.nan
    with (
        read(write_run(tmp_path / "none", one)) as run,
        pytest.raises(OutputError, match="no whole frame"),
    ):
        write_glb(run, tmp_path / "none.glb")
