"""Runs and checks as JUnit XML, which continuous integration shows.

A run is one test case and one for each expectation; a check is one for each scenario.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element, SubElement, tostring

from ..errors import DismechError
from ..output.durable import write_bytes
from ..session.exit_codes import Exit

if TYPE_CHECKING:
    from ..session.conduct import Finished
    from ..studies.sweep.sweep import Swept


def write_junit(file: Path, finished: Finished) -> None:
    """Write how a run ended.

    Raises:
        OutputError: If the file cannot be written.
    """
    manifest, ending = finished.record.manifest, finished.record.ending
    suite = Element("testsuite", name=manifest.name)
    run = _case(suite, manifest.name, "run", manifest.seconds.get("total", 0.0))
    if ending.code not in (Exit.DONE, Exit.EXPECTATION):
        _fault(run, "error", ending.message)
    for verdict in ending.verdicts:
        case = _case(suite, manifest.name, verdict.name, 0.0)
        if not verdict.passed:
            _fault(case, "failure", str(verdict))
    _write(file, suite)


def write_checks(file: Path, faults: Mapping[str, str]) -> None:
    """Write what was checked.

    Args:
        file: Where to.
        faults: What is wrong with each scenario, or nothing.

    Raises:
        OutputError: If the file cannot be written.
    """
    suite = Element("testsuite", name="check")
    for scenario, message in faults.items():
        case = _case(suite, scenario, "check", 0.0)
        if message:
            _fault(case, "error", message)
    _write(file, suite)


def write_sweep(file: Path, swept: Swept) -> None:
    """Write how the points of a sweep ended: each is a test case, its time that of the processor.

    Raises:
        OutputError: If the file cannot be written.
    """
    from ..session.verdicts import Verdict

    suite = Element("testsuite", name=swept.name)
    for point in swept.points:
        result = swept.results.get(point.id)
        case = _case(suite, swept.name, point.label, 0.0 if result is None else result.cpu)
        if result is None:
            SubElement(case, "skipped", message="no result")
        elif result.exit_code == Exit.EXPECTATION:
            missed = [Verdict.of_json(entry) for entry in result.expectations if not entry["passed"]]
            _fault(case, "failure", "\n".join(map(str, missed)))
        elif result.exit_code:
            _fault(case, "error", result.message)
    _write(file, suite)


@contextmanager
def failures_in_junit(file: Path | None, name: str) -> Iterator[None]:
    """Write a failure inside the block to ``file``, if there is one, and pass it on."""
    try:
        yield
    except DismechError as error:
        if file is not None:
            suite = Element("testsuite", name=name)
            _fault(_case(suite, name, "run", 0.0), "error", str(error))
            _write(file, suite)
        raise


def _case(suite: Element, scenario: str, name: str, seconds: float) -> Element:
    return SubElement(suite, "testcase", classname=scenario, name=name, time=f"{seconds:.3f}")


def _fault(case: Element, kind: str, message: str) -> None:
    plain = _printable(message)
    SubElement(case, kind, message=plain.partition("\n")[0]).text = plain


def _printable(text: str) -> str:
    """XML 1.0 has no control characters."""
    return "".join(c if c in "\t\n" or c.isprintable() else "?" for c in text)


def _write(file: Path, suite: Element) -> None:
    cases = list(suite)
    suite.set("tests", str(len(cases)))
    for key, kind in (("failures", "failure"), ("errors", "error")):
        suite.set(key, str(sum(case.find(kind) is not None for case in cases)))
    write_bytes(file, tostring(suite, encoding="utf-8", xml_declaration=True) + b"\n")
