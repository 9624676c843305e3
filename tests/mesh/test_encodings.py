"""Mesh files as other systems and programs write their text."""

from pathlib import Path

import pytest
from mesh_texts import BELL, HYBRID, MSH22, MSH41
from numpy.testing import assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.files.read import READERS, read_mesh

TEXTS = [("m.txt", HYBRID), ("m.obj", BELL), ("a.msh", MSH41), ("b.msh", MSH22)]
POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:" + b"ab" * 32 + b"\nsize 4711\n"


@pytest.mark.parametrize(("name", "text"), TEXTS)
@pytest.mark.parametrize("end", ["\r", "\r\n"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_encodings_and_line_ends(tmp_path: Path, name: str, text: str, end: str, encoding: str) -> None:
    (tmp_path / "plain").mkdir()
    (tmp_path / "plain" / name).write_bytes(text.encode())
    (tmp_path / name).write_bytes(text.replace("\n", end).encode(encoding))
    plain, foreign = read_mesh(tmp_path / "plain" / name), read_mesh(tmp_path / name)
    assert_array_equal(foreign.nodes, plain.nodes)
    assert_array_equal(foreign.edges, plain.edges)
    assert_array_equal(foreign.triangles, plain.triangles)
    assert foreign.node_groups.keys() == plain.node_groups.keys()


def test_errors_name_the_line_of_carriage_returns(tmp_path: Path) -> None:
    path = tmp_path / "m.txt"
    path.write_bytes(HYBRID.replace("1e-1, 0, 0", "1e-1, zero, 0").replace("\n", "\r").encode())
    with pytest.raises(MeshError, match=r"m\.txt:7: coordinate 'zero'"):
        read_mesh(path)


@pytest.mark.parametrize("suffix", READERS)
def test_a_file_that_was_not_fetched_is_told(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"m{suffix}"
    path.write_bytes(POINTER)
    with pytest.raises(MeshError, match=rf"m\{suffix}:1: a Git LFS pointer .* 'git lfs pull'"):
        read_mesh(path)
