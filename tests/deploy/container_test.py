#!/usr/bin/env python3
"""deploy/Containerfile and deploy/compose.yaml with buildah and podman; needs root and the packages buildah, podman, runc
and debootstrap. Images and containers are in a folder of its own, and nothing of them is left.

    tests/deploy/container_test.py BUILD PROGRAMS CACHE

An image is built from the package of the folder BUILD, on a base that debootstrap makes (in the folder CACHE, where it stays for the next time).
Cases in four containers, merged, are those of one process, byte for byte. The containers of compose.yaml make a run with
the hashes of one process, and a scraper with the token of the viewer sees it. The commands of the action for GitHub, with
podman as docker, make JUnit files.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

from engine import (DEPLOY, ROOT, Wrong, await_that, main, require, require_same_files, run, skip, skip_without)

sys.path.insert(0, str(ROOT / "scripts"))
from virtual_network import Network, obstacle_to_hosts  # noqa: E402

try:
    import yaml
except ImportError:
    skip("no module yaml; scripts/setup python3-yaml installs it")

PACKAGES = "buildah podman runc debootstrap python3-yaml"
TEST = ROOT / "examples/fleet_tests/relay.test.json"
BASE = "localhost/debian-base"
TICKS = 50
LARGEST_LAYER = 100e6  # bytes that Troupe may add to its base


class Engine:
    """buildah and podman without systemd, and without anything of the machine's own containers."""

    # The network is one of the engine's own, on which no other program has ports; the limits are those that a container
    # may set on this kind of machine.
    def __init__(self, folder, network):
        self.storage = ["--storage-driver", "vfs", "--root", str(folder / "storage"), "--runroot", str(folder / "run")]
        self.program = ["podman", *self.storage, "--runtime", "runc", "--cgroup-manager", "cgroupfs"]
        self.network = f"/run/netns/{network.space('h1')}"
        self.limits = ["--network", f"ns:{self.network}", "--ulimit", "nofile=1024:1024", "--ulimit", "nproc=1000:1000"]

    def buildah(self, *words):
        return run("buildah", *self.storage, *words)

    def podman(self, *words, **options):
        return run(*self.program, *words, **options)

    def start(self, words, *options):
        """Runs a program in a container of the image."""
        return self.podman("run", "--rm", *self.limits, *options, "troupe", *words)

    def size(self, image):
        return json.loads(self.podman("image", "inspect", image))[0]["Size"]


def build(engine, build_folder, cache):
    root = cache / "debian"
    if not (root / "ready").exists():
        shutil.rmtree(root, ignore_errors=True)
        cache.mkdir(parents=True, exist_ok=True)
        done = subprocess.run(["debootstrap", "--variant=minbase", "--include=ca-certificates", "bookworm", str(root)],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if done.returncode != 0:
            skip(f"debootstrap makes no base image: {done.stdout[-300:]}")
        (root / "ready").touch()
    container = engine.buildah("from", "scratch").strip()
    engine.buildah("copy", "--quiet", container, root, "/")
    engine.buildah("commit", "--quiet", container, BASE)
    engine.buildah("rm", container)
    with tempfile.TemporaryDirectory() as context:
        run("cpack", "--config", build_folder / "CPackConfig.cmake", "-B", context)
        engine.buildah("build", "--isolation", "chroot", "--network", "host", "--build-arg", f"BASE={BASE}", "--file",
                       DEPLOY / "Containerfile", "--tag", "troupe", context)
    added = engine.size("troupe") - engine.size(BASE)
    print(f"the image adds {added / 1e6:.0f} MB to its base")
    require(0 < added < LARGEST_LAYER, f"the image adds {added / 1e6:.0f} MB to its base")
    require(engine.start(["id", "-u"]).strip() == "1000", "the container's user is root")
    require("troupe run" in engine.start(["troupe", "help"]) + engine.start(["troupe", "run", "--help"]), "no help")


def cases(engine, programs, folder):
    parts = folder / "parts"
    parts.mkdir(mode=0o777)
    parts.chmod(0o777)  # the user of the containers is none of this machine
    for task in range(1, 5):
        engine.start(["troupe", "sweep", TEST, "--output", parts / str(task), "--shard", f"{task}/4"],
                     "--volume", f"{ROOT}:{ROOT}:ro", "--volume", f"{parts}:{parts}")
    run(programs / "troupe", "sweep", "--merge", *sorted(parts.iterdir()), "--output", folder / "merged")
    run(programs / "troupe", "sweep", TEST, "--output", folder / "whole")
    require_same_files(folder / "merged", folder / "whole")


def action(engine, folder):
    """Two jobs of a matrix."""
    programs = folder / "docker"
    programs.mkdir()
    (programs / "docker").write_text(f"""#!/bin/sh
test "$1" = run && shift && exec {" ".join([*engine.program, "run", *engine.limits])} "$@"
""")
    (programs / "docker").chmod(0o755)
    step = yaml.safe_load((DEPLOY / "ci/github-action.yml").read_text())["runs"]["steps"][0]
    names = []
    for shard in ("1/2", "2/2"):
        checkout = folder / f"checkout-{shard[0]}"
        shutil.copytree(DEPLOY / "worlds", checkout / "tests")
        run("bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"], cwd=checkout,
            env=os.environ | {"PATH": f"{programs}:{os.environ['PATH']}", "IMAGE": "troupe", "TESTS": "tests", "SHARD": shard,
                              "GITHUB_OUTPUT": str(checkout / "output")})
        require((checkout / "output").read_text() == f"part={shard[0]}\n", "the step has no output")
        results = xml.etree.ElementTree.parse(checkout / "troupe-report/junit.xml")
        names += [case.get("name") for case in results.iter("testcase")]
    require(len(names) == len(set(names)) == 20, f"the JUnit files have the cases {names}, expected each of 20 once")


class Composition:
    """The containers of compose.yaml by podman, on one network address."""

    def __init__(self, engine, folder, worlds, address):
        self.engine = engine
        self.address = address
        self.services = yaml.safe_load((DEPLOY / "compose.yaml").read_text())["services"]
        self.volumes = {"./worlds": worlds}
        for name in ("keys", "journal"):
            self.volumes[name] = folder / name
            self.volumes[name].mkdir(mode=0o700)
            os.chown(self.volumes[name], 1000, 1000)
        self.started = []

    def words(self, name, more=""):
        """The options of podman, and the command with `more` behind it."""
        service = self.services[name]
        options = ["--add-host", f"world:{self.address}"]
        for key, value in service.get("environment", {}).items():
            options += ["--env", f"{key}={value}"]
        for volume in service.get("volumes", []):
            source, _, target = volume.partition(":")
            options += ["--volume", f"{self.volumes[source]}:{target}"]
        command = [word.replace("$$", "$") for word in service["command"]]
        if more:
            command[-1] += more
        return options, service.get("entrypoint", []) + command

    def finish(self, name):
        options, command = self.words(name)
        self.engine.start(command, *options)

    def start(self, name, more=""):
        options, command = self.words(name, more)
        self.started.append(name)
        self.engine.start(command, "--detach", "--name", name, *options)

    def log(self, name):
        done = subprocess.run(["podman", *self.engine.storage, "logs", name], capture_output=True, text=True)
        return done.stdout + done.stderr

    def runs(self, name):
        return name in self.engine.podman("ps", "--format", "{{.Names}}").split()

    def remove(self):
        for name in reversed(self.started):
            subprocess.run([*self.engine.program, "rm", "--force", "--ignore", "--time", "10", name], capture_output=True)


def composition(engine, programs, folder, address):
    worlds = DEPLOY / "worlds"
    parts = Composition(engine, folder, worlds, address)
    hashes = folder / "journal/hashes"
    robots = [name for name in parts.services if name.startswith("robot-")]
    try:
        parts.finish("keys")
        parts.start("viewer")
        parts.start("world", f" --speed max --ticks {TICKS} --hash-log /journal/hashes --paused")
        for robot in robots:
            parts.start(robot)
        await_that(lambda: "viewer: http" in parts.log("viewer"), 60, "the viewer has an address")
        token = parts.log("viewer").partition("token=")[2].split()[0]

        def metrics():
            script = (f"import urllib.request as u; print(u.urlopen(u.Request('http://127.0.0.1:8470/metrics', headers="
                      f"{{'Authorization': 'Bearer {token}', 'Host': 'viewer:8470'}})).read().decode())")
            return run("nsenter", f"--net={engine.network}", sys.executable, "-c", script)

        await_that(lambda: f'troupe_agents{{session="fleet"}} {len(robots)}' in metrics(), 120, "all robots join")
        control = ["troupe", "ctl", "play", "--session", "fleet", "--service", "world:17910", "--interface", "auto",
                   "--security", "/keys/run"]
        engine.start(control, *parts.words("viewer")[0])
        await_that(lambda: not parts.runs("world"), 120, "the run ends")
    except Wrong:
        for name in parts.started:
            print(f"== {name}\n{parts.log(name)}")
        raise
    finally:
        parts.remove()
    os.environ["STAGEPATH"] = str(ROOT / "worlds/include")
    expected = folder / "expected.hashes"
    run(programs / "troupe", "run", worlds / "fleet.json", "--in-process", "--headless", "--speed", "max", "--ticks", TICKS,
        "--hash-log", expected)
    require(hashes.read_text() == expected.read_text(), "the hashes of the run in containers differ")


def trial():
    skip_without(["buildah", "podman", "runc", "debootstrap"], PACKAGES)
    if obstacle := obstacle_to_hosts():
        skip(obstacle)
    build_folder, programs, cache = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    with tempfile.TemporaryDirectory(prefix="troupe-containers-") as temporary:
        folder = pathlib.Path(temporary)
        folder.chmod(0o755)
        network = Network(1, name="c")
        try:
            engine = Engine(folder, network)
            build(engine, build_folder, cache)
            cases(engine, programs, folder)
            action(engine, folder)
            composition(engine, programs, folder, network.address("h1"))
        finally:
            network.remove()


main(trial)
