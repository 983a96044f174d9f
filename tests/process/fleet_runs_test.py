#!/usr/bin/python3
"""Runs of a generated warehouse with the fleet control of examples/fleet_control are equal, tick by tick: those in one process at any
speed, with a broker that is slow, and without a broker in a replay; those with a process for each vehicle at any speed, and when the
service was killed. The former are not compared with the latter.

usage: fleet_runs_test.py --programs FOLDER [--vehicles N] [--ticks N] [--wait MS] [--only NAME ...]

Prints a row for each run: its name, the hash of its last tick, the hash of all, and its wall time.
"""
import argparse
import hashlib
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parent))
from mqtt_broker import SECONDS, Broker, Listener, free_port  # noqa: E402

EXAMPLE = HERE.parents[2] / "examples/fleet_control"
DELAY = 0.05  # s, of a slow broker, each way


class SlowBroker:
    """Passes the bytes of all connections on to a broker, and back, each some time later."""
    def __init__(self, broker):
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

    @staticmethod
    def _pass(source, sink):
        """What came at one time goes on at one time, later by the delay."""
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
                    waiting.append((time.monotonic() + DELAY, data))
                else:
                    ends.set()
                changed.notify()
            if not data:
                return

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.server.close()


def kill_service(troupe, run, session):
    """While the run is paused, so that no message is on its way."""
    def ask(*words):
        subprocess.run([troupe, "ctl", *words, "--session", session], check=True, capture_output=True, timeout=SECONDS)

    ask("pause")
    time.sleep(2.0)  # the fleet control has answered the last state
    children = pathlib.Path(f"/proc/{run.process.pid}/task/{run.process.pid}/children").read_text().split()
    service = next(int(pid) for pid in children if b"world-service" in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes())
    os.kill(service, signal.SIGKILL)
    run.wait_for("the world service has been started again")
    ask("play")


def play(arguments, folder, name):
    """A run; the text of its hash log."""
    troupe, log = arguments.programs / "troupe", folder / f"{name}.hashes"
    options, is_slow, is_killed = RUNS[name]
    session = f"fleet-runs-{os.getpid()}-{list(RUNS).index(name)}"
    with Broker(folder) as broker, SlowBroker(broker) as slow:
        url = slow.url if is_slow else broker.url
        wait = arguments.wait + (4000 * DELAY if is_slow else 0)
        with Listener(sys.executable, EXAMPLE / "fleet_control.py", folder / "warehouse.lif.json", "--broker", url, "--jobs",
                      folder / "warehouse.jobs", "--vehicles", str(arguments.vehicles), "--clearance", "1.1", "--patience", "60") as control:
            control.wait_for("listening at ")
            with Listener(troupe, "run", folder / "warehouse.json", "--vda5050", url, "--vda5050-wait", f"{wait:g}", "--headless", *options,
                          "--ticks", str(arguments.ticks), "--hash-log", log, "--record", folder / f"{name}.mcap", "--session", session) as run:
                if is_killed:
                    run.wait_for("says: order")
                    kill_service(troupe, run, session)
                lines = run.process.stdout.read()
                assert run.process.wait(SECONDS) == 0, run.lines[-5:] + lines.splitlines()[-10:]
    return log.read_text()


ONE, EACH = ["--in-process"], []
RUNS = {  # options, a slow broker, a kill
    "max": ([*ONE, "--speed", "max"], False, False),
    "max again": ([*ONE, "--speed", "max"], False, False),
    "speed 5": ([*ONE, "--speed", "5"], False, False),
    "speed 1": ([*ONE, "--speed", "1"], False, False),
    "slow broker, max": ([*ONE, "--speed", "max"], True, False),
    "slow broker, speed 5": ([*ONE, "--speed", "5"], True, False),
    "a process each, max": ([*EACH, "--speed", "max"], False, False),
    "a process each, speed 5": ([*EACH, "--speed", "5"], False, False),
    "service killed": ([*EACH, "--speed", "max"], False, True),
}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True, type=pathlib.Path)
    parser.add_argument("--vehicles", type=int, default=4)
    parser.add_argument("--ticks", type=int, default=300)
    parser.add_argument("--wait", type=int, default=300)
    parser.add_argument("--only", nargs="*")
    arguments = parser.parse_args()
    wrong = []
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        subprocess.run([sys.executable, EXAMPLE / "make_warehouse.py", folder, "--vehicles", str(arguments.vehicles), "--jobs", "50", "--doors"],
                       check=True)
        names = [name for name in RUNS if not arguments.only or name in arguments.only]
        firsts = {}

        def compare(name, text, seconds):
            is_one = name not in RUNS or RUNS[name][0][:1] == ONE
            first = firsts.setdefault(is_one, text)
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
