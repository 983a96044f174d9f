"""The scenes: each measures in rounds and gives rows for a CSV file of its name."""
import json
import pathlib
import time

from . import worlds
from .peers import peers
from .programs import Failure


class Setting:
    """The common parts of the scenes."""

    def __init__(self, troupe, stage, stage_worlds, folder, quick, rounds, peers):
        self.troupe = troupe
        self.stage = stage
        self.stage_worlds = stage_worlds
        self.folder = pathlib.Path(folder)
        self.quick = quick
        self.rounds = 1 if quick else rounds
        self.peers = peers  # the paths of other simulators, or None, by name

    def cave(self, seconds):
        return worlds.copy_for_stage(self.stage_worlds, self.folder / "stage", "benchmark/cave.world", seconds)


def functions(setting):
    """Single functions, by Google Benchmark."""
    environment = {"TROUPE_STAGE_WORLDS": str(setting.stage_worlds)} if setting.stage_worlds else {}
    for program in ["ray_cast", "map_import", "body_index", "step", "manipulation"]:
        if not setting.troupe.has(f"bench_{program}"):
            continue
        for row in setting.troupe.functions(f"bench_{program}", setting.rounds, setting.quick, environment):
            yield {"program": program, "name": row["name"], "time": row["real_time"], "unit": row["time_unit"],
                   "items_per_second": row.get("items_per_second", row.get("rays", ""))}


def barrier(setting):
    """A service and N processes that only answer: by data sharing and over DDS alone; plain shared memory and UDP."""
    if not setting.troupe.has("udp_barrier"):
        return
    counts = [1, 4] if setting.quick else [1, 4, 16, 50, 100, 200]
    for number in range(setting.rounds):
        for count in counts:
            ticks = 50 if setting.quick else max(300, 20_000 // count)
            for transport, command in [("memory", ["shared_memory_barrier", count, ticks]),
                                       ("sharing", ["dds_barrier", count, ticks, 0, "on"]),
                                       ("udp", ["udp_barrier", count, ticks]),
                                       ("dds", ["dds_barrier", count, ticks, 0, "off"])]:
                row = setting.troupe.json_line(*command)
                yield {"round": number, "transport": transport, **row}


def observers(setting):
    """Lockstep over DDS of 100 processes that only answer: with 10 observer processes that read every frame, and alone."""
    if not setting.troupe.has("dds_barrier"):
        return
    agents = 4 if setting.quick else 100
    for number in range(setting.rounds):
        for count in [0, 10]:
            row = setting.troupe.json_line("dds_barrier", agents, 50 if setting.quick else 1000, count)
            yield {"round": number, **row}


def processes(setting):
    """Idle robots, a process each: the real programs without work."""
    counts = [1, 4] if setting.quick else [1, 4, 16, 50, 100, 200]
    for number in range(setting.rounds):
        for count in counts:
            ticks = 50 if setting.quick else max(300, 20_000 // count)
            yield {"round": number, **setting.troupe.per_robot_and_tick(
                worlds.write_yard(setting.folder / f"yard{count}", count), ticks)}
    # While so many start, one may be silent for longer than the default lease of 2 s.
    for number in range(0 if setting.quick else setting.rounds):
        for count in [400, 1000]:
            yield {"round": number, **setting.troupe.per_robot_and_tick(
                worlds.write_yard(setting.folder / f"yard{count}", count), 50, "--lease", 30, "--start-timeout", 120)}


def requests(setting):
    """100 processes of idle robots, beside a tool that opens and closes a door ten times a second, and alone."""
    if not setting.troupe.has("door_requests"):
        return
    count, ticks = (4, 200) if setting.quick else (100, 20_000)
    world = worlds.write_yard(setting.folder / f"gate{count}", count, door=True)
    for number in range(setting.rounds):
        for asked in [False, True]:
            run = setting.troupe.with_door_requests(world, ticks, requests=asked)
            yield {"round": number, "door": "asked" if asked else "none", "requests": run["requests"],
                   "ticks_per_second": run["ticks"] / run["wall_seconds"]}


def cases(setting):
    """Cases of `troupe test`: 450 ticks of the laboratory with ten expectations each; the time of a case is that of many
    without that of one."""
    count = 4 if setting.quick else 1000
    test = worlds.write_lab_test(setting.folder / "cases", count)
    for number in range(setting.rounds):
        one, many = (setting.troupe.test(test, *options) for options in [["--case", "seed=1"], []])
        yield {"round": number, "cases": count, "seconds": many["wall"],
               "processor_ms": 1e3 * sum(many[key] - one[key] for key in ["user", "system"]) / (count - 1)}


def robots(setting):
    """Growth in one process: robots with 12 infrared rays, 8.4 m2 for each."""
    counts = [10, 100] if setting.quick else [10, 100, 1000, 10_000, 100_000]
    for number in range(setting.rounds):
        for count in counts:
            side = max(20.0, round((8.4 * count) ** 0.5, -1))
            ticks = 20 if setting.quick else max(20, min(1000, 100_000 // count))
            world = worlds.write_swarm(setting.folder / f"robots{count}", count, side, side)
            yield {"round": number, **setting.troupe.per_robot_and_tick(world, ticks, "--in-process")}


def memory(setting):
    """The memory of agents and service together, with and without data sharing: the cave, and 400 robots with 12 rays."""
    world_of = {"cave": lambda: setting.cave(60)} if setting.stage_worlds else {}
    count = 20 if setting.quick else 400
    world_of[f"swarm of {count}"] = lambda: worlds.write_swarm(setting.folder / f"memory{count}", count, 90, 40)
    packing = ["--robots-per-process", 5] if setting.quick else []
    for number in range(setting.rounds):
        for name, world in world_of.items():
            for sharing in ["on", "off"]:
                yield {"round": number, "world": name, "sharing": sharing, **setting.troupe.memory(
                    world(), 50, "--data-sharing", sharing, "--lease", 30, "--start-timeout", 120, *packing)}


def cave(setting):
    """Stage's benchmark: 100 robots, 600 ticks; in 100 processes with and without data sharing, in one, and Stage."""
    if setting.stage_worlds is None:
        return
    ticks = 20 if setting.quick else 600
    packing = ["--robots-per-process", 20] if setting.quick else []
    for number in range(setting.rounds):
        world = setting.cave(60)
        for program, options in [("sharing", []), ("sharing, 2 threads", ["--threads", 2]),
                                 ("dds", ["--data-sharing", "off"])]:
            yield {"round": number, "program": program,
                   **setting.troupe.per_robot_and_tick(world, ticks, *packing, *options)}
        if setting.stage:
            yield {"round": number, "program": "stage", **setting.stage.per_robot_and_tick(setting.cave, 100, ticks)}
        for program, options in [("in-process", []), ("in-process, 1 thread", ["--threads", 1])]:
            yield {"round": number, "program": program,
                   **setting.troupe.per_robot_and_tick(world, ticks, "--in-process", *options)}


def additions(setting):
    """Viewer, recording and ROS 2 without readers, beside Stage's benchmark in 100 processes, and it alone."""
    if setting.stage_worlds is None:
        return
    ticks = 20 if setting.quick else 10_000  # tools and robots discover each other in the first 3,000
    packing = ["--robots-per-process", 20] if setting.quick else []
    recording = setting.folder / "additions.mcap"
    for number in range(setting.rounds):
        world = setting.cave(1000)
        for name, options in [("none", []), ("viewer", []), ("recording", ["--record", recording]),
                              ("ROS 2", ["--ros", "--ros-interface", "lo"])]:
            recording.unlink(missing_ok=True)
            yield {"round": number, "addition": name,
                   **setting.troupe.per_robot_and_tick(world, ticks, *packing, *options, headless=name != "viewer")}


def swarm(setting):
    """1,000 robots with 12 infrared rays in 140 m x 60 m; 10,000 in one process."""
    count, ticks = (50, 20) if setting.quick else (1000, 200)
    packing = max(1, count // 20)

    def world(seconds):
        return worlds.write_swarm(setting.folder / f"swarm{count}-{seconds}", count, seconds=seconds)

    for number in range(setting.rounds):
        yield {"round": number, "program": "dds", **setting.troupe.per_robot_and_tick(
            world(60), ticks, "--robots-per-process", packing)}
        if setting.stage:
            yield {"round": number, "program": "stage", **setting.stage.per_robot_and_tick(world, count, ticks)}
        yield {"round": number, "program": "in-process",
               **setting.troupe.per_robot_and_tick(world(60), ticks, "--in-process")}
        if not setting.quick:
            many = worlds.write_swarm(setting.folder / "swarm10000", 10_000)
            yield {"round": number, "program": "in-process",
                   **setting.troupe.per_robot_and_tick(many, 50, "--in-process")}


def scenarios(setting):
    """The manipulation scenarios, each to its end: a process for each robot, and all in one."""
    names = ["lab", "marina", "stacking", "relay"]
    for number in range(setting.rounds):
        for name in names[:1] if setting.quick else names:
            path = worlds.SCENARIOS / f"{name}.json"
            ticks = 20 if setting.quick else json.loads(path.read_text())["ticks"]
            for program, options in [("dds", []), ("in-process", ["--in-process"])]:
                yield {"round": number, "scenario": name, "program": program,
                       **setting.troupe.per_robot_and_tick(path, ticks, *options)}


def site_map(setting):
    """Loading a map of 50,000 x 35,000 cells."""
    size = (2000, 1400) if setting.quick else (50_000, 35_000)
    world = worlds.write_site_map(setting.folder / "site", *size)
    for number in range(setting.rounds):
        begin = time.monotonic()
        _, usage = setting.troupe.check(world)
        yield {"round": number, "width": size[0], "height": size[1], "seconds": time.monotonic() - begin,
               "processor_seconds": usage["user"] + usage["system"]}


ALL = {scene.__name__: scene for scene in [functions, barrier, observers, processes, requests, cases, robots, memory, cave, additions,
                                            swarm, peers, scenarios, site_map]}


def measure(name, setting):
    """All rows of a scene; failed ones are reported and left out."""
    rows = []
    try:
        for row in ALL[name](setting):
            rows.append(row)
            print(f"  {name}: " + ", ".join(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}"
                                            for key, value in row.items()), flush=True)
    except Failure as failure:
        return rows, failure
    return rows, None
