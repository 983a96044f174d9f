"""What the tests of the package share: places, programs, and hash logs."""
import os
import pathlib
import signal
import subprocess
import sys

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


def interrupted(test, code):
    """(output, exit status) of a program in Python that prints "on", and then gets Ctrl-C, which is a KeyboardInterrupt to it."""
    # Shells start background jobs with the signal ignored.
    code = "import signal, troupe; signal.signal(signal.SIGINT, signal.default_int_handler)\n" + code
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    test.addCleanup(child.kill)
    test.assertEqual(child.stdout.readline(), "on\n")
    child.send_signal(signal.SIGINT)
    out, _ = child.communicate(timeout=60)
    return out, child.returncode


def logged(scenario, folder, *arguments):
    """The hashes of a run by `troupe run`."""
    log = os.path.join(folder, "hashes")
    run(scenario, "--speed", "max", "--hash-log", log, *arguments)
    return hashes(log)
