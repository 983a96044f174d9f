"""Worlds of Gazebo against a raster of their own: every static obstacle at a height is where SDF has it, within 5 cm.

The raster shares nothing with Troupe: it reads the XML by Python's parser, multiplies the poses as matrices, and asks of each
point whether it is in a solid.
"""

import math
import os
import pathlib
import random
import tempfile
import unittest
import xml.etree.ElementTree as xml

import numpy
import troupe

from support import ROOT

CELL = 0.025  # m, of the raster
SLACK = 0.05  # m


def matrix(element):
    """Of the `pose` of an element: x y z roll pitch yaw."""
    text = element.findtext("pose", "0 0 0 0 0 0")
    x, y, z, roll, pitch, yaw = map(float, text.split())
    (a, b), (c, d), (e, f) = ((math.cos(angle), math.sin(angle)) for angle in (roll, pitch, yaw))
    turn = (numpy.array([[e, -f, 0], [f, e, 0], [0, 0, 1]]) @ numpy.array([[c, 0, d], [0, 1, 0], [-d, 0, c]])
            @ numpy.array([[1, 0, 0], [0, a, -b], [0, b, a]]))
    pose = numpy.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, (x, y, z)
    return pose


def solids(file, left_out=()):
    """(4 x 4 pose in the world, geometry element) of the collisions of static models."""
    found = []
    for model in xml.parse(file).getroot().find("world").findall("model"):
        if model.findtext("static") not in ("true", "1") or model.get("name") in left_out:
            continue
        frames = {frame.get("name"): matrix(frame) for frame in model.findall("frame")}
        for link in model.findall("link"):
            pose = link.find("pose")
            relative = frames.get(pose.get("relative_to")) if pose is not None and pose.get("relative_to") else numpy.eye(4)
            for collision in link.findall("collision"):
                found.append((matrix(model) @ relative @ matrix(link) @ matrix(collision), collision.find("geometry")))
    return found


def inside(points, pose, geometry):
    """Which of the points (n, 3) are in the solid."""
    x, y, z = (numpy.linalg.inv(pose)[:3] @ numpy.column_stack([points, numpy.ones(len(points))]).T)
    if (box := geometry.find("box")) is not None:
        half = [float(word) / 2 for word in box.findtext("size").split()]
        return (abs(x) <= half[0]) & (abs(y) <= half[1]) & (abs(z) <= half[2])
    if (cylinder := geometry.find("cylinder")) is not None:
        return (numpy.hypot(x, y) <= float(cylinder.findtext("radius"))) & (abs(z) <= float(cylinder.findtext("length")) / 2)
    if geometry.find("sphere") is None:
        return numpy.zeros(len(points), bool)  # a plane
    return numpy.sqrt(x**2 + y**2 + z**2) <= float(geometry.find("sphere").findtext("radius"))


def grown(cells, reach):
    """Cells within `reach` m of the given ones."""
    steps = round(reach / CELL)
    rows, columns = cells.shape
    wide = numpy.zeros((rows + 2 * steps, columns + 2 * steps), bool)
    for dy in range(-steps, steps + 1):
        for dx in range(-steps, steps + 1):
            if dx * dx + dy * dy <= steps * steps:
                wide[steps + dy:steps + dy + rows, steps + dx:steps + dx + columns] |= cells
    return wide[steps:-steps, steps:-steps]


class Raster(unittest.TestCase):
    def compare(self, file, height, left_out=()):
        """The map of Troupe and the raster agree, each within the slack of the other."""
        occupancy = troupe.Simulation(str(file)).map(CELL, height)
        occupied = numpy.asarray(occupancy.occupied)
        rows, columns = occupied.shape
        x = occupancy.origin[0] + (numpy.arange(columns) + 0.5) * CELL
        y = occupancy.origin[1] + (numpy.arange(rows) + 0.5) * CELL
        points = numpy.column_stack([*(grid.ravel() for grid in numpy.meshgrid(x, y)), numpy.full(rows * columns, height)])
        raster = numpy.zeros(rows * columns, bool)
        for pose, geometry in solids(file, left_out):
            raster |= inside(points, pose, geometry)
        raster = raster.reshape(rows, columns)
        self.assertGreater(raster.sum(), 100)
        return int((raster & ~grown(occupied, SLACK)).sum()), int((occupied & ~grown(raster, SLACK)).sum())

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
        for number in (0, 150, 299):
            file = pathlib.Path(checkout) / f"jackal_helper/worlds/BARN/world_{number}.world"
            self.assertEqual(self.compare(file, 0.25), (0, 0), number)


if __name__ == "__main__":
    unittest.main()
