"""Worlds of Gazebo against a raster of their own (gazebo_raster.py): every static obstacle at a height is where SDF has it,
within 5 cm."""

import os
import pathlib
import random
import tempfile
import unittest

import gazebo_raster
import troupe

from support import ROOT


class Raster(unittest.TestCase):
    def compare(self, file, height, left_out=()):
        """The map of Troupe and the raster agree, each within the slack of the other."""
        shapes, unknown = gazebo_raster.solids(file, left_out)
        self.assertEqual(unknown, [])
        cells, missing, more = gazebo_raster.compare(troupe.Simulation(str(file)), shapes, height)
        self.assertGreater(cells, 100)
        return missing, more

    def test_the_yard(self):
        yard = ROOT / "worlds/gazebo/yard.sdf"
        for height in (0.5, 0.72):  # above the ramp, which is larger by a bound that a warning states
            self.assertEqual(self.compare(yard, height, left_out=("ramp",)), (0, 0), height)

    def test_random_worlds(self):
        for seed in range(2):
            chance = random.Random(seed)
            models = []
            for i in range(20):
                shape = chance.choice((
                    f"<box><size>{chance.uniform(0.1, 2):.3f} {chance.uniform(0.1, 2):.3f} 2</size></box>",
                    f"<cylinder><radius>{chance.uniform(0.05, 0.8):.3f}</radius><length>2</length></cylinder>",
                    f"<sphere><radius>{chance.uniform(0.3, 0.9):.3f}</radius></sphere>"))
                place = " ".join(f"{chance.uniform(-4, 4):.3f}" for _ in range(2))
                models.append(
                    f"<model name='m{i}'><static>1</static><pose>{place} 0 0 0 {chance.uniform(-3, 3):.3f}</pose><link name='l'>"
                    f"<pose>{chance.uniform(-1, 1):.3f} 0.2 0.1 0 0 {chance.uniform(-3, 3):.3f}</pose><collision name='c'>"
                    f"<pose>0.3 {chance.uniform(-1, 1):.3f} 0 0 0 0.5</pose><geometry>{shape}</geometry></collision></link></model>")
            with tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder) / "random.sdf"
                file.write_text(f"<sdf version='1.9'><world name='w'>{''.join(models)}</world></sdf>")
                self.assertEqual(self.compare(file, 0.2), (0, 0), seed)

    def test_a_checkout_of_barn(self):
        checkout = os.environ.get("TROUPE_BARN")
        if not checkout:
            self.skipTest("TROUPE_BARN is no checkout of the BARN Challenge")
        for number in range(300) if os.environ.get("TROUPE_BARN_ALL") else (0, 150, 299):
            file = pathlib.Path(checkout) / f"jackal_helper/worlds/BARN/world_{number}.world"
            self.assertEqual(self.compare(file, 0.25), (0, 0), number)


if __name__ == "__main__":
    unittest.main()
