"""Hosts of a network as network namespaces of this machine; needs root. For scripts/scale, same-hash,
kill-test and hosts-test."""
import json
import os
import pathlib
import shutil
import signal
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent


def ip(*words, check=True):
    done = subprocess.run(["ip", *words], capture_output=True, text=True)
    if check and done.returncode != 0:
        raise OSError(f"ip {' '.join(words)}: {done.stderr.strip()}")
    return done.stdout


def obstacle_to_hosts():
    """Why this machine makes no such hosts; empty if it does."""
    if os.geteuid() != 0:
        return "network namespaces need root; run this as root"
    if shutil.which("ip") is None:
        return "no program ip; install the package iproute2"
    try:
        Network(1).remove()
    except OSError as problem:
        return f"this kernel makes no network namespaces with a bridge: {problem}"
    return ""


def absolute(scenario):
    """The content of a scenario, or a scenario of a world file, which can be written to any folder."""
    if scenario.suffix != ".json":
        return {"world": str(scenario.resolve())}
    content = json.loads(scenario.read_text())
    if "world" in content:
        content["world"] = str((scenario.parent / content["world"]).resolve())
    content["include"] = [str((scenario.parent / file).resolve()) for file in content.get("include", [])]
    return content


class Network:
    """Hosts h1, h2, ... as namespaces, each with an interface eth0 that is plugged into one bridge."""

    def __init__(self, hosts, name=""):
        self.prefix = f"troupe-{os.getpid()}-{name}"
        self.bridge = self.prefix + "lan"
        self.hosts = [f"h{i + 1}" for i in range(hosts)]
        self.spaces = []
        self.switch = None
        try:
            self.build()
        except BaseException:
            self.remove()
            raise

    def space(self, host):
        return self.prefix + host

    def address(self, host):
        return f"10.213.77.{self.hosts.index(host) + 1}"

    def add_space(self, name):
        ip("netns", "add", name)
        self.spaces.append(name)
        ip("-n", name, "link", "set", "lo", "up")

    def build(self):
        self.add_space(self.bridge)
        # Without snooping: the bridge would forget groups that no router asks for, and discovery by multicast would
        # stop.
        ip("-n", self.bridge, "link", "add", "bridge", "type", "bridge", "mcast_snooping", "0")
        ip("-n", self.bridge, "link", "set", "bridge", "up")
        for host in self.hosts:
            space = self.space(host)
            self.add_space(space)
            ip("-n", self.bridge, "link", "add", host, "type", "veth", "peer", "name", "eth0", "netns", space)
            ip("-n", self.bridge, "link", "set", host, "master", "bridge", "up")
            ip("-n", space, "addr", "add", self.address(host) + "/24", "dev", "eth0")
            ip("-n", space, "link", "set", "eth0", "up")

    def disturb_by_netem(self, delay_ms, jitter_percent, loss_percent):
        """Returns whether the kernel supports it."""
        jitter_ms = delay_ms * jitter_percent / 100
        for host in self.hosts:
            try:
                done = subprocess.run(
                    ["ip", "netns", "exec", self.space(host), "tc", "qdisc", "replace", "dev", "eth0", "root", "netem",
                     "limit", "100000", "delay", f"{delay_ms}ms", f"{jitter_ms}ms", "loss", f"{loss_percent}%"],
                    capture_output=True, text=True)
            except FileNotFoundError:
                return False
            if done.returncode != 0:
                return False
        return True

    def disturb_by_switch(self, delay_ms, jitter_percent, loss_percent, seed):
        self.join_by_switch("--delay", delay_ms, "--jitter", delay_ms * jitter_percent / 100, "--loss", loss_percent,
                            "--seed", seed)

    def limit_rate_by_switch(self, kbit):
        """Each host sends and receives so many kbit/s at most, which only the network knows, not the kernels of the hosts."""
        self.join_by_switch("--rate", kbit)

    def join_by_switch(self, *options):
        for host in self.hosts:
            ip("-n", self.bridge, "link", "set", host, "nomaster")
        self.switch = subprocess.Popen(
            ["ip", "netns", "exec", self.bridge, str(ROOT / "scripts" / "lossy_switch"), *self.hosts, *map(str, options)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        if self.switch.stdout.readline().strip() != "ready":
            raise OSError("scripts/lossy_switch cannot join the hosts")

    def set_link(self, host, up):
        """Plugs the host in, or pulls its cable."""
        ip("-n", self.bridge, "link", "set", "dev", host, "up" if up else "down")

    def forbid_multicast(self):
        """The bridge passes no multicast on, as the networks of most clouds."""
        for host in self.hosts:
            ip("-n", self.bridge, "link", "set", "dev", host, "type", "bridge_slave", "mcast_flood", "off")

    def limit_rate(self, kbit):
        """Each host sends and receives so many kbit/s at most; what waits for more than 0.4 s is dropped."""
        for space, link in [(self.space(host), "eth0") for host in self.hosts] + [
                (self.bridge, host) for host in self.hosts]:
            done = subprocess.run(["ip", "netns", "exec", space, "tc", "qdisc", "replace", "dev", link, "root", "tbf",
                                   "rate", f"{kbit}kbit", "burst", "10000", "latency", "400ms"],
                                  capture_output=True, text=True)
            if done.returncode != 0:
                raise OSError(f"tc cannot limit the rate of a link: {done.stderr.strip()}")

    def kill(self, host, only=""):
        """Kills the processes of a host; with `only` those whose command line contains it."""
        self.signal(host, signal.SIGKILL, only)

    def signal(self, host, number, only=""):
        """Sends a signal to them."""
        for pid in ip("netns", "pids", self.space(host), check=False).split():
            try:
                words = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
                if only in words:
                    os.kill(int(pid), number)
            except (ProcessLookupError, FileNotFoundError):
                pass

    def on(self, host, *command, **options):
        """A program that is started on a host."""
        return subprocess.Popen(["ip", "netns", "exec", self.space(host), *map(str, command)],
                                stdin=subprocess.DEVNULL, text=True, **options)

    def entry(self, host, **more):
        """The entry of a host in a scenario."""
        start = f"ip netns exec {self.space(host)} {{command}}"
        return {"name": host, "address": self.address(host), "start": start} | more

    def bytes(self, host):
        """The number of bytes sent and received."""
        link = json.loads(ip("-n", self.space(host), "-s", "-j", "link", "show", "dev", "eth0"))[0]["stats64"]
        return link["tx"]["bytes"] + link["rx"]["bytes"]

    def remove(self):
        if self.switch is not None:
            self.switch.stdin.close()
            self.switch.wait(10)
            self.switch = None
        for space in self.spaces:
            for pid in ip("netns", "pids", space, check=False).split():
                try:
                    os.kill(int(pid), signal.SIGKILL)
                except ProcessLookupError:
                    pass
            # Its processes first: a namespace with a process lives on without a name.
            ip("netns", "del", space, check=False)  # with its interfaces
        self.spaces = []
