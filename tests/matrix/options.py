#!/usr/bin/env python3
"""Tries each pair of the options of each command: both have the effects that they have alone, or the command refuses the pair by
one line that names both. None is accepted and ignored.

usage: options.py TROUPE [--all] [COMMAND ...]

The options are those of the help texts, so that a new one is in the list by itself; VALUES has a value for each that needs
one. The effect of an option is a change of what the command prints or writes. One that changes neither alone, as a number of
threads, is only tried. Without --all each option is tried beside its next one only.
"""

import argparse
import concurrent.futures
import dataclasses
import functools
import hashlib
import itertools
import json
import os
import pathlib
import pty
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import worlds
from rows import THINGS

SECONDS = 60
WORLD = tuple(thing for thing in THINGS if thing.name in ("robot", "object", "joint", "ranger", "camera", "energy", "lane", "zone"))
DOMAIN = 101 + os.getpid() % 49  # and the next 50th

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
    "--heat": "robots", "--since": "2", "--cell": "0.7", "--format": "csv", "--listen": "127.0.0.1:0", "--token-file": "token", "--case-timeout": "50", "--host-start": "{command}",
    "--session": "other", "--domain": str(DOMAIN + 50), "--service": "127.0.0.1", "--timeout": "30", "--tolerance": "0.3",
    "--turn-rate": "2", "--hold": "0.5", "--expect": "all.test.json", "--module": "module", "--output": "page.html",
    "--ros-discovery": "localhost", "--ros-peers": "127.0.0.1", "--ros-distro": "humble", "--ros-services": "cyclone",
    "--ros-security": "off", "--ros-keystore": "keystore", "--ros-enclave": "/all", "--ros-tf": "namespaced",
    "--ros-names": "robot", "--ros-cmd-vel": "both", "--ros-command-timeout": "3", "--ros-no-hit": "range-max",
    "--ros-map": "grid", "--ros-clock-rate": "20", "--ros-map-resolution": "0.1", "--ros-map-height": "0.2", "--ros-rviz": "goal",
    "--model-path": ".", "--robot": "rover.urdf@-20,20", "--agents": "2", "--cell": "2", "--paths": "paths", "--delays": "0.1", "--planner": "cat",
    "--ros-lockstep-period": "2", "--ros-lockstep-limit": "3", "--ros-lockstep-at-limit": "continue", "--ros-participants": "host",
}
CONNECTION = {"--security": "auto"}


@dataclasses.dataclass(frozen=True)
class Command:
    """`words`: without options; `last`: words behind those; `left_out`: options that end the command at once, that it cannot
    do without, or that wait for a node; `values`: its own; `only`: a regular expression of the options that are tried; `way`:
    "ends", "serves" until it is interrupted, or "terminal"; `shows`: its options have effects in what it prints or writes;
    `is_live`: it needs live runs."""
    words: tuple
    last: tuple = ()
    left_out: tuple = ()
    values: dict = dataclasses.field(default_factory=dict)
    only: str = "--(?!ros)"
    way: str = "ends"
    shows: bool = True
    is_live: bool = False


COMMANDS = {
    "run": Command(("run", "all.json", "--in-process", "--headless"), left_out=(
        "--in-process", "--headless", "--paused", "--from-tick", "--session", "--domain", "--ros", "--no-ros"),
        only="--(?!ros|vda5050)"),  # the world has no vehicle
    "run --ros": Command(("run", "all.json", "--in-process", "--headless", "--ros", "--ros-interface", "lo", "--ros-domain",
                          str(DOMAIN - 100)), left_out=("--ros", "--ros-interface", "--ros-domain", "--ros-lockstep"),
                         only="--(no-)?ros", shows=False),
    "replay": Command(("replay", "run.mcap")),
    "snapshot": Command(("snapshot", "all.json", "-o", "out.png"), left_out=("--output",)),
    "export": Command(("export", "run.mcap", "--format", "csv", "-o", "tables"), left_out=("--output", "--format")),
    "export-map": Command(("export-map", "all.json", "-o", "map_of_all"), left_out=("--output",)),
    "export-views": Command(("export-views", "all.json", "-o", "views_of_all"), left_out=("--output",)),
    "test": Command(("test", "all.test.json"), left_out=("--processes",)),
    "sweep": Command(("sweep", "-o", "report"), left_out=("--output",)),
    "check": Command(("check", "all.json")),
    "edit": Command(("edit", "all.json"), way="serves", shows=False),
    "view": Command(("view", "run.mcap"), way="serves", shows=False, values=CONNECTION | {"--domain": str(DOMAIN)}),
    "ctl": Command(("ctl",), ("list",), values=CONNECTION, is_live=True),
    "top": Command(("top", "--once"), left_out=("--once",), values=CONNECTION, is_live=True),
    "goto": Command(("goto", "goer", "-4,4"), values=CONNECTION, shows=False, is_live=True),
    "teleop": Command(("teleop", "goer"), values=CONNECTION | {"--speed": "1"}, way="terminal", shows=False, is_live=True),
}
# Pairs of which one changes what the other does not show: the camera sees no person, whose place follows from the seed.
UNSEEN = {("snapshot", "--tick", "--camera"), ("snapshot", "--camera", "--seed")}
INSTEAD = {"sweep": ("--merge", ("all.test.json",))}  # words that stand where the option does not


class Trials:
    def __init__(self, troupe, folder):
        self.troupe, self.folder = troupe, folder
        self.environment = {**os.environ, "NO_COLOR": "1", "TROUPE_DOMAIN": str(DOMAIN), "TROUPE_SESSION": "one"}
        self.runs = []
        self.files = folder / "files"
        self.files.mkdir()
        worlds.write(self.files, "all", WORLD)
        (self.files / "all.json").write_text(json.dumps(worlds.scenario(WORLD) | {"ticks": 12}))
        (self.files / "all.test.json").write_text(json.dumps(worlds.test_of(WORLD, ticks=15) | {
            "vary": {"seed": {"values": [1, 2, 3]}, "robots[rover].pose[0]": {"uniform": [-0.5, 0.5]}},
            "design": {"random": 4}}))
        (self.files / "module").mkdir()
        for name in ("troupe-core.wasm", "troupe-core.js", "page_worker.js"):
            (self.files / "module" / name).write_text("none")
        for words in (["run", "all.json", "--in-process", "--headless", "--ticks", "15", "--record", "run.mcap"],
                      ["sweep", "all.test.json", "--shard", "1/1", "-o", "shard"]):
            subprocess.run([troupe, *words], cwd=self.files, env=self.environment, check=True, capture_output=True)

    def start_runs(self):
        """Two in each of two domains, with a robot that has the name of both."""
        # Their names differ by letters, because numbers change in what a live run shows.
        for (place, domain), session in itertools.product({"near": DOMAIN, "far": DOMAIN + 50}.items(), ("one", "other")):
            world = {"robots": [{"name": robot, "model": "position", "pose": [-4, y, 0], "controller": "go_to"}
                                for robot, y in (("goer", 4), (f"{session}_{place}", 8))]}
            name = f"{session}_{place}.json"
            (self.files / name).write_text(json.dumps(world))
            self.runs.append(subprocess.Popen(
                [self.troupe, "run", name, "--headless", "--speed", "10", "--robots-per-process", "2", "--session", session, "--domain",
                 str(domain)], cwd=self.files, env=self.environment, text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT))
        for run in self.runs:
            for line in run.stdout:
                if "ready" in line:
                    break

    def end_runs(self):
        for run in self.runs:
            run.send_signal(signal.SIGINT)
        for run in self.runs:
            run.communicate()

    def options_of(self, command):
        text = subprocess.run([self.troupe, command.words[0], "--help"], capture_output=True, text=True, check=True,
                              env=self.environment).stdout
        text = text.partition("\nExamples:\n")[0]
        names = re.findall(r"^  (?:-\w, *)?(--[a-z0-9-]+)", text, re.MULTILINE)
        return [name for name in dict.fromkeys(names)
                if name not in (*command.left_out, "--help") and re.match(command.only, name)]

    def finish(self, command, words, place):
        """(status, text on stdout, text on stderr)"""
        if command.way == "ends":
            done = subprocess.run([self.troupe, *words], cwd=place, env=self.environment, capture_output=True, text=True,
                                  timeout=SECONDS, check=False)
            return done.returncode, done.stdout, done.stderr
        terminal, other = pty.openpty() if command.way == "terminal" else (None, None)
        with subprocess.Popen([self.troupe, *words], cwd=place, env=self.environment, stdin=other or subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
            text = process.stdout.readline()
            if process.poll() is None:
                time.sleep(0.02)  # its handler of the signal comes after the line
                process.send_signal(signal.SIGINT)
            try:
                text += process.communicate(timeout=SECONDS)[0]
            finally:
                process.kill()
                for end in filter(None, (terminal, other)):
                    os.close(end)
        return (0 if process.returncode in (130, -signal.SIGINT) else process.returncode), text, ""

    def try_words(self, name, options):
        """(status, text, outcome): what was printed, without numbers that change, and the files that were written."""
        command = COMMANDS[name]
        with tempfile.TemporaryDirectory(dir=self.folder) as place:
            place = pathlib.Path(place) / "place"
            shutil.copytree(self.files, place)
            before = {path for path in place.rglob("*") if path.is_file()}
            words = list(command.words)
            option, instead = INSTEAD.get(name, (None, ()))
            words += instead if option not in options else ()
            for option in options:
                value = (VALUES | command.values).get(option, ()) if not (name == "snapshot" and option == "--depth") else ()
                words += [option, *([value] if isinstance(value, str) else value)]
            words += command.last
            try:
                status, printed, errors = self.finish(command, words, place)
            except subprocess.TimeoutExpired:
                return "no end", " ".join(words), None
            written = []
            for path in sorted(path for path in place.rglob("*") if path.is_file()):
                content = path.read_bytes()
                if path not in before:
                    volatile = path.suffix == ".mcap" or path.name in ("summary", "trace")
                    written.append((str(path.relative_to(place)), volatile or hashlib.sha1(content).hexdigest()))
            text = re.sub(r"-? *\d+(\.\d+)?\b *" if command.is_live else r"\d+\.\d+( ?(s|x|MiB|ms|%))", "N", printed)
            return status, printed + errors, (text, tuple(written))

    def check(self, name, whole):
        """The pairs that are neither effective nor refused, and the numbers of both."""
        command = COMMANDS[name]
        options = self.options_of(command)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            base = pool.submit(self.try_words, name, []).result()
            # An option that the base itself excludes (--in-process those of processes) is refused in each pair, too.
            words = [word for word in command.words if word.startswith("--")]
            excludes = [f"{word} beside" for word in words] + [f"beside {word}" for word in words]
            trials = {} if not command.shows and not whole else {option: pool.submit(self.try_words, name, [option]) for option in options}
            alone = functools.cache(lambda option: trials[option].result() if trials else self.try_words(name, [option]))
            excluded = {option for option in trials if alone(option)[0] == 2 and option in alone(option)[1]
                        and any(part in alone(option)[1] for part in excludes)}
            tried = [option for option in options if option not in excluded]
            pairs = list(itertools.combinations(tried, 2) if whole or len(tried) < 4 else zip(tried, tried[1:] + tried[:1]))
            outcomes = list(pool.map(lambda pair: self.try_words(name, list(pair)), pairs))
        problems, refused = [], 0
        if base[0] not in (0, 1):
            problems.append(f"troupe {name}: status {base[0]}: {base[1].strip()}")
        for option in trials:
            status, text, _ = alone(option)
            if status not in (0, 1, 2) or (status == 2 and len(text.strip().splitlines()) != 1):
                problems.append(f"troupe {name} {option}: status {status}: {text.strip()}")
        for (first, second), (status, text, outcome) in zip(pairs, outcomes):
            words = f"troupe {name} {first} {second}"
            if status == 2:
                refused += 1
                lines = text.strip().splitlines()
                if len(lines) != 1 or (not all(option in text for option in (first, second)) and
                                       all(alone(option)[0] != 2 for option in (first, second))):
                    problems.append(f"{words}: the refusal does not name both: {text.strip()}")
            elif status not in (0, 1):
                problems.append(f"{words}: status {status}: {text.strip()}")
            elif command.shows and (name, first, second) not in UNSEEN:
                for option, other in ((first, second), (second, first)):
                    has_effect = alone(option)[0] in (0, 1) and alone(option)[2] != base[2]
                    if has_effect and alone(other)[0] in (0, 1) and outcome == alone(other)[2]:
                        problems.append(f"{words}: accepted, and {option} is ignored")
        return problems, len(pairs) + len(excluded), refused + len(excluded)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("troupe", type=pathlib.Path)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("commands", nargs="*")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        trials = Trials(arguments.troupe.resolve(), pathlib.Path(folder))
        problems = []
        try:
            for name in arguments.commands or COMMANDS:
                if COMMANDS[name].is_live and not trials.runs:
                    trials.start_runs()
                used = os.times()
                found, pairs, refused = trials.check(name, arguments.all)
                used = [after - before for before, after in zip(used, os.times())]
                print(f"troupe {name}: {pairs} pairs of options, {refused} refused, {len(found)} wrong; {used[2] + used[3]:.1f} s of the "
                      f"processor", flush=True)
                for problem in found:
                    print(problem, flush=True)
                problems += found
        finally:
            trials.end_runs()
    if problems:
        sys.exit(f"error: {len(problems)} pairs of options are neither effective nor refused")


if __name__ == "__main__":
    main()
