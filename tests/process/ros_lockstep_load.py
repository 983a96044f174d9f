#!/usr/bin/python3
"""Runs whose ticks wait for nodes of ROS repeat under load. Each trial starts a run and its nodes in a network of their own, with one to
three robots, at a drawn speed, while any of their processes is stopped at random for up to 0.3 s at a time; the world service, agents
and nodes are killed and started again, and tools that read come and go. Its hashes are those of an undisturbed run, and its
recording replays without nodes. Needs root.

usage: ros_lockstep_load.py --programs FOLDER [--trials N] [--seed N] [--jobs N] [--ways counter,protocol,..] [--robots 1,2,3]
                            [--courses straight,back] [--network lo|lossy] [--nodes own|rclpy] [--only DEATH ..]
                            [--keep FOLDER]

Ways to take part: counter and topic are plain nodes on their topic of commands, one that counts its scans and one that forgets them;
protocol answers ticks; with --nodes rclpy there are executor and memory, of which the latter counts. Only nodes without a memory
are killed. Courses: straight plays 25 ticks; back steps, rewinds, steps, resets and steps. With --network lossy the nodes are on
another host, behind a switch that delays packets by 1 to 3 ms and loses 3 %. A trial depends on its seed alone: --seed N --trials 1
repeats it.
"""
import argparse
import concurrent.futures
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[2] / "scripts"))
from virtual_network import Network, obstacle_to_hosts  # noqa: E402

SKIPPED = 77  # exit status for tests: this machine cannot run it
TICKS = 25
BACK = [("step", 8), ("rewind", 3), ("step", 6), ("reset", 0), ("step", 9)]
LIMIT = 240.0  # s of a trial
DOMAIN = 7
ANSWERING = ("protocol", "executor", "memory")
FORGETFUL = ("topic", "protocol", "executor")


class Failure(Exception):
    """What a trial has found."""


class Disturber(threading.Thread):
    """Stops one random process of the trial after another for a random time, as a busy machine does, and kills those whose turn it is.

    `deaths`: pairs of a time since the start and a function."""

    def __init__(self, trial, deaths):
        super().__init__(daemon=True)
        self.trial, self.deaths, self.random = trial, sorted(deaths, key=lambda death: death[0]), random.Random(trial.seed)
        self.ended = threading.Event()

    def run(self):
        begun = time.monotonic()
        while not self.ended.is_set():
            while self.deaths and time.monotonic() - begun > self.deaths[0][0]:
                self.deaths.pop(0)[1]()
            pids = self.trial.pids()
            if pids:
                self.stop(self.random.choice(pids))
            self.ended.wait(self.random.uniform(0.0, 0.06))

    def stop(self, pid):
        try:
            os.kill(pid, signal.SIGSTOP)
            self.ended.wait(self.random.uniform(0.0, 0.3))
            os.kill(pid, signal.SIGCONT)
        except ProcessLookupError:
            pass

    def end(self):
        self.ended.set()
        self.join()


class Trial:
    def __init__(self, arguments, kind, seed, is_reference, folder):
        self.arguments, self.seed, self.is_reference, self.folder = arguments, seed, is_reference, folder
        self.way, self.robots, self.course = kind
        self.random = random.Random(seed)
        self.name = f"{'reference' if is_reference else seed}-{self.way}-{self.robots}-{self.course}"
        self.notes = []
        self.nodes, self.tools = {}, []
        self.lock = threading.Lock()

    def node_host(self):
        return self.network.hosts[-1]

    def start_node(self, robot):
        delay = 0 if self.is_reference else self.delays[robot]
        with open(self.folder / f"node{robot}.log", "a", encoding="utf-8") as log:
            return self.network.on(self.node_host(), *self.program(), self.way, f"driver{robot}", f"/r{robot}", delay,
                                   self.random.randrange(1000), DOMAIN, self.interface, stdout=log, stderr=log, env=self.environment)

    def program(self):
        if self.arguments.nodes == "own":
            return [self.arguments.programs / "lockstep_node"]
        return ["/usr/bin/python3", HERE.parent / "rclpy_lockstep_node.py"]

    def pids(self):
        """The processes of the trial, without those that only speak to the run."""
        found = []
        for host in self.network.hosts:
            space = os.stat(f"/run/netns/{self.network.space(host)}").st_ino
            for entry in pathlib.Path("/proc").iterdir():
                if not entry.name.isdigit():
                    continue
                try:
                    if os.stat(entry / "ns/net").st_ino == space and b"\0ctl\0" not in (entry / "cmdline").read_bytes():
                        found.append(int(entry.name))
                except OSError:
                    pass
        return sorted(found)

    def kill(self, part):
        victims = [pid for pid in self.pids() if part in self.command_line(pid)]
        if not victims:
            return
        victim = self.random.choice(victims)
        self.notes.append(f"{part} killed {time.monotonic() - self.begun:.1f} s after the start")
        try:
            os.kill(victim, signal.SIGKILL)
        except ProcessLookupError:
            pass

    @staticmethod
    def command_line(pid):
        try:
            return pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            return ""

    def kill_node(self):
        robot = self.random.randrange(self.robots)
        self.notes.append(f"node {robot} killed {time.monotonic() - self.begun:.1f} s after the start")
        self.nodes[robot].kill()
        self.nodes[robot].wait()
        self.nodes[robot] = self.start_node(robot)

    def start_tool(self):
        self.notes.append(f"a reader came {time.monotonic() - self.begun:.1f} s after the start")
        self.tools.append(self.network.on(self.node_host(), *self.program(), "echo", f"tool{len(self.tools)}",
                                          f"/r{self.random.randrange(self.robots)}", 0, 1, DOMAIN, self.interface,
                                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=self.environment))

    def end_tool(self):
        if self.tools:
            self.notes.append(f"a reader ended {time.monotonic() - self.begun:.1f} s after the start")
            self.tools[0].kill()
            self.tools.pop(0).wait()

    def draw_deaths(self):
        longest = {"max": 4.0, "5": 5.0, "1": 6.0}[self.speed]
        deaths = []

        def perhaps(share, most, action):
            if self.random.random() < share:
                deaths.extend((self.random.uniform(0.5, longest), action) for _ in range(self.random.randint(1, most)))

        only = self.arguments.only
        if only:
            longest = max(longest, 6.0)
        likely = 1.0 if only else 0.4
        if not only or "service" in only:
            perhaps(likely, 2, lambda: self.kill("world-service"))
        if not only or "agent" in only:
            perhaps(likely, 2, lambda: self.kill("robot-agent"))
        if self.way in FORGETFUL and (not only or "node" in only):
            perhaps(likely, 1, self.kill_node)
        if not only or "reader" in only:
            perhaps(likely, 3, self.start_tool)
            perhaps(likely / 2, 2, self.end_tool)
        return deaths

    def ctl(self, *words):
        """Its output; none if the service that was asked has died."""
        done = subprocess.run(["ip", "netns", "exec", self.network.space("h1"), self.arguments.programs / "troupe", "ctl", *map(str, words),
                               "--session", self.session], capture_output=True, text=True, timeout=LIMIT)
        if done.returncode == 0:
            return done.stdout
        if "is gone" in done.stderr or "no world service" in done.stderr:
            self.notes.append(f"'{' '.join(map(str, words))}' got no reply")
            return None
        raise Failure(f"troupe ctl {' '.join(map(str, words))}: {done.stderr.strip()}")

    def tick(self):
        """That at which the run is paused."""
        deadline = time.monotonic() + LIMIT
        while time.monotonic() < deadline:
            found = re.match(r"paused tick (\d+)", self.ctl("status") or "")
            if found:
                return int(found[1])
            time.sleep(0.1)
        raise Failure("the run did not pause")

    def command(self):
        names = ",".join(f"driver{i}" if self.way in ANSWERING else f"/r{i}/cmd_vel" for i in range(self.robots))
        more = ["--ticks", TICKS] if self.course == "straight" else ["--paused", "--ticks", 100000]
        return [self.arguments.programs / "troupe", "run", HERE.parent / "worlds/pen.world", "--headless", "--seed", 1, "--session", self.session,
                "--ros", "--ros-domain", DOMAIN, "--ros-interface", self.interface, "--ros-lockstep", names, "--ros-lockstep-limit", 0,
                "--lease", 5, "--on-agent-loss", "rebuild", "--speed", self.speed, "--hash-log", self.folder / "hashes",
                "--record", self.folder / "run.mcap", *more]

    def run(self):
        """The hashes."""
        lossy = self.arguments.network == "lossy"
        self.session = f"load{os.getpid()}-{self.seed}{'r' if self.is_reference else ''}"
        self.delays = [self.random.choice([0, 20, 50, 300]) for _ in range(self.robots)]
        self.speed = "max" if self.is_reference else self.random.choice(["max", "5", "1"])
        self.interface = "eth0" if lossy else "lo"
        self.environment = dict(os.environ, ROS_DOMAIN_ID=str(DOMAIN), CYCLONEDDS_URI=(
            f"<CycloneDDS><Domain><General><Interfaces><NetworkInterface name='{self.interface}'/></Interfaces><AllowMulticast>"
            f"{'spdp' if lossy else 'false'}</AllowMulticast></General><Discovery><Peers>"
            f"{'' if lossy else '<Peer address=' + chr(39) + '127.0.0.1' + chr(39) + '/>'}</Peers>"
            "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex></Discovery></Domain></CycloneDDS>"))
        self.folder.mkdir(parents=True)
        # Names of interfaces are short, and other trials have theirs.
        self.network = Network(2 if lossy else 1, f"{self.seed % 1000}{'r' if self.is_reference else ''}-")
        disturber = None
        try:
            if lossy:
                self.network.disturb_by_switch(2, 50, 3, self.seed)
            self.begun = time.monotonic()
            with open(self.folder / "run.log", "w", encoding="utf-8") as log:
                run = self.network.on("h1", *self.command(), stdout=log, stderr=log)
            for robot in range(self.robots):
                self.nodes[robot] = self.start_node(robot)
            if not self.is_reference:
                disturber = Disturber(self, self.draw_deaths())
                disturber.start()
            if self.course == "back":
                self.step_and_go_back(run)
            try:
                status = run.wait(LIMIT)
            except subprocess.TimeoutExpired:
                raise Failure("the run did not end") from None
        finally:
            if disturber is not None:
                disturber.end()
            self.network.remove()
            for process in [*self.nodes.values(), *self.tools]:
                process.wait()
        if status != (0 if self.course == "straight" else 130):
            raise Failure(f"the run ended with status {status}")
        return (self.folder / "hashes").read_text()

    def step_and_go_back(self, run):
        deadline = time.monotonic() + LIMIT
        while ", ready" not in (self.folder / "run.log").read_text():
            if time.monotonic() > deadline:
                raise Failure("the run did not start")
            time.sleep(0.05)
        for action, number in BACK:
            goal = self.tick() + number if action == "step" else number
            try:
                while self.ctl(*{"step": ("step", goal - self.tick()), "rewind": ("rewind", goal), "reset": ("reset",)}[action]) is None:
                    if self.tick() == goal:  # the one that died had done it
                        break
            except subprocess.TimeoutExpired:
                raise Failure(f"{action} {number} did not end") from None
        run.send_signal(signal.SIGINT)

    def replay(self):
        done = subprocess.run([self.arguments.programs / "troupe", "replay", self.folder / "run.mcap", "--verify"], capture_output=True, text=True)
        if done.returncode != 0:
            raise Failure(f"the recording does not replay: {done.stderr.strip()}{done.stdout.strip()}")

    def description(self):
        return f"{self.name}, speed {self.speed}, delays {self.delays}: {'; '.join(self.notes) or 'starved only'}"


def run_trial(arguments, kind, seed, reference, base):
    trial = Trial(arguments, kind, seed, reference is None, base / f"{'reference' if reference is None else seed}-{'-'.join(map(str, kind))}")
    begun = time.monotonic()
    try:
        hashes = trial.run()
        trial.replay()
        if reference is not None and hashes != reference:
            lines = [ours == theirs for ours, theirs in zip(hashes.splitlines(), reference.splitlines())]
            raise Failure(f"other hashes from line {lines.index(False) + 1 if False in lines else len(lines) + 1} on")
    except Failure as failure:
        print(f"FAILED {trial.description()}: {failure}", flush=True)
        if arguments.keep:
            shutil.copytree(trial.folder, arguments.keep / trial.folder.name, dirs_exist_ok=True)
        return None
    print(f"equal {trial.description()} ({time.monotonic() - begun:.0f} s)", flush=True)
    if not arguments.keep:
        shutil.rmtree(trial.folder)
    return hashes


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, type=pathlib.Path)
    parser.add_argument("--trials", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1, help="of the first trial")
    parser.add_argument("--jobs", type=int, default=2, help="trials at once")
    parser.add_argument("--ways", default="")
    parser.add_argument("--robots", default="1,2,3")
    parser.add_argument("--courses", default="straight,back")
    parser.add_argument("--network", choices=["lo", "lossy"], default="lo")
    parser.add_argument("--nodes", choices=["own", "rclpy"], default="own")
    parser.add_argument("--only", choices=["service", "agent", "node", "reader"], nargs="*", default=[], help="in each trial these, and no others")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the outputs of trials that fail")
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    obstacle = obstacle_to_hosts()
    if obstacle:
        print(f"skipped: {obstacle}")
        return SKIPPED
    ways = arguments.ways or ("counter,topic,protocol" if arguments.nodes == "own" else "counter,topic,protocol,executor,memory")
    kinds = [(way, robots, course) for robots in map(int, arguments.robots.split(",")) for course in arguments.courses.split(",")
             for way in ways.split(",")]
    with tempfile.TemporaryDirectory(prefix="troupe-load-") as name, concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        seeds = range(arguments.seed, arguments.seed + arguments.trials)
        used = list(dict.fromkeys(kinds[seed % len(kinds)] for seed in seeds))
        references = dict(zip(used, pool.map(lambda kind: run_trial(arguments, kind, kinds.index(kind), None, pathlib.Path(name)), used)))
        results = list(pool.map(lambda seed: references[kinds[seed % len(kinds)]] is not None and run_trial(
            arguments, kinds[seed % len(kinds)], seed, references[kinds[seed % len(kinds)]], pathlib.Path(name)) is not None, seeds))
    print(f"{sum(results)} of {len(results)} trials have the hashes of their reference, and replay")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
