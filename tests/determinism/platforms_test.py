"""The scenarios of scenario_hash_test in a WebAssembly module, in node: the hashes and the readings of all sensors at every
tick are those of the host, byte by byte. Builds the preset wasm where emscripten is there.

    webassembly_test.py FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
"""

import itertools
import pathlib
import re
import shutil
import subprocess
import sys

SKIPPED = 77


def golden_scenarios(source):
    """Names of files in worlds/scenarios, and ticks."""
    test = (source / "tests/determinism/scenario_hash_test.cc").read_text()
    found = re.findall(r'(?:HashAfter|StateAfter)\("(\w+\.json)", (\d+)\)', test)
    assert len(found) >= 8, found
    return [(name, int(ticks)) for name, ticks in found]


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit status {done.returncode}\n{done.stdout}{done.stderr}")


def first_difference(found, expected, ticks):
    """The line of two files, from 1; None: they are equal. The module measures in the last state, too, the host does not."""
    with open(found) as a, open(expected) as b:
        lines = itertools.zip_longest(a, b, fillvalue="")
        for number, (x, y) in enumerate(lines, 1):
            if x != y and (y or f'"tick":{ticks},' not in x):
                return f"line {number}: found {x[:200]!r}, expected {y[:200]!r}"
    return None


def main():
    programs, source, files = (pathlib.Path(path).resolve() for path in sys.argv[1:4])
    if not shutil.which("em++"):
        print("no emscripten (scripts/setup emscripten node-acorn libstb-dev)")
        return SKIPPED
    files.mkdir(parents=True, exist_ok=True)
    run("cmake", "--preset", "wasm", cwd=source)
    run("cmake", "--build", "--preset", "wasm", "--target", "troupe-core", "-j", "2", cwd=source)
    module = source / "build/wasm/bin"
    print(f"module: {(module / 'troupe-core.wasm').stat().st_size} bytes")

    failures = 0
    for name, ticks in golden_scenarios(source):
        scenario = source / "worlds/scenarios" / name
        logs = {side: (files / f"{name}.{side}.hashes", files / f"{name}.{side}.scans") for side in ("host", "wasm")}
        run(programs / "troupe", "run", scenario, "--in-process", "--headless", "--ticks", ticks,
            "--hash-log", logs["host"][0], "--scans", logs["host"][1])
        run("node", module / "troupe-core.mjs", scenario, ticks, *logs["wasm"])
        lines = sum(1 for _ in open(logs["host"][0]))
        for what, found, expected in zip(("hashes", "readings"), logs["wasm"], logs["host"]):
            difference = first_difference(found, expected, ticks)
            if lines <= ticks:
                difference = f"found {lines} hashes of the host, expected {ticks + 1}"
            failures += difference is not None
            print(f"{name}, {ticks} ticks: {what} {difference or 'equal'}")
    return 1 if failures else 0


sys.exit(main())
