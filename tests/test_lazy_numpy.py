"""Loading SciPy loads no part of NumPy that nobody uses, and takes nothing away from either."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import pytest

CODE = """
import json, sys
import dismech_cli.solve
import numpy as np
import scipy.linalg, scipy.sparse, scipy.spatial, scipy.interpolate
from scipy._lib.array_api_compat import numpy as copy
loaded = [name for name in ("f2py", "testing", "ctypeslib") if f"numpy.{name}" in sys.modules]
missing = [name for name in np.__all__ if getattr(np, name) is not getattr(copy, name, None)]
everything = {}
exec("from numpy import *", everything)
print(json.dumps({
    "loaded": loaded,
    "missing": missing,
    "all": "f2py" in everything and "f2py" in dir(np),
    "unknown": hasattr(copy, "no_such_name"),
}))
"""


@pytest.fixture(scope="module")
def seen() -> dict[str, Any]:
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout))


def test_what_nobody_uses_is_not_loaded(seen: dict[str, Any]) -> None:
    assert seen["loaded"] == []


def test_every_name_is_found_when_it_is_asked_for(seen: dict[str, Any]) -> None:
    # functions of SciPy's own that stand for those of NumPy
    assert not {"random", "testing", "ma", "fft", "polynomial", "f2py", "exp"} & set(seen["missing"]) - {
        "fft"
    }
    assert seen["all"]
    assert not seen["unknown"]
