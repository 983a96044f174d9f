"""The views of the rows: how each is made from a run, and how a thing is found in it. A thing that a view must have and
has not is an error of the pair."""

import csv
import json
import subprocess
import sys

PYTHON = """
import json, sys, troupe
sim = troupe.Simulation(sys.argv[1])
sim.step(int(sys.argv[2]))
print(json.dumps({"tables": {name: list(sim.table(name).get("name", ())) for name in sim.tables},
                  "models": list(sim.robots), "hash": f"{sim.state_hash:016x}"}))
"""


class Output:
    """What `troupe run` has written of a world of the rows."""

    def __init__(self, program, folder, name, environment):
        self.program, self.folder, self.name, self.environment = program, folder, name, environment

    def path(self, ending):
        return self.folder / f"{self.name}{ending}"

    def troupe(self, *words, status=0):
        return self.program.run(*words, status=status)


def rows_of_csv(path):
    with open(path, newline="") as file:
        return list(csv.reader(file))


def hash_log(output, ticks):
    lines = output.path(".hashes").read_text().splitlines()
    assert len(lines) == ticks + 1, f"found {len(lines)} lines, expected {ticks + 1}"
    return lambda thing: True


def poses(output, ticks):
    rows = rows_of_csv(output.path(".poses"))
    assert rows[-1][0] == str(ticks), f"the last line is of tick {rows[-1][0]}, expected {ticks}"
    names = {row[1] for row in rows[1:]}
    return lambda thing: thing.row in names


def scans(output, ticks):
    lines = [json.loads(line) for line in output.path(".scans").read_text().splitlines()]
    assert max(line["tick"] for line in lines) == ticks - 1, "the last tick has no readings"
    robots = {line["robot"] for line in lines}
    return lambda thing: thing.row.split(".")[0] in robots


def json_lines(output, ticks):
    lines = [json.loads(line) for line in output.path(".jsonl").read_text().splitlines()]
    assert lines[-1]["tick"] == ticks
    header = lines[0]
    names = {name for key in ("robots", "joints", "grippers", "objects") for name in header.get(key, ())}
    tables = header.get("tables", {})
    listed = {(table, name) for table, content in tables.items() for name in content["names"]}

    def has(thing):
        if thing.table == "lanes":
            return bool(tables.get("lanes", {}).get("names"))
        if thing.table == "grippers":  # by the model that it is at
            return any(name.startswith(thing.row) for name in names)
        return thing.row in names or (thing.table, thing.row) in listed

    return has


def replay(output, ticks):
    output.troupe("replay", output.path(".mcap"), "--verify", "--controllers", "--hash-log", output.path(".replayed"))
    assert output.path(".replayed").read_text() == output.path(".hashes").read_text(), "the replay has other hashes"
    return lambda thing: True


def tables(output, ticks):
    folder = output.path(".tables")
    output.troupe("export", output.path(".mcap"), "--format", "csv", "-o", folder)

    def has(thing):
        rows = rows_of_csv(folder / ("poses.csv" if thing.table == "robots" else f"{thing.table}.csv"))
        return len(rows) > 1 if not thing.row else any(row[2] == thing.row for row in rows[1:])

    return has


def _exported(ending, output, form):
    path = output.path(ending)
    output.troupe("export", output.path(".mcap"), "--format", form, "-o", path)
    content = path.read_bytes()
    return lambda thing: f"/tables/{thing.table}".encode() in content  # in the summary of the file


def foxglove(output, ticks):
    return _exported(".foxglove.mcap", output, "foxglove")


def ros_bag(output, ticks):
    return _exported(".ros2.mcap", output, "ros2")


def expectations(output, ticks):
    """All expectations of the test, in its run and on the recording."""
    text = output.troupe("test", output.path(".test.json"), "--on", output.path(".mcap"))
    return lambda thing: not thing.holds or f"holds {thing.name}:" in text


def picture(output, ticks):
    for ending in ("png", "svg"):
        output.troupe("snapshot", output.path(".mcap"), "--rays", "--tick", ticks, "-o", output.path(f".{ending}"))
        assert output.path(f".{ending}").stat().st_size > 500
    return lambda thing: True


def python(output, ticks):
    found = subprocess.run([sys.executable, "-c", PYTHON, output.path(".json"), str(ticks)], capture_output=True, text=True,
                           env=output.environment, check=False)
    assert found.returncode == 0, found.stderr.strip().splitlines()[-1]
    content = json.loads(found.stdout)
    last = output.path(".hashes").read_text().splitlines()[-1].split()[1]
    assert content["hash"] == last, f"found the hash {content['hash']}, expected {last}"
    return lambda thing: thing.row in content["tables"][thing.table] if thing.row else bool(content["tables"][thing.table])


MAKERS = {"hash log": hash_log, "poses": poses, "scans": scans, "JSON lines": json_lines, "replay": replay, "CSV": tables,
          "Foxglove": foxglove, "ROS bag": ros_bag, "expectations": expectations, "picture": picture, "Python": python}
