"""Vehicles of VDA 5050 in this process: messages to them and of them, doors and lifts on their way, maps, and people who take over."""
import json
import os
import pathlib
import unittest

import troupe

WORLDS = pathlib.Path(os.environ["TROUPE_SOURCE_DIR"]) / "worlds"


class Fleet:
    """A simulation with one vehicle that a fleet control drives."""
    def __init__(self, world, robot, version="2.1.0"):
        self.simulation, self.robot, self.version = troupe.Simulation(world), robot, version
        self.state, self.orders, self.news, self.headers = None, 0, [], 0

    def step(self, ticks=1):
        for _ in range(ticks):
            self.simulation.step()
            for _tick, robot, topic, message in self.simulation.messages:
                if robot == self.robot and topic == "state":
                    self.state = message
            self.news += [event.detail for event in self.simulation.events if event.type == "said" and event.detail]

    def until(self, is_true, seconds=120.0):
        for _ in range(round(seconds / self.simulation.interval)):
            if self.state is not None and is_true():
                return
            self.step()
        raise AssertionError(f"not within {seconds} s: {json.dumps(self.state)}")

    def header(self):
        self.headers += 1
        return {"headerId": self.headers, "timestamp": "2026-01-01T00:00:00.00Z", "version": self.version, "manufacturer": "Troupe",
                "serialNumber": self.robot}

    def order(self, *stops, horizon=0):
        """Over (name, x, y, map) of each stop, the last `horizon` of them not released. Returns its id."""
        self.orders += 1
        last = len(stops) - horizon
        nodes = [{"nodeId": name, "sequenceId": 2 * i, "released": i < last, "actions": [],
                  "nodePosition": {"x": x, "y": y, "mapId": level, "allowedDeviationXY": 0.3}} for i, (name, x, y, level) in enumerate(stops)]
        edges = [{"edgeId": f"e{i}", "sequenceId": 2 * i + 1, "released": i + 1 < last, "startNodeId": stops[i][0],
                  "endNodeId": stops[i + 1][0], "actions": []} for i in range(len(stops) - 1)]
        name = f"o{self.orders}"
        self.simulation.send_message(self.robot, "order", self.header() | {"orderId": name, "orderUpdateId": 0, "nodes": nodes, "edges": edges})
        return name

    def act(self, kind, identity, **parameters):
        action = {"actionType": kind, "actionId": identity, "blockingType": "HARD",
                  "actionParameters": [{"key": key, "value": value} for key, value in parameters.items()]}
        self.simulation.send_message(self.robot, "instantActions", self.header() | {"actions": [action]})

    def status(self, identity):
        return next((each["actionStatus"] for each in self.state["actionStates"] if each["actionId"] == identity), None)

    def opening(self, door):
        doors = self.simulation.table("doors")
        return doors["opening"][doors["name"].index(door)]

    @property
    def is_done(self):
        return not self.state["nodeStates"] and not self.state["driving"]


def hall():
    return Fleet(WORLDS / "scenarios/vda5050.json", "cart_1")


def guesthouse():
    fleet = Fleet({"world": str(WORLDS / "sites/guesthouse.building.yaml"),
                   "robots": [{"name": "tiny_1", "controller": "vda5050"}], "without": ["delivery_1"]}, "tiny_1")
    fleet.step(2)
    return fleet


class VehiclesTest(unittest.TestCase):
    def test_messages(self):
        fleet = hall()
        fleet.order(("a", -3, 0, "hall"), ("b", -3, -1, "hall"), ("c", -3, -2, "hall"), horizon=1)
        fleet.until(lambda: fleet.state["lastNodeId"] == "b" and not fleet.state["driving"])
        self.assertEqual([(node["nodeId"], node["released"]) for node in fleet.state["nodeStates"]], [("c", False)])
        self.assertIn("order o1 accepted", fleet.news)
        with self.assertRaisesRegex(ValueError, "topic: found 'state', expected order"):
            fleet.simulation.send_message("cart_1", "state", {})
        fleet.simulation.send_message("cart_1", "order", "no JSON")
        fleet.until(lambda: any(error["errorType"] == "validationError" for error in fleet.state["errors"]), 1)
        fleet.act("cancelOrder", "stop")
        fleet.until(lambda: fleet.status("stop") == "FINISHED", 5)
        self.assertTrue(any("order o1 cancelled" in line for line in fleet.news), fleet.news)

    def test_moved_by_a_person(self):
        fleet = hall()
        fleet.order(("a", -3, 0, "hall"), ("b", -3, -2, "hall"))
        fleet.until(lambda: fleet.state["driving"])
        fleet.simulation.set_pose("cart_1", (2, 2, 0))
        fleet.until(lambda: fleet.state["operatingMode"] == "MANUAL", 1)
        self.assertEqual((fleet.state["nodeStates"], fleet.state["lastNodeId"]), ([], ""))
        fleet.order(("x", 2, 2, "hall"), ("y", 3, 2, "hall"))
        fleet.step(2)
        self.assertEqual([error["errorType"] for error in fleet.state["errors"]], ["orderError"])
        fleet.until(lambda: fleet.state["operatingMode"] == "AUTOMATIC", 3)
        fleet.order(("x", 2, 2, "hall"), ("y", 3, 2, "hall"))
        fleet.until(lambda: fleet.state["lastNodeId"] == "y" and fleet.is_done)
        news = "; ".join(fleet.news)
        for line in ("order o1 cancelled", "mode MANUAL", "order o2 0 rejected: mode_without_orders", "mode AUTOMATIC", "order o3 finished"):
            self.assertIn(line, news)

    def test_driven_by_a_person(self):
        fleet = hall()
        fleet.order(("a", -3, 0, "hall"), ("b", -3, -2, "hall"))
        fleet.until(lambda: fleet.state["driving"])
        fleet.simulation.set_pose("pallet_1", (-3, -1, 0))
        fleet.until(lambda: any(error["errorType"] == "pathBlocked" for error in fleet.state["errors"]), 10)
        references = {each["referenceKey"]: each["referenceValue"] for each in fleet.state["errors"][0]["errorReferences"]}
        self.assertEqual(references, {"nodeId": "b", "obstacle": "pallet_1", "edgeId": "e0"})
        fleet.simulation.set_pose("pallet_1", (5, -3, 0))
        fleet.until(lambda: fleet.state["lastNodeId"] == "b" and fleet.is_done, 20)
        self.assertEqual(fleet.state["errors"], [])
        news = "; ".join(fleet.news)
        self.assertIn("error pathBlocked: pallet_1 is in the way; ", news)
        self.assertIn("error pathBlocked cleared", news)

    def test_doors(self):
        fleet = guesthouse()
        x, y = fleet.simulation.find_pose("tiny_1").x, fleet.simulation.find_pose("tiny_1").y
        self.assertEqual([(each["mapId"], each["mapStatus"]) for each in fleet.state["maps"]], [("L1", "ENABLED"), ("L2", "ENABLED")])
        fleet.simulation.set_door("lobby_door", 0.0)
        fleet.step(80)
        self.assertEqual(fleet.opening("lobby_door"), 0.0)
        fleet.order(("start", x, y, "L1"), ("lobby", 3.0, -3.75, "L1"), ("L1.24", 5.0, -3.75, "L1"), ("lift_lobby", 10.0, -3.75, "L1"))
        fleet.until(lambda: fleet.state["lastNodeId"] == "lift_lobby" and fleet.is_done)
        self.assertEqual(fleet.state["errors"], [])
        self.assertFalse(any("error" in line for line in fleet.news), fleet.news)
        fleet.step(60)  # it is closed behind the vehicle
        self.assertEqual(fleet.opening("lobby_door"), 0.0)

    def test_lift(self):
        fleet = guesthouse()
        place = fleet.simulation.find_pose("tiny_1")
        fleet.order(("start", place.x, place.y, "L1"), ("lobby", 3.0, -3.75, "L1"), ("L1.24", 5.0, -3.75, "L1"), ("corridor", 7.0, -3.75, "L1"),
                    ("lift_lobby", 10.0, -3.75, "L1"), ("in", 10.0, -1.5, "L1"), ("up", 10.0, -1.5, "L2"), ("landing", 10.0, -3.75, "L2"),
                    ("hall", 7.5, -5.5, "L2"), ("room", 3.0, -5.5, "L2"))
        fleet.until(lambda: fleet.state["lastNodeId"] == "up", 300)
        self.assertEqual(fleet.state["agvPosition"]["mapId"], "L2")
        self.assertAlmostEqual(fleet.simulation.find_pose("tiny_1").z, 4.0, places=2)
        fleet.until(lambda: fleet.state["lastNodeId"] == "room" and fleet.is_done, 200)
        self.assertEqual(fleet.state["errors"], [])
        self.assertEqual(fleet.simulation.table("lifts")["session"], ("",))
        # Where no lift is, none brings it.
        fleet.order(("room", 3.0, -5.5, "L2"), ("below", 3.0, -5.5, "L1"))
        fleet.until(lambda: any(error["errorType"] == "mapNotReachable" for error in fleet.state["errors"]), 10)

    def test_maps(self):
        fleet = hall()
        fleet.act("downloadMap", "d", mapId="hall", mapVersion="2", mapDownloadLink="http://localhost/hall")
        fleet.step(2)
        self.assertEqual(fleet.status("d"), "RUNNING")
        fleet.until(lambda: fleet.status("d") == "FINISHED", 10)
        self.assertEqual([(each["mapVersion"], each["mapStatus"]) for each in fleet.state["maps"]], [("1", "ENABLED"), ("2", "DISABLED")])
        fleet.act("enableMap", "e", mapId="hall", mapVersion="2")
        fleet.act("deleteMap", "x", mapId="hall", mapVersion="2")
        fleet.step(2)
        self.assertEqual((fleet.status("e"), fleet.status("x")), ("FINISHED", "FAILED"))
        fleet.act("deleteMap", "y", mapId="hall", mapVersion="1")
        fleet.act("deleteMap", "z", mapId="cellar", mapVersion="1")
        fleet.step(2)
        self.assertEqual((fleet.status("y"), fleet.status("z")), ("FINISHED", "FAILED"))
        self.assertEqual([(each["mapId"], each["mapVersion"], each["mapStatus"]) for each in fleet.state["maps"]], [("hall", "2", "ENABLED")])


if __name__ == "__main__":
    unittest.main()
