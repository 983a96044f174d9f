"""What the tests of the package share: places, programs, and hash logs."""
import os
import pathlib
import subprocess

ROOT = pathlib.Path(os.environ["TROUPE_SOURCE_DIR"])
PROGRAMS = pathlib.Path(os.environ["TROUPE_BINARY_DIR"]) / "bin"
SCENARIOS = ROOT / "worlds/scenarios"
SWARM = SCENARIOS / "swarm.json"
LAB = SCENARIOS / "lab.json"


def run(*arguments, check=True, **options):
    """Runs `troupe run`, and returns the finished process."""
    command = [PROGRAMS / "troupe", "run", *map(str, arguments), "--headless"]
    done = subprocess.run(command, text=True, capture_output=True, timeout=100, **options)
    if check and done.returncode != 0:
        raise AssertionError(f"{command}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done


def hashes(file):
    """By tick, from a hash log."""
    with open(file) as lines:
        return {int(tick): int(digest, 16) for tick, digest in map(str.split, lines)}


def logged(scenario, folder, *arguments):
    """The hashes of a run by `troupe run`."""
    log = os.path.join(folder, "hashes")
    run(scenario, "--speed", "max", "--hash-log", log, *arguments)
    return hashes(log)
