#!/usr/bin/env python3
"""Kills and stops processes of runs at random instants, and looks for hangs, processes left behind and changed hashes.

    kills.py WORLD [--programs FOLDER] [--rounds N] [--seed S] [--keep] [-- OPTION ...]

Each round is a run of 200 ticks that waits for lost agents (on_agent_loss pause), with the options after "--". One or half
of its agents, its world service or its launcher is killed (SIGKILL), or stopped and continued (SIGSTOP, SIGCONT). A run
whose processes were only stopped, or whose service was restarted, has the hashes of an undisturbed one; the others have a
part of them. Prints each failure and a table of the rounds; exit status 3 after a failure.
"""
import argparse
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PATIENCE = 120  # s, until a run counts as hanging
TICKS = 200
ACTIONS = ["stop an agent", "stop half of the agents", "stop the service", "kill an agent", "kill the service",
           "kill the launcher"]


def children_of(pid):
    try:
        return [int(word) for word in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def is_running(pid, program):
    try:
        state = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
        return state != "Z" and program in pathlib.Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return False


def send(pid, number):
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        pass  # it has ended


def wait_until(condition, seconds):
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.02)
    return condition()


class Round:
    def __init__(self, options, folder):
        self.folder = folder
        self.output = folder / "output"
        command = [options.programs / "troupe", "run", options.world, "--ticks", str(TICKS), "--speed", "40", "--headless",
                   "--lease", "0.5", "--on-agent-loss", "pause", "--restart-agents", "0", "--hash-log", folder / "hashes",
                   *options.options]
        self.launcher = subprocess.Popen(command, stdout=self.output.open("w"), stderr=subprocess.STDOUT,
                                         start_new_session=True)
        wait_until(lambda: "ready" in self.output.read_text() or self.launcher.poll() is not None, PATIENCE)

    def hashes(self):
        path = self.folder / "hashes"
        return path.read_text() if path.exists() else ""

    def act(self, action, choice):
        started = children_of(self.launcher.pid)
        agents = [pid for pid in started if is_running(pid, "robot-agent")]
        services = [pid for pid in started if is_running(pid, "world-service")]
        kind, _, whom = action.partition(" ")
        chosen = {"an agent": agents[:1] and [choice.choice(agents)], "half of the agents": agents[::2],
                  "the service": services, "the launcher": [self.launcher.pid]}[whom]
        for pid in chosen:
            send(pid, signal.SIGKILL if kind == "kill" else signal.SIGSTOP)
        if kind == "stop":
            time.sleep(choice.choice([0.05, 0.9]))  # less and more than the lease
            for pid in chosen:
                send(pid, signal.SIGCONT)
        if action == "kill an agent":  # for which the run waits
            time.sleep(0.8)
            send(self.launcher.pid, signal.SIGINT)
        return agents, services

    def end(self):
        """Whether it ended by itself."""
        try:
            self.launcher.wait(PATIENCE)
            return True
        except subprocess.TimeoutExpired:
            os.killpg(self.launcher.pid, signal.SIGKILL)
            self.launcher.wait()
            return False


def problems_of(run, action, choice, expected):
    time.sleep(choice.uniform(0.0, 1.0))
    agents, services = run.act(action, choice)
    problems = [] if run.end() else ["it hung"]
    left = [pid for program, pids in [("robot-agent", agents), ("world-service", services)] for pid in pids
            if not wait_until(lambda pid=pid, program=program: not is_running(pid, program), 20)]
    for pid in left:
        send(pid, signal.SIGKILL)
    if left:
        problems.append(f"processes left behind: {left}")
    hashes = run.hashes()
    if not expected.startswith(hashes[:hashes.rfind("\n") + 1]):
        problems.append("other hashes")
    # A service that dies before the first tick is not restarted.
    must_complete = action.startswith("stop") or (action == "kill the service" and hashes)
    if must_complete and hashes != expected:
        problems.append(f"{len(hashes.splitlines())} of {len(expected.splitlines())} hashes")
    return problems


def main():
    parser = argparse.ArgumentParser(description="Kills and stops processes of runs; see the head of this file.")
    parser.add_argument("world")
    parser.add_argument("--programs", type=pathlib.Path,
                        default=pathlib.Path(__file__).resolve().parents[2] / "build/release/bin")
    parser.add_argument("--rounds", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", action="store_true", help="keep the output of failed rounds")
    parser.add_argument("options", nargs="*", metavar="OPTION", help="more options of troupe run")
    options = parser.parse_args()
    choice = random.Random(options.seed)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="troupe-kills-"))
    subprocess.run([options.programs / "troupe", "run", options.world, "--ticks", str(TICKS), "--speed", "max",
                    "--in-process", "--headless", "--hash-log", folder / "expected"], check=True, stdout=subprocess.DEVNULL)
    expected = (folder / "expected").read_text()
    counts = {action: [0, 0] for action in ACTIONS}
    for number in range(options.rounds):
        action = choice.choice(ACTIONS)
        place = folder / str(number)
        place.mkdir()
        problems = problems_of(Round(options, place), action, choice, expected)
        counts[action][0] += 1
        if problems:
            counts[action][1] += 1
            print(f"round {number}, {action}: {', '.join(problems)}\n  {place}", flush=True)
        else:
            shutil.rmtree(place)
    for action, (rounds, failed) in counts.items():
        print(f"{action:24} {rounds:5} rounds {failed:5} failed")
    failed = sum(failures for _, failures in counts.values())
    if not (failed and options.keep):
        shutil.rmtree(folder)
    return 3 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
