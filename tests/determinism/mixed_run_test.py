"""A run of eight robots on two hosts, with agents that are programs of this machine on one and of ARM64, in qemu, on
the other, and a run of which all programs are of ARM64: their hashes are those of a run in one process. The hosts are
network namespaces.

    mixed_run_test.py FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES [--ticks N]
"""

import argparse
import filecmp
import pathlib
import shlex
import shutil
import subprocess
import sys

parser = argparse.ArgumentParser()
parser.add_argument("programs", type=pathlib.Path)
parser.add_argument("source", type=pathlib.Path)
parser.add_argument("files", type=pathlib.Path)
parser.add_argument("--ticks", type=int, default=300)
arguments = parser.parse_args()
programs, source, files = (path.resolve() for path in (arguments.programs, arguments.source, arguments.files))
sys.path.insert(0, str(source / "scripts"))

from run_processes import descendants  # noqa: E402
from scenario_runner import Runner  # noqa: E402
from virtual_network import Network, absolute, obstacle_to_hosts  # noqa: E402

SKIPPED = 77
EMULATOR = "qemu-aarch64-static"
# Emulated programs are slow to start, and qemu 7.2 sends no multicast (IP_MULTICAST_IF).
OPTIONS = ["--network", "unicast", "--start-timeout", 300, "--lease", 30]


def write_script(file, *command):
    """A program that is the command."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f"#!/bin/sh\nexec {shlex.join(map(str, command))} \"$@\"\n")
    file.chmod(0o755)


def write_programs(folder):
    """The programs of the second host: the host's own, and an agent for ARM64."""
    arm64 = source / "build/arm64/bin/robot-agent"
    write_script(folder / "robot-agent", EMULATOR, "-L", source / "build/arm64-root", arm64)
    for name in ("troupe", "world-service"):
        shutil.copy2(programs / name, folder)


def problems_of_arm64_alone(scenario, expected):
    """Of a run whose launcher, service and agents are of ARM64."""
    emulate = source / "scripts/emulate-arm64"
    if subprocess.run([emulate, "true"], check=False).returncode != 0:
        print("SKIPPED: a run of ARM64 alone needs Linux 6.7")
        return []
    write_script(files / "emulated/troupe", emulate, source / "build/arm64/bin/troupe")
    summary, found = Runner(files / "emulated", files, False).run("emulated", scenario, OPTIONS)
    print(f"{summary['robots']} robots, {summary['ticks']} ticks, all programs of ARM64, "
          f"last hash {summary['state_hash']}")
    return [] if filecmp.cmp(expected, found, shallow=False) else [f"{found} and {expected} differ"]


def main():
    if not shutil.which(EMULATOR):
        print(f"no {EMULATOR} (scripts/setup-arm64)")
        return SKIPPED
    if not (source / "build/arm64/bin/robot-agent").exists():
        print("no build of the preset arm64")
        return SKIPPED
    if obstacle := obstacle_to_hosts():
        print(obstacle)
        return SKIPPED
    write_programs(files / "arm64")
    scenario = absolute(source / "worlds/scenarios/demo.json") | {"ticks": arguments.ticks}
    runner = Runner(programs, files, False)
    _, expected = runner.run("local", scenario, ["--in-process"])

    seen = {}

    def watch(launcher):
        seen.update(descendants(launcher))

    network = Network(2)
    first, second = network.hosts
    hosts = [network.entry(first, service=True, robots=4), network.entry(second, programs=str(files / "arm64"))]
    try:
        summary, found = runner.run("mixed", scenario | {"hosts": hosts}, OPTIONS, watch)
    finally:
        runner.stop()
        network.remove()
    agents = list(seen.values())
    print(f"{summary['robots']} robots, {summary['ticks']} ticks, agents: {agents.count('robot-agent')} of this "
          f"machine, {agents.count(EMULATOR)} of ARM64, last hash {summary['state_hash']}")
    problems = problems_of_arm64_alone(scenario, expected)
    if not filecmp.cmp(expected, found, shallow=False):
        problems.append(f"{found} and {expected} differ")
    if (agents.count("robot-agent"), agents.count(EMULATOR)) != (4, 4):
        problems.append(f"found the programs {sorted(agents)}, expected four agents of each architecture")
    with open(found) as log:
        lines = sum(1 for _ in log)
    if lines != arguments.ticks + 1:
        problems.append(f"found {lines} hashes, expected {arguments.ticks + 1}")
    print("; ".join(problems) or "equal hashes")
    return 1 if problems else 0


sys.exit(main())
