#!/usr/bin/python3
"""JUnit of `troupe test`, read by junitparser, a library of its own: verdicts, names, failures and errors apart.

usage: read_junit.py --programs FOLDER     exit status 77: junitparser is not installed
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    from junitparser import Error, Failure, JUnitXml
except ImportError:
    print("found no junitparser (Debian's python3-junitparser); nothing was checked")
    sys.exit(77)

parser = argparse.ArgumentParser()
parser.add_argument("--programs", required=True)
troupe = pathlib.Path(parser.parse_args().programs) / "troupe"

TEST = {
    "name": "<verdicts> & \"names\"",
    "ticks": 20,
    "robots": [{"name": "a", "model": "position", "controller": {
        "name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.5}]}}}],
    "vary": {"robots[a].model": ["position", "none"],
             "robots[a].controller.parameters.commands[0].vx": [0.1, 0.5]},
    "expect": [{"name": "slow <&>", "that": "forall r: always x(r) < 0.5 m"}],
}

with tempfile.TemporaryDirectory() as folder:
    path = pathlib.Path(folder) / "verdicts.test.json"
    path.write_text(json.dumps(TEST))
    junit = pathlib.Path(folder) / "junit.xml"
    status = subprocess.run([troupe, "test", path, "--no-shrink", "--junit", junit, "--report", pathlib.Path(folder) / "report"],
                            stdout=subprocess.PIPE, check=False).returncode
    assert status == 1, status
    xml = JUnitXml.fromfile(str(junit))
    assert (xml.tests, xml.failures, xml.errors, xml.skipped) == (4, 1, 2, 0), xml
    suites = list(xml)
    assert len(suites) == 1 and suites[0].name == str(path), suites
    assert (suites[0].tests, suites[0].failures, suites[0].errors) == (4, 1, 2)
    found = {case.name: case for case in suites[0]}
    draws = 'robots[a].model="{}",robots[a].controller.parameters.commands[0].vx={}'
    expected = {draws.format("position", "0.1"): None, draws.format("position", "0.5"): Failure,
                draws.format("none", "0.1"): Error, draws.format("none", "0.5"): Error}
    assert found.keys() == expected.keys(), found.keys()
    for name, kind in expected.items():
        case = found[name]
        assert case.classname == TEST["name"], case.classname
        assert [type(result) for result in case.result] == ([] if kind is None else [kind]), (name, case.result)
    failure = found[draws.format("position", "0.5")].result[0]
    assert failure.message.startswith("slow <&>: fails at tick "), failure.message
    assert "troupe test " in failure.text and "--case " in failure.text, failure.text
    error = found[draws.format("none", "0.1")].result[0]
    assert "'none'" in error.message, error.message
print("junitparser reads the verdicts of 4 cases")
