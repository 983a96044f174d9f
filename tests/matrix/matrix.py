#!/usr/bin/env python3
"""Goes over all pairs of the rows of rows.py: each pair works, by the same checks for all, or is refused by one line that
names it. Writes the page of the pairs, and fails if docs/matrix.md is another one.

usage: matrix.py TROUPE [--all] [--write FILE] [--page FILE]      --write: the page; --page: compares with this one

A world with all things has all of their pairs with a mode or a view in one run. Without --all the live edits are made in one
mode; with it in each.
"""

import argparse
import collections
import concurrent.futures
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

import views
import worlds
from rows import ACTIONS, INPUTS, MODES, THINGS, TICKS, VIEWS

SECONDS = 100
OUTPUTS = (("--hash-log", ".hashes"), ("--poses", ".poses"), ("--scans", ".scans"))
WORKS, NONE = "yes", "–"


class Failed(Exception):
    pass


class Program:
    """troupe, for runs in a domain of this test."""

    def __init__(self, path, folder):
        self.path, self.folder = path, folder
        self.domain = 101 + os.getpid() % 100
        self.environment = {**os.environ, "TROUPE_DOMAIN": str(self.domain), "NO_COLOR": "1"}
        self.environment.pop("TROUPE_SESSION", None)

    def start(self, *words):
        return subprocess.Popen([self.path, *map(str, words)], cwd=self.folder, env=self.environment, text=True,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    @staticmethod
    def end_of(process, words):
        """All that it printed."""
        try:
            return process.communicate(timeout=SECONDS)[0]
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
            try:
                text = process.communicate(timeout=SECONDS)[0]
            except subprocess.TimeoutExpired:
                process.kill()
                text = process.communicate()[0]
            raise Failed(f"troupe {' '.join(map(str, words))}: no end within {SECONDS} s: {text}") from None

    def finish(self, *words):
        with self.start(*words) as process:
            text = self.end_of(process, words)
            return process.returncode, text

    def run(self, *words, status=0):
        found, text = self.finish(*words)
        if found != status:
            raise Failed(f"troupe {' '.join(map(str, words))}: status {found}: {text.strip()}")
        return text


class Live:
    """A paused run with tools beside it."""

    def __init__(self, program, words, session):
        self.program, self.session = program, session
        self.process = program.start("run", *words, "--headless", "--paused", "--session", session)
        self.text = ""
        while "ready" not in self.text:
            line = self.process.stdout.readline()
            if not line:
                raise Failed(f"troupe run {' '.join(map(str, words))}: {self.text}")
            self.text += line

    def ctl(self, *words):
        """(status, text)"""
        return self.program.finish("ctl", "--session", self.session, *words)

    def end(self):
        self.process.send_signal(signal.SIGINT)
        text = self.program.end_of(self.process, ["run"])
        if self.process.returncode not in (0, 130):
            raise Failed(f"the run ended with {self.process.returncode}: {text}")


def descendants(pid):
    found = []
    for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        for child in task.read_text().split():
            found += [int(child), *descendants(child)]
    return found


def kill(process, program):
    """Kills one child of that program once it works."""
    deadline = time.monotonic() + SECONDS
    while time.monotonic() < deadline and process.poll() is None:
        for pid in descendants(process.pid):
            try:
                if pathlib.Path(f"/proc/{pid}/comm").read_text().strip() == program[:15]:
                    os.kill(pid, signal.SIGKILL)
                    return
            except (OSError, ProcessLookupError):
                continue
        time.sleep(0.01)


class Matrix:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.cells = {}  # (row, row) by name of kind and row -> WORKS, NONE or a refusal
        self.failures = []

    def note(self, first, second, outcome):
        self.cells[first, second] = outcome

    def check(self, first, second, work, *arguments):
        """`work` returns nothing, or the reason for which there is no such pair."""
        try:
            self.note(first, second, work(*arguments) or WORKS)
        except (Failed, AssertionError, OSError, KeyError, ValueError, IndexError) as failure:
            text = " ".join(str(failure).split()) or repr(failure)
            self.failures.append(f"{' '.join(first)} x {' '.join(second)}: {text}")
            self.note(first, second, "FAILS")

    # Runs of a world NAME.json in a mode; their outputs are NAME-MODE.*.
    def run(self, name, mode, *more):
        base = f"{name}-{mode.name.replace(' ', '_')}"
        outputs = [word for option, ending in OUTPUTS for word in (option, f"{base}{ending}")]
        words = ["run", f"{name}.json", "--headless", *mode.options, *outputs, *more]
        if not mode.in_process:
            words += ["--session", f"{base}-{os.getpid()}"]
        if "ROS" in mode.name:
            words += ["--ros-domain", self.program.domain - 100]
        with self.program.start(*words) as process:
            if mode.kills:
                for line in process.stdout:
                    if "ready" in line:
                        break
                for victim in mode.kills:
                    kill(process, victim)
            text = self.program.end_of(process, words)
        if process.returncode != 0:
            raise Failed(f"troupe {' '.join(map(str, words))}: status {process.returncode}: {text.strip()}")
        return base

    def read(self, base, ending):
        return (self.folder / f"{base}{ending}").read_text()

    def same_output(self, made, mode, reference, ending):
        base = made[0]
        if not mode.same or (ending == ".scans" and mode.kills):
            return  # those that a killed agent had not written yet are missing
        ours, theirs = self.read(base, ending).splitlines(), self.read(reference, ending).splitlines()
        if ours != theirs:
            at = next((i for i, pair in enumerate(zip(ours, theirs)) if pair[0] != pair[1]), min(len(ours), len(theirs)))
            raise Failed(f"{ending[1:]} differ from those of one process in line {at + 1}")

    def replays(self, made, mode):
        recording = f"{mode.name.replace(' ', '_')}.mcap"
        self.program.run("replay", recording, "--verify", "--hash-log", f"{made[0]}.replayed")
        assert self.read(made[0], ".replayed") == self.read(made[0], ".hashes"), "the replay has other hashes"

    def things_with_views(self, name, things):
        """All files of one run, and things in them."""
        self.run(name, MODES[0], "--record", f"{name}.mcap")
        reference = f"{name}-one_process"
        self.program.run("run", f"{name}.json", "--headless", "--in-process", "--record", f"{name}.jsonl")
        for _, ending in OUTPUTS:
            (self.folder / f"{name}{ending}").write_text(self.read(reference, ending))
        output = views.Output(self.program, self.folder, name, self.program.environment)
        for view in VIEWS:
            if view.live:
                continue
            column = ("view", view.name)
            made = []
            self.check(("mode", "one process"), column, lambda: made.append(views.MAKERS[view.name](output, TICKS)))
            for thing in things:
                self.check(("thing", thing.name), column, self.thing_in, thing, view, made)
        return reference

    @staticmethod
    def thing_in(thing, view, made):
        if not made:
            raise Failed("there is no such view")
        if not thing.table and view.name != "expectations":
            return NONE
        if view.tables is not None and thing.table not in view.tables:
            return NONE
        if not made[0](thing):
            raise Failed("the thing is not in it")
        return None

    def things_with_things(self):
        """Each pair in a world of its own, in one process."""
        def pair(first, second):
            name = f"{first.name}+{second.name}".replace(" ", "_")
            worlds.write(self.folder, name, [first, second])
            base = self.run(name, MODES[0], "--record", f"{name}.mcap")
            self.program.run("replay", f"{name}.mcap", "--hash-log", f"{name}.replayed")
            assert self.read(name, ".replayed") == self.read(base, ".hashes"), "the replay has other hashes"
            text = self.program.run("test", f"{name}.test.json", "--on", f"{name}.mcap")
            for thing in (first, second):
                assert not thing.holds or f"holds {thing.name}:" in text, text
        pairs = [(a, b) for i, a in enumerate(THINGS) for b in THINGS[i + 1:]]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(lambda ab: self.check(("thing", ab[0].name), ("thing", ab[1].name), pair, *ab), pairs))

    def things_with_modes(self, name, things, reference):
        for mode in MODES:  # one after another: each runs several processes
            base = []
            self.check(("mode", mode.name), ("view", "hash log"), lambda mode=mode: base.append(
                self.run(name, mode, "--record", f"{mode.name.replace(' ', '_')}.mcap")))
            for _, ending in OUTPUTS:
                view = {".hashes": "hash log"}.get(ending, ending[1:])
                self.check(("mode", mode.name), ("view", view), self.same_output, base, mode, reference, ending)
            self.check(("mode", mode.name), ("view", "replay"), self.replays, base, mode)
            outcomes = {self.cells[("mode", mode.name), ("view", view)] for view in ("hash log", "poses", "scans", "replay")}
            for thing in things:
                self.note(("thing", thing.name), ("mode", mode.name), "FAILS" if "FAILS" in outcomes else WORKS)

    def things_with_inputs(self):
        def one(thing, source):
            if not worlds.can_be_written(thing, source):
                return NONE
            if source.name in ("building", "layout (LIF)"):
                file = source.file
            elif source.name == "recording":
                file = f"{thing.name}.json".replace(" ", "_")
            else:
                file = f"{thing.name}.{source.file.split('.', 1)[1]}".replace(" ", "_")
            if source.name == "test":
                self.program.run("test", file, "--no-shrink")
                return None
            base = f"{file}-{source.name.split()[0]}".replace(".", "_")
            self.program.run("run", file, "--headless", "--in-process", "--no-ros", "--ticks", TICKS, "--record",
                             f"{base}.mcap", "--hash-log", f"{base}.hashes")
            if source.name == "recording":
                self.program.run("run", f"{base}.mcap", "--headless", "--in-process", "--from-tick", TICKS // 2, "--ticks", TICKS,
                                 "--hash-log", f"{base}.branch")
                branch = self.read(base, ".branch").splitlines()
                assert branch[-1] == self.read(base, ".hashes").splitlines()[-1], "the continued run has other hashes"
            self.program.run("export", f"{base}.mcap", "--format", "csv", "-o", f"{base}.tables")
            if thing.table:
                table = "poses" if thing.table == "robots" else thing.table
                rows = views.rows_of_csv(self.folder / f"{base}.tables/{table}.csv")
                assert len(rows) > 1, f"{table}.csv has no row"
            return None
        for thing in THINGS:
            worlds.write(self.folder, thing.name.replace(" ", "_"), [thing])
        pairs = [(thing, source) for thing in THINGS for source in INPUTS]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(lambda pair: self.check(("thing", pair[0].name), ("input", pair[1].name), one, *pair), pairs))

    def actions(self, name, things, mode, number):
        """Every action on every thing, in a live run of a mode: done, or refused with the name of the thing. Its hash log."""
        session = f"live-{number}-{os.getpid()}"
        live = Live(self.program, [f"{name}.json", *mode.options, "--ticks", 100000, "--hash-log", f"live{number}.hashes", "--record",
                                   f"live{number}.mcap"], session)
        try:
            self.live_views(live, things)
            for action in ACTIONS:
                for thing in things if action.of else (None,):
                    first = ("action", action.name)
                    second = ("thing", thing.name) if thing else ("mode", mode.name)
                    self.check(first, second, self.act, live, action, thing)
                    if thing:
                        outcome = self.cells[first, second]
                        if outcome == "FAILS" or (first, ("mode", mode.name)) not in self.cells:
                            self.cells[first, ("mode", mode.name)] = outcome if outcome == "FAILS" else WORKS
                live.ctl("step", "2")
        finally:
            live.end()
        self.program.run("replay", f"live{number}.mcap", "--hash-log", f"live{number}.replayed")
        assert self.read(f"live{number}", ".replayed") == self.read(f"live{number}", ".hashes"), "the replay differs"
        return self.read(f"live{number}", ".hashes")

    @staticmethod
    def entity_of(thing):
        return thing.row or thing.mark

    def act(self, live, action, thing):
        place = {} if thing is None else {"name": self.entity_of(thing), "x": -3, "y": 2 * THINGS.index(thing)}
        words = [word.format(**place) for word in action.words]
        status, text = live.ctl(*words)
        if thing is None or thing.table in action.of:
            if status != 0:
                raise Failed(f"troupe ctl {' '.join(words)}: status {status}: {text.strip()}")
            return None
        if status == 0:
            return None  # a model that is edited like others
        lines = text.strip().splitlines()
        assert status in (2, 3) and len(lines) == 1, f"troupe ctl {' '.join(words)}: status {status}: {text.strip()}"
        assert self.entity_of(thing) in text, f"troupe ctl {' '.join(words)}: the refusal does not name it: {text.strip()}"
        return "refused: " + lines[0]

    def live_views(self, live, things):
        _, listed = live.ctl("list")
        for thing in things:
            def get(thing=thing):
                if thing.table not in VIEWS[-2].tables:
                    return NONE
                status, text = live.ctl("get", self.entity_of(thing))
                assert status == 0 and thing.row in text, text
                return None
            def find(thing=thing):
                if thing.table not in VIEWS[-1].tables:
                    return NONE
                assert re.search(rf"\b{re.escape(thing.row)}\b", listed), "it is not listed"
                return None
            self.check(("thing", thing.name), ("view", "ctl get"), get)
            self.check(("thing", thing.name), ("view", "ctl list"), find)


KINDS = (("input", INPUTS), ("thing", THINGS), ("mode", MODES), ("view", VIEWS), ("action", ACTIONS))
REFUSED = "refused: "


def blocks(cells):
    """(title, rows, columns, cell of names) of each table of the page."""
    for i, (kind, rows) in enumerate(KINDS):
        for other, columns in KINDS[i:]:
            found = {}
            for at, row in enumerate(rows):
                for column in columns[at + 1:] if other == kind else columns:
                    a, b = (kind, row.name), (other, column.name)
                    outcome = cells.get((a, b), cells.get((b, a)))
                    if outcome is not None:
                        found[row.name, column.name] = outcome
            if found:
                used_rows = [row.name for row in rows if any(row.name == pair[0] for pair in found)]
                used = [column.name for column in columns if any(column.name == pair[1] for pair in found)]
                yield f"{kind.capitalize()}s and {other}s", used_rows, used, found


def reason_of(outcome):
    """A refusal without the names of the pair."""
    return re.sub(r"'[^']*'", "'…'", outcome.removeprefix(REFUSED).removeprefix("error: "))


def page(cells):
    """docs/matrix.md."""
    lines, counts = [], collections.Counter()
    for title, rows, columns, found in blocks(cells):
        lines += [f"## {title}", "", "| | " + " | ".join(columns) + " |", "|" + "---|" * (len(columns) + 1)]
        reasons = {}
        for row in rows:
            texts = []
            for column in columns:
                outcome = found.get((row, column), "")
                if outcome.startswith(REFUSED):
                    counts[REFUSED] += 1
                    outcome = f"no ({reasons.setdefault(reason_of(outcome), len(reasons) + 1)})"
                else:
                    counts[outcome] += 1
                texts.append(outcome)
            lines.append(f"| {row} | " + " | ".join(texts) + " |")
        lines += ["", *(f"{number}. `{reason}`" for reason, number in reasons.items()), *[""] * bool(reasons)]
    total = counts[WORKS] + counts[REFUSED] + counts["FAILS"]
    head = ["# All features in pairs", "",
            "`tests/matrix/matrix.py --write docs/matrix.md` makes this page. It goes over all pairs of the list in "
            "`tests/matrix/rows.py`:", "a pair works (yes), is refused (no) by the line below its table, or does not exist (–).", "",
            f"{total} pairs: {counts[WORKS]} work, {counts[REFUSED]} are refused, {counts['FAILS']} fail; {counts[NONE]} more do "
            "not exist.", ""]
    return "\n".join(head + lines).rstrip("\n") + "\n"


def read_page(text):
    """The cells of a page by its titles, rows and columns; a refusal has its reason."""
    cells = {}
    for block in text.split("\n## ")[1:]:
        lines = block.splitlines()
        table = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
        reasons = dict(re.findall(r"^(\d+)\. `(.*)`$", block, re.MULTILINE))
        for row in table[2:]:
            for column, cell in zip(table[0][1:], row[1:]):
                number = re.fullmatch(r"no \((\d+)\)", cell)
                cells[lines[0], row[0], column] = REFUSED + reasons[number[1]] if number else cell
    return cells


def differences(cells, text):
    """The pairs that the page does not have, or otherwise."""
    shown = read_page(text)
    for title, _, _, found in blocks(cells):
        for (row, column), outcome in found.items():
            expected = REFUSED + reason_of(outcome) if outcome.startswith(REFUSED) else outcome
            if shown.get((title, row, column)) != expected:
                yield f"{title}: {row}, {column}: the page has '{shown.get((title, row, column))}', found '{expected}'"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("troupe", type=pathlib.Path)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--write", type=pathlib.Path)
    parser.add_argument("--page", type=pathlib.Path)
    parser.add_argument("--folder", type=pathlib.Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or pathlib.Path(temporary)
        program = Program(arguments.troupe.resolve(), folder)
        matrix = Matrix(program, folder)
        worlds.write(folder, "all", THINGS)
        began = time.monotonic()

        def report(name):
            print(f"{name}: {time.monotonic() - began:.1f} s", flush=True)

        reference = matrix.things_with_views("all", THINGS)
        report("views")
        matrix.things_with_modes("all", THINGS, reference)
        report("modes")
        matrix.things_with_inputs()
        report("inputs")
        matrix.things_with_things()
        report("things")
        live_modes = [mode for mode in MODES if not mode.in_process and mode.same and not mode.kills and mode.name != "ROS 2"]
        logs = [matrix.actions("all", THINGS, mode, i) for i, mode in enumerate(live_modes if arguments.all else live_modes[1:2])]
        if len(set(logs)) > 1:
            matrix.failures.append("actions: the hashes of live runs differ with the mode")
        report("actions")
        if arguments.write:
            arguments.write.write_text(page(matrix.cells))
        for failure in matrix.failures:
            print(failure)
        if matrix.failures:
            sys.exit(f"error: {len(matrix.failures)} pairs fail")
        stale = list(differences(matrix.cells, arguments.page.read_text())) if arguments.page else []
        for line in stale:
            print(line)
        if stale:
            sys.exit(f"error: {arguments.page} is out of date, expected that of matrix.py --write {arguments.page}")
        print(f"{len(matrix.cells)} pairs")


if __name__ == "__main__":
    main()
