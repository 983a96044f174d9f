#!/usr/bin/env python3
"""deploy/kubernetes and deploy/ci without a cluster. The files are checked against the published types of Kubernetes (of the
npm package kubernetes-models, where npm reaches it), so that no key and no type is wrong, and their parts against each
other. The commands, probes and merged reports of the pods are run as processes of this machine, in a network of their own
(needs root): the world service is killed in the middle and started again as a kubelet would. The commands of
the template for GitLab make a JUnit file.

    tests/deploy/kubernetes_test.py PROGRAMS CACHE
"""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

from engine import DEPLOY, ROOT, Wrong, await_that, main, require, require_same_files, run, skip, terminate

sys.path.insert(0, str(ROOT / "scripts"))
from virtual_network import Network, obstacle_to_hosts  # noqa: E402

try:
    import yaml
except ImportError:
    skip("no module yaml; scripts/setup python3-yaml installs it")

TYPES = ["kubernetes-models@4.5.1", "typescript@5.4.5"]
TICKS = 60
KILLED_AT = 25


def documents():
    found = [document for file in sorted((DEPLOY / "kubernetes").glob("*.yaml"))
             for document in yaml.safe_load_all(file.read_text())]
    require(len(found) == 7, f"found {len(found)} documents, expected 7")
    return {(document["kind"], document["metadata"]["name"]): document for document in found}


def pod(document):
    return document["spec"]["template"]["spec"]


def check_types(objects, cache):
    """As an API server that is asked for strict validation: no unknown keys, no wrong types."""
    folder = cache / "kubernetes-types"
    if not (folder / "node_modules/typescript").exists():
        folder.mkdir(parents=True, exist_ok=True)
        try:
            run("npm", "install", "--no-audit", "--no-fund", "--prefix", folder, *TYPES, timeout=300)
        except (OSError, subprocess.TimeoutExpired, Wrong) as problem:
            print(f"not checked against the published types: {problem}")
            return

    def problems(documents_of):
        text = "".join(f"const d{i}: import('kubernetes-models/{document['apiVersion']}').I{document['kind']} = "
                       f"{json.dumps(document)};\n" for i, document in enumerate(documents_of))
        (folder / "documents.ts").write_text(text)
        done = subprocess.run(["node", folder / "node_modules/typescript/bin/tsc", "--noEmit", "--strict", "--skipLibCheck",
                               "--moduleResolution", "node", "--target", "es2020", folder / "documents.ts"],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True)
        return done.stdout

    require(problems(objects.values()) == "", problems(objects.values()))
    wrong = json.loads(json.dumps(objects["StatefulSet", "robot"]).replace('"volumeMounts"', '"volumeMount"', 1))
    require("volumeMount" in problems([wrong]), "an unknown key is not found")
    print(f"{len(objects)} objects have the types of Kubernetes")


def check_references(objects):
    """What names another part of the files names one that is there."""
    for (kind, name), document in objects.items():
        if "template" not in document["spec"]:
            continue
        labels = document["spec"]["template"]["metadata"]["labels"]
        volumes = {volume["name"] for volume in pod(document)["volumes"]}
        volumes |= {claim["metadata"]["name"] for claim in document["spec"].get("volumeClaimTemplates", [])}
        for container in pod(document)["containers"] + pod(document).get("initContainers", []):
            mounted = {mount["name"] for mount in container["volumeMounts"]}
            require(mounted <= volumes, f"{name}: {container['name']} mounts {mounted - volumes}, which is no volume")
        require(pod(document)["securityContext"]["runAsNonRoot"], f"{name} may be root")
        for volume in pod(document)["volumes"]:
            claim = volume.get("persistentVolumeClaim", {}).get("claimName")
            require(claim is None or ("PersistentVolumeClaim", claim) in objects, f"{name}: there is no claim {claim}")
        if kind == "StatefulSet":
            service = objects["Service", document["spec"]["serviceName"]]["spec"]
            require(document["spec"]["selector"]["matchLabels"] == labels, f"{name} does not select its pods")
            require(service["selector"].items() <= labels.items() and service["clusterIP"] == "None",
                    f"{name}: its Service does not select its pods, or is not headless")


class Pods:
    """Pods as processes: their folders are of this machine, their host names programs in the search path."""

    def __init__(self, network, programs, folder):
        self.network = network
        self.folder = folder
        self.programs = programs
        self.started = []
        for name in ("journal", "reports", "token"):
            (folder / name).mkdir()

    def words(self, pod_name, command):
        """The command with the places of this machine for those of the pod."""
        places = {"/keys/": self.folder / f"keys-{pod_name}/", "/secret/": self.folder / f"secret-{pod_name}/",
                  "/worlds/": DEPLOY / "worlds", "/journal/": self.folder / "journal", "/token/": self.folder / "token",
                  "/reports/": self.folder / "reports"}
        text = "\0".join(command).replace("world-0.world", self.network.address("h1"))
        text = re.sub(r"/keys(?= |\0|$)", "/keys/", text)
        for place, here in places.items():
            text = re.sub(rf"(?<![\w.-]){place}", f"{here}/", text)
        host = self.folder / f"bin-{pod_name}"
        if not host.exists():
            host.mkdir()
            (host / "hostname").write_text(f"#!/bin/sh\necho {pod_name}\n")
            (host / "hostname").chmod(0o755)
        return text.split("\0")

    def environment(self, pod_name):
        return os.environ | {"PATH": f"{self.folder}/bin-{pod_name}:{self.programs}:{os.environ['PATH']}",
                             "STAGEPATH": str(ROOT / "worlds/include")}

    def inside(self, words):
        return ["nsenter", f"--net=/run/netns/{self.network.space('h1')}", *words]

    def finish(self, pod_name, command, **more):
        words = self.words(pod_name, command)
        return run(*self.inside(words), env=self.environment(pod_name) | more)

    def start(self, pod_name, command, name, more=""):
        words = self.words(pod_name, command)
        words[-1] += more
        log = open(self.folder / f"{name}.log", "a")
        process = subprocess.Popen(self.inside(words), env=self.environment(pod_name), stdin=subprocess.DEVNULL, stdout=log,
                                   stderr=subprocess.STDOUT)
        self.started.append(process)
        return process

    def answers(self, pod_name, command):
        return subprocess.run(self.inside(self.words(pod_name, command)), env=self.environment(pod_name),
                              stdin=subprocess.DEVNULL, capture_output=True).returncode == 0


def make_secrets(pods, robots):
    """As docs/deploy.md says."""
    keys = pods.folder / "keys"
    run(pods.programs / "troupe", "keys", "make", keys, "--robots", ",".join(robots))
    for pod_name, parts in {"world-0": ["service", "operator", "observer"], **{robot: ["agents"] for robot in robots}}.items():
        secret = pods.folder / f"secret-{pod_name}"
        secret.mkdir()
        run("tar", "-C", keys, "-cf", secret / "keys.tar", *parts)
    (pods.folder / "token/token").write_text("0123456789abcdef0123456789abcdef\n")


def run_pods(pods, objects):
    world, robot = pod(objects["StatefulSet", "world"]), pod(objects["StatefulSet", "robot"])
    robots = [f"robot-{i}" for i in range(objects["StatefulSet", "robot"]["spec"]["replicas"])]
    make_secrets(pods, robots)
    service, viewer = world["containers"]
    for name, spec in [("world-0", world), *((name, robot) for name in robots)]:
        pods.finish(name, spec["initContainers"][0]["command"])
    hashes = pods.folder / "hashes"
    options = f" --speed max --ticks {TICKS} --paused --hash-log {hashes}"
    first = pods.start("world-0", service["command"], "service", options)
    pods.start("world-0", viewer["command"], "viewer")
    for name in robots:
        pods.start(name, robot["containers"][0]["command"], name)

    def metrics():
        # No program of the image asks for it: a scraper does, by the name of the pod.
        script = ("import urllib.request as u; print(u.urlopen(u.Request('http://127.0.0.1:8470/metrics', headers={"
                  "'Authorization': 'Bearer 0123456789abcdef0123456789abcdef', 'Host': 'world-0.world:8470'})).read().decode())")
        done = subprocess.run(pods.inside([sys.executable, "-c", script]), capture_output=True, text=True)
        return done.stdout

    await_that(lambda: f'troupe_agents{{session="fleet"}} {len(robots)}\n' in metrics(), 120, "all robots join", first)
    for probe in ("readinessProbe", "livenessProbe"):
        require(pods.answers("world-0", service[probe]["exec"]["command"]), f"{probe} fails")
    control = service["readinessProbe"]["exec"]["command"]
    pods.finish("world-0", [*control[:2], "step", str(KILLED_AT), *control[3:]])
    first.send_signal(signal.SIGKILL)
    first.wait()
    require(not pods.answers("world-0", service["livenessProbe"]["exec"]["command"]), "a dead service is alive")
    second = pods.start("world-0", service["command"], "service", options.replace(" --paused", ""))
    await_that(lambda: 'troupe_service_restarts_total{session="fleet"} 1\n' in metrics(), 120, "the run continues", second)
    pods.finish("world-0", [*control[:2], "play", *control[3:]])
    require(second.wait(120) == 0, "the run did not end in order")
    expected = pods.folder / "expected"
    run(pods.programs / "troupe", "run", DEPLOY / "worlds/fleet.json", "--in-process", "--headless", "--speed", "max", "--ticks",
        TICKS, "--hash-log", expected, env=pods.environment("world-0"))
    require(hashes.read_text() == expected.read_text(), "the hashes of the pods' run differ from those of one process")


def run_cases(pods, objects):
    job = objects["Job", "troupe-cases"]
    command = pod(job)["containers"][0]["command"]
    for index in range(job["spec"]["completions"]):
        pods.finish("cases", command, JOB_COMPLETION_INDEX=str(index))
    pods.finish("merge", pod(objects["Job", "troupe-merge"])["containers"][0]["command"])
    whole = pods.folder / "whole"
    pods.finish("cases", ["troupe", "test", "/worlds/fleet.test.json", "--report", str(whole)])
    require_same_files(pods.folder / "reports/all", whole)


def run_template(pods):
    """The commands of the template for GitLab, in two parallel jobs."""
    job = yaml.safe_load((DEPLOY / "ci/gitlab.yml").read_text())[".troupe"]
    names = []
    for node in (1, 2):
        folder = pods.folder / f"gitlab-{node}"
        folder.mkdir()
        variables = {"TROUPE_TESTS": str(DEPLOY / "worlds"), "CI_NODE_INDEX": str(node), "CI_NODE_TOTAL": "2"}
        run("sh", "-e", "-c", "\n".join(job["script"]), cwd=folder, env=pods.environment("ci") | variables)
        results = xml.etree.ElementTree.parse(folder / job["artifacts"]["reports"]["junit"])
        names += [case.get("name") for case in results.iter("testcase")]
    require(len(names) == len(set(names)) == 20, f"the JUnit files have the cases {names}, expected each of 20 once")


def trial():
    programs, cache = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    objects = documents()
    check_references(objects)
    check_types(objects, cache)
    if obstacle := obstacle_to_hosts():
        skip(obstacle)
    with tempfile.TemporaryDirectory(prefix="troupe-kubernetes-") as temporary:
        network = Network(1, name="k")
        pods = Pods(network, programs, pathlib.Path(temporary))
        try:
            run_cases(pods, objects)
            run_template(pods)
            run_pods(pods, objects)
        except BaseException:
            for log in sorted(pods.folder.glob("*.log")):
                print(f"== {log.name}\n{log.read_text()[-2000:]}")
            raise
        finally:
            terminate(pods.started)
            network.remove()


main(trial)
