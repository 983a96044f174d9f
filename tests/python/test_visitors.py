"""People who come and go, are recorded or leave an evacuation, together with lifts, levels, doors, zones and copies of worlds."""
import pathlib
import tempfile
import unittest

import troupe
from support import ROOT, SCENARIOS

HOTEL = str(ROOT / "worlds/sites/hotel.building.yaml")
OFFICE = str(ROOT / "worlds/office.world")
ENTRANCE = [22.8, 1.2, 25.2, 4]


def guests(goals, exits, per_hour=1200, **more):
    return {"count": 12, "region": ENTRANCE, "name_prefix": "guest", "goals": goals, "wait": [1, 3],
            "visits": {"per_hour": per_hour, "exits": exits, "stops": 1}, **more}


def present(sim):
    return [name for name, is_there in zip(sim.people, sim.table("people")["present"]) if is_there]


class Visitors(unittest.TestCase):
    def test_they_ride_to_an_exit_on_another_level_and_snapshots_go_on(self):
        sim = troupe.Simulation({"world": HOTEL, "seed": 2, "people": [guests(["landing_L2"], ["landing_L3"])]})
        sim.step(900)
        saved = sim.save()
        self.assertTrue(sim.table("people")["place"].any(), "none is in a lift, or gets on")
        left = []
        while sim.tick < 1800:
            sim.step()
            left += [event for event in sim.events if event.type == "person_left"]
        self.assertGreater(len(left), 3)
        self.assertTrue((sim.table("visitors")["visits"] > 1).any())
        last = sim.state_hash
        sim.restore(saved)
        sim.step(900)
        self.assertEqual(sim.state_hash, last)

    def test_the_worlds_of_a_vector_may_have_other_rates(self):
        worlds = [{"world": OFFICE, "seed": 3, "robots": [{"name": "anna", "model": "scout", "pose": [-4, 0, 0], "controller": "wander"}],
                   "people": [{"count": 10, "region": [-8, -0.6, -6, 0.6], "goals": [[2, 0]], "name_prefix": "guest",
                               "visits": {"per_hour": rate, "exits": [[-10, 0]]}}]} for rate in (0, 600, 3600)]
        vector = troupe.VectorSimulation(worlds, threads=2)
        vector.step(600)
        singles = [troupe.Simulation(world, seed=vector[i].seed) for i, world in enumerate(worlds)]
        for sim in singles:
            sim.step(600)
        self.assertEqual(vector.state_hashes.tolist(), [sim.state_hash for sim in singles])
        came = [float(vector[i].table("visitor_flows")["came"][0]) for i in range(3)]
        self.assertEqual(came, sorted(came))
        self.assertEqual(came[0], 0)
        self.assertGreater(came[2], came[1])

    def test_automatic_doors_open_for_them_and_not_for_those_who_are_away(self):
        world = {"world": HOTEL, "seed": 2,
                 "override": [{"match": {"name": "kitchen_entrance"}, "properties": {"opening": 0, "sensor_depth": 1.5, "hold": 2}}],
                 "people": [guests(["kitchen"], ["entrance"], region=[16.4, 4.2, 17.6, 5.2], count=1)]}
        door = troupe.Simulation(world).doors.index("kitchen_entrance")
        for per_hour in (0, 3600):
            world["people"][0]["visits"]["per_hour"] = per_hour
            sim = troupe.Simulation(world)
            most = 0.0
            while sim.tick < 300:
                sim.step(10)
                most = max(most, float(sim.table("doors")["opening"][door]))
            self.assertEqual(most, 1.0 if per_hour else 0.0)

    def test_recorded_people_are_on_their_level(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "recorded.txt"
            file.write_text("".join(f"{10 * i} 1 {20 + 0.4 * i} 14\n" for i in range(15)))
            for react in (False, True):
                sim = troupe.Simulation({"world": HOTEL, "seed": 1, "recorded_people": [
                    {"file": str(file), "z": 4, "react": react}]})
                heights = set()
                while sim.tick < 120:
                    sim.step()
                    people = sim.table("people")
                    if people["present"][0]:
                        heights.add(float(people["z"][0]))
                        self.assertEqual(people["level"][0], "L2")
                self.assertEqual(heights, {4.0})
                self.assertEqual(present(sim), [])

    def test_zones_of_robots_are_no_obstacles_to_people(self):
        for kind, more in (("keepout", {}), ("one_way", {"heading": 180}), ("speed", {"speed_limit": 0.2}), ("release", {})):
            sim = troupe.Simulation({
                "world": OFFICE, "seed": 1, "robots": [], "people": [{"count": 1, "region": [-6, -0.2, -5.6, 0.2], "goals": [[6, 0]]}],
                "zones": [{"name": "zone", "kind": kind, "region": [-2, -1, 2, 1], **more}]})
            inside = 0
            while sim.tick < 200:
                sim.step()
                inside += float(sim.table("zones")["people"][0])
            self.assertGreater(sim.table("people")["x"][0], 5, kind)
            self.assertTrue(20 < inside < 50, (kind, inside))


class Evacuation(unittest.TestCase):
    def test_recorded_people_who_react_leave_and_others_stay_on_their_ways(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "recorded.txt"
            file.write_text("".join(f"{10 * i} 1 {-6 + 0.4 * i} 0\n" for i in range(30)))
            ends = []
            for react in (False, True):
                sim = troupe.Simulation({
                    "world": OFFICE, "seed": 1, "robots": [], "recorded_people": [{"file": str(file), "react": react}],
                    "zones": [{"name": "alarm", "kind": "evacuation", "region": [-13, -10, 13, 10], "exits": [[-10, 0]], "on": False}],
                    "events": [{"at": 3, "zone": "alarm", "on": True}]})
                while present(sim) or sim.tick < 30:
                    sim.step()
                    last = float(sim.table("people")["x"][0]) if present(sim) else last
                    self.assertLess(sim.tick, 400)
                ends.append(last)
            self.assertGreater(ends[0], 5)
            self.assertLess(ends[1], -9)

    def test_a_building_is_emptied_by_its_lifts_the_same_in_each_run(self):
        crowd = [{"count": 16, "region": [19, 13, 29, 17], "z": 4 * level, "name_prefix": f"guest{level}_",
                  "goals": ["landing_L2", "lobby"]} for level in range(3)]
        world = {"world": HOTEL, "seed": 6, "people": crowd + [guests(["landing_L2"], ["entrance"])],
                 "zones": [{"name": f"alarm{level}", "kind": "evacuation", "z": 4 * level, "region": [0, 0, 48, 24],
                            "exits": ["entrance"], "on": False} for level in range(3)],
                 "events": [{"at": 30, "zone": f"alarm{level}", "on": True} for level in range(3)]}
        ends = []
        for _ in range(2):
            sim = troupe.Simulation(world)
            sim.step(300)
            self.assertTrue(set(sim.table("people")["level"]) >= {"L1", "L2", "L3"})
            while present(sim):
                sim.step(10)
                self.assertLess(sim.tick, 5000, present(sim))
            ends.append((sim.tick, sim.state_hash))
        self.assertEqual(ends[0], ends[1])


class Example(unittest.TestCase):
    def test_the_scenario_of_visitors_is_empty_of_guests_after_its_alarm(self):
        sim = troupe.Simulation(SCENARIOS / "visitors.json")
        sim.step(2900)
        self.assertTrue(present(sim))
        sim.step(1200)
        self.assertEqual(sim.table("zones")["people"].tolist(), [0.0])


if __name__ == "__main__":
    unittest.main()
