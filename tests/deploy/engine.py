"""For the trials of deploy/ with real engines: programs that are there or not, processes that end, files to compare."""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DEPLOY = ROOT / "deploy"
SKIPPED = 77


class Wrong(Exception):
    pass


def require(holds, text):
    if not holds:
        raise Wrong(text)


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def skip_without(programs, packages):
    """Ends the trial if root or a program is missing."""
    if os.geteuid() != 0:
        skip("the engine runs as root only")
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    missing = [program for program in programs if shutil.which(program) is None]
    if missing:
        skip(f"no {', '.join(missing)}; scripts/setup {packages} installs them")


def run(*command, **options):
    """The output of a program that has to succeed."""
    done = subprocess.run([*map(str, command)], stdin=subprocess.DEVNULL, capture_output=True, text=True, **options)
    require(done.returncode == 0,
            f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def await_that(condition, seconds, text, process=None):
    """Waits until the condition holds, at most so long, and while the process lives."""
    deadline = time.monotonic() + seconds
    while not condition():
        require(process is None or process.poll() is None, f"{text}: the program has ended")
        require(time.monotonic() < deadline, f"{text}: not within {seconds} s")
        time.sleep(0.1)


def terminate(processes):
    """Ends processes that this program has started, the last one first."""
    for process in reversed(processes):
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
    for process in reversed(processes):
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def require_same_files(found, expected):
    """Two folders with the same files, byte for byte."""
    names = sorted(path.name for path in expected.iterdir())
    others = sorted(path.name for path in found.iterdir())
    require(names == others, f"{found} has {others}, expected {names}")
    for name in names:
        require((found / name).read_bytes() == (expected / name).read_bytes(),
                f"{found / name} differs from {expected / name}")


def main(trial):
    """Runs the trial; status 1 if something is wrong."""
    try:
        trial()
    except Wrong as problem:
        print(f"FAILED: {problem}")
        sys.exit(1)
    print("passed")
