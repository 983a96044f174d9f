#!/usr/bin/python3
"""The shipped scenarios do not grind: in half an hour a robot seldom stalls, less than once in ten minutes, and none waits for long.

Prints a table of Markdown: robots, stalls per robot and minute, the longest wait of a robot on its way to a goal (s), arrivals on lanes.

usage: stalls_test.py --programs FOLDER [--ticks N] [SCENARIO ...]     default: 18000 ticks, half an hour; all scenarios
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

SCENARIOS = pathlib.Path(__file__).resolve().parents[2] / "worlds" / "scenarios"
MOST = 0.1  # stalls per robot and minute
LONGEST = 600.0  # s, of a wait: a door of a restaurant among its guests, a lift for which several robots wait
# A robot without rangers, for which a contact is what a range is for others, and those that it runs into.
BY_CONTACT = {"sensors"}

parser = argparse.ArgumentParser()
parser.add_argument("--programs", type=pathlib.Path, required=True)
parser.add_argument("--ticks", type=int, default=18000)
parser.add_argument("scenarios", nargs="*")
arguments = parser.parse_args()

wrong = []
with tempfile.TemporaryDirectory() as folder:
    summary_file = pathlib.Path(folder) / "summary.json"
    for name in arguments.scenarios or sorted(path.stem for path in SCENARIOS.glob("*.json")):
        if name in BY_CONTACT:
            continue
        subprocess.run([arguments.programs / "troupe", "run", SCENARIOS / f"{name}.json", "--in-process", "--headless",
                        "--speed", "max", "--ticks", str(arguments.ticks), "--threads", "1", "--summary", summary_file],
                       capture_output=True, check=True)
        summary = json.loads(summary_file.read_text())
        rate = summary["stalls"] / summary["robots"] / (summary["sim_seconds"] / 60.0)
        longest = max((place["longest"] for place in summary["waits"]), default=0.0)
        arrivals = summary["traffic"]["arrivals"] if summary["traffic"] else 0
        print(f"| {name} | {summary['robots']} | {rate:.3f} | {longest:.0f} | {arrivals} |", flush=True)
        if rate < MOST and longest < LONGEST:
            continue
        wrong.append(name)
        most = sorted(summary["robot_totals"], key=lambda robot: -robot["stalls"])[:3]
        print(*(f"{robot['robot']} {robot['stalls']} stalls ({' '.join(robot['contacts'])})" for robot in most), sep="; ", flush=True)
        print(*(f"{place['place']} {place['longest']:.0f} s" for place in sorted(summary["waits"], key=lambda place: -place["longest"])[:3]),
              sep="; ", flush=True)
assert not wrong, (f"these grind or wait: {', '.join(wrong)}; expected less than {MOST} stalls per robot and minute, "
                   f"and no wait of {LONGEST:.0f} s")
