#!/usr/bin/python3
"""The fleet control of examples/fleet_control drives vehicles of a run in a generated warehouse: pallets come where the jobs say,
nothing touches anything, and neither side breaks a rule.

usage: fleet_warehouse_test.py --programs FOLDER [--vehicles N] [--jobs N] [--speed X]
"""
import argparse
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parent))
from mqtt_broker import Broker, Listener  # noqa: E402

EXAMPLE = HERE.parents[2] / "examples/fleet_control"


def final_places(folder, troupe):
    """Of the pallets at the end of the recording, m."""
    subprocess.run([troupe, "export", folder / "run.mcap", "--format", "csv", "-o", folder / "tables"], check=True, capture_output=True)
    with open(folder / "tables/objects.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {row["object"]: (float(row["x"]), float(row["y"])) for row in rows if row["object"].startswith("pallet")}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True, type=pathlib.Path)
    parser.add_argument("--vehicles", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=3)
    parser.add_argument("--speed", default="20")
    arguments = parser.parse_args()
    troupe = arguments.programs / "troupe"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([sys.executable, EXAMPLE / "make_warehouse.py", folder, "--vehicles", str(arguments.vehicles), "--jobs",
                        str(arguments.jobs), "--doors"], check=True)
        jobs = [json.loads(line) for line in (folder / "warehouse.jobs").read_text().splitlines()]
        with Broker(folder) as broker, Listener(troupe, "fleet", "check", "--vda5050", broker.url) as checker:
            checker.wait_for("listening at ")
            with Listener(troupe, "run", folder / "warehouse.json", "--vda5050", broker.url, "--headless", "--in-process", "--speed",
                          arguments.speed, "--record", folder / "run.mcap") as run:
                with Listener(sys.executable, EXAMPLE / "fleet_control.py", folder / "warehouse.lif.json", "--broker", broker.url, "--jobs",
                              folder / "warehouse.jobs", "--vehicles", str(arguments.vehicles), "--clearance", "1.1") as control:
                    control.wait_for(" jobs done, ")
                    status, lines = control.finish(interrupt=False)
                assert status == 0 and lines[-1] == f"{len(jobs)} of {len(jobs)} jobs done, 0 failed", lines
                status, lines = run.finish()
                assert status == 130 and any("0 stalls" in line for line in lines), lines[-10:]
            status, lines = checker.finish()
        assert status == 130 and sum(line.endswith("no violation") for line in lines) == arguments.vehicles, lines
        # The recording has the same messages.
        done = subprocess.run([troupe, "fleet", "check", folder / "run.mcap"], capture_output=True, text=True, check=False)
        assert done.returncode == 0 and done.stdout.count("no violation") == arguments.vehicles, done
        layout = json.loads((folder / "warehouse.lif.json").read_text())["layouts"][0]
        racks = {station["stationId"]: station["stationPosition"] for station in layout["stations"]}
        last = {job["to"] for i, job in enumerate(jobs) if all(job["to"] != later["from"] for later in jobs[i:])}
        pallets = final_places(folder, troupe).values()
        for rack in last:
            near = min(math.dist((racks[rack]["x"], racks[rack]["y"]), pallet) for pallet in pallets)
            assert near < 0.7, f"the nearest pallet is {near:.2f} m from {rack}"


main()
