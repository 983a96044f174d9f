#!/usr/bin/python3
"""What the gateway to fleet controls costs with many vehicles of VDA 5050: the processor time of a message, and the time from a message
of a fleet control to the state that answers it.

usage: fleet_gateway.py --programs FOLDER [--vehicles N] [--seconds S] [--rate R] [--speed X]

A run of N vehicles (1,000) with a state each second is played twice for S simulated seconds (60), without a broker and with Debian's
mosquitto on loopback; the difference of the processor times, connections included, is the gateway's. Meanwhile a client sends R instant
actions in a second of wall time (50) to vehicles in turn, which the states show: the latency is from the call that publishes an action to
the call that delivers such a state. Of it the wait for the next tick is a part, half an interval (of 100 ms at --speed 1) on average. An
echo, what the client sends to itself through the broker at the same time, says what of it is the broker's and the client's own.
"""
import argparse
import json
import os
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time

import paho.mqtt.client as mqtt

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests/process"))
from mqtt_broker import SECONDS, Broker  # noqa: E402

SPACING = 2.0  # m between vehicles
WORLD = """name "many_vehicles"
define cart position ( size [0.8 0.6 0.3] drive "diff" kjoules 600 watts 10 )
"""


def write_scenario(folder, count):
    """Vehicles on a grid that stand still: what is measured is messages."""
    side = 1
    while side * side < count:
        side += 1
    names = [f"cart_{i}" for i in range(count)]
    carts = "".join(f'cart( name "{name}" pose [{SPACING * (i % side)} {SPACING * (i // side)} 0 0] )\n' for i, name in enumerate(names))
    (folder / "many.world").write_text(WORLD + carts)
    controller = {"name": "vda5050", "parameters": {"map": "hall", "state_interval": 1.0, "visualization_interval": 0}}
    path = folder / "many.json"
    path.write_text(json.dumps({"world": "many.world", "robots": [{"name": name, "controller": controller} for name in names]}))
    return path, names


class Client:
    """Sends actions, and takes the times of the states that show them."""
    def __init__(self, port, names):
        self.lock, self.names, self.number = threading.Lock(), names, 0
        self.sent, self.latencies, self.echoes, self.messages, self.bytes = {}, [], [], 0, 0
        self.states = set()
        self.client = mqtt.Client()
        self.client.on_socket_open = lambda _client, _data, opened: opened.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.client.max_inflight_messages_set(1000)
        ready = threading.Event()
        self.client.on_connect = lambda client, *_: client.subscribe([("uagv/v2/Troupe/+/state", 0), ("benchmark/echo", 0)])
        self.client.on_subscribe = lambda *_: ready.set()
        self.client.on_message = self._on_message
        self.client.connect("127.0.0.1", port)
        self.client.loop_start()
        assert ready.wait(SECONDS)

    def _on_message(self, _client, _data, message):
        now = time.perf_counter()
        if message.topic == "benchmark/echo":
            self.echoes.append(now - float(message.payload))
            return
        with self.lock:
            self.messages += 1
            self.bytes += len(message.payload)
            self.states.add(message.topic)
            for found in re.findall(rb'"actionId":"(b-\d+)"', message.payload):
                begin = self.sent.pop(found, None)
                if begin is not None:
                    self.latencies.append(now - begin)

    def send(self):
        name = self.names[self.number % len(self.names)]
        identity = f"b-{self.number}"
        self.number += 1
        action = {"actionType": "stateRequest", "actionId": identity, "blockingType": "NONE"}
        message = {"headerId": self.number // len(self.names), "timestamp": "2026-01-01T00:00:00.00Z", "version": "2.1.0",
                   "manufacturer": "Troupe", "serialNumber": name, "actions": [action]}
        text = json.dumps(message)
        with self.lock:
            self.sent[identity.encode()] = time.perf_counter()
        self.client.publish(f"uagv/v2/Troupe/{name}/instantActions", text)
        self.client.publish("benchmark/echo", repr(time.perf_counter()))

    def close(self):
        self.client.disconnect()
        self.client.loop_stop()


def share(values, part):
    return 1e3 * sorted(values)[min(len(values) - 1, int(part * len(values)))]


def play(arguments, path, names, broker=None):
    """Processor seconds and wall seconds of the run, and the client."""
    more = ["--vda5050", broker.url] if broker else []
    client = Client(broker.port, names) if broker else None
    ticks = str(round(10 * arguments.seconds))
    begin, sent, first = time.monotonic(), 0, None
    run = subprocess.Popen([arguments.programs / "troupe", "run", path, "--in-process", "--headless", "--speed", arguments.speed, "--ticks",
                            ticks, *more], stdout=subprocess.DEVNULL)
    while True:
        pid, status, usage = os.wait4(run.pid, os.WNOHANG)
        if pid:
            break
        now = time.monotonic()
        if client and first is None and len(client.states) == len(names):
            first = now
        while first is not None and sent < (now - first) * arguments.rate:
            client.send()
            sent += 1
        time.sleep(0.5 / arguments.rate)
    run.returncode = os.waitstatus_to_exitcode(status)
    assert run.returncode == 0, run.returncode
    if client:
        client.close()
    return usage.ru_utime + usage.ru_stime, time.monotonic() - begin, client


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True, type=pathlib.Path)
    parser.add_argument("--vehicles", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rate", type=float, default=50.0)
    parser.add_argument("--speed", default="1")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        path, names = write_scenario(folder, arguments.vehicles)
        alone, _, _ = play(arguments, path, names)
        with Broker(folder) as broker:
            used, seconds, client = play(arguments, path, names, broker)
    print(f"{arguments.vehicles} vehicles, {arguments.seconds:g} s at speed {arguments.speed}: {client.messages} states of "
          f"{client.bytes / client.messages:.0f} bytes each in {seconds:.0f} s; the run took {used:.2f} s of processor time with the broker and "
          f"{alone:.2f} s without, {1e6 * (used - alone) / client.messages:.0f} us for each message")
    print(f"{len(client.latencies)} of {client.number} actions shown by a state")
    for name, values in (("latency", client.latencies), ("echo", client.echoes)):
        print(f"{name:8} " + ", ".join(f"{label} {share(values, part):.1f} ms"
                                       for label, part in (("median", 0.5), ("90 %", 0.9), ("99 %", 0.99), ("most", 1.0))))


if __name__ == "__main__":
    main()
