#!/usr/bin/env python3
"""Measures and prints the tables of docs/performance.md. scripts/bench builds first, and then runs this.

    run.py [SCENE ...] [--quick] [--rounds N] [--stage PATH] [--argos PATH] [--mvsim PATH] [--output FOLDER]

Scenes: functions, barrier, observers, processes, requests, cases, robots, memory, cave, additions, swarm, peers,
scenarios, site_map; all of them without names. Each writes FOLDER/SCENE.csv; what a scene wrote before stays until it is measured again, so
that scenes can be measured one by one.
"""
import argparse
import os
import pathlib
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "scripts"))
from runner import machine, plots, report, scenes  # noqa: E402
from runner.programs import Stage, Troupe  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent


def parse():
    parser = argparse.ArgumentParser(prog="scripts/bench", description="Measures; see docs/performance.md.")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of {', '.join(scenes.ALL)}; default: all")
    parser.add_argument("--quick", action="store_true", help="a short pass with few robots, to see that all works")
    parser.add_argument("--rounds", type=int, default=5, help="how often each measurement is made (default: 5)")
    parser.add_argument("--stage", metavar="PATH", help="the program stage of Stage 4.3, to compare with")
    parser.add_argument("--argos", metavar="PATH", help="the program argos3 of ARGoS 3, with its headers (scene peers)")
    parser.add_argument("--mvsim", metavar="PATH", help="the program mvsim of MVSim, with its headers (scene peers)")
    parser.add_argument("--stage-worlds", metavar="FOLDER", help="with benchmark/cave.world; default: "
                        "$TROUPE_STAGE_WORLDS, or shared/stage-worlds beside the checkout")
    parser.add_argument("--programs", metavar="FOLDER", default=ROOT / "build/release/bin")
    parser.add_argument("--output", metavar="FOLDER", default=ROOT / "build/bench", type=pathlib.Path)
    parser.add_argument("--report", action="store_true", help="no measurement: tables of the last measurements")
    parser.add_argument("--document", metavar="FILE", help="write tables and plots into docs/performance.md, or a copy of it")
    options = parser.parse_args()
    for name in options.scenes:
        if name not in scenes.ALL:
            parser.error(f"found scene '{name}', expected one of {', '.join(scenes.ALL)}")
    if options.rounds < 1:
        parser.error("found --rounds below 1")
    return options


def stage_worlds(options):
    for folder in [options.stage_worlds, os.environ.get("TROUPE_STAGE_WORLDS"), ROOT.parent / "shared/stage-worlds"]:
        if folder and (pathlib.Path(folder) / "benchmark/cave.world").exists():
            return pathlib.Path(folder).absolute()
    print("no Stage worlds: the cave is left out")
    return None


def main():
    options = parse()
    options.output.mkdir(parents=True, exist_ok=True)
    failed = False
    if not options.report:
        (options.output / "machine.txt").write_text(machine.describe() + "\n")
        with tempfile.TemporaryDirectory(prefix="troupe-bench-") as folder:
            setting = scenes.Setting(Troupe(options.programs), Stage(options.stage) if options.stage else None,
                                     stage_worlds(options), folder, options.quick, options.rounds,
                                     {"stage": options.stage, "argos": options.argos, "mvsim": options.mvsim})
            for name in options.scenes or scenes.ALL:
                print(f"{name}: {scenes.ALL[name].__doc__}", flush=True)
                rows, failure = scenes.measure(name, setting)
                if rows:
                    report.write(options.output, name, rows)
                if failure:
                    failed = True
                    print(f"error: {failure}", file=sys.stderr)
    print("", report.text_of_targets(options.output), report.text_of_growth(options.output),
          report.text_of_peers(options.output), sep="\n\n")
    drawn = plots.draw_all(options.output)
    for path in drawn:
        print(f"drawn: {path}")
    if options.document:
        report.write_into(options.document, options.output, drawn)
    return 3 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
