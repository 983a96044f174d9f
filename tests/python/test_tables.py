"""The tables of the state in Python: robots, doors, people and the like, with their names and signals."""

import re
import unittest
from pathlib import Path

import numpy

import troupe
from support import ROOT
from troupe.testing import watch


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sim = troupe.Simulation(ROOT / "worlds/sites/guesthouse_guests.json")

    def test_has_every_table_of_the_state(self):
        text = Path(ROOT / "include/troupe/world_state.h").read_text()
        tables = re.findall(r"std::vector<\w+> (\w+)", text[text.index("struct WorldState {"):])
        self.assertIn("doors", tables)
        self.assertEqual(sorted(self.sim.tables), sorted({*tables, "levels", "lanes", "sensors"}))
        for name in self.sim.tables:
            table = self.sim.table(name)
            if name in ("transmissions", "traffic_robots", "traffic_moves", "lane_closures", "lane_rules", "charging_robots",
                        "jobs", "zones", "coverage", "flows", "waits"):  # no rows in this world
                self.assertEqual({len(values) for values in table.values()}, {0})
                continue
            names = getattr(self.sim, name)
            self.assertEqual(table["name"], names)
            for column, values in table.items():
                self.assertEqual(len(values), len(names), f"{name}.{column}")

    def test_has_the_values_of_the_arrays(self):
        robots = self.sim.table("robots")
        numpy.testing.assert_array_equal(robots["x"], self.sim.poses[:, 0])
        numpy.testing.assert_array_equal(robots["stalled"], self.sim.stalls)
        self.assertEqual(robots["stalled"].dtype, bool)
        self.assertEqual(set(robots["level"]), {"L1"})

    def test_follows_doors_lifts_and_people(self):
        sim = self.sim.copy()
        self.assertIn("lobby_door", sim.doors)
        self.assertEqual(sim.lifts, ("guest_lift",))
        door = sim.doors.index("lobby_door")
        opened, levels, types = False, set(), set()
        for _ in range(1200):
            sim.step()
            types.update(event.type for event in sim.events)
            opened = opened or bool(sim.table("doors")["open"][door])
            levels.update(sim.table("people")["level"])
        self.assertTrue(opened)
        self.assertEqual(levels, {"L1", "L2"})
        self.assertLessEqual({"door_opened", "door_closed", "lift_left", "lift_arrived", "person_boarded",
                              "person_alighted", "person_arrived"}, types)

    def test_counts_robots_and_people_on_levels(self):
        levels = self.sim.table("levels")
        self.assertEqual(levels["name"], ("L1", "L2"))
        self.assertEqual(levels["robots"].sum(), len(self.sim.robots))
        self.assertEqual(levels["people"].sum(), len(self.sim.people))
        self.assertTrue(set(self.sim.table("sensors")["type"]) <= {"ranger", "bumper", "camera", "imu"})

    def test_of_many_worlds_have_the_worlds_first(self):
        vector = troupe.VectorSimulation(ROOT / "worlds/sites/guesthouse_guests.json", 2, seeds=[1, 2])
        vector.step(3)
        for name in self.sim.tables:
            table = vector.table(name)
            singles = [vector[i].table(name) for i in range(2)]
            self.assertEqual([*singles[0]], [column for column in table if column != "rows"])
            for column, values in table.items():
                if column == "rows":
                    continue
                for world, single in enumerate(singles):
                    rows = table["rows"][world]
                    if isinstance(values, tuple):
                        self.assertEqual(values[world], single[column])
                        continue
                    self.assertEqual(values.dtype, single[column].dtype)
                    numpy.testing.assert_array_equal(values[world, :rows], single[column])
        with self.assertRaisesRegex(ValueError, "found table 'gates'"):
            vector.table("gates")

    def test_of_worlds_with_fewer_rows_end_with_nan(self):
        vector = troupe.VectorSimulation(ROOT / "worlds/sites/guesthouse_guests.json", 2, seeds=[1, 1])
        other = troupe.VectorSimulation(ROOT / "worlds/scenarios/swarm.json", 1)
        vector.reset([1], other.save())
        table = vector.table("robots")
        self.assertEqual(table["rows"].tolist(), [len(vector[0].robots), 100])
        self.assertEqual(table["x"].shape, (2, 100))
        self.assertTrue(numpy.isnan(table["x"][0, table["rows"][0]:]).all())
        self.assertFalse(table["stalled"][0, table["rows"][0]:].any())
        self.assertEqual(len(table["name"][1]), 100)

    def test_names_the_tables_that_there_are(self):
        with self.assertRaisesRegex(ValueError, "found table 'gates', expected one of: robots, joints"):
            self.sim.table("gates")


if __name__ == "__main__":
    unittest.main()
