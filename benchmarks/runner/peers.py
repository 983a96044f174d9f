"""The scene `peers`: equal work in Troupe and in simulators that users would pick instead, each with one thread.

Three works, in ticks of 0.1 s:
    12 rays    worlds.write_swarm: robots with 12 infrared rays of 2 m spread out in a building of rooms, 8.4 m2 for
               each. Troupe and Stage read the same file.
    24 rays    foot-bots with 24 proximity rays of 0.1 m wander between four walls, 1 m2 for each: Troupe, ARGoS 3.
    lidar      robots with a lidar of 12 rays of 2 m spread out between four walls, 8.4 m2 for each: MVSim. Compared
               with the 12 rays of Troupe, though there are no rooms.
"""
import json
import os
import pathlib
import re
import sys
import tempfile

from . import peer_worlds, worlds
from .programs import Failure, run

SOURCES = pathlib.Path(__file__).resolve().parents[1] / "peers"
CHILD = pathlib.Path(__file__).resolve().with_name("child.py")
TICK = 0.1      # s
SHORT = 2       # ticks of the short run, the cost of start and end
LIMIT = 200     # s, of a run

# Ticks of the long run for each number of robots, the same for all programs of a work: later ticks may cost more, when
# robots have gathered. They take seconds.
TICKS = {
    "12 rays": {10: 10_000, 100: 2000, 1000: 200, 10_000: 80, 100_000: 20},
    "24 rays": {10: 10_000, 100: 1000, 1000: 300, 10_000: 40, 100_000: 20},
    "lidar": {10: 2000, 100: 300, 1000: 30, 10_000: 5},
}
MOST = 10_000      # robots in a peer: with ten times as many, each would start for minutes
LARGE = 10_000     # from so many on, no program is measured in more rounds than:
LARGE_ROUNDS = 3


def swarm_side(robots):
    return max(20.0, round((8.4 * robots) ** 0.5, -1))


class TroupeWork:
    """One of the works in Troupe: all robots in one process."""
    name = "troupe"

    def __init__(self, troupe, work):
        self.program = troupe.folder / "troupe"
        self.work = work

    def prepare(self, folder, robots):
        if self.work == "24 rays":
            return peer_worlds.write_foot_bots(folder, robots)
        return shared_swarm(folder, robots)

    def command(self, world, ticks):
        return [self.program, "run", world, "--ticks", ticks, "--speed", "max", "--headless", "--in-process",
                "--threads", 1], {}


class StageWork:
    name, work = "stage", "12 rays"

    def __init__(self, program, _folder):
        self.program = pathlib.Path(program).absolute()

    def prepare(self, folder, robots):
        return shared_swarm(folder, robots)

    def command(self, world, ticks):
        text = re.sub(r"^quit_time .*$", f"quit_time {ticks * TICK:g}", world.read_text(), flags=re.MULTILINE)
        path = world.with_name(f"swarm_{ticks}.world")
        path.write_text(text)
        return [self.program, "-g", path], library_path(self.program.parent.parent / "lib")


class ArgosWork:
    """PATH: the program argos3 of an installation with headers and the foot-bot."""
    name, work = "argos", "24 rays"

    def __init__(self, program, folder):
        self.program = pathlib.Path(program).absolute()
        self.library = build("argos", self.program.parent.parent, folder) / "libargos_wander.so"

    def prepare(self, folder, robots):
        return folder, robots

    def command(self, world, ticks):
        plugins = self.program.parent.parent / "lib/argos3"
        return ([self.program, "-n", "-z", "-c", peer_worlds.write_argos(*world, ticks, self.library)],
                {"ARGOS_PLUGIN_PATH": str(plugins), **library_path(plugins)})


class MvsimWork:
    """PATH: the program mvsim of an installation with headers and CMake files."""
    name, work = "mvsim", "lidar"

    def __init__(self, program, folder):
        self.root = pathlib.Path(program).absolute().parent.parent
        self.program = build("mvsim", self.root, folder) / "mvsim_run"

    def prepare(self, folder, robots):
        return peer_worlds.write_mvsim(folder, robots)

    def command(self, world, ticks):
        return [self.program, world, ticks], library_path(self.root / "lib")


def library_path(folder):
    return {"LD_LIBRARY_PATH": f"{folder}:{os.environ.get('LD_LIBRARY_PATH', '')}"}


def shared_swarm(folder, robots):
    """The swarm of Stage and Troupe, written once."""
    path = folder.parent / f"swarm{robots}"
    if not (path / "swarm.world").exists():
        worlds.write_swarm(path, robots, swarm_side(robots), swarm_side(robots))
    return path / "swarm.world"


def build(peer, prefix, folder):
    """Builds the controller or the program for a peer against its installation; the folder with it."""
    path = folder / f"build-{peer}"
    run(["cmake", "-S", SOURCES, "-B", path, f"-DCMAKE_PREFIX_PATH={prefix}", f"-DPEER={peer}"])
    run(["cmake", "--build", path])
    return path


def measured(command, environment):
    """What a run used: wall, user and system time in s, and MiB at most."""
    with tempfile.NamedTemporaryFile(suffix=".json") as result:
        run([sys.executable, CHILD, result.name, *command], limit=LIMIT, environment=environment)
        return json.load(open(result.name))


def measured_again(work, world, ticks):
    """As measured; Stage's threads sometimes miss their start, and then it never ends."""
    attempts = 3 if work.name == "stage" else 1
    for attempt in range(attempts):
        try:
            return measured(*work.command(world, ticks))
        except Failure as failure:
            if attempt + 1 == attempts:
                raise
            print(f"{work.name}, attempt {attempt + 1}: {failure}", file=sys.stderr)


def row_of(work, world, robots, ticks):
    """The cost of a tick: that of a long run minus that of a short one."""
    short = measured_again(work, world, SHORT)
    long = measured_again(work, world, ticks)
    share = 1e6 / robots / (ticks - SHORT)
    return {"work": work.work, "program": work.name, "robots": robots, "ticks": ticks,
            "wall_us": (long["wall"] - short["wall"]) * share,
            "processor_us": (long["user"] + long["system"] - short["user"] - short["system"]) * share,
            "mib": long["mib"], "startup_seconds": short["wall"]}


def works(setting):
    """All works, with the peers of which a path was given."""
    found = [TroupeWork(setting.troupe, "12 rays"), TroupeWork(setting.troupe, "24 rays")]
    for name, kind in [("stage", StageWork), ("argos", ArgosWork), ("mvsim", MvsimWork)]:
        path = setting.peers.get(name)
        if path:
            found.append(kind(path, setting.folder))
        else:
            print(f"  peers: no --{name} PATH: it is left out")
    return found


def peers(setting):
    """The same work beside Stage, ARGoS 3 and MVSim, one thread: robots that drive and avoid each other by rays."""
    found = works(setting)
    for number in range(setting.rounds):
        for count in [10, 100] if setting.quick else [10, 100, 1000, 10_000, 100_000]:
            if number >= LARGE_ROUNDS and count >= LARGE:
                continue
            # Side by side: all programs with so many robots, one after another.
            for work in found:
                if work.name != "troupe" and count > MOST:
                    continue
                ticks = 20 if setting.quick else TICKS[work.work][count]
                world = work.prepare(setting.folder / f"peers-{work.work.replace(' ', '-')}-{work.name}-{count}", count)
                yield {"round": number, **row_of(work, world, count, ticks)}
