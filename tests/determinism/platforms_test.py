"""The same worlds on other platforms: the hashes of the state and the readings of all sensors at every tick are those
of the programs under test, byte by byte.

    platforms_test.py FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
                      [--platforms gcc,arm64,wasm] [--cases golden,worlds,random] [--seeds FIRST,COUNT]

Platforms: the target troupe-core of the preset gcc, and the program troupe of arm64 in qemu, where they are built; the
preset wasm in node, which is built here where emscripten is. Cases: the scenarios of scenario_hash_test; all other worlds
of the project, and those of Stage's, for fewer ticks; random scenarios (random_scenario.py), whose seeds are in their
names.
"""

import argparse
import itertools
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

from random_scenario import write_random_scenarios

SKIPPED = 77
TICKS = 100
# Worlds whose logs are long, because they have cameras and scanners with many rays.
FEW_TICKS = {"lab_views.json": 2, "sensors.json": 20, "sensors.world": 20, "swarm.json": 50, "cave.world": 50}


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit status {done.returncode}\n{done.stdout}{done.stderr}")


class Programs:
    """The program troupe or troupe-core of a build, perhaps in an emulator."""

    def __init__(self, preset, program, emulator=()):
        self.preset, self.program, self.emulator = preset, program, emulator

    def obstacle(self):
        if self.emulator and not shutil.which(self.emulator[0]):
            return f"no {self.emulator[0]} (scripts/setup-arm64)"
        return "" if self.program.exists() else f"no build of the preset {self.preset}"

    def run(self, world, ticks, hashes, scans):
        if self.program.name == "troupe-core":
            run(self.program, world, ticks, hashes, scans)
            return
        run(*self.emulator, self.program, "run", world, "--in-process", "--headless", "--ticks", ticks,
            "--hash-log", hashes, "--scans", scans)


class Module:
    """The WebAssembly module, in node."""

    def __init__(self, source):
        self.source, self.built = source, False

    def obstacle(self):
        sources = self.source / "build/wasm-root/yaml-cpp"
        return "" if shutil.which("em++") and sources.exists() else "no emscripten (scripts/setup-wasm)"

    def run(self, world, ticks, hashes, scans):
        folder = self.source / "build/wasm/bin"
        if not self.built:
            run("cmake", "--preset", "wasm", cwd=self.source)
            run("cmake", "--build", "--preset", "wasm", "--target", "troupe-core", "-j", "2", cwd=self.source)
            self.built = True
            print(f"module: {(folder / 'troupe-core.wasm').stat().st_size} bytes")
        run("node", folder / "troupe-core.mjs", world, ticks, hashes, scans)


def platforms(source):
    builds = source / "build"
    return {"gcc": Programs("gcc", builds / "gcc/bin/troupe-core"),
            "arm64": Programs("arm64", builds / "arm64/bin/troupe",
                              ("qemu-aarch64-static", "-L", builds / "arm64-root")),
            "wasm": Module(source)}


def golden_cases(source):
    test = (source / "tests/determinism/scenario_hash_test.cc").read_text()
    found = re.findall(r'(?:HashAfter|StateAfter)\("([\w./]+\.json)", (\d+)\)', test)
    assert len(found) >= 11, found
    return [((source / "worlds/scenarios" / name).resolve(), int(ticks)) for name, ticks in found]


def world_cases(source):
    golden = {world for world, _ in golden_cases(source)}
    stage = pathlib.Path(os.environ.get("TROUPE_STAGE_WORLDS") or source.parent / "shared/stage-worlds")
    if not stage.exists():
        print("SKIPPED stage: no Stage worlds")
    found = [*source.glob("worlds/scenarios/*.json"), *source.glob("worlds/*.world"),
             *source.glob("worlds/sites/*.json"), *source.glob("worlds/sites/*.yaml"), *stage.glob("**/*.world")]
    assert len(found) >= 20, found
    return [(world, FEW_TICKS.get(world.name, TICKS)) for world in sorted(found) if world not in golden]


def random_cases(files, first, count):
    return ((world, 2 * TICKS) for world in write_random_scenarios(files, first, count))


def first_difference(found, expected, ticks):
    """The line of two files, from 1; None: they are equal. The module measures in the last state, too."""
    # Without a sensor no log is written.
    with open(found if found.exists() else os.devnull) as a, open(expected if expected.exists() else os.devnull) as b:
        lines = itertools.zip_longest(a, b, fillvalue="")
        for number, (x, y) in enumerate(lines, 1):
            if x != y and (y or f'"tick":{ticks},' not in x):
                return f"line {number}: found {x[:200]!r}, expected {y[:200]!r}"
    return None


def differences(name, world, ticks, expected, platform, files):
    """What differs from the expected logs, and the processor time of the platform in s."""
    logs = [files / f"{world.name}.{name}.{kind}" for kind in ("hashes", "scans")]
    for log in logs:
        log.unlink(missing_ok=True)
    before = os.times()
    platform.run(world, ticks, *logs)
    after = os.times()
    seconds = after.children_user + after.children_system - before.children_user - before.children_system
    found = [f"{log.suffix[1:]}: {difference}" for log, other in zip(logs, expected)
             if (difference := first_difference(log, other, ticks))]
    if not found:
        for log in logs:
            log.unlink(missing_ok=True)  # hundreds of megabytes
    return found, seconds


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("files", type=pathlib.Path)
    parser.add_argument("--platforms", default="gcc,arm64,wasm")
    parser.add_argument("--cases", default="golden,worlds,random")
    parser.add_argument("--seeds", default="1,12", metavar="FIRST,COUNT")
    arguments = parser.parse_args()
    programs, source, files = (path.resolve() for path in (arguments.programs, arguments.source, arguments.files))
    files.mkdir(parents=True, exist_ok=True)
    chosen = {name: platforms(source)[name] for name in arguments.platforms.split(",")}
    for name, platform in list(chosen.items()):
        if obstacle := platform.obstacle():
            print(f"SKIPPED {name}: {obstacle}")
            del chosen[name]
    if not chosen:
        return SKIPPED
    makers = {"golden": lambda: golden_cases(source), "worlds": lambda: world_cases(source),
              "random": lambda: random_cases(files, *map(int, arguments.seeds.split(",")))}
    cases = itertools.chain.from_iterable(makers[kind]() for kind in arguments.cases.split(","))

    here = Programs("", programs / "troupe")
    failures = 0
    began = time.monotonic()
    for world, ticks in cases:
        expected = [files / f"{world.name}.here.{kind}" for kind in ("hashes", "scans")]
        for log in expected:
            log.unlink(missing_ok=True)
        here.run(world, ticks, *expected)
        with open(expected[0]) as log:
            lines = sum(1 for _ in log)
        results = [] if lines == ticks + 1 else [f"found {lines} hashes, expected {ticks + 1}"]
        equal = []
        for name, platform in chosen.items():
            found, seconds = differences(name, world, ticks, expected, platform, files)
            results += [f"{name}: {difference}" for difference in found]
            if not found:
                equal.append(f"{name} ({seconds:.1f} s)")
        failures += bool(results)
        size = expected[1].stat().st_size if expected[1].exists() else 0
        verdict = "; ".join(results) or "equal"
        print(f"{world.name}, {ticks} ticks, {size} bytes of readings: {verdict}: {', '.join(equal)}", flush=True)
        expected[1].unlink(missing_ok=True)
    print(f"{time.monotonic() - began:.0f} s")
    return 1 if failures else 0


sys.exit(main())
