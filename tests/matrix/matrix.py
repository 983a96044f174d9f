#!/usr/bin/env python3
"""Goes over all pairs of the rows of rows.py: each pair works, by the same checks for all, is refused by one line that names
it, or does not exist, for a reason. Writes the page of the pairs, and fails if docs/matrix.md is another one.

usage: matrix.py TROUPE NODE [--all] [--only SECTION] [--write FILE] [--page FILE]
NODE: matrix_ros_node; --only: after one_process, of inputs, modes, things_with_things, live_runs and modes_with_modes; --write: writes the
page, without --all or with --only with the pairs that the page has; --page: compares with this one

Without --all many things are in one run, and of the pairs that need a run of their own there is a sample, which has each row. The
page is of all.
"""

import argparse
import concurrent.futures
import itertools
import os
import pathlib
import re
import sys
import tempfile
import time

import commands
import live
import pages
import views
import worlds
from live import Failed, Live, Program, Refused, RosNode
from pages import FAILS, NONE, REFUSED, WORKS
from rows import ACTIONS, INPUTS, MODES, MOVED, RESTORED, ROS, THINGS, TICKS, VIEWS

ONE = MODES[0]
OUTPUTS = (("--hash-log", ".hashes"), ("--poses", ".poses"), ("--scans", ".scans"), ("--record", ".mcap"))
FILES = [view for view in VIEWS if not view.live]
LIVE_MODE = "packed"  # of the live runs of inputs, and of that without --all


def no_view(thing, view):
    """Why the view cannot have the thing, or None."""
    if view.name in ("expectations", "report"):
        return None if thing.holds else NONE + "it has no signal, so no expectation is about it"
    if view.name == "ROS topics":
        return None if thing.topic else NONE + "ROS 2 has no topic of it"
    if view.tables == ():
        return NONE + "the view has the whole run, and no single things"
    if not thing.table:
        return None if view.marks else NONE + "it has no row in a table of the state"
    if view.tables is not None and thing.table not in view.tables:
        return NONE + f"{view.name} has {', '.join(view.tables)}"
    return None


def option_names(mode):
    return [word for word in mode.options if word.startswith("--")]


def joined_options(first, second):
    """Those of the second as far as the first has none of the name."""
    words, name = list(first.options), None
    for word in second.options:
        name = word if word.startswith("--") else name
        if name not in first.options:
            words.append(word)
    return words


class Matrix:
    def __init__(self, program, folder, whole):
        self.program, self.folder, self.whole = program, folder, whole
        self.cells = {}
        self.failures = []
        self.reference = None

    def note(self, first, second, outcome):
        """Of several trials of a pair a failure counts, else the first."""
        before = pages.outcome_of(self.cells, first, second)
        if before is None or outcome == FAILS:
            self.cells.pop((second, first), None)
            self.cells[first, second] = outcome

    def check(self, first, second, work, *arguments):
        """`work` returns nothing, or the outcome of a pair that does not work."""
        try:
            outcome = work(*arguments) or WORKS
        except Refused as refusal:
            outcome = REFUSED + str(refusal)
        except (Failed, AssertionError, OSError, KeyError, ValueError, IndexError, TypeError) as failure:
            text = " ".join(str(failure).split()) or repr(failure)
            self.failures.append(f"{' '.join(first)} x {' '.join(second)}: {text}")
            outcome = FAILS
        self.note(first, second, outcome)
        return outcome

    # Runs.
    def run(self, base, file, mode, *more, options=None):
        """Of FILE, with the outputs BASE.*."""
        words = ["run", file, "--headless", *(mode.options if options is None else options)]
        words += [word for option, ending in OUTPUTS if option not in more for word in (option, f"{base}{ending}")]
        words += more
        if not mode.in_process:
            words += ["--session", self.session_of(base)]
        node = RosNode(self.program) if mode.answers else None
        try:
            with self.program.start(*words) as process:
                if mode.kills:
                    for line in process.stdout:
                        if "ready" in line:
                            break
                    for victim in mode.kills:
                        live.kill(process, victim)
                text = self.program.end_of(process, words)
        finally:
            if node:
                node.end()
        if process.returncode != 0:
            raise Failed(f"troupe {' '.join(map(str, words))}: status {process.returncode}: {text.strip()}")
        return base

    @staticmethod
    def session_of(base):
        return re.sub(r"[^A-Za-z0-9._-]", "_", f"{base}-{os.getpid()}")[-64:]

    def output(self, base, file="all.json", test="all.test.json"):
        return views.Output(self.program, self.folder, base, file, test)

    def same(self, base, reference, ending, mode=ONE):
        if not mode.same or (ending == ".scans" and mode.kills):
            return  # those that a killed agent had not written yet are missing
        ours, theirs = ((self.folder / f"{name}{ending}").read_text().splitlines() for name in (base, reference))
        if ours != theirs:
            at = next((i for i, pair in enumerate(zip(ours, theirs)) if pair[0] != pair[1]), min(len(ours), len(theirs)))
            raise Failed(f"{ending[1:]} differ from those of one process in line {at + 1}")

    # The sections.
    def one_process(self):
        """All things in one run: with all views that are files, and with what happens to a whole run."""
        self.reference = self.run("all", "all.json", ONE)
        self.run("all-lines", "all.json", ONE, "--record", "all.jsonl")
        output = self.output(self.reference)
        for view in FILES:
            made = []
            outcome = self.check(("mode", ONE.name), ("view", view.name), lambda view=view, made=made: made.append(
                views.MAKERS[view.name](output, TICKS)))
            for thing in THINGS:
                self.check(("thing", thing.name), ("view", view.name), self.thing_in, thing, view, made)
            for other in FILES:
                if other is not view:
                    self.note(("view", view.name), ("view", other.name), outcome)
        for name, command in commands.COMMANDS.items():
            outcome = self.check(("action", name), ("mode", ONE.name), command, self.program, output, ONE)
            for thing in THINGS:
                known = thing.holds or name in ("replay", "branch")
                self.note(("action", name), ("thing", thing.name),
                          outcome if known else NONE + "it has no signal, so no expectation is about it")
            for view in VIEWS:
                has = view.name in (("replay", "hash log", "poses", "scans") if name == "replay" else ("expectations", "report"))
                if name == "branch":
                    continue  # views_of_branch
                self.note(("action", name), ("view", view.name), outcome if has else NONE + f"{name} has no such output")
        self.views_of_branch()

    def views_of_branch(self):
        """All outputs of a run that goes on from a recording."""
        recording = f"{self.reference}.mcap"
        words = ("--from-tick", TICKS // 2, "--ticks", TICKS)
        self.run("branch", recording, ONE, *words)
        self.run("branch-lines", recording, ONE, *words, "--record", "branch.jsonl")
        output = self.output("branch", recording)
        for view in VIEWS:
            if view.live:
                self.note(("action", "branch"), ("view", view.name), NONE + "a branch is a run as others")
            else:
                self.check(("action", "branch"), ("view", view.name), self.make, output, view.name)

    @staticmethod
    def make(output, view, ticks=None):
        views.MAKERS[view](output, ticks)

    @staticmethod
    def thing_in(thing, view, made):
        if not made:
            raise Failed("there is no such view")
        if outcome := no_view(thing, view):
            return outcome
        if not made[0](thing):
            raise Failed("the thing is not in it")
        return None

    def modes(self):
        """All things in each mode; the recording is that of one process."""
        for i, mode in enumerate(MODES):  # one after another: each runs several processes
            base = self.reference if mode is ONE else f"all-{mode.name}".replace(" ", "_")
            if mode is not ONE:
                self.check(("mode", mode.name), ("view", "hash log"), lambda base=base, mode=mode: self.run(
                    base, "all.json", mode) and None)
            output = self.output(base)
            for ending, view in ((".hashes", "hash log"), (".poses", "poses"), (".scans", "scans")):
                self.check(("mode", mode.name), ("view", view), self.same, base, self.reference, ending, mode)
            made = [view for view in FILES if not view.of_run and view.name != "replay"]
            for view in made if self.whole else made[i % len(made)::len(made)]:
                self.check(("mode", mode.name), ("view", view.name), self.file_view, output, view, mode)
            self.check(("mode", mode.name), ("view", "replay"), commands.replay, self.program, output, mode)
            self.note(("mode", mode.name), ("action", "replay"), self.cells[("mode", mode.name), ("view", "replay")])
            if self.whole or i % 4 == 1:
                self.check(("mode", mode.name), ("view", "JSON lines"), self.lines, base, mode)
            for name in ("branch", "test", "sweep", "shard", "search") if self.whole else ("branch",) if i % 4 == 2 else ():
                self.check(("mode", mode.name), ("action", name), commands.COMMANDS[name], self.program,
                           self.output(self.reference), mode)
            outcomes = {self.cells[("mode", mode.name), ("view", view)] for view in ("hash log", "poses", "scans", "replay")}
            for thing in THINGS:
                self.note(("thing", thing.name), ("mode", mode.name), FAILS if FAILS in outcomes else WORKS)
                if mode.kills == ("robot-agent",):
                    self.note(("thing", thing.name), ("action", "kill"), FAILS if FAILS in outcomes else WORKS)
        self.kinds_of_kill()

    def kinds_of_kill(self):
        rebuilt = self.output("all-rebuild")
        for view in FILES:
            if view.name == "JSON lines":
                self.note(("action", "kill"), ("view", view.name), self.cells.get(
                    (("mode", "rebuild"), ("view", view.name)), WORKS))
            elif self.whole or view.of_run:
                self.check(("action", "kill"), ("view", view.name), self.make, rebuilt, view.name,
                           None if view.name == "scans" else TICKS)

    def file_view(self, output, view, mode):
        if view.name == "Python" and not mode.same:
            return NONE + "Python steps its runs itself, in lockstep"
        views.MAKERS[view.name](output, TICKS)
        return None

    def lines(self, base, mode):
        self.run(f"{base}-lines", "all.json", mode, "--record", f"{base}.jsonl")
        if mode.same and not mode.kills:  # the lines have the losses, too
            self.same(base, "all", ".jsonl")

    def modes_with_modes(self):
        def pair(first, second):
            words = joined_options(first, second)
            mode = type(first)(f"{first.name}+{second.name}", tuple(words), first.same and second.same,
                               first.in_process or second.in_process, first.kills + second.kills, first.answers or second.answers)
            base = mode.name.replace(" ", "_")
            refusal = self.refusal_of("run", "all.json", "--headless", *words, "--ticks", "1") if any(
                option in ("--in-process", "--mode") for option in words) else None
            if refusal:
                for one in (first, second):
                    assert any(option in refusal for option in option_names(one)) or not one.options, refusal
                return REFUSED + refusal
            self.run(base, "all.json", mode)
            self.same(base, self.reference, ".hashes", mode)
            return None
        for first, second in itertools.combinations(MODES, 2):
            self.check(("mode", first.name), ("mode", second.name), pair, first, second)

    def refusal_of(self, *words):
        """The line with which the words are refused, or None."""
        status, text = self.program.finish(*words)
        if status != 2:
            return None
        lines = text.strip().splitlines()
        assert len(lines) == 1, text
        return lines[0]

    def things_with_things(self):
        """Each pair in a world of its own, in one process; a sample: each thing with its next."""
        def pair(first, second):
            name = f"{first.name}+{second.name}".replace(" ", "_")
            worlds.write(self.folder, name, [first, second])
            output = self.output(self.run(name, f"{name}.json", ONE), f"{name}.json", f"{name}.test.json")
            commands.replay(self.program, output, ONE)
            text = self.program.run("test", output.test, "--on", output.path(".mcap"))
            for thing in (first, second):
                assert not thing.holds or f"holds {thing.name}:" in text, text
        chosen = itertools.combinations(THINGS, 2) if self.whole else zip(THINGS[::2], THINGS[1::2])
        self.side_by_side([(("thing", a.name), ("thing", b.name), pair, a, b) for a, b in chosen])

    def side_by_side(self, checks):
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(lambda words: self.check(*words), checks))

    def inputs(self):
        """Each input with views, modes and other inputs, and the things in it."""
        for i, source in enumerate(INPUTS):
            row, base = ("input", source.name), worlds.base_of(source)
            output = self.output(base, source.file, None if source.name == "recording" else f"{base}.test.json")
            if source.runs:
                if self.check(row, ("mode", ONE.name), lambda base=base, source=source: self.run(
                        base, source.file, ONE, *self.ticks_of(source)) and None) == FAILS:
                    continue
                self.run(f"{base}-lines", source.file, ONE, *self.ticks_of(source), "--record", f"{base}.jsonl")
            else:
                self.check(row, ("mode", ONE.name), commands.test, self.program, output, ONE)
            for view in FILES if self.whole or not source.runs else FILES[i::len(INPUTS)]:
                self.check(row, ("view", view.name), self.input_view, source, base, view)
            for name, command in commands.COMMANDS.items():
                if self.whole or name == "test":
                    self.check(row, ("action", name), self.input_action, source, output, name, command)
            for at, mode in enumerate(MODES):
                if mode is not ONE and (self.whole or at == 2 * i + 3):
                    self.check(row, ("mode", mode.name), self.input_mode, source, output, mode)
            for other in INPUTS[i + 1:]:
                self.check(row, ("input", other.name), self.inputs_together, source, other)
        self.things_with_inputs()

    @staticmethod
    def ticks_of(source):
        return ("--from-tick", 0, "--ticks", TICKS) if source.name == "recording" else ("--no-ros", "--ticks", TICKS)

    def input_view(self, source, base, view):
        if not source.runs:
            return None if view.name in ("expectations", "report") else NONE + "a case has only its report"
        if view.name == "Python" and source.name == "recording":
            return NONE + "Python steps no recording, but reads it"
        views.MAKERS[view.name](self.output(base, source.file, f"{base}.test.json"), TICKS)
        return None

    def input_action(self, source, output, name, command):
        if not source.runs and name in ("replay", "branch"):
            return NONE + "a case has a recording only if it fails"
        return command(self.program, output, ONE)

    def input_mode(self, source, output, mode):
        if not source.runs:
            return commands.test(self.program, output, mode)
        words = [word for word in self.ticks_of(source) if word != "--no-ros"]
        base = self.run(f"{output.base}-{mode.name}".replace(" ", "_"), source.file, mode, *words)
        self.same(base, output.base, ".hashes", mode)
        return None

    def inputs_together(self, source, other):
        if not other.runs:
            return commands.test(self.program, self.output(worlds.base_of(source), source.file, f"{worlds.base_of(source)}.test.json"
                                                           if source.name != "recording" else None), ONE)
        if source.name != "scenario":
            return NONE + "a run has one of them"
        file = f"{worlds.base_of(other)}.of_scenario.json"
        (self.folder / file).write_text(f'{{"world": "{other.file}"}}')
        refusal = self.refusal_of("run", file, "--headless", "--in-process", "--no-ros", "--ticks", 5)
        if refusal:
            assert other.file in refusal, refusal
            return REFUSED + refusal.replace(file, "'FILE'")
        return None

    def things_with_inputs(self):
        """All things that an input has in one file, or with --all each in a file of its own."""
        def content(source, file, thing=None):
            """A function that says whether a thing is there; of a file for one thing, in outputs of its own."""
            base = f"{file}-{source.name.split()[0]}-{thing.name if thing else ''}".replace(".", "_").replace(" ", "_")
            if source.name == "test":
                self.program.run("test", file, "--no-shrink")
                return lambda thing: True
            self.run(base, file, ONE, "--no-ros", "--ticks", TICKS)
            output = self.output(base, file)
            if source.name == "recording":
                commands.branch(self.program, output, ONE)
            views.tables(output, TICKS)
            folder = output.path(".tables")
            return lambda thing: not thing.table or len(views.rows_of_csv(
                folder / ("poses.csv" if thing.table == "robots" else f"{thing.table}.csv"))) > 1

        def one(thing, source, made):
            if not worlds.can_be_written(thing, source):
                return NONE + f"{source.name} has no such thing"
            if not made:
                own = source.name in ("building", "layout (LIF)")
                ending = "json" if source.name == "recording" else source.file.split(".", 1)[1]
                made = [content(source, source.file if own else f"{thing.name}.{ending}".replace(" ", "_"), thing)]
            assert made[0](thing), "its table has no row"
            return None

        for thing in THINGS if self.whole else ():
            worlds.write(self.folder, thing.name.replace(" ", "_"), [thing])
        checks = []
        for source in INPUTS:
            made = []
            if not self.whole and source.name != "ROS map":
                self.check(("input", source.name), ("mode", ONE.name), lambda source=source, made=made: made.append(
                    content(source, "all.json" if source.name == "recording" else source.file)))
            checks += [(("thing", thing.name), ("input", source.name), one, thing, source, made) for thing in THINGS]
        self.side_by_side(checks)

    def live_run(self, row, file, mode, things, number, actions=ACTIONS):
        """Views and actions of a paused run, which are on the page in row and column of `row`. Returns its hash log."""
        base = f"live{number}"
        lines = number == 1  # with these instead of a recording
        outputs = [word for option, ending in OUTPUTS for word in (option, f"{base}{ending}")]
        outputs[-1] = f"{base}.jsonl" if lines else outputs[-1]
        run = Live(self.program, [file, *mode.options, *(() if "--ros" in mode.options else ROS), *(
            ("--from-tick", 0) if file.endswith(".mcap") else ()), "--ticks", 100000, *outputs], f"{base}-{os.getpid()}", mode.kills)
        try:
            before = {view: self.check(row, ("view", view), self.live_view, run, view, things) for view in live.MAKERS}
            for action in actions:
                if action.words:
                    self.do(run, action, row, things)
            after = {view: self.check(row, ("view", view), self.live_view, run, view, things) for view in live.MAKERS}
            self.check(("action", "kill"), row, commands.kill, run)
        finally:
            run.end()
        log = (self.folder / f"{base}.hashes").read_text()
        if things:  # all
            self.views_of_live_run(base, before, after, lines, actions)
        if not lines:
            self.check(row, ("view", "replay"), commands.replay, self.program, self.output(base), ONE)
        return log

    def live_view(self, run, view, things):
        made = [live.MAKERS[view](run)]
        of = next(one for one in VIEWS if one.name == view)
        for thing in things if self.whole or view != "ctl get" else things[::4]:
            self.check(("thing", thing.name), ("view", view), self.thing_in, thing, of, made)

    def views_of_live_run(self, base, before, after, lines, actions):
        """Of a run with these actions: the views beside it, and those of its files."""
        output = self.output(base)
        outcomes = dict(after)
        one = next((action for action in actions if action.edits), actions[0])
        for view in FILES:
            if (view.name == "JSON lines") != lines:
                continue
            outcomes[view.name] = self.check(("action", one.name), ("view", view.name), self.make, output, view.name)
        for name, outcome in outcomes.items():
            for action in actions:
                # Edits are a reason to refuse a recording, which others have that are in the same run.
                if (action.words and (action.edits or not outcome.startswith(REFUSED))) or (action.name == "kill" and name in after):
                    self.note(("action", action.name), ("view", name), outcome)
            for other in before:
                if name != other:
                    self.note(("view", name), ("view", other), outcome)

    def do(self, run, action, row, things):
        """An action on each of the things, or on the whole run, in which all of them stay."""
        first = ("action", action.name)
        if not action.of:
            outcome = self.check(first, row, self.act, run, action, None)
            tables = run.tables_with(things)
            for thing in things:
                there = not thing.row or thing.row in tables[thing.table]
                self.note(first, ("thing", thing.name), outcome if there else FAILS)
                if not there:
                    self.failures.append(f"action {action.name} x thing {thing.name}: it is gone")
        for i, thing in enumerate(things if action.of else ()):
            if self.whole or i % 4 == 0 or (action.of not in (MOVED, RESTORED) and {thing.table, thing.name} & set(action.of)):
                outcome = self.check(first, ("thing", thing.name), self.act, run, action, thing)
                self.note(first, row, outcome if outcome == FAILS else WORKS)
        if action.of and not things:
            self.note(first, row, NONE + "its things are those of other inputs")
        run.ask("ctl", "step", "2")

    @staticmethod
    def entity_of(thing):
        return thing.row or thing.mark

    def act(self, run, action, thing):
        """Done, or refused with the name of the thing."""
        place = {} if thing is None else {"name": self.entity_of(thing), "x": -3, "y": 2 * THINGS.index(thing)}
        words = [word.format(**place) for word in action.words]
        status, text = run.ask(*words)
        if action.name == "speed" and status == 3 and "realtime" in text:
            return REFUSED + text.strip()
        if thing is None or {thing.table, thing.name} & set(action.of):
            if status != 0:
                raise Failed(f"troupe {' '.join(words)}: status {status}: {text.strip()}")
            return None
        if status == 0:
            return None  # a model that is edited like others
        lines = text.strip().splitlines()
        assert status in (2, 3) and len(lines) == 1, f"troupe {' '.join(words)}: status {status}: {text.strip()}"
        assert self.entity_of(thing) in text, f"troupe {' '.join(words)}: the refusal does not name it: {text.strip()}"
        return REFUSED + lines[0]

    def live_runs(self):
        """Live runs of all things, in a mode or in each, and of each input."""
        for mode in MODES:
            if mode.in_process:
                for view in live.MAKERS:
                    self.note(("mode", mode.name), ("view", view), NONE + "a run in one process has no network")
                for action in ACTIONS:
                    if action.words or action.name == "kill":
                        self.note(("mode", mode.name), ("action", action.name), NONE + "a run in one process has no network")
        logs = {}
        for number, mode in enumerate(mode for mode in MODES if not mode.in_process):
            if self.whole or mode.name == LIVE_MODE:
                row = ("mode", mode.name)
                self.check(row, ("action", "step"), lambda mode=mode, row=row, number=number: logs.update(
                    {mode.name: self.live_run(row, "all.json", mode, THINGS, number)}))
        if len({log for name, log in logs.items() if next(mode for mode in MODES if mode.name == name).same}) > 1:
            self.failures.append("actions: the hashes of live runs differ with the mode")
        mode = next(mode for mode in MODES if mode.name == LIVE_MODE)
        if self.whole:
            actions = tuple(action for action in ACTIONS if not action.edits)
            self.check(("mode", mode.name), ("action", "step"), lambda: self.live_run(
                ("mode", mode.name), "all.json", mode, THINGS, len(MODES) + len(INPUTS), actions) and None)
        for number, source in enumerate(INPUTS, len(MODES)):
            row = ("input", source.name)
            if not source.runs:
                for view in live.MAKERS:
                    self.note(row, ("view", view), NONE + "a case has only its report")
                for action in ACTIONS:
                    if action.words or action.name == "kill":
                        self.note(row, ("action", action.name), NONE + "a case takes no requests")
            elif self.whole:
                self.check(row, ("action", "step"), lambda source=source, row=row, number=number: self.live_run(
                    row, source.file, mode, (), number) and None)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("troupe", type=pathlib.Path)
    parser.add_argument("node", type=pathlib.Path)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--only")
    parser.add_argument("--write", type=pathlib.Path)
    parser.add_argument("--page", type=pathlib.Path)
    parser.add_argument("--folder", type=pathlib.Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or pathlib.Path(temporary)
        folder.mkdir(exist_ok=True)
        matrix = Matrix(Program(arguments.troupe.resolve(), arguments.node.resolve(), folder), folder, arguments.all)
        worlds.write(folder, "all", THINGS)
        sections = [matrix.one_process, matrix.inputs, matrix.modes, matrix.things_with_things, matrix.live_runs]
        sections += [matrix.modes_with_modes] if arguments.all else []
        for section in sections if not arguments.only else [matrix.one_process, getattr(matrix, arguments.only)]:
            began, used = time.monotonic(), os.times()
            section()
            now = os.times()
            used = now.children_user + now.children_system - used.children_user - used.children_system
            print(f"{section.__name__}: {time.monotonic() - began:.1f} s, {used:.1f} s of the processor", flush=True)
        if arguments.write:
            is_part = arguments.only or not arguments.all
            kept = pages.tried(arguments.write.read_text()) if is_part and arguments.write.exists() else {}
            kept = {pair: cell for pair, cell in kept.items() if pages.outcome_of(matrix.cells, *pair) is None}
            arguments.write.write_text(pages.page({**matrix.cells, **kept}))
        for failure in matrix.failures:
            print(failure)
        if matrix.failures:
            sys.exit(f"error: {len(matrix.failures)} pairs fail")
        stale = list(pages.differences(matrix.cells, arguments.page.read_text())) if arguments.page else []
        for line in stale:
            print(line)
        if stale:
            sys.exit(f"error: {arguments.page} is out of date, expected that of matrix.py --all --write {arguments.page}")
        print(f"{len(matrix.cells)} pairs")


if __name__ == "__main__":
    main()
