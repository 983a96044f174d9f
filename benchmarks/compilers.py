#!/usr/bin/env python3
"""Compares the speed of the simulation by gcc with that by clang and in WebAssembly (node): the processor time in user
mode of troupe-core, one thread, without readings, in alternation. A figure is the time per robot and tick, from the
difference of a long run and a short one, so that start and end do not count.

    compilers.py WORLD ROBOTS TICKS [--rounds N] [--gcc FOLDER_OF_BUILD]

Builds: the target troupe-core of the presets gcc and ci, and the preset wasm; what is not built is left out.
"""
import argparse
import filecmp
import pathlib
import resource
import statistics
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHORT = 50  # ticks


def user_seconds(command, world, ticks, log):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([*command, world, str(ticks), log], check=True, stdout=subprocess.DEVNULL)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def text(values, digits):
    return f"{statistics.median(values):.{digits}f} ({min(values):.{digits}f} to {max(values):.{digits}f})"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("world")
    parser.add_argument("robots", type=int)
    parser.add_argument("ticks", type=int)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--gcc", type=pathlib.Path, default=ROOT / "build/gcc")
    arguments = parser.parse_args()
    programs = {"gcc": (arguments.gcc / "bin/troupe-core", []), "clang": (ROOT / "build/ci/bin/troupe-core", []),
                "WebAssembly": (ROOT / "build/wasm/bin/troupe-core.mjs", ["node"])}
    commands = {name: [*before, str(path)] for name, (path, before) in programs.items() if path.exists()}
    times = {name: [] for name in commands}
    with tempfile.TemporaryDirectory(prefix="troupe-compilers-") as folder:
        for _ in range(arguments.rounds):
            for name, command in commands.items():
                short, long = (user_seconds(command, arguments.world, ticks, f"{folder}/{name}")
                               for ticks in (SHORT, arguments.ticks))
                times[name].append(1e6 * (long - short) / (arguments.robots * (arguments.ticks - SHORT)))
        for name in commands:
            if not filecmp.cmp(f"{folder}/gcc", f"{folder}/{name}", shallow=False):
                raise SystemExit(f"error: the state hashes of {name} differ from those of gcc")
    for name, found in times.items():
        ratios = [time / gcc for time, gcc in zip(found, times["gcc"])]
        print(f"{name}: {text(found, 2)} us per robot and tick, {text(ratios, 2)} times gcc")


main()
