"""Runs that go on: a paused run with tools, the page, Foxglove and ROS 2 beside it; and how a thing is found in each."""

import json
import os
import pathlib
import re
import select
import signal
import struct
import subprocess
import sys
import time

sys.path[1:1] = [str(pathlib.Path(__file__).resolve().parents[up] / folder) for up, folder in ((1, "python"), (2, "scripts"))]
from page_client import PageClient
from run_processes import reserve_domain

SECONDS = 100
WORLD, DATA = 1, 1  # the first bytes of a message of the page and of Foxglove
ANSWERER = "answerer"  # the node of ROS 2


class Failed(Exception):
    pass


class Refused(Exception):
    """With the line of the refusal."""


class Program:
    """troupe, for runs in a domain of this test, and the node of ROS 2 (`node`)."""

    def __init__(self, path, node, folder):
        self.path, self.node, self.folder = path, node, folder
        self.domain, self.reserved = reserve_domain(1)
        self.ros_domain, self.reserved_for_ros = reserve_domain(1)
        self.environment = {**os.environ, "TROUPE_DOMAIN": str(self.domain), "NO_COLOR": "1"}
        self.environment.pop("TROUPE_SESSION", None)

    def words(self, words):
        """Of a row, with the domain of ROS 2."""
        return [str(word).format(ros_domain=self.ros_domain) if "{" in str(word) else str(word) for word in words]

    def start(self, *words):
        return subprocess.Popen([self.path, *self.words(words)], cwd=self.folder, env=self.environment, text=True,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    @staticmethod
    def end_of(process, words):
        """All that it printed."""
        try:
            return process.communicate(timeout=SECONDS)[0]
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
            try:
                text = process.communicate(timeout=SECONDS)[0]
            except subprocess.TimeoutExpired:
                process.kill()
                text = process.communicate()[0]
            raise Failed(f"troupe {' '.join(map(str, words))}: no end within {SECONDS} s: {text}") from None

    def finish(self, *words):
        """(status, text)"""
        with self.start(*words) as process:
            text = self.end_of(process, words)
            return process.returncode, text

    def run(self, *words, status=0):
        found, text = self.finish(*words)
        if found != status:
            raise Failed(f"troupe {' '.join(map(str, words))}: status {found}: {text.strip()}")
        return text


class RosNode:
    """Answers ticks, and knows the topics."""

    def __init__(self, program):
        self.process = subprocess.Popen([program.node, str(program.ros_domain), ANSWERER], text=True, stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE)
        os.set_blocking(self.process.stdout.fileno(), False)
        self.text = ""

    def await_topic(self, topic):
        deadline = time.monotonic() + 10
        while f"topic {topic}" not in self.text:  # or topics below it
            ready, _, _ = select.select([self.process.stdout], [], [], max(0, deadline - time.monotonic()))
            part = self.process.stdout.read() if ready else ""
            if not part:  # none in time, or the node has ended
                raise Failed(f"no topic {topic}; found {self.text.split()[1::2]}")
            self.text += part

    def end(self):
        self.process.communicate(timeout=SECONDS)


def descendants(pid):
    found = []
    for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        for child in task.read_text().split():
            found += [int(child), *descendants(child)]
    return found


def kill(process, program):
    """Kills one child of that program once it works."""
    deadline = time.monotonic() + SECONDS
    while time.monotonic() < deadline and process.poll() is None:
        for pid in descendants(process.pid):
            try:
                if pathlib.Path(f"/proc/{pid}/comm").read_text().strip() == program[:15]:
                    os.kill(pid, signal.SIGKILL)
                    return
            except (OSError, ProcessLookupError):
                continue
        time.sleep(0.01)


class Live:
    """A paused run, with ROS 2, and the server of the page."""

    def __init__(self, program, words, session, kills=()):
        self.program, self.session = program, session
        self.node = RosNode(program)
        self.process = program.start("run", *words, "--headless", "--paused", "--session", session)
        self.viewer = None
        self.await_text(self.process, "ready")
        for victim in kills:
            kill(self.process, victim)
        self.viewer = program.start("view", session, "--listen", "127.0.0.1:0")
        self.address = re.search(r"http://\S+", self.await_text(self.viewer, "http://"))[0]
        self.open_page()

    def open_page(self):
        """(a new client, the description of the world that it was sent). The server ends one that does not answer for a while."""
        client = PageClient(self.address)
        while True:
            kind, message = client.read()
            if kind == 2 and message[0] == WORLD:
                return client, message

    def await_text(self, process, part):
        text = ""
        while part not in text:
            line = process.stdout.readline()
            if not line:
                self.end()
                raise Failed(f"{' '.join(map(str, process.args[1:]))}: no {part}: {text}")
            text += line
        return text

    def ask(self, command, *words):
        """(status, text) of a tool"""
        return self.program.finish(command, "--session", self.session, *words)

    def end(self):
        if self.viewer:
            self.viewer.send_signal(signal.SIGINT)
            self.program.end_of(self.viewer, ["view"])
        self.process.send_signal(signal.SIGINT)
        text = self.program.end_of(self.process, ["run"])
        self.node.end()
        if self.process.returncode not in (0, 5, 130):
            raise Failed(f"the run ended with {self.process.returncode}: {text}")

    def tables(self):
        """Of the page's list of plots: the names of the things with signals, by table."""
        client, _ = self.open_page()
        reply = client.ask({"type": "series", "from": 0, "to": 1, "every": 1, "signals": []})
        return {table["name"]: table["things"] for table in reply["tables"] if table["signals"]}

    def tables_with(self, things):
        """The tables once they have these things, or after a while: an observer follows the reply to a request."""
        end = time.monotonic() + 20
        while True:
            tables = self.tables()
            if all(not thing.row or thing.row in tables[thing.table] for thing in things) or time.monotonic() > end:
                return tables
            time.sleep(0.05)


def ctl_get(live):
    def has(thing):
        status, text = live.ask("ctl", "get", thing.row)
        return status == 0 and thing.row in text
    return has


def ctl_list(live):
    _, listed = live.ask("ctl", "list")
    return lambda thing: re.search(rf"\b{re.escape(thing.row)}\b", listed)


def page(live):
    """The description of the world that it draws."""
    _, world = live.open_page()
    return lambda thing: (thing.row or thing.mark).encode() in world


def plots(live):
    tables = live.tables()
    return lambda thing: thing.row in tables[thing.table] if thing.row else bool(tables[thing.table])


def foxglove(live):
    client = PageClient(live.address, "foxglove.sdk.v1")
    topics, rows = {}, {}
    while not topics or len(rows) < len(topics):
        kind, message = client.read()
        text = json.loads(message) if kind == 1 else {}
        if text.get("op") == "advertise":  # again, with other ids, for a world that was edited meanwhile
            topics, rows = {channel["id"]: channel["topic"] for channel in text["channels"] if "/tables/" in channel["topic"]}, {}
            client.send({"op": "subscribe", "subscriptions": [{"id": channel, "channelId": channel} for channel in topics]})
        if kind == 2 and message[0] == DATA:
            subscription, _ = struct.unpack_from("<IQ", message, 1)
            if subscription in topics:
                rows[topics[subscription].split("/")[-1]] = [row.get("name") for row in json.loads(message[13:])["rows"]]
    return lambda thing: thing.row in rows[thing.table] if thing.row else bool(rows[thing.table])


def ros_topics(live):
    def has(thing):
        live.node.await_topic(thing.topic)
        return True
    return has


MAKERS = {"ctl get": ctl_get, "ctl list": ctl_list, "page": page, "plots": plots, "Foxglove live": foxglove,
          "ROS topics": ros_topics}
