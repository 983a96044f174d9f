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
        self.assertEqual(sorted(self.sim.tables), sorted(set(tables)))
        for name in tables:
            table = self.sim.table(name)
            if name == "transmissions":
                self.assertEqual(len(table["due"]), 0)
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

    def test_names_the_tables_that_there_are(self):
        with self.assertRaisesRegex(ValueError, "found table 'gates', expected one of: robots, joints"):
            self.sim.table("gates")


if __name__ == "__main__":
    unittest.main()
