"""The views of the rows: how each is made from a run, and how a thing is found in it. A thing that a view must have and
has not is an error of the pair."""

import base64
import csv
import gzip
import html
import json
import re
import subprocess
import sys

from live import Refused

PYTHON = """
import json, sys, troupe
last = troupe.Recording(sys.argv[3])[-1]
if sys.argv[2] == "None":
    sim = last
else:
    sim = troupe.Simulation(sys.argv[1])
    sim.step(int(sys.argv[2]))
print(json.dumps({"tables": {name: list(sim.table(name).get("name", ())) for name in sim.tables},
                  "hashes": [f"{state.state_hash:016x}" for state in (sim, last)]}))
"""
TEXT = "<script type=\"text/plain\" id=\"static-content\">([^<]*)<"


class Output:
    """What `troupe run FILE` has written as BASE.*; `test`: of the same world."""

    def __init__(self, program, folder, base, file="all.json", test="all.test.json"):
        self.program, self.folder, self.base, self.file, self.test = program, folder, base, file, test

    def path(self, ending):
        return self.folder / f"{self.base}{ending}"

    def troupe(self, *words, status=0):
        return self.program.run(*words, status=status)


def rows_of_csv(path):
    with open(path, newline="") as file:
        return list(csv.reader(file))


def hash_log(output, ticks):
    lines = output.path(".hashes").read_text().splitlines()
    assert ticks is None or len(lines) == ticks + 1, f"found {len(lines)} lines, expected {ticks + 1}"
    return lambda thing: True


def poses(output, ticks):
    rows = rows_of_csv(output.path(".poses"))
    assert len(rows) == 1 or ticks is None or rows[-1][0] == str(ticks), f"the last line is of tick {rows[-1][0]}, expected {ticks}"
    names = {row[1] for row in rows[1:]}
    return lambda thing: thing.row in names


def scans(output, ticks):
    lines = [json.loads(line) for line in output.path(".scans").read_text().splitlines()]
    assert not lines or ticks is None or max(line["tick"] for line in lines) == ticks - 1, "the last tick has no readings"
    robots = {line.get("robot") for line in lines}  # a line of an edit has none
    return lambda thing: thing.row.split(".")[0] in robots


def json_lines(output, ticks):
    lines = [json.loads(line) for line in output.path(".jsonl").read_text().splitlines()]
    assert ticks is None or lines[-1]["tick"] == ticks
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
    controllers = [] if ticks is None else ["--controllers"]  # of a run without edits
    output.troupe("replay", output.path(".mcap"), "--verify", *controllers, "--hash-log", output.path(".replayed"))
    logs = [output.path(ending).read_text() for ending in (".replayed", ".hashes")]
    assert logs[0] == logs[1] or (ticks is None and logs[0].endswith(logs[1])), "the replay has other hashes"  # of a branch
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


def judged(output, ticks, *more):
    """A run of another number of ticks may fail."""
    words = ("test", output.test, "--on", output.path(".mcap"), *more)
    status, text = output.program.finish(*words)
    if status == 2 and ticks is None and "expected a run without edits" in text:
        raise Refused(text.strip().replace(str(output.path(".mcap")), "'RECORDING'"))
    assert status == 0 or (status == 1 and ticks is None), f"{words}: status {status}: {text}"
    return text


def expectations(output, ticks):
    """All expectations of the test on the recording."""
    text = judged(output, ticks)
    return lambda thing: not thing.holds or f"holds {thing.name}:" in text


def report(output, ticks):
    judged(output, ticks, "--report", output.path(".report"))
    text = html.unescape((output.path(".report") / "index.html").read_text())
    return lambda thing: not thing.holds or thing.holds in text


def static_page(output, ticks):
    """What the document has, without the module that computes it."""
    module = output.folder / "module"
    module.mkdir(exist_ok=True)
    for name in ("troupe-core.wasm", "troupe-core.js", "page_worker.js"):
        (module / name).write_text("none")
    output.troupe("view", "--static", output.path(".mcap"), "--module", module, "-o", output.path(".html"))
    content = gzip.decompress(base64.b64decode(re.search(TEXT, output.path(".html").read_text())[1]))
    return lambda thing: (thing.row or thing.mark).encode() in content


def picture(output, ticks):
    for ending in ("png", "svg"):
        tick = [] if ticks is None else ["--tick", ticks]
        output.troupe("snapshot", output.path(".mcap"), "--rays", *tick, "-o", output.path(f".{ending}"))
        assert output.path(f".{ending}").stat().st_size > 500
    return lambda thing: True


def python(output, ticks):
    """A run of its own, which ends as the recorded one, and the recording; of one with edits only that."""
    found = subprocess.run([sys.executable, "-c", PYTHON, output.file, str(ticks), output.path(".mcap")], capture_output=True,
                           text=True, cwd=output.folder, env=output.program.environment, check=False)
    assert found.returncode == 0, found.stderr.strip().splitlines()[-1]
    content = json.loads(found.stdout)
    assert len(set(content["hashes"])) == 1, f"the hashes are {content['hashes']}"
    return lambda thing: thing.row in content["tables"][thing.table] if thing.row else bool(content["tables"][thing.table])


MAKERS = {"hash log": hash_log, "poses": poses, "scans": scans, "JSON lines": json_lines, "replay": replay, "CSV": tables,
          "Foxglove": foxglove, "ROS bag": ros_bag, "expectations": expectations, "report": report, "picture": picture,
          "static page": static_page, "Python": python}
