"""What scripts read: JSON on every exit, JUnit, quiet words."""

from __future__ import annotations

import json
from xml.etree.ElementTree import parse

from cli_call import call
from cli_process import swing

__all__ = ["call", "swing"]

SHORT = ("--set", "numerics.t_end=0.01")
MISSED = (
    "--set",
    "expect={tip: {probe: {displacement: beam.end, component: z}, value: 1, tolerance: 1 %, source: x}}",
)
PROBE = ("--set", "output.probes={tip: {displacement: beam.end, component: z}}")


def test_json_of_a_run_has_probes_overrides_energy_error_and_versions(call, swing):
    done = call("run", "swing.yaml", *SHORT, *PROBE, "--json", "-o", "out")
    result = json.loads(done.stdout)
    assert done.code == result["exit_code"] == 0
    assert result["errors"] == []
    assert result["overrides"] == [SHORT[1], PROBE[1]]
    assert list(result["probes"]) == ["tip"]
    assert abs(result["probes"]["tip"]) > 0.0
    assert isinstance(result["energy_error"], float)
    assert {"python", "dismech", "numpy"} <= set(result["versions"])


def test_json_of_a_bad_scenario_has_the_place_of_every_fault(call, swing):
    bad = (swing / "swing.yaml").read_text().replace("2 MPa", "2 mm").replace("radius: 1 mm", "radius: -1 mm")
    (swing / "bad.yaml").write_text(bad)
    done = call("run", "bad.yaml", "--json")
    result = json.loads(done.stdout)
    assert done.code == result["exit_code"] == 2
    assert [fault["key"].rpartition(".")[2] for fault in result["errors"]] == ["youngs_modulus", "radius"]
    for fault in result["errors"]:
        assert fault["file"] == "bad.yaml"
        assert bad.splitlines()[fault["line"] - 1][fault["column"] - 1 :].startswith(("2 mm", "-1 mm"))
        assert fault["message"]
    (checked,) = json.loads(call("check", "bad.yaml", "--json").stdout)
    assert checked["errors"] == result["errors"]


def test_json_of_a_bad_command_line_and_of_a_taken_folder(call, swing):
    done = call("run", "swing.yaml", "--nonsense", "--json")
    assert (done.code, json.loads(done.stdout)["exit_code"]) == (2, 2)
    assert "--nonsense" in json.loads(done.stdout)["errors"][0]["message"]
    done = call("resume", "nowhere", "--json")
    assert (done.code, json.loads(done.stdout)["exit_code"]) == (2, 2)
    (swing / "full").mkdir()
    (swing / "full" / "thing").write_text("")
    done = call("run", "swing.yaml", *SHORT, "-o", "full", "--json")
    assert (done.code, json.loads(done.stdout)["exit_code"]) == (5, 5)


def test_quiet_says_what_was_expected_and_measured(call, swing):
    done = call("run", "swing.yaml", *SHORT, *MISSED, "-q", "-o", "out")
    assert done.code == 4
    assert done.stdout == "out\n"
    assert "tip missed: measured -" in done.stderr
    assert "expected 1 m within 1 % (x)" in done.stderr


def test_junit_of_a_missed_expectation_and_of_a_bad_scenario(call, swing):
    done = call("run", "swing.yaml", *SHORT, *MISSED, "-o", "out", "--junit", "report.xml")
    assert done.code == 4
    suite = parse(swing / "report.xml").getroot()
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("2", "1", "0")
    assert [case.get("name") for case in suite] == ["run", "tip"]
    assert "expected 1 m within 1 %" in suite[1][0].get("message")
    assert call("run", "swing.yaml", "--set", "numerics.dt=1 mm", "--junit", "report.xml").code == 2
    suite = parse(swing / "report.xml").getroot()
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("1", "0", "1")


def test_no_render_draws_nothing(call, swing):
    asked = ("--set", "output.render.still=true")
    done = call("run", "swing.yaml", *SHORT, *asked, "--no-render", "-o", "out", "--json")
    assert done.code == 0
    assert json.loads(done.stdout)["pictures"] == []
    assert not (swing / "out" / "render").exists()


def test_resume_of_a_finished_run_says_what_the_run_said(call, swing):
    done = call("run", "swing.yaml", *SHORT, *MISSED, *PROBE, "--json", "-o", "out")
    again = call("resume", "out", "--json", "--junit", "report.xml")
    assert again.code == done.code == 4
    ran, resumed = json.loads(done.stdout), json.loads(again.stdout)
    assert len(ran["expectations"]) == 1
    assert list(ran["probes"]) == ["tip"]
    assert resumed == ran
    assert parse(swing / "report.xml").getroot().get("failures") == "1"
    assert "MISSED" in call("resume", "out").stdout
    later = json.loads(call("resume", "out", "--json", "--until", "0.02 s").stdout)
    assert later["expectations"][0]["measured"] < ran["expectations"][0]["measured"]
    assert later["probes"]["tip"] == later["expectations"][0]["measured"]


def test_junit_of_a_check_has_a_case_per_scenario(call, swing):
    (swing / "bad.yaml").write_text((swing / "swing.yaml").read_text().replace("2 MPa", "2 mm"))
    assert call("check", "swing.yaml", "bad.yaml", "--junit", "report.xml").code == 2
    suite = parse(swing / "report.xml").getroot()
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("2", "0", "1")
    assert [case.get("classname") for case in suite] == ["swing.yaml", "bad.yaml"]
    assert "youngs_modulus" in suite[1][0].text
    assert call("check", "swing.yaml", "--junit", "no/folder/report.xml").code == 5
