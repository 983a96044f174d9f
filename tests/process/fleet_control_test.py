#!/usr/bin/python3
"""The fleet control of examples/fleet_control: vehicles never meet and never wait for each other for ever, whatever is lost, rejected
or taken over; equal messages lead to equal decisions; at a real broker neither side breaks a rule.

usage: fleet_control_test.py --programs FOLDER
"""
import argparse
import itertools
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import threading

import paho.mqtt.client as mqtt

HERE = pathlib.Path(__file__).resolve()
EXAMPLE = HERE.parents[2] / "examples/fleet_control"
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE.parent), str(EXAMPLE)]
from fleet_control import FleetControl, Job  # noqa: E402
from layout import BadLayout, Layout  # noqa: E402
from mqtt_broker import SECONDS, Broker, Listener  # noqa: E402
from plain_vehicle import PlainVehicle  # noqa: E402


def grid(columns, rows, homes):
    """A layout of aisles in both directions 3 m apart, with homes above and below."""
    nodes, edges, stations = [], [], []

    def add(name, x, y, actions=()):
        properties = [{"vehicleTypeId": "cart", "actions": [{"actionType": kind} for kind in actions]}]
        nodes.append({"nodeId": name, "mapId": "m", "nodePosition": {"x": x, "y": y}, "vehicleTypeNodeProperties": properties})

    def join(one, other):
        edges.extend({"edgeId": f"{start}-{end}", "startNodeId": start, "endNodeId": end} for start, end in ((one, other), (other, one)))

    for x, y in itertools.product(range(columns), range(rows)):
        add(f"n{x}_{y}", 3 * x, 3 * y)
        if x:
            join(f"n{x - 1}_{y}", f"n{x}_{y}")
        if y:
            join(f"n{x}_{y - 1}", f"n{x}_{y}")
        if (x + y) % 3 == 0:
            stations.append({"stationId": f"S{x}_{y}", "interactionNodeIds": [f"n{x}_{y}"]})
    for home in range(homes):
        x, side = home % columns, home // columns
        add(f"h{home}", 3 * x, -3 if side == 0 else 3 * rows, ["startCharging"])
        join(f"h{home}", f"n{x}_{0 if side == 0 else rows - 1}")
    return {"layouts": [{"nodes": nodes, "edges": edges, "stations": stations}]}


class Settings:
    def __init__(self, vehicles):
        self.vehicles, self.steps, self.horizon, self.load_type = vehicles, 2, 3, "load"


def jobs_of(layout, count, seed):
    draw = random.Random(seed)
    return [Job(i + 1, *draw.sample(sorted(layout.stations), 2)) for i in range(count)]


def play(version, seed, vehicles=10, jobs=25, trouble=False, fails=()):
    """A control and vehicles without a broker. Returns the news, with vehicles' visits."""
    layout = Layout(grid(6, 5, vehicles), clearance=1.2)
    news, fleet, orders = [], [], []
    control = FleetControl(layout, jobs_of(layout, jobs, seed), lambda topic, content: orders.append((topic, content)),
                           Settings(vehicles), news.append)
    for i in range(vehicles):
        vehicle = PlainVehicle(f"v{i:02}", f"h{i}", layout.positions[layout.nodes[f"h{i}"]],
                               lambda topic, text, _retain: control.receive(topic, text), version, fails)
        fleet.append(vehicle)
        vehicle.start()
    draw = random.Random(seed)
    conflicts, now = layout.conflicts, 1_767_225_600.0
    for turn in range(20_000):
        now += 1.0
        control.decide(now)
        if control.is_finished:
            break
        for topic, content in orders:
            if trouble and draw.random() < 0.05:
                continue  # lost
            place, _, last = topic.rpartition("/")
            next(each for each in fleet if each.topic == place).receive(last, json.dumps(content))
        orders.clear()
        for vehicle in fleet:
            if trouble and draw.random() < 0.002:
                vehicle.take_over(True)
            elif vehicle.mode == "MANUAL" and draw.random() < 0.1:
                vehicle.take_over(False)
            elif draw.random() < 0.7:
                vehicle.step()
        at = [layout.nodes[vehicle.last] for vehicle in fleet]
        for one, other in itertools.combinations(at, 2):
            assert not conflicts[one] >> other & 1, f"two vehicles at {layout.names[one]} and {layout.names[other]} at turn {turn}"
    assert control.is_finished, f"{control.done} of {control.total} jobs after {turn} turns: {news[-5:]}"
    assert all(vehicle.last == f"h{i}" for i, vehicle in enumerate(fleet)), "not all are at home"
    return control, news, [vehicle.visited for vehicle in fleet]


def check_play():
    for version in ("2.1.0", "3.0.0"):
        control, news, visited = play(version, 1)
        assert (control.done, control.failed) == (25, 0), news
        assert (news, visited) == play(version, 1)[1:], "the same messages lead to other decisions"
        assert visited != play(version, 2)[2]
        control, news, _ = play(version, 3, trouble=True)
        assert control.done + control.failed == 25 and control.done >= 20, news
        assert any("has dropped" in line for line in news), news
    control, news, _ = play("2.1.0", 4, jobs=6, fails=("drop",))
    assert (control.done, control.failed) == (0, 6) and any("failed: drop of Plain/" in line for line in news), news
    assert len(play("2.1.0", 5, vehicles=12, jobs=40)[1]) > 80


def check_layouts():
    content = grid(2, 2, 1)
    layout = Layout(content)
    assert layout.route(layout.nodes["h0"], layout.nodes["n1_1"]) is not None
    node, away = layout.nearest(2.9, 0.2, "m")
    assert node == layout.nodes["n1_0"] and abs(away - 0.05 ** 0.5) < 1e-9
    # Lanes that cross without a node, and a lane beside a node, are in conflict.
    cross = {"layouts": [{"nodes": [{"nodeId": name, "nodePosition": {"x": x, "y": y}, "mapId": "m"} for name, x, y in
                                    (("a", 0, 0), ("b", 4, 4), ("c", 0, 4), ("d", 4, 0), ("e", 2, 2.5))],
                          "edges": [{"edgeId": "ab", "startNodeId": "a", "endNodeId": "b"},
                                    {"edgeId": "cd", "startNodeId": "c", "endNodeId": "d"}]}]}
    layout = Layout(cross)
    parts = {name: number for number, name in enumerate(layout.names)}
    assert layout.conflicts[parts["ab"]] >> parts["cd"] & 1 and layout.conflicts[parts["e"]] >> parts["ab"] & 1
    assert not layout.conflicts[parts["a"]] >> parts["cd"] & 1
    for wrong in ({}, {"layouts": []}, {"layouts": [{"nodes": [{"nodeId": "a"}], "edges": []}]}, [], None):
        try:
            Layout(wrong)
        except BadLayout:
            continue
        raise AssertionError(f"{wrong} is no layout")


def check_broker(troupe, folder):
    vehicles, jobs = 6, 8
    content = grid(4, 3, vehicles)
    path = folder / "grid.lif.json"
    path.write_text(json.dumps(content))
    layout = Layout(content)
    with Broker(folder) as broker, Listener(troupe, "fleet", "check", "--vda5050", broker.url, "--log", folder / "log.jsonl") as checker:
        checker.wait_for("listening at ")
        client = mqtt.Client()
        fleet = {}
        lock = threading.Lock()

        def send(topic, text, retain):
            client.publish(topic, text, qos=1, retain=retain)

        for i in range(vehicles):
            version = "3.0.0" if i % 2 else "2.1.0"
            vehicle = PlainVehicle(f"v{i}", f"h{i}", layout.positions[layout.nodes[f"h{i}"]], send, version)
            fleet[vehicle.topic] = vehicle

        def on_message(_client, _data, message):
            with lock:
                place, _, last = message.topic.rpartition("/")
                vehicle = fleet.get(place)
                if vehicle is not None and last in ("order", "instantActions"):
                    vehicle.receive(last, message.payload)
                    while vehicle.step():
                        pass

        client.on_message = on_message
        client.connect("127.0.0.1", broker.port)
        client.subscribe([("uagv/+/+/+/order", 1), ("uagv/+/+/+/instantActions", 1)])
        client.loop_start()
        command = [sys.executable, EXAMPLE / "fleet_control.py", path, "--broker", broker.url, "--random", str(jobs), "--vehicles",
                   str(vehicles)]
        with Listener(*command) as control:
            with lock:
                for vehicle in fleet.values():
                    vehicle.start()
            status, lines = control.finish(interrupt=False)
        client.disconnect()
        client.loop_stop()
        assert status == 0 and lines[-1] == f"{jobs} of {jobs} jobs done, 0 failed", lines
        status, lines = checker.finish()
    assert status == 130, lines
    assert sum(line.endswith("no violation") for line in lines) == vehicles, lines
    for arguments, error in (([folder / "none", "--random", "1"], "No such file"), ([path, "--random", "1", "--broker", "x"], "expected mqtt://"),
                             ([path, "--jobs", path], "found no job")):
        done = subprocess.run([sys.executable, EXAMPLE / "fleet_control.py", *arguments], capture_output=True, text=True, timeout=SECONDS,
                              check=False)
        assert done.returncode == 2 and done.stderr.startswith("error: ") and error in done.stderr, done


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True)
    troupe = os.path.join(parser.parse_args().programs, "troupe")
    check_layouts()
    check_play()
    with tempfile.TemporaryDirectory() as name:
        check_broker(troupe, pathlib.Path(name))


main()
