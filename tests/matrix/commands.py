"""What happens to a run as a whole: each function works on a recording BASE.mcap of FILE, or on a test of the same world, and
fails if the outcome is another one than that of the run. `mode`: in which it is done."""

import re
import time

import live
from rows import TICKS
from worlds import HEAT


def of_cases(function):
    """A command for the cases of a test, which a mode has or not."""
    def command(program, output, mode):
        if mode.test is None:
            return "none: cases run in one process, or with --processes in a process each"
        if output.test is None:
            return "none: a recording has no cases"
        return function(program, output, mode)
    return command


def replay(program, output, mode):
    program.run("replay", output.path(".mcap"), "--verify", "--hash-log", output.path(".again"))
    assert output.path(".again").read_text() == output.path(".hashes").read_text(), "the replay has other hashes"


def branch(program, output, mode, *more):
    """From the middle to the end of the run; in lockstep it ends as the run."""
    name = f"{output.base}.branch.{mode.name}".replace(" ", "_")
    node = live.RosNode(program) if mode.answers else None
    program.run("run", output.path(".mcap"), "--headless", *mode.options, "--from-tick", TICKS // 2, "--ticks", TICKS, "--hash-log",
                output.folder / name, *([] if mode.in_process else ["--session", name]), *more)
    if node:
        node.end()
    last = (output.folder / name).read_text().splitlines()[-1]
    expected = output.path(".hashes").read_text().splitlines()[-1]
    assert not mode.same or last == expected, f"the continued run ends with '{last}', expected '{expected}'"


def test(program, output, mode):
    if output.test is None:
        program.run("test", worldless(output), "--on", output.path(".mcap"))
    elif mode.test is None:
        return "none: cases run in one process, or with --processes in a process each"
    else:
        text = program.run("test", output.test, "--no-shrink", *mode.test)
        assert re.search(r"[1-9]\d* passed, 0 failed, 0 errors", text), text
    return None


def worldless(output):
    return output.folder / "of_recording.test.json"


@of_cases
def sweep(program, output, mode):
    if "--processes" in mode.test:
        return "none: cases of troupe sweep run in one process"
    program.run("sweep", output.test, *mode.test, "-o", output.path(".sweep"))
    assert (output.path(".sweep") / "index.html").exists()
    assert len(list(output.path(".sweep").glob("*-heat-*.png"))) == len(HEAT)


@of_cases
def shard(program, output, mode):
    """Both halves, and the whole of them."""
    if "--processes" in mode.test:
        program.run("test", output.test, *mode.test, "--no-shrink", "--shard", "1/2")
        return None
    halves = [output.path(f".half{i}") for i in (1, 2)]
    for i, half in enumerate(halves):
        program.run("sweep", output.test, *mode.test, "--shard", f"{i + 1}/2", "-o", half)
    program.run("sweep", "--merge", *halves, "-o", output.path(".whole"))
    assert (output.path(".whole") / "index.html").exists()
    assert len(list(output.path(".whole").glob("*-heat-*.png"))) == len(HEAT)
    return None


@of_cases
def search(program, output, mode):
    text = program.run("test", output.test, *mode.test, "--search", "2", "--no-shrink")
    assert re.search(r"[1-9]\d* passed, 0 failed, 0 errors", text), text


def kill(run):
    """An agent of a live run dies; another one takes its place."""
    live.kill(run.process, "robot-agent")
    deadline = time.monotonic() + live.SECONDS
    while True:
        status, text = run.ask("ctl", "agents")
        if status == 0 and not re.search(r" (lost|none)\b", text):
            return None
        assert time.monotonic() < deadline, text
        time.sleep(0.05)


COMMANDS = {"replay": replay, "branch": branch, "test": test, "sweep": sweep, "shard": shard, "search": search}
