#!/usr/bin/python3
"""Hours of a generated warehouse with doors and people, in lockstep with the fleet control of examples/fleet_control: no vehicle is
stuck, and no job fails.

usage: fleet_hours_test.py --programs FOLDER [--hours H] [--vehicles N] [--people N] [--patience S] [--free X]

A vehicle is stuck when it has something to do and has made no step of it (a node, an action, a part of its order) for the patience.
Prints a line for each simulated half hour, and the longest pauses at the end. The run is the same on any machine:
8 hours of 50 vehicles are those of `--hours 8 --vehicles 50 --people 6`. With --free the run does not wait for the fleet control, and takes
a third of the time or less: it goes on at X times real time, or as fast as it can, and is another one each time.
"""
import argparse
import datetime
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time

import paho.mqtt.client as mqtt

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parent))
from mqtt_broker import SECONDS, Broker  # noqa: E402

EXAMPLE = HERE.parents[2] / "examples/fleet_control"
JOBS_PER_HOUR = 12  # and vehicle: more than many vehicles can do; few may have done all before the end
TICKS_PER_HOUR = 36_000


class Progress:
    """Of vehicles, by their states: when each has made its last step, in simulated time."""
    def __init__(self):
        self.steps, self.longest, self.now, self.errors = {}, {}, 0.0, {}

    def take(self, topic, state):
        self.now = max(self.now, datetime.datetime.fromisoformat(state["timestamp"].replace("Z", "+00:00")).timestamp())
        vehicle = topic.split("/")[3]
        actions = [(each["actionId"], each["actionStatus"]) for each in state["actionStates"]]
        has_work = bool(state["nodeStates"]) or any(status not in ("FINISHED", "FAILED") for _, status in actions)
        step = (state["orderId"], state["orderUpdateId"], state["lastNodeSequenceId"], len(state["nodeStates"]), actions)
        before = self.steps.get(vehicle)
        if before is None or before[0] != step or not has_work:
            self.steps[vehicle] = step, self.now
        self.errors[vehicle] = [error["errorType"] for error in state["errors"]]
        self.longest[vehicle] = max(self.longest.get(vehicle, 0.0), self.now - self.steps[vehicle][1])

    def stuck(self, patience):
        return [vehicle for vehicle, pause in self.longest.items() if pause > patience]


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # through the ends of its programs
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True, type=pathlib.Path)
    parser.add_argument("--hours", type=float, default=0.1)
    parser.add_argument("--vehicles", type=int, default=12)
    parser.add_argument("--people", type=int, default=4)
    parser.add_argument("--patience", type=float, default=900.0, help="s, simulated")
    parser.add_argument("--free", metavar="X", help="speed of a run without lockstep")
    arguments = parser.parse_args()
    progress, lock = Progress(), threading.Lock()
    ticks = round(arguments.hours * TICKS_PER_HOUR)
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        jobs = max(10, round(JOBS_PER_HOUR * arguments.hours * arguments.vehicles))
        subprocess.run([sys.executable, EXAMPLE / "make_warehouse.py", folder, "--vehicles", str(arguments.vehicles), "--jobs", str(jobs),
                        "--people", str(arguments.people), "--doors"], check=True)
        # Without visualizations many ticks have no message, and need no answer.
        scenario = json.loads((folder / "warehouse.json").read_text())
        for robot in scenario["robots"]:
            robot["controller"]["parameters"]["visualization_interval"] = 0
        (folder / "warehouse.json").write_text(json.dumps(scenario))
        with Broker(folder) as broker, open(folder / "control", "wb") as told, open(folder / "run", "wb") as lines:
            client = mqtt.Client()
            subscribed = threading.Event()

            def on_message(_client, _data, message):
                with lock:
                    progress.take(message.topic, json.loads(message.payload))

            client.on_connect = lambda client, *_: client.subscribe("+/+/+/+/state", 0)
            client.on_subscribe = lambda *_: subscribed.set()
            client.on_message = on_message
            client.connect("127.0.0.1", broker.port)
            client.loop_start()
            assert subscribed.wait(SECONDS)
            control = subprocess.Popen([sys.executable, EXAMPLE / "fleet_control.py", folder / "warehouse.lif.json", "--broker", broker.url,
                                        "--jobs", folder / "warehouse.jobs", "--vehicles", str(arguments.vehicles), "--clearance", "1.1",
                                        *([] if arguments.free else ["--lockstep"])], stdout=told, stderr=told)
            wait = ["--speed", arguments.free] if arguments.free else ["--speed", "max", "--vda5050-wait", "lockstep"]
            run = subprocess.Popen([arguments.programs / "troupe", "run", folder / "warehouse.json", "--vda5050", broker.url, "--headless",
                                    "--in-process", "--ticks", str(ticks), *wait], stdout=lines, stderr=lines)
            try:
                begin, next_line, first = time.monotonic(), 1800.0, None
                while run.poll() is None:
                    time.sleep(1.0)
                    if control.poll() is not None:  # all jobs are done
                        assert control.returncode == 0, (folder / "control").read_text()[-1000:]
                        run.send_signal(signal.SIGINT)
                        run.wait(SECONDS)
                        break
                    with lock:
                        now, stuck = progress.now, progress.stuck(arguments.patience)
                    first = first or now
                    assert not stuck, [(vehicle, progress.steps[vehicle], progress.errors[vehicle]) for vehicle in stuck]
                    if first and now - first >= next_line:
                        done = (folder / "control").read_text().count(": done by ")
                        print(f"{(now - first) / 3600:.2f} h: {done} jobs, {time.monotonic() - begin:.0f} s", flush=True)
                        next_line += 1800.0
            finally:
                for process in (run, control):
                    if process.poll() is None:
                        process.kill()
                    process.wait()
                client.disconnect()
                client.loop_stop()
        output, news = (folder / "run").read_text(), (folder / "control").read_text()
        assert run.returncode in (0, 130), output[-2000:]
        assert not progress.stuck(arguments.patience), progress.longest
        assert len(progress.steps) == arguments.vehicles
        done, failed = news.count(": done by "), news.count(": failed")
        print(f"{arguments.hours:g} h: {done} jobs, {failed} failed, {time.monotonic() - begin:.0f} s; the longest pauses: "
              + ", ".join(f"{pause:.0f} s" for pause in sorted(progress.longest.values())[-3:]))
        print("\n".join(line for line in output.splitlines()[-12:] if line.strip()))
        assert done > 0 and failed == 0, news[-2000:]


main()
