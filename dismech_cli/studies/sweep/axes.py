"""The rows of a sweep: what each point sets, in order, counted before they are made."""

from __future__ import annotations

import csv
import inspect
import itertools
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from ...arrays import FloatArray
from ...csv_columns import MAX_BYTES
from ...errors import ScenarioError
from ...file_text import decode
from ...scenario.language.sweep import MAX_POINTS, Sample, Span, Sweep
from ...scenario.text.problems import ProblemsError
from ...scenario.text.tree import Source
from ...scenario.text.yaml_text import parse_yaml

Row: TypeAlias = tuple[tuple[str, str], ...]
"""Key paths and their values, as ``--set`` takes them."""


def rows(sweep: Sweep, directory: Path) -> list[Row]:
    """What each point of a sweep sets, the last axis changing fastest.

    Args:
        sweep: The axes.
        directory: Where the names of files start.

    Raises:
        ScenarioError: There are too many points, or a table cannot be read.
    """
    table = _table(directory / sweep.csv) if sweep.csv is not None else None
    sizes = [axis.count if isinstance(axis, Span) else len(axis) for axis in sweep.over.values()]
    sizes += [len(next(iter(sweep.zip.values())))] if sweep.zip else []
    sizes += [len(table)] if table is not None else []
    sizes += [sweep.sample.count] if sweep.sample is not None else []
    count = math.prod(sizes)
    if count > MAX_POINTS:
        product = " x ".join(map(str, sizes))
        raise ScenarioError(f"a sweep of {product} = {count} points: at most {MAX_POINTS} are allowed")
    blocks: list[Sequence[Row]] = [
        [((key, text),) for text in _values(axis)] for key, axis in sweep.over.items()
    ]
    if sweep.zip:
        lists = [[(key, written(value)) for value in values] for key, values in sweep.zip.items()]
        blocks.append(list(zip(*lists, strict=True)))
    if table is not None:
        blocks.append(table)
    if sweep.sample is not None:
        blocks.append(_sampled(sweep.sample))
    made = [tuple(itertools.chain.from_iterable(parts)) for parts in itertools.product(*blocks)]
    _refuse_twice(made[0])
    return made


def written(value: Any) -> str:
    """A value as text that reads as the same value."""
    if isinstance(value, str):
        try:
            if parse_yaml(Source("", value)).value == value and "\n" not in value:
                return value
        except ProblemsError:
            pass
    return json.dumps(value, ensure_ascii=False)


def _values(axis: Span | tuple[Any, ...]) -> list[str]:
    if isinstance(axis, Span):
        return [axis.at(k / (axis.count - 1)) for k in range(axis.count)]
    return [written(value) for value in axis]


def _sampled(sample: Sample) -> list[Row]:
    shares = latin_hypercube(sample.count, len(sample.over), sample.seed)
    return [
        tuple(
            (key, axis.at(float(share))) for (key, axis), share in zip(sample.over.items(), row, strict=True)
        )
        for row in shares
    ]


def latin_hypercube(count: int, dimensions: int, seed: int) -> FloatArray:
    """Points of which each of ``count`` slices of an axis holds one, shape (count, dimensions), in [0, 1)."""
    from scipy.stats import qmc

    # SciPy renamed the argument; the numbers are the same.
    named = "rng" if "rng" in inspect.signature(qmc.LatinHypercube).parameters else "seed"
    source: Mapping[str, Any] = {named: np.random.default_rng(seed)}
    return np.asarray(qmc.LatinHypercube(dimensions, **source).random(count), dtype=np.float64)


def _table(path: Path) -> list[Row]:
    try:
        if not path.is_file() or path.stat().st_size > MAX_BYTES:
            raise ScenarioError(f"{path}: expected a file of at most {MAX_BYTES // 1024**2} MB")
        text = decode(path.read_bytes())
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{path}: cannot read: {getattr(error, 'strerror', None) or 'no text'}") from None
    lines = [(n, line) for n, line in enumerate(text.split("\n"), start=1) if line.strip() and line[0] != "#"]
    if len(lines) < 2:
        raise ScenarioError(f"{path}: expected a line of key paths and a row for each point")
    if len(lines) - 1 > MAX_POINTS:
        raise ScenarioError(f"{path}: {len(lines) - 1} rows: at most {MAX_POINTS} points are allowed")
    separator = next((mark for mark in (";", "\t") if mark in lines[0][1]), ",")
    head, *body = (
        (number, [cell.strip() for cell in next(csv.reader([line], delimiter=separator), [])])
        for number, line in lines
    )
    keys = head[1]
    for number, cells in body:
        if len(cells) != len(keys) or not all(cells):
            raise ScenarioError(
                f"{path}:{number}: expected a value for each of {', '.join(keys)}; "
                f"got {len([*filter(None, cells)])}"
            )
    return [tuple(zip(keys, cells, strict=True)) for _, cells in body]


def _refuse_twice(row: Row) -> None:
    keys = [key for key, _ in row]
    twice = sorted({key for key in keys if keys.count(key) > 1})
    if twice:
        raise ScenarioError(f"varied twice: {', '.join(twice)}")
    inner = sorted({key for key in keys if key.split(".")[0] == "sweep"})
    if inner:
        raise ScenarioError(f"a sweep does not vary itself: {', '.join(inner)}")
