"""Whoever has memory saves itself, and a checkpoint of another version is refused."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dismech_cli.errors import OutputError
from dismech_cli.model.saved import Arrays, Numbers, restore_all, save_all
from dismech_cli.output import checkpoint
from dismech_cli.output.run_directory import CHECKPOINT_FOLDER
from dismech_cli.run.recorder import load_checkpoint


@dataclass(frozen=True)
class Memory:
    values: Arrays
    count: int = 0

    def arrays(self) -> Arrays:
        return self.values

    def numbers(self) -> Numbers:
        return {"count": self.count}

    def restore(self, arrays: Arrays, numbers: Numbers) -> Memory:
        return replace(self, values=arrays, count=int(numbers["count"]))


def test_parts_do_not_see_each_other() -> None:
    """Not even where the name of one begins with that of another."""
    parts = {"a": Memory({"x": np.arange(3.0)}, 1), "ab": Memory({"x.y": np.ones(2)}, 2)}
    arrays, numbers = save_all(parts)
    found = restore_all({name: Memory({}) for name in parts}, arrays, numbers)
    for name, part in parts.items():
        assert found[name].numbers() == part.numbers()
        assert found[name].arrays().keys() == part.arrays().keys()
        for key, values in part.arrays().items():
            assert_array_equal(found[name].arrays()[key], values)


@pytest.mark.parametrize("meta", [{"identity": {}, "numbers": {"t": 0.5}}, {"format": 1}])
def test_a_checkpoint_of_another_version_is_refused(tmp_path: Path, meta: dict[str, object]) -> None:
    checkpoint.save(tmp_path / CHECKPOINT_FOLDER, {"q": np.zeros(3)}, meta)
    with pytest.raises(OutputError, match="of another version of dismech: resume with that one, or run anew"):
        load_checkpoint(tmp_path)
