#!/usr/bin/python3
"""A fleet control of VDA 5050 (2.0, 2.1, 3.0): transport orders over the nodes of a layout in LIF, and vehicles that do not meet.

usage: fleet_control.py LAYOUT [--broker mqtt://HOST[:PORT]] [--jobs FILE | --random N] [...]      see --help

A line of FILE is a job, {"from": PLACE, "to": PLACE}, where places are stations or nodes of the layout. Ends when all jobs are done
and all vehicles are at home; its exit status is 1 if a job failed.
"""
import argparse
import datetime
import json
import random
import signal
import socket
import sys
import time
import urllib.parse

import paho.mqtt.client as mqtt

from layout import BadLayout, Layout
from traffic import Traffic
from vehicles import Vehicle

RESEND_SECONDS = 3.0    # without an answer of the vehicle
RETRY_SECONDS = 5.0     # from a rejection to the next order
SETTLED_SECONDS = 0.02  # without a message, before a decision
CANDIDATES = 3          # vehicles that are tried for a job at once
LOW, ENOUGH = 30.0, 80.0  # %: a vehicle with less charges at home, until it has enough
REACH = 1.0             # m from a node at which a vehicle is first seen
ASK_TOPIC, ANSWER_TOPIC = "troupe/lockstep/tick", "troupe/lockstep/done"


class Job:
    def __init__(self, number, start, end):
        self.number, self.start, self.end = number, start, end
        self.failures = 0


class Task:
    """What the control does with a vehicle: nothing, a job, or the way home. `next`: a job with its route's stops, for when it stands."""
    def __init__(self):
        self.kind, self.job, self.next, self.retry_at = "none", None, None, 0.0
        self.is_charging, self.is_low = False, False


class FleetControl:
    """Decides by the messages alone, in the order in which they came. `tell(line)`: news for people."""
    def __init__(self, layout, jobs, send, settings, tell=print):
        self.layout, self.settings, self.send, self.tell = layout, settings, send, tell
        self.waiting = list(jobs)
        self.total, self.done, self.failed = len(self.waiting), 0, 0
        self.traffic = Traffic(layout)
        self.vehicles, self.tasks, self.told = {}, {}, set()

    def receive(self, topic, payload):
        """A message of a vehicle; others are ignored."""
        place, _, last = topic.rpartition("/")
        if last not in ("connection", "factsheet", "state") or place.count("/") < 3:
            return
        if place not in self.vehicles:
            self.vehicles[place] = Vehicle(place, self.send)
            self.tasks[place] = Task()
        try:
            self.vehicles[place].receive(last, json.loads(payload))
        except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as problem:
            self.tell_once(f"{place}: a {last} that cannot be read: {problem!r}")

    def tell_once(self, line):
        if line not in self.told:
            self.told.add(line)
            self.tell(line)

    @property
    def is_finished(self):
        return not self.waiting and len(self.traffic.travellers) >= self.settings.vehicles and all(
            task.kind == "none" and task.next is None for place, task in self.tasks.items() if place in self.traffic.travellers)

    def decide(self, now):
        for place in sorted(self.vehicles):
            # One that was there before has sent its state already.
            vehicle = self.vehicles[place]
            if vehicle.is_online and vehicle.state is None and now - vehicle.asked_at > RETRY_SECONDS:
                vehicle.asked_at = now
                vehicle.act("stateRequest", now)
        ready = [place for place in sorted(self.vehicles) if self.vehicles[place].is_ready and self._is_placed(place)]
        for place in ready:
            self._follow(place, now)
        if len(self.traffic.travellers) >= self.settings.vehicles:
            self._assign(ready)
        for place in ready:
            self._start(place, now)
        for place in ready:
            self._extend(place, now)

    def _is_placed(self, place):
        """The node at which a vehicle is first seen is its home."""
        if place in self.traffic.travellers:
            return True
        vehicle = self.vehicles[place]
        position = vehicle.state["position"]
        node = self.layout.nodes.get(vehicle.state["last"])
        if node is None and "x" in position:
            node, away = self.layout.nearest(position["x"], position["y"], position.get("mapId"))
            if away > REACH:
                self.tell_once(f"{vehicle.name}: found it {away:.1f} m from the nearest node, expected at most {REACH:g} m")
                return False
        if node is None or not self.traffic.add(place, node, node):
            if node is not None:
                self.tell_once(f"{vehicle.name}: the place of another vehicle is too near to {self.layout.names[node]}")
            return False
        self.tell(f"{vehicle.name}: at home at {self.layout.names[node]}")
        return True

    def _follow(self, place, now):
        vehicle, task = self.vehicles[place], self.tasks[place]
        if vehicle.order is None or task.kind not in ("job", "home"):
            return
        if vehicle.rejection is not None and not vehicle.has_answered:
            self.tell(f"{vehicle.name}: rejects {vehicle.order['id']}: {vehicle.rejection}")
            self._give_up(place, now)
            return
        passed = vehicle.passed
        if passed is None:
            return
        self.traffic.pass_node(place, passed)
        if not vehicle.is_idle:
            return
        if passed >= vehicle.order["end"]:
            self._finish(place)
        elif passed < vehicle.order["base"] or vehicle.order["horizon"] > 0:
            # Cancelled, or taken over by a person.
            self.tell(f"{vehicle.name}: has dropped {vehicle.order['id']}")
            self._give_up(place, now)

    def _finish(self, place):
        vehicle, task = self.vehicles[place], self.tasks[place]
        failed = vehicle.failed_actions()
        if task.job is not None and failed:
            self.failed += 1
            self.tell(f"job {task.job.number}: failed: {', '.join(failed)} of {vehicle.name}")
        elif task.job is not None:
            self.done += 1
            self.tell(f"job {task.job.number}: done by {vehicle.name}")
        task.is_charging = task.kind == "home" and bool(vehicle.order["actions"])
        task.kind, task.job = "none", None

    def _give_up(self, place, now):
        vehicle, task = self.vehicles[place], self.tasks[place]
        if vehicle.state["nodes"] > 0:
            vehicle.act("cancelOrder", now)
        for job in [task.job, task.next and task.next[0]]:
            if job is None:
                continue
            job.failures += 1
            if job.failures < 3:
                self.waiting.insert(0, job)
            else:
                self.failed += 1
                self.tell(f"job {job.number}: failed: given up")
        task.kind, task.job, task.next, task.retry_at = "lost", None, None, now + RETRY_SECONDS

    def _assign(self, ready):
        """The first job whose nearest vehicles can take it, and so on. Jobs at one station are done in their order."""
        running = [task.job or task.next[0] for task in self.tasks.values() if task.job or task.next]
        in_use = {station for job in running for station in (job.start, job.end)}
        for job in list(self.waiting):
            stations = {job.start, job.end}
            is_late = bool(stations & in_use)
            in_use |= stations
            if is_late:
                continue
            free = [place for place in ready if self.tasks[place].kind in ("none", "home") and self.tasks[place].next is None
                    and not self._is_low(place)]
            if not free:
                return
            pick = self.layout.place(job.start)

            def away(place, pick=pick):
                traveller = self.traffic.travellers[place]
                return self.layout.length(traveller.route[traveller.base], pick), place

            for place in sorted(free, key=away)[:CANDIDATES]:
                found = self.traffic.find_route(place, [pick, self.layout.place(job.end)])
                if found is None:
                    self.tell_once(f"{self.vehicles[place].name}: no way from {job.start} to {job.end} and home")
                elif self.traffic.take_route(place, found[0]):
                    self.tasks[place].next = job, found[1]
                    self.waiting.remove(job)
                    self.tell(f"job {job.number}: {job.start} to {job.end} by {self.vehicles[place].name}")
                    break

    def _is_low(self, place):
        task, charge = self.tasks[place], self.vehicles[place].state["charge"]
        can_charge = self.traffic.travellers[place].home in self.layout.chargers and self.vehicles[place].can("startCharging", "NODE")
        task.is_low = can_charge and charge < (ENOUGH if task.is_low else LOW)
        return task.is_low

    def _start(self, place, now):
        """A new order for a vehicle that stands at the end of its granted route."""
        vehicle, task, traveller = self.vehicles[place], self.tasks[place], self.traffic.travellers[place]
        if task.kind == "lost":
            if now < task.retry_at or vehicle.state["nodes"] > 0 or vehicle.instant:
                return
            node = self.layout.nodes.get(vehicle.state["last"], traveller.route[traveller.at])
            self.traffic.relocate(place, node)
            task.kind = "none"
        stands = traveller.at == traveller.base and (vehicle.order is None or vehicle.is_idle)
        if not stands or task.kind == "job" or (task.kind == "home" and task.next is None):
            return
        if task.is_charging and (task.next or len(traveller.route) > traveller.base + 1):
            task.is_charging = False
            if vehicle.can("stopCharging", "INSTANT"):
                vehicle.act("stopCharging", now)
                return
        if task.next is not None:
            job, stops = task.next
            actions = {}
            for stop, kind in zip(stops, ("pick", "drop")):
                if vehicle.can(kind, "NODE"):
                    station = job.start if kind == "pick" else job.end
                    actions.setdefault(stop, []).append((kind, {"stationType": "floor", "stationName": station,
                                                               "loadType": self.settings.load_type}))
            self.traffic.start_here(place)
            vehicle.start(traveller.route, stops[-1], actions, "job", self.layout, self.settings.horizon)
            task.kind, task.job, task.next = "job", job, None
        elif task.kind == "none" and len(traveller.route) > traveller.base + 1:
            self.traffic.start_here(place)
            end = len(traveller.route) - 1
            charge = traveller.home in self.layout.chargers and vehicle.can("startCharging", "NODE")
            # Without a horizon the vehicle is idle wherever it stands, and can take a job on the way.
            vehicle.start(traveller.route, end, {end: [("startCharging", {})]} if charge else {}, "home", self.layout, 0)
            task.kind = "home"

    def _extend(self, place, now):
        vehicle, task, traveller = self.vehicles[place], self.tasks[place], self.traffic.travellers[place]
        if task.kind not in ("job", "home"):
            return
        order = vehicle.order
        if not vehicle.has_answered and order["update"] >= 0:
            if now - vehicle.sent_at > RESEND_SECONDS:
                vehicle.repeat(now)
            return
        if task.next is None:
            while traveller.base - traveller.at < self.settings.steps and self.traffic.extend(place, order["end"]):
                pass
        if traveller.base > order["base"] and (traveller.base > 0 or order["end"] == 0):
            vehicle.release(traveller.base, now)


class Connection:
    """The messages of a broker, one after another. `loop` returns whether some have come; `ask` receives questions of the lockstep."""
    def __init__(self, arguments, receive, ask=None):
        url = urllib.parse.urlsplit(arguments.broker)
        if url.scheme not in ("mqtt", "mqtts") or not url.hostname:
            raise ValueError(f"found the broker '{arguments.broker}', expected mqtt://HOST[:PORT] or mqtts://HOST[:PORT]")
        self.client, self.came, self.patience = mqtt.Client(), 0, arguments.patience
        topics = [f"{arguments.interface}/+/+/+/{topic}" for topic in ("connection", "factsheet", "state")]
        topics += [ASK_TOPIC] if ask else []
        self.client.on_connect = lambda client, *_: client.subscribe([(topic, 1) for topic in topics])
        self.client.on_subscribe = lambda *_: print(f"listening at {arguments.broker}", flush=True)
        self.client.on_message = self._on_message
        # An answer goes out at once, and does not wait for the acknowledgement of the message before it (40 ms).
        self.client.on_socket_open = lambda _client, _data, opened: opened.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.receive, self.ask = receive, ask
        if url.scheme == "mqtts":
            self.client.tls_set(ca_certs=arguments.ca)
        self.client.connect(url.hostname, url.port or (8883 if url.scheme == "mqtts" else 1883))

    def _on_message(self, _client, _data, message):
        self.came += 1
        if message.topic == ASK_TOPIC:
            self.ask(message.payload)
        else:
            self.receive(message.topic, message.payload)

    def send(self, topic, content):
        self.client.publish(topic, json.dumps(content))

    def exchange(self, seconds):
        if self.client.loop(seconds) != mqtt.MQTT_ERR_SUCCESS:
            time.sleep(seconds)
            try:
                self.client.reconnect()
            except OSError:
                pass

    def loop(self, seconds):
        self.came = 0
        self.exchange(seconds)
        # What comes without a pause is one situation, but many fast vehicles never make one.
        end = time.monotonic() + SETTLED_SECONDS
        latest = time.monotonic() + self.patience
        while self.came and time.monotonic() < min(end, latest):
            before = self.came
            self.client.loop(SETTLED_SECONDS)
            if self.came > before:
                end = time.monotonic() + SETTLED_SECONDS
        return self.came > 0


class Lockstep:
    """Decides when the run asks, after each tick in which vehicles have sent messages, and answers then.

    A question that comes again is answered again. One of another service, which continues the run, brings what was sent in this tick
    again, because the service before may have lost it.
    """
    def __init__(self, send):
        self.send_to_broker = send
        self.control, self.asked, self.sent = None, None, []

    def send(self, topic, content):
        self.sent.append((topic, content))
        self.send_to_broker(topic, content)

    def ask(self, payload):
        try:
            question = json.loads(payload)
            place, service = (question["run"], question["tick"]), question["service"]
            now = datetime.datetime.fromisoformat(question["timestamp"].replace("Z", "+00:00")).timestamp()
        except (KeyError, TypeError, ValueError, AttributeError) as problem:
            return self.control.tell_once(f"a question that cannot be read: {problem!r}")
        before, self.asked = self.asked, (place, service)
        if before is None or place != before[0]:
            self.sent.clear()
            self.control.decide(now)
        elif service != before[1]:
            for message in self.sent:
                self.send_to_broker(*message)
        answer = {"run": place[0], "tick": place[1]}
        return self.send_to_broker(ANSWER_TOPIC, answer | {"leaves": True} if self.control.is_finished else answer)


def read_jobs(arguments, layout):
    if arguments.random:
        places = sorted(layout.stations) or sorted(layout.nodes)
        draw = random.Random(arguments.seed)
        return [Job(i + 1, *draw.sample(places, 2)) for i in range(arguments.random)]
    jobs = []
    with open(arguments.jobs, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            try:
                content = json.loads(line)
                job = Job(len(jobs) + 1, content["from"], content["to"])
            except (ValueError, KeyError, TypeError) as problem:
                raise ValueError(f"{arguments.jobs}:{number}: found no job: {problem!r}") from problem
            for place in (job.start, job.end):
                if layout.place(place) is None:
                    raise ValueError(f"{arguments.jobs}:{number}: found '{place}', expected a station or node of the layout")
            jobs.append(job)
    return jobs


def parse():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("layout", help="a file in LIF; 'troupe export-map FILE --lanes' writes one of a building")
    parser.add_argument("--broker", default="mqtt://localhost", help="mqtt://HOST[:PORT] or mqtts://HOST[:PORT]")
    parser.add_argument("--ca", help="certificates that may have signed the broker's")
    parser.add_argument("--interface", default="uagv", help="the first level of topics (default: uagv)")
    work = parser.add_mutually_exclusive_group(required=True)
    work.add_argument("--jobs", help='a file of jobs, {"from": PLACE, "to": PLACE} a line')
    work.add_argument("--random", type=int, metavar="N", help="N jobs between stations")
    parser.add_argument("--seed", type=int, default=1, help="of these jobs")
    parser.add_argument("--vehicles", type=int, default=1, metavar="N", help="begin when N vehicles have come (default: 1)")
    parser.add_argument("--vehicle-type", help="of the layout (default: all nodes and edges)")
    parser.add_argument("--clearance", type=float, default=1.0, metavar="M", help="between vehicles (default: 1 m)")
    parser.add_argument("--steps", type=int, default=2, metavar="N", help="nodes that are released ahead (default: 2)")
    parser.add_argument("--horizon", type=int, default=3, metavar="N", help="nodes that are shown behind these (default: 3)")
    parser.add_argument("--patience", type=float, default=0.5, metavar="S",
                        help="decide after that time even if messages keep coming (default: 0.5 s)")
    parser.add_argument("--lockstep", action="store_true",
                        help="decide when the run asks, for 'troupe run --vda5050-wait lockstep': equal runs on any machine")
    parser.add_argument("--load-type", default="load", help="of pick and drop")
    return parser.parse_args()


def main():
    arguments = parse()
    try:
        layout = Layout.read(arguments.layout, arguments.vehicle_type, arguments.clearance)
        jobs = read_jobs(arguments, layout)
        lockstep = Lockstep(lambda topic, content: connection.send(topic, content)) if arguments.lockstep else None
        connection = Connection(arguments, lambda topic, payload: control.receive(topic, payload), lockstep and lockstep.ask)
    except (BadLayout, OSError, ValueError) as problem:
        print(f"error: {problem}", file=sys.stderr)
        return 2
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    control = FleetControl(layout, jobs, (lockstep or connection).send, arguments, lambda line: print(line, flush=True))
    looked = 0.0
    try:
        if lockstep is not None:
            lockstep.control = control
        while not control.is_finished:
            if lockstep is not None:
                connection.exchange(0.5)
                continue
            has_news = connection.loop(0.05)
            now = time.time()
            if has_news or now - looked > 1.0:
                looked = now
                control.decide(now)
    except KeyboardInterrupt:
        print("interrupted", flush=True)
    connection.client.disconnect()
    print(f"{control.done} of {control.total} jobs done, {control.failed} failed", flush=True)
    return 1 if control.failed or control.done < control.total else 0


if __name__ == "__main__":
    sys.exit(main())
