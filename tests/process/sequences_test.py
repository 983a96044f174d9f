#!/usr/bin/env python3
"""The search of scripts/kill-test for the fewest requests with which a trial fails: a trial is here a function.

usage: sequences_test.py --programs FOLDER      (not used)
"""
import importlib.machinery
import importlib.util
import pathlib
import random
import sys
import tempfile

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"


def load(name):
    sys.path.insert(0, str(SCRIPTS))
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader(name.replace("-", "_"), str(SCRIPTS / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


def check_shrinking(kill):
    """Of a trial that fails with a deletion before a rewind, while the death follows the deletion."""
    class Failing(kill.Interleaving):
        def __init__(self):
            self.requests = [("step", 3), ("delete", "anna"), ("reset",), ("door", "gate", "open"), ("rewind", 2), ("step", 5), ("play",)]
            self.disturbances = [kill.Disturbance(kill.AGENT, "kill", 0.1, 0.0, False, 0.5, 2)]

        def fails(self, requests, disturbances, number):
            found = [request[0] for request in requests]
            if "delete" in found and "rewind" in found and disturbances[0].request == found.index("delete") + 1:
                return ["other hashes"]
            return []

    fewest = Failing().shrink()
    expected = [("delete", "anna"), ("rewind", 2), ("play",)]
    assert fewest == expected, f"found {fewest}, expected {expected}"


def check_kinds(kill, folder):
    """The sequences have every kind of request."""
    kinds = set()
    for seed in range(60):
        source = kill.RequestSource(random.Random(seed), folder)
        for _ in range(kill.REQUESTS):
            request = source.draw()
            source.note(request)
            kinds.add(request[0] if request[0] != "reset" else " ".join(request))
    expected = {"step", "reset", "reset --time", "reset --state", "reset --spawned", "load", "rewind", "spawn", "delete", "restore",
                "set-pose", "speed", "door", "lift", "light", "goto"}
    assert kinds == expected, f"missing {expected - kinds}, unknown {kinds - expected}"


def main():
    kill = load("kill-test")
    check_shrinking(kill)
    with tempfile.TemporaryDirectory() as folder:
        check_kinds(kill, pathlib.Path(folder))


if __name__ == "__main__":
    main()
