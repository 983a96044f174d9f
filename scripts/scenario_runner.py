"""Runs the launcher. For scripts/scale and scripts/same-hash."""
import json
import subprocess
import sys


class Runner:
    """Runs the launcher, one run at a time."""

    def __init__(self, programs, folder, verbose):
        self.programs = programs
        self.folder = folder
        self.verbose = verbose
        self.process = None

    def run(self, name, scenario, options, watch=None):
        """The summary of a run and the file with its hashes. Calls watch(pid of the launcher) meanwhile."""
        scenario_file = self.folder / f"{name}.json"
        scenario_file.write_text(json.dumps(scenario, indent=1))
        hashes, summary, log = (self.folder / f"{name}.{kind}" for kind in ("hashes", "summary", "log"))
        command = [str(self.programs / "troupe"), "run", str(scenario_file), "--headless", "--speed", "max",
                   "--hash-log", str(hashes), "--summary", str(summary), *map(str, options)]
        if self.verbose:
            print(" ".join(command), file=sys.stderr)
        with open(log, "w") as output:
            # No input: the launcher must not read keys of the terminal that this script runs in.
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output,
                                            stderr=subprocess.STDOUT)
            while watch and self.process.poll() is None:
                watch(self.process.pid)
                try:
                    self.process.wait(0.02)
                except subprocess.TimeoutExpired:
                    pass
            status = self.process.wait()
            self.process = None
        if self.verbose or status != 0:
            print(log.read_text(), file=sys.stderr)
        if status != 0:
            raise RuntimeError(f"the run '{name}' ended with status {status}")
        return json.loads(summary.read_text()), hashes

    def stop(self):
        if self.process is None:
            return
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
