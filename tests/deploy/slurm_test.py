#!/usr/bin/env python3
"""deploy/slurm on a real Slurm of two nodes, which are network namespaces of this machine; needs root and the packages
slurmctld, slurmd, slurm-client and munge. It ends all that it has started.

    tests/deploy/slurm_test.py PROGRAMS [FOLDER]

A sweep in four tasks of an array, merged, has the files of the sweep of one process, byte for byte. A run over both nodes
with a process for each robot has the hashes of a run in one process.
"""
import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile

from engine import (DEPLOY, ROOT, await_that, main, require, require_same_files, run, skip, skip_without, terminate)

sys.path.insert(0, str(ROOT / "scripts"))
from virtual_network import Network, obstacle_to_hosts  # noqa: E402

PACKAGES = "slurmctld slurmd slurm-client munge"
TEST = ROOT / "examples/fleet_tests/relay.test.json"
TICKS = 60
ROBOTS = 6


class Cluster:
    """munged, slurmctld and two slurmd."""

    def __init__(self, folder):
        self.folder = folder
        self.started = []
        self.network = Network(2, name="s")
        try:
            self.start()
        except BaseException:
            self.remove()
            raise

    def daemon(self, host, *command):
        log = open(self.folder / f"{pathlib.Path(command[0]).name}-{host}.log", "w")
        process = subprocess.Popen(self.on(host, *command), stdin=subprocess.DEVNULL, stdout=log,
                                   stderr=subprocess.STDOUT, env=self.environment())
        self.started.append(process)
        return process

    def environment(self):
        return os.environ | {"SLURM_CONF": str(self.folder / "slurm.conf")}

    def start(self):
        key, munge = self.folder / "munge.key", self.folder / "munge.socket"
        run("mungekey", "--create", f"--keyfile={key}")
        munged = self.daemon("h1", "munged", "--foreground", "--force", f"--key-file={key}", f"--socket={munge}",
                             f"--pid-file={self.folder}/munge.pid", f"--seed-file={self.folder}/munge.seed",
                             f"--log-file={self.folder}/munge.log")
        await_that(munge.exists, 60, "munged listens", munged)

        name = socket.gethostname()
        nodes = "\n".join(f"NodeName={host} NodeHostname={name} NodeAddr={self.network.address(host)} CPUs=2 "
                          "State=UNKNOWN" for host in self.network.hosts)
        (self.folder / "slurm.conf").write_text(f"""ClusterName=troupe
SlurmctldHost={name}({self.network.address("h1")})
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={munge}
StateSaveLocation={self.folder}/state
SlurmdSpoolDir={self.folder}/spool-%n
SlurmctldPidFile={self.folder}/slurmctld.pid
SlurmdPidFile={self.folder}/slurmd-%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
MpiDefault=none
ReturnToService=2
SlurmdTimeout=600
MessageTimeout=100
{nodes}
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")
        (self.folder / "state").mkdir()
        controller = self.daemon("h1", "slurmctld", "-D")
        for host in self.network.hosts:
            (self.folder / f"spool-{host}").mkdir()
            self.daemon(host, "slurmd", "-D", "-N", host)
        await_that(lambda: self.state().count("idle") == 2, 120, "both nodes are idle", controller)

    def state(self):
        done = subprocess.run(self.on("h1", "sinfo", "--Node", "--noheader", "--format=%t"), capture_output=True, text=True,
                              env=self.environment())
        return done.stdout.split()

    def on(self, host, *command):
        """A command on a node; `ip netns exec` would hide /sys/fs/cgroup from slurmd."""
        return ["nsenter", f"--net=/run/netns/{self.network.space(host)}", *map(str, command)]

    def submit(self, programs, *words):
        """Runs a job to its end, and returns its output."""
        environment = self.environment() | {"PATH": f"{programs}:{os.environ['PATH']}"}
        output = self.folder / "job-%a.log"
        try:
            run(*self.on("h1", "sbatch", "--wait", f"--output={output}", f"--chdir={self.folder}", *words),
                env=environment, timeout=600)
        finally:
            logs = "".join(path.read_text() for path in sorted(self.folder.glob("job-*.log")))
            print(logs, flush=True)
        return logs

    def remove(self):
        terminate(self.started)
        self.network.remove()


def sweep(cluster, programs, folder):
    cluster.submit(programs, "--array=1-4", DEPLOY / "slurm/cases.sbatch", "sweep", folder / "parts", TEST)
    parts = [folder / "parts" / str(task) for task in range(1, 5)]
    run(programs / "troupe", "sweep", "--merge", *parts, "-o", folder / "merged")
    run(programs / "troupe", "sweep", TEST, "-o", folder / "whole")
    require_same_files(folder / "merged", folder / "whole")
    counts = [len((part / "cases.jsonl").read_text().splitlines()) for part in parts]
    require(min(counts) > 0 and max(counts) < 10, f"the tasks had {counts} lines of cases, expected shares of 10 cases")


def distributed_run(cluster, programs, folder):
    scenario = folder / "run.json"
    scenario.write_text(json.dumps({
        "world": str(ROOT / "worlds/office.world"), "seed": 4, "ticks": TICKS, "speed": "max",
        "spawn": [{"model": "scout", "count": ROBOTS, "region": [-11.5, -7.5, 11.5, 7.5], "spacing": 0.6,
                   "name_prefix": "r", "controller": "wander"}]}))
    hashes = [folder / "nodes.hashes", folder / "local.hashes"]
    summary = folder / "summary.json"
    cluster.submit(programs, "--nodes=2", DEPLOY / "slurm/run.sbatch", scenario, "--hash-log", hashes[0], "--summary",
                   summary, "--start-timeout", "300", "--lease", "60")
    run(programs / "troupe", "run", scenario, "--in-process", "--headless", "--hash-log", hashes[1])
    found, expected = (file.read_text() for file in hashes)
    require(found == expected, "the hashes of the run over two nodes differ from those of one process")
    require(len(found.splitlines()) > TICKS - 1, "the run has fewer ticks than expected")
    result = json.loads(summary.read_text())
    hosts = {robot.get("host") for robot in result["slowest_robots"]}
    require(result["processes"] >= ROBOTS + 1 and hosts == {"h1", "h2"},
            f"expected a process for each of {ROBOTS} robots, on both nodes: {result}")


def trial():
    skip_without(["slurmctld", "slurmd", "sbatch", "srun", "munged", "mungekey"], PACKAGES)
    if obstacle := obstacle_to_hosts():
        skip(obstacle)
    programs = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory(prefix="troupe-slurm-") as temporary:
        folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else temporary).resolve()
        cluster = Cluster(folder)
        try:
            sweep(cluster, programs, folder)
            distributed_run(cluster, programs, folder)
        finally:
            cluster.remove()


main(trial)
