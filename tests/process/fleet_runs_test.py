#!/usr/bin/python3
"""Runs of a generated warehouse in lockstep with the fleet control of examples/fleet_control are equal, tick by tick: in one process and
with a process for each vehicle, at any speed, with a broker that delays each message by another time, when the service was killed, and
without a broker in a replay.

usage: fleet_runs_test.py --programs FOLDER [--vehicles N] [--ticks N] [--only NAME ...]

Prints a row for each run: its name, the hash of its last tick, the hash of all, and its wall time.
"""
import argparse
import hashlib
import itertools
import json
import os
import pathlib
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

import paho.mqtt.client as mqtt

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parent))
from mqtt_broker import SECONDS, Broker, Listener, free_port  # noqa: E402

EXAMPLE = HERE.parents[2] / "examples/fleet_control"
DELAY = 0.2  # s, at most, of a slow broker, each way


class SlowBroker:
    """Passes the bytes of all connections on to a broker, and back, each some time later: those of a connection in their sequence, those of
    two connections in any. Other seeds have other delays."""
    def __init__(self, broker, seed):
        self.seed, self.passes = seed, itertools.count()
        self.to, self.port = broker.port, free_port()
        self.server = socket.create_server(("127.0.0.1", self.port))
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def url(self):
        return f"mqtt://127.0.0.1:{self.port}"

    def _accept(self):
        while True:
            try:
                client, _ = self.server.accept()
            except OSError:
                return
            broker = socket.create_connection(("127.0.0.1", self.to))
            for source, sink in ((client, broker), (broker, client)):
                source.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                threading.Thread(target=self._pass, args=(source, sink), daemon=True).start()

    def _pass(self, source, sink):
        draw = random.Random(f"{self.seed} {next(self.passes)}")
        waiting, ends = [], threading.Event()
        changed = threading.Condition()

        def deliver():
            while True:
                with changed:
                    changed.wait_for(lambda: waiting or ends.is_set())
                    if not waiting:
                        break
                    due, data = waiting.pop(0)
                time.sleep(max(0.0, due - time.monotonic()))
                try:
                    sink.sendall(data)
                except OSError:
                    break
            try:
                sink.shutdown(socket.SHUT_WR)
            except OSError:
                pass

        threading.Thread(target=deliver, daemon=True).start()
        while True:
            try:
                data = source.recv(1 << 16)
            except OSError:
                data = b""
            with changed:
                if data:
                    waiting.append((time.monotonic() + draw.uniform(0.0, DELAY), data))
                else:
                    ends.set()
                changed.notify()
            if not data:
                return

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.server.close()


class Questions:
    """The questions of the run to the fleet control: their ticks, in the sequence in which they came."""
    def __init__(self, broker):
        self.ticks, self.changed = [], threading.Condition()
        self.client = mqtt.Client()
        self.client.on_connect = lambda client, *_: client.subscribe("troupe/lockstep/tick", 1)
        self.client.on_message = self._on_message
        self.client.connect("127.0.0.1", broker.port)
        self.client.loop_start()

    def _on_message(self, _client, _data, message):
        with self.changed:
            self.ticks.append(json.loads(message.payload)["tick"])
            self.changed.notify()

    def wait_for(self, is_enough):
        with self.changed:
            assert self.changed.wait_for(lambda: is_enough(self.ticks), SECONDS), self.ticks[-5:]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.client.disconnect()
        self.client.loop_stop()


def pause(troupe, session):
    for word in ("pause", "play"):
        subprocess.run([troupe, "ctl", word, "--session", session], check=True, capture_output=True, timeout=SECONDS)


def kill_service(run, control, questions):
    """While it waits for the fleet control, whose answer comes too late, and is lost."""
    control.process.send_signal(signal.SIGSTOP)
    questions.wait_for(lambda ticks: len(ticks) > 1 and ticks[-1] == ticks[-2])
    children = pathlib.Path(f"/proc/{run.process.pid}/task/{run.process.pid}/children").read_text().split()
    service = next(int(pid) for pid in children if b"world-service" in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes())
    os.kill(service, signal.SIGKILL)
    run.wait_for("the world service has been started again")
    control.process.send_signal(signal.SIGCONT)


def play(arguments, folder, name):
    """A run; the text of its hash log."""
    troupe, log = arguments.programs / "troupe", folder / f"{name}.hashes"
    options, is_slow, trouble = RUNS[name]
    session = f"fleet-runs-{os.getpid()}-{list(RUNS).index(name)}"
    with Broker(folder) as broker, SlowBroker(broker, name) as slow, Questions(broker) as questions:
        url = slow.url if is_slow else broker.url
        with Listener(sys.executable, EXAMPLE / "fleet_control.py", folder / "warehouse.lif.json", "--broker", url, "--jobs",
                      folder / "warehouse.jobs", "--vehicles", str(arguments.vehicles), "--clearance", "1.1", "--lockstep") as control:
            control.wait_for("listening at ")
            with Listener(troupe, "run", folder / "warehouse.json", "--vda5050", url, "--vda5050-wait", "lockstep", "--headless",
                          *options, "--ticks", str(arguments.ticks), "--hash-log", log, "--record", folder / f"{name}.mcap", "--session", session) as run:
                if trouble:
                    questions.wait_for(lambda ticks: ticks and ticks[-1] >= arguments.ticks // 5)
                if trouble == "kill":
                    kill_service(run, control, questions)
                elif trouble == "pause":
                    pause(troupe, session)
                lines = run.process.stdout.read()
                assert run.process.wait(SECONDS) == 0, run.lines[-5:] + lines.splitlines()[-10:]
    return log.read_text()


ONE, EACH = ["--in-process"], []
RUNS = {  # options, a slow broker, trouble
    "max": ([*ONE, "--speed", "max"], False, None),
    "max again": ([*ONE, "--speed", "max"], False, None),
    "speed 5": ([*ONE, "--speed", "5"], False, None),
    "speed 1": ([*ONE, "--speed", "1"], False, None),
    "slow broker, max": ([*ONE, "--speed", "max"], True, None),
    "slow broker, again": ([*ONE, "--speed", "max"], True, None),
    "a process each, max": ([*EACH, "--speed", "max"], False, None),
    "a process each, speed 5": ([*EACH, "--speed", "5"], False, None),
    "a process each, slow broker": ([*EACH, "--speed", "max"], True, None),
    "paused": ([*EACH, "--speed", "1"], False, "pause"),
    "service killed": ([*EACH, "--speed", "1"], False, "kill"),
}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True, type=pathlib.Path)
    parser.add_argument("--vehicles", type=int, default=4)
    parser.add_argument("--ticks", type=int, default=300)
    parser.add_argument("--only", nargs="*")
    arguments = parser.parse_args()
    wrong = []
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        subprocess.run([sys.executable, EXAMPLE / "make_warehouse.py", folder, "--vehicles", str(arguments.vehicles), "--jobs", "50", "--doors"],
                       check=True)
        names = [name for name in RUNS if not arguments.only or name in arguments.only]
        first = ""

        def compare(name, text, seconds):
            nonlocal first
            first = first or text
            assert len(text.splitlines()) == arguments.ticks + 1, f"{name}: {len(text.splitlines())} ticks"
            whole = hashlib.sha256(text.encode()).hexdigest()[:16]
            print(f"| {name} | {text.split()[-1]} | {whole} | {seconds:.0f} s |", flush=True)
            if text != first:
                tick = next(i for i, (a, b) in enumerate(zip(text.splitlines(), first.splitlines())) if a != b)
                wrong.append(f"{name}: differs from tick {tick} on")

        for name in names:
            begin = time.monotonic()
            compare(name, play(arguments, folder, name), time.monotonic() - begin)
        begin = time.monotonic()
        log = folder / "replay.hashes"
        subprocess.run([arguments.programs / "troupe", "replay", folder / f"{names[0]}.mcap", "--verify", "--controllers", "--hash-log", log],
                       check=True, capture_output=True)
        compare("replay, without a broker", log.read_text(), time.monotonic() - begin)
        assert (folder / f"{names[0]}.mcap").stat().st_size > 0
    assert not wrong, wrong


main()
