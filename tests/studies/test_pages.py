"""Pages that need nothing but themselves, and what they tell of a run."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from cli_call import call
from cli_process import swing

from dismech_cli.studies import page
from dismech_cli.studies.study.measure import Point
from dismech_cli.studies.study.studied import Row, Studied
from dismech_cli.studies.study.study_page import study_page
from dismech_cli.studies.sweep.sweep_page import sweep_page
from dismech_cli.studies.sweep.table import columns
from dismech_cli.studies.sweep.task import Result

__all__ = ["call", "swing"]

LARGEST = 1_000_000


def references(text: str) -> set[str]:
    """What a browser would fetch for a page: links, sources, styles, imports; data inside is none."""
    found = re.findall(r"""(?:src|href|xlink:href|srcset|poster|action|data)\s*=\s*["']([^"']*)""", text)
    found += re.findall(r"url\(\s*[\"']?([^)\"']*)", text)
    found += re.findall(r"@import\s*([^;]*)", text)
    return {one for one in found if not one.startswith(("data:", "#"))}


def test_a_page_fetches_nothing_and_shows_text_as_text():
    figure, (left, right) = page.new_figure(2)
    left.plot([1, 2], [3, 4])
    right.set_title("<script src='https://example.org/x.js'>")
    text = page.page(
        "<b>name</b>",
        [
            page.heading("a < b"),
            page.paragraph("<img src='http://example.org/a.png'>"),
            page.table(["<i>"], [["<u>", 1.23456789, None, True]]),
            page.drawn(figure),
            page.drawn(figure, points=page.DRAWN_POINTS + 1),
            page.listing("<pre>"),
        ],
        lead="<a href='https://example.org'>",
    )
    assert not references(re.sub(r"&lt;.*?&gt;", "", text))
    assert "default-src 'none'" in text
    for tag in ("<b>", "<i>", "<u>", "<script", "<a "):
        assert tag not in text
    assert "1.23457" in text
    assert text.count("<svg") == 1
    assert text.count("data:image/png") == 1


def test_a_figure_is_the_same_bits_every_time():
    def made() -> str:
        figure, (panel,) = page.new_figure()
        panel.plot([1, 2], [3, 4])
        return page.drawn(figure)

    assert made() == made()


def result(k: int, **more) -> Result:
    settings = tuple(
        {"key": key, "text": str(value), "value": value, "unit": "Pa"}
        for key, value in {"a": float(k % 100), "b": 10.0 ** (k // 100)}.items()
    )
    given = {
        "id": f"{k:016x}",
        "settings": settings,
        "status": "done",
        "exit_code": 0,
        "message": "",
        "probes": {"tip": float(np.sin(k))},
        "units": {"tip": "m"},
        "counters": {"steps": 3},
        "cpu": 1.0,
        "wall": 2.0,
        "light": True,
    }
    return Result(**(given | more))


def test_the_page_of_a_thousand_points_is_small():
    results = [result(k) for k in range(2000)]
    text = sweep_page("many", 2000, results, columns(results))
    assert len(text.encode()) < LARGEST
    assert not references(text)
    assert "The first 500 of 2000; all are in table.csv" in text


def test_the_page_of_a_sweep_tells_what_went_wrong():
    results = [result(0), result(1, status="broken", exit_code=1, message="<died>", probes={})]
    text = sweep_page("few", 3, results, columns(results))
    assert "3 points: 1 done, 1 broken, 1 without a result" in text
    assert "&lt;died&gt;" in text


def test_the_page_of_the_largest_study_is_small():
    """Twelve levels of step and mesh of twenty alternatives."""
    rows = [
        Row(
            point=Point(
                settings=(
                    ("numerics.integrator", f"{{type: generalized_alpha, spectral_radius: 0.{k}}}"),
                    ("numerics.dt", f"{i} ms"),
                    ("geometry[0].generate.nodes", str(j)),
                ),
                status="failed" if i == 0 else "done",
                message="the solver gave up at t = 1 s with dt = 0.01 s: max iterations",
                cpu=1.0 + i + j + 0.01 * k,
                steps=100,
                iterations=200,
                cuts=0,
                size=1.0,
                order=2,
                t_end=1.0,
                courses={},
            ),
            error=0.1 / (1.0 + i + j + k),
            best=k == 0,
        )
        for i in range(12)
        for j in range(12)
        for k in range(20)
    ]
    studied = Studied(
        name="<b>",
        folder=Path("out"),
        target=0.01,
        quantities={},
        rows=tuple(rows),
        found=(),
        count=len(rows),
        finer="--over KEY=FROM:LEVELS",
        missing=(),
        reference="levels",
        load=1.0,
    )
    text = study_page(studied)
    assert len(text.encode()) < LARGEST
    assert not references(text)
    assert "The first 500 of 2880; all are in study.csv." in text


def test_a_sweep_of_words_draws_nothing():
    words = tuple({"key": "a", "text": t, "value": t, "unit": ""} for t in ("x",))
    results = [result(0, settings=words), result(1, settings=words)]
    assert "Nothing to draw" in sweep_page("words", 2, results, columns(results))


@pytest.fixture
def run_dir(call, swing: Path) -> Path:
    done = call("run", "swing.yaml", "-o", "out", "--no-render", "-q", "--set", "numerics.dt=1 ms")
    assert done.code == 0
    return swing / "out"


def test_the_page_of_a_run(call, run_dir):
    done = call("report", run_dir)
    assert done.code == 0, done.stderr
    assert done.stdout.strip() == str(run_dir / "report.html")
    text = (run_dir / "report.html").read_text()
    assert len(text.encode()) < LARGEST
    assert not references(text)
    told = re.findall("<h2>(.*?)</h2>", text)
    assert told == ["Expectations", "Probes", "Energy account", "Convergence", "Settings", "Made by"]
    manifest = json.loads((run_dir / "manifest.json").read_text())
    for part in ("anything that falls", "kept", "numerics.dt=1 ms", manifest["versions"]["numpy"], "tip [m]"):
        assert part in text
    assert f">{manifest['counters']['iterations']}<" in text
    assert "data:image/png" in text
    assert "<video" not in text


def test_the_page_of_a_run_without_frames_or_table(call, run_dir):
    (run_dir / "run.vtkhdf").unlink()
    (run_dir / "scalars.csv").unlink()
    done = call("report", run_dir, "-o", "page.html", "--json")
    assert done.code == 0, done.stderr
    assert json.loads(done.stdout) == {"files": ["page.html"]}
    assert "No pictures: the run kept no frames." in Path("page.html").read_text()


def test_what_is_no_run_has_no_report(call, run_dir):
    shutil.rmtree(run_dir / "checkpoints")
    (run_dir / "manifest.json").unlink()
    done = call("report", run_dir)
    assert done.code == 2
    assert "is no run directory" in done.stderr
