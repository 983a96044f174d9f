"""Tables from the CSV files of a folder."""
import csv
import pathlib
import re
import shutil
import statistics

STAGE_SWARM_SPEED = 2.2  # times real time, of Stage with 1,000 robots in such a scene
STAGE_MAP_SECONDS = 63
# Work, program and name in plots of the scene peers.
PEERS = [("12 rays", "troupe", "Troupe, 12 rays in rooms"), ("12 rays", "stage", "Stage 4.3, 12 rays in rooms"),
         ("24 rays", "troupe", "Troupe, 24 proximity rays"), ("24 rays", "argos", "ARGoS 3, 24 proximity rays"),
         ("lidar", "mvsim", "MVSim, lidar of 12 rays")]
NOISE = "noise"  # in place of a time below zero


def read(folder, name):
    path = pathlib.Path(folder) / f"{name}.csv"
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def write(folder, name, rows):
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with open(pathlib.Path(folder) / f"{name}.csv", "w", newline="") as file:
        out = csv.DictWriter(file, columns, lineterminator="\n")
        out.writeheader()
        for row in rows:
            out.writerow({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()})


class Values:
    """Numbers of several rounds."""

    def __init__(self, values):
        self.values = sorted(values)

    def __bool__(self):
        return bool(self.values)

    @property
    def median(self):
        return statistics.median(self.values)

    def text(self, unit="", digits=3):
        """Median, and from least to most. A negative value is printed as noise: it is the difference of a long and a short
        run, of which the short one was the longer."""
        def number(value):
            if value < 0:
                return NOISE
            return f"{value:.{digits}g}" if value < 1000 else f"{value:,.0f}"
        middle = f"{number(self.median)}{unit}"
        if len(self.values) == 1:
            return middle
        return f"{middle} ({number(self.values[0])} to {number(self.values[-1])})"


def pick(rows, column, **where):
    return Values(float(row[column]) for row in rows
                  if row.get(column) and all(row.get(key) == str(value) for key, value in where.items()))


def processor(rows, **where):
    """Processor times of the system and the programs."""
    return Values(float(row.get("processor_us") or float(row["user_us"]) + float(row["system_us"] or 0)) for row in rows
                  if all(row.get(key) == str(value) for key, value in where.items()))


def ratios(rows, column, key, above, below, **where):
    """`above` divided by `below` of the same round."""
    def by_round(kind):
        return {row["round"]: float(row[column]) for row in rows
                if row[key] == kind and all(row.get(k) == str(v) for k, v in where.items())}
    upper, lower = by_round(above), by_round(below)
    return Values(upper[number] / lower[number] for number in upper if number in lower)


def verdict(target, values):
    """Whether the median of `values` reaches a target such as "at most 0.25" or "at least 40"."""
    sense, limit = re.match(r"(at most|at least|under) ([\d.]+)", target).groups()
    if not values:
        return ""
    met = {"at most": values.median <= float(limit), "under": values.median < float(limit),
           "at least": values.median >= float(limit)}[sense]
    return "met" if met else "**missed**"


def targets(folder):
    """Rows (scene, target, verdict, measured, command) of docs/performance.md."""
    cave, barrier, swarm = (read(folder, name) for name in ["cave", "barrier", "swarm"])
    processes, site, functions = (read(folder, name) for name in ["processes", "site_map", "functions"])
    table = []

    def add(what, target, values, unit, scene, note=""):
        measured = values.text(unit) + note if values else "not measured"
        table.append((what, target, verdict(target, values), measured, f"`scripts/bench {scene}`"))

    def beside(rows, **kinds):
        values = [f"{kind} {pick(rows, 'wall_us', **where).median:.3g} ({processor(rows, **where).median:.3g}) us"
                  for kind, where in kinds.items() if pick(rows, "wall_us", **where)]
        return f"; {', '.join(values)} per robot and tick (processor time)" if values else ""

    cave_us = beside(cave, Troupe={"program": "sharing"}, Stage={"program": "stage"},
                     **{"without data sharing": {"program": "dds"}})
    cave_one_us = beside(cave, Troupe={"program": "in-process"}, Stage={"program": "stage"})
    add("cave.world, 100 processes, against Stage", "at most 0.20",
        ratios(cave, "wall_us", "program", "sharing", "stage"), "", "cave", cave_us)
    add("cave.world in one process, against Stage", "at most 0.05",
        ratios(cave, "wall_us", "program", "in-process", "stage"), "", "cave", cave_one_us)
    add("lockstep of 100 processes, against plain shared memory", "at most 1.3",
        ratios(barrier, "wall_us", "transport", "sharing", "memory", processes=100), "", "barrier",
        beside([row for row in barrier if row["processes"] == "100"], Troupe={"transport": "sharing"},
               **{"shared memory": {"transport": "memory"}}))
    add("lockstep of 100 processes over DDS (--data-sharing off), against plain UDP", "at most 1.5",
        ratios(barrier, "wall_us", "transport", "dds", "udp", processes=100), "", "barrier",
        beside([row for row in barrier if row["processes"] == "100"], DDS={"transport": "dds"}, UDP={"transport": "udp"}))
    add("ticks per second of 100 processes with 10 reading observers, against none", "at least 0.95",
        ratios(read(folder, "observers"), "ticks_per_second", "observers", "10", "0"), "", "observers")
    for name in ["viewer", "recording", "ROS 2"]:
        add(f"{name} without readers, cave.world in 100 processes, times the tick without", "at most 1.05",
            ratios(read(folder, "additions"), "wall_us", "addition", name, "none"), "", "additions")
    for count, target in [(100, "0.5"), (400, "2.5"), (1000, "8")]:
        add(f"{count:,} processes from start to first tick", f"at most {target} s",
            pick(processes, "startup_seconds", robots=count), " s", "processes")
    add("ticks per second of 100 processes with ten requests a second for a door, against none", "at least 0.98",
        ratios(read(folder, "requests"), "ticks_per_second", "door", "asked", "none"), "", "requests")
    cases = read(folder, "cases")
    add("a case of `troupe test`: 450 ticks of the laboratory, ten expectations", "at most 12 ms",
        pick(cases, "processor_ms"), " ms", "cases")
    add("1,000 such cases on two cores", "at most 10 s", pick(cases, "seconds", cases=1000), " s", "cases")
    remembered = read(folder, "memory")
    add("memory of a robot's process in the cave, pages of its own", "at most 2 MiB",
        pick(remembered, "agent_private_mib", world="cave", sharing="on"), " MiB", "memory")
    add("memory of a robot's process in the cave, all pages", "at most 10 MiB", pick(cave, "agent_mib", program="sharing"),
        " MiB", "cave", ", the largest of 100")
    add(f"loading a map of 50,000 x 35,000 cells (Stage: {STAGE_MAP_SECONDS} s)", "under 0.5 s",
        pick(site, "seconds", width=50_000), " s", "site_map")
    rays = pick(functions, "items_per_second", name="BM_StageCave")
    add("rays in the cave, one core", "at least 10 million a second", Values(rate / 1e6 for rate in rays.values),
        " million a second", "functions")
    add("swarm of 1,000 with 12 rays, 20 processes, times real time", f"at least {2 * STAGE_SWARM_SPEED}",
        pick(swarm, "real_time_factor", program="dds", robots=1000), "", "swarm",
        f"; Stage {pick(swarm, 'real_time_factor', program='stage').text()}" if pick(
            swarm, "real_time_factor", program="stage") else "")
    grown = read(folder, "robots")
    for count, target in [(1000, "1.2"), (10_000, "0.6"), (100_000, "0.4")]:
        rates = Values(1 / microseconds for microseconds in pick(grown, "wall_us", robots=count).values)
        add(f"{count:,} robots with 12 rays in one process", f"at least {target} million robot-steps a second", rates,
            " million a second", "robots")
    beside_peers = read(folder, "peers")
    add("the same swarm work as ARGoS 3 (1,000 robots with 24 proximity rays, one thread), of its processor time",
        "at most 0.10",
        ratios(beside_peers, "processor_us", "program", "troupe", "argos", work="24 rays", robots=1000), "", "peers")
    add("100,000 robots with 12 rays, from the start of the program to its end after two ticks", "at most 5 s",
        pick(grown, "short_seconds", robots=100_000), " s", "robots")
    add("the same, memory", "under 2048 MiB", pick(grown, "service_mib", robots=100_000), " MiB", "robots")
    return table


def growth(folder):
    """Rows (scene, count, wall, processor time) of the growth tables."""
    table = []
    barrier = read(folder, "barrier")
    for name, key, rows in [("barrier over shared memory", "processes", [r for r in barrier if r["transport"] == "memory"]),
                            ("barrier by data sharing", "processes", [r for r in barrier if r["transport"] == "sharing"]),
                            ("barrier over UDP", "processes", [r for r in barrier if r["transport"] == "udp"]),
                            ("barrier over DDS", "processes", [r for r in barrier if r["transport"] == "dds"]),
                            ("idle robots, a process each", "robots", read(folder, "processes")),
                            ("robots with 12 rays in one process", "robots", read(folder, "robots"))]:
        for count in sorted({int(row[key]) for row in rows}):
            mine = [row for row in rows if int(row[key]) == count]
            extra = ""
            if name.startswith("idle"):
                extra = (f"{pick(mine, 'startup_seconds').text(' s')}; {pick(mine, 'agent_mib').text(' MiB')}; "
                         f"{pick(mine, 'bytes_per_tick').text()} bytes a tick")
            table.append((name, count, pick(mine, "wall_us").text(" us"), processor(mine).text(" us"), extra))
    return table


def peers(folder):
    """Rows (peer and work, robots, processor time of Troupe and the peer, their ratio, memory of both) of scene peers."""
    rows = read(folder, "peers")

    def runs_of(work, program, count):
        # Without the work, which the lidar compares with another one.
        return [{**row, "work": ""} for row in rows
                if (row["work"], row["program"], row["robots"]) == (work, program, str(count))]

    table = []
    for work, program, name in PEERS:
        if program == "troupe" or not any(row["program"] == program for row in rows):
            continue
        own_work = "12 rays" if work == "lidar" else work
        for count in sorted({int(row["robots"]) for row in rows if row["work"] == own_work}):
            mine, other = runs_of(own_work, "troupe", count), runs_of(work, program, count)
            cells = ["not measured", "", ""]
            if other:
                times = ratios(mine + other, "processor_us", "program", program, "troupe")
                cells = [processor(other).text(" us"), times.text(), pick(other, "mib").text(" MiB")]
            table.append((name, f"{count:,}", processor(mine).text(" us"), *cells[:2],
                          pick(mine, "mib").text(" MiB"), cells[2]))
    return table


def scenarios(folder):
    """Rows (scenario, robots, each of both programs' wall time of a tick and speed) of the manipulation scenarios."""
    rows = read(folder, "scenarios")
    table = []
    for name in dict.fromkeys(row["scenario"] for row in rows):
        cells = []
        for program in ["dds", "in-process"]:
            mine = [row for row in rows if row["scenario"] == name and row["program"] == program]
            ticks = Values(float(row["wall_us"]) * int(row["robots"]) for row in mine)
            cells += [ticks.text(" us"), pick(mine, "real_time_factor").text()]
        table.append((name, next(row["robots"] for row in rows if row["scenario"] == name), *cells))
    return table


def memory(folder):
    """Rows (world, data sharing, MiB of an agent: alone, its share, resident; share of the service; all together)."""
    rows = read(folder, "memory")
    table = []
    for name, sharing in dict.fromkeys((row["world"], row["sharing"]) for row in rows):
        cells = [pick(rows, column, world=name, sharing=sharing).text(" MiB") for column in
                 ["agent_private_mib", "agent_share_mib", "agent_resident_mib", "service_share_mib", "together_mib"]]
        table.append((name, sharing, *cells))
    return table


def markdown(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def text_of_targets(folder):
    machine = (pathlib.Path(folder) / "machine.txt")
    parts = ["Measured on: " + machine.read_text().strip()] if machine.exists() else []
    parts.append(markdown(["scene", "target", "", "measured: median (least to most)", "command"], targets(folder)))
    return "\n\n".join(parts)


def text_of_growth(folder):
    tables = [(["growth", "robots", "wall time per robot and tick", "processor time",
                "start to first tick; memory of an agent; traffic"], growth(folder)),
              (["world", "data sharing", "an agent, memory of its own", "with its part of shared pages", "resident",
                "world service", "all together"], memory(folder)),
              (["scenario", "robots", "a tick, a process each", "times real time", "a tick in one process",
                "times real time"], scenarios(folder))]
    return "\n\n".join(markdown(header, rows) for header, rows in tables if rows)


def text_of_peers(folder):
    rows = peers(folder)
    return markdown(["peer and work", "robots", "Troupe, processor time per robot and tick", "the peer", "times Troupe",
                     "Troupe, memory", "the peer"], rows) if rows else ""


def write_into(document, folder, plots):
    """Replaces the lines between the marks of a document, and of DOCUMENT-growth.md beside it if there is one; copies the
    plots to the folder pictures beside it."""
    path = pathlib.Path(document)
    growth_path = path.with_name(f"{path.stem}-growth{path.suffix}")
    pictures = path.parent / "pictures"
    pictures.mkdir(exist_ok=True)
    shown = {"growth": [], "peers": []}
    for plot in plots:
        shutil.copy(plot, pictures / plot.name)
        shown["peers" if plot.stem.endswith("peers") else "growth"].append(
            f"![{plot.stem.replace('_', ' ')}](pictures/{plot.name})")
    for name, page, lines in [("targets", path, text_of_targets(folder)),
                              ("peers", path, "\n\n".join([*shown["peers"], text_of_peers(folder)])),
                              ("growth", growth_path if growth_path.exists() else path,
                               "\n\n".join([*shown["growth"], text_of_growth(folder)]))]:
        before, rest = page.read_text().split(f"<!-- scripts/bench writes {name} from here -->\n")
        after = rest.split("<!-- to here -->", 1)[1]
        page.write_text(f"{before}<!-- scripts/bench writes {name} from here -->\n{lines}\n<!-- to here -->{after}")
