#!/usr/bin/env python3
"""Tries each pair of the options of each command that needs no live run: both have the effects that they have alone, or the
command refuses the pair by one line that names both. None is accepted and ignored.

usage: options.py TROUPE

The options are those of the help texts, so that a new one is in the list by itself; VALUES has a value for each that needs
one. The effect of an option is a change of what the command prints or writes. One that changes neither alone, as a number of
threads, is only tried.
"""

import concurrent.futures
import hashlib
import itertools
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import worlds
from rows import THINGS

SECONDS = 60
WORLD = tuple(thing for thing in THINGS if thing.name in ("robot", "object", "joint", "ranger", "camera", "energy", "lane"))

VALUES = {
    "--ticks": "9", "--mode": "realtime", "--speed": "50", "--on-agent-loss": "rebuild", "--seed": "9", "--controller": "expand",
    "--allow-files": ".", "--allow-controllers": ".", "--threads": "1", "--start-timeout": "9", "--hash-log": "hashes",
    "--poses": "poses", "--record": "new.mcap", "--keyframe-interval": "3", "--scans": "scans", "--summary": "summary",
    "--trace": "trace", "--trace-ticks": "1:3", "--faults": "loss=0.01,seed=1", "--robots-per-process": "2",
    "--restart-agents": "1", "--on-service-loss": "end", "--journal": "journal.mcap", "--hosts": "a", "--interface": "lo",
    "--network": "lan", "--security": "on", "--data-sharing": "off", "--lease": "9", "--shuffle-start": "1", "--from": "3",
    "--to": "11", "--tick": "5", "--view": "side", "--camera": "camera_bot", "--center": ("26", "4"), "--meters": "40",
    "--heights": ("0", "1"), "--width": "300", "--resolution": "0.5", "--height": "0.1", "--jobs": "1", "--shard": "1/2",
    "--case": "seed=2", "--search": "4", "--on": "run.mcap", "--junit": "junit.xml", "--report": "report", "--merge": "shard",
    "--format": "csv", "--listen": "127.0.0.1:0", "--token-file": "token",
}
# Not tried: they end the command at once, need a live run, or are the base of all trials of their command.
LEFT_OUT = {
    "run": {"--in-process", "--headless", "--paused", "--from-tick", "--session", "--domain", "--host-start", "--ros",
            "--no-ros"},
    "export": {"--output", "--format"}, "snapshot": {"--output"}, "export-map": {"--output"}, "sweep": {"--output"},
    "test": {"--processes"},
}
COMMANDS = {
    "run": ["all.json", "--in-process", "--headless"],
    "replay": ["run.mcap"],
    "snapshot": ["all.json", "-o", "out.png"],
    "export": ["run.mcap", "--format", "csv", "-o", "tables"],
    "export-map": ["all.json", "-o", "map_of_all"],
    "test": ["all.test.json"],
    "sweep": ["-o", "report"],
    "check": ["all.json"],
}
# Pairs of which one changes what the other does not show: the camera sees no person, whose place follows from the seed.
UNSEEN = {("snapshot", "--tick", "--camera"), ("snapshot", "--camera", "--seed")}
BASES = {"sweep": {"--merge": [], "": ["all.test.json"]}}  # words that stand where the option does not


class Trials:
    def __init__(self, troupe, folder):
        self.troupe, self.folder = troupe, folder
        self.environment = {**os.environ, "NO_COLOR": "1"}
        for name in ("TROUPE_SESSION", "TROUPE_DOMAIN"):
            self.environment.pop(name, None)
        self.files = folder / "files"
        self.files.mkdir()
        worlds.write(self.files, "all", WORLD)
        (self.files / "all.json").write_text(json.dumps(worlds.scenario(WORLD) | {"ticks": 12}))
        (self.files / "all.test.json").write_text(json.dumps(worlds.test_of(WORLD, ticks=15) | {
            "vary": {"seed": {"values": [1, 2, 3]}, "robots[rover].pose[0]": {"uniform": [-0.5, 0.5]}},
            "design": {"random": 4}}))
        for words in (["run", "all.json", "--in-process", "--headless", "--ticks", "15", "--record", "run.mcap"],
                      ["sweep", "all.test.json", "--shard", "1/1", "-o", "shard"]):
            subprocess.run([troupe, *words], cwd=self.files, env=self.environment, check=True, capture_output=True)

    def options_of(self, command):
        text = subprocess.run([self.troupe, command, "--help"], capture_output=True, text=True, check=True,
                              env=self.environment).stdout
        text = text.partition("\nExamples:\n")[0]
        names = re.findall(r"^  (?:-\w, *)?(--[a-z-]+)", text, re.MULTILINE)
        return [name for name in dict.fromkeys(names)
                if name not in LEFT_OUT.get(command, ()) and name != "--help" and not name.startswith("--ros")]

    def try_words(self, command, options):
        """(status, text, outcome): what was printed, without times, and the files that were written."""
        with tempfile.TemporaryDirectory(dir=self.folder) as place:
            place = pathlib.Path(place) / "place"
            shutil.copytree(self.files, place)
            before = {path for path in place.rglob("*") if path.is_file()}
            words = [command, *COMMANDS[command]]
            for option, instead in BASES.get(command, {}).items():
                if option not in options:
                    words += instead
            for option in options:
                value = VALUES.get(option, ()) if self.needs_value(command, option) else ()
                words += [option, *([value] if isinstance(value, str) else value)]
            try:
                done = subprocess.run([self.troupe, *words], cwd=place, env=self.environment, capture_output=True, text=True,
                                      timeout=SECONDS, check=False)
            except subprocess.TimeoutExpired:
                return "no end", " ".join(words), None
            written = []
            for path in sorted(path for path in place.rglob("*") if path.is_file()):
                content = path.read_bytes()
                if path not in before:
                    volatile = path.suffix == ".mcap" or path.name in ("summary", "trace")
                    written.append((str(path.relative_to(place)), volatile or hashlib.sha1(content).hexdigest()))
            text = re.sub(r"\d+\.\d+( ?(s|x|MiB|ms|%))", r"N\1", done.stdout)
            return done.returncode, done.stdout + done.stderr, (text, tuple(written))

    def needs_value(self, command, option):
        return option in VALUES and not (command == "snapshot" and option == "--depth")

    def check(self, command):
        """The pairs that are neither effective nor refused, and the numbers of both."""
        options = self.options_of(command)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            alone = dict(zip(options, pool.map(lambda option: self.try_words(command, [option]), options)))
            base = self.try_words(command, [])
            # An option that the base itself excludes (--in-process those of processes) is refused in each pair, too.
            words = [word for word in COMMANDS[command] if word.startswith("--")]
            excluded = {option for option, (status, text, _) in alone.items()
                        if status == 2 and option in text and any(f"{word} beside" in text or f"beside {word}" in text for word in words)}
            pairs = list(itertools.combinations([option for option in options if option not in excluded], 2))
            outcomes = list(pool.map(lambda pair: self.try_words(command, list(pair)), pairs))
        problems, refused = [], 0
        for (first, second), (status, text, outcome) in zip(pairs, outcomes):
            name = f"troupe {command} {first} {second}"
            if "no end" in (status, alone[first][0], alone[second][0]):
                problems.append(f"{name}: no end")
            elif status == 2:
                refused += 1
                alone_refused = [option for option in (first, second) if alone[option][0] == 2]
                lines = text.strip().splitlines()
                if len(lines) != 1 or (not alone_refused and not all(option in text for option in (first, second))):
                    problems.append(f"{name}: the refusal does not name both: {text.strip()}")
            elif status not in (0, 1):
                problems.append(f"{name}: status {status}: {text.strip()}")
            else:
                for option, other in ((first, second), (second, first)) if (command, first, second) not in UNSEEN else ():
                    has_effect = alone[option][0] in (0, 1) and alone[option][2] != base[2]
                    if has_effect and alone[other][0] in (0, 1) and outcome == alone[other][2]:
                        problems.append(f"{name}: accepted, and {option} is ignored")
        return problems, len(pairs) + len(excluded), refused + len(excluded)


def main():
    troupe = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        trials = Trials(troupe, pathlib.Path(folder))
        problems = []
        for command in sys.argv[2:] or COMMANDS:
            found, pairs, refused = trials.check(command)
            print(f"troupe {command}: {pairs} pairs of options, {refused} refused, {len(found)} wrong", flush=True)
            problems += found
    for problem in problems:
        print(problem)
    if problems:
        sys.exit(f"error: {len(problems)} pairs of options are neither effective nor refused")


if __name__ == "__main__":
    main()
