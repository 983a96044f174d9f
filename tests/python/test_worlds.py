"""Worlds from code: dicts, troupe.World, arrays as maps, generators, and controllers that are classes of this process."""

import json
import math
import os
import subprocess
import sys
import tempfile
import unittest

import numpy

import troupe
from support import ROOT, logged
from troupe import World, generators, lidar


class Bounce:
    """Turns at obstacles."""

    def __init__(self, robot, speed=0.4):
        self.ranger = robot.sensor("ranger")
        self.speed = speed

    def subscriptions(self):
        return [self.ranger]

    def update(self, seen):
        reading = seen.sensors[self.ranger]
        if reading is None or reading.ranges.min() > 0.8:
            return self.speed, 0.0
        return 0.0, 1.0


class Failing:
    def __init__(self, robot):
        pass

    def update(self, seen):
        return 1 / (3 - seen.tick), 0.0


def arena():
    world = World(name="arena", seed=3)
    world.wall((-3, -2), (3, -2), (3, 2), (-3, 2), closed=True)
    world.robot("anna", (0, 0, 0), controller=Bounce, parameters={"speed": 0.5})
    return world


class Worlds(unittest.TestCase):
    def folder(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        return folder.name

    def test_a_dict_is_a_scenario(self):
        with open(ROOT / "worlds/scenarios/swarm.json") as file:
            scenario = json.load(file)
        scenario["world"] = str(ROOT / "worlds/scenarios" / scenario["world"])
        scenario["include"] = [str(ROOT / "worlds/scenarios" / name) for name in scenario.get("include", [])]
        scenario.pop("$schema", None)
        sim, same = troupe.Simulation(scenario), troupe.Simulation(ROOT / "worlds/scenarios/swarm.json")
        for _ in range(3):
            sim.step(10)
            same.step(10)
            self.assertEqual(sim.state_hash, same.state_hash)
        for bad, error, text in (({"robots": [{"model": "scout", "pose": [0, 0]}]}, troupe.InputError, "<world>:6:"),
                                 ({"robotos": []}, troupe.InputError, "robotos"),
                                 ({"ticks": math.nan}, ValueError, "JSON"),
                                 ({"ticks": object()}, TypeError, "object"),
                                 (3, TypeError, "found int, expected a path, a dict"),
                                 (None, TypeError, "found NoneType")):
            with self.subTest(bad), self.assertRaisesRegex(error, text):
                troupe.Simulation(bad)

    def test_bodies_have_their_places_and_sizes(self):
        world = World(include=["robots.inc"])
        world.wall((2, -1), (2, 1), thickness=0.2)
        world.box((0, 2, 0, 0), (1, 0.5, 1))
        world.block([(-2, -1), (-1.5, 0), (-2, 1)], z=(0, 0.6))
        world.block([(-0.2, -3), (0.2, -3), (0, -2.5)], z=(0.5, 0.9))       # above the lidar
        world.robot("anna", (0, 0, 0), "position", size=[0.2, 0.2, 0.2], children=[lidar(9, samples=5, z=-0.15)])
        ranges = troupe.Simulation(world).read("anna", "ranger").ranges
        # The rays point back, right, ahead, left, back.
        numpy.testing.assert_allclose(ranges, [1.5, 9, 1.9, 1.75, 1.5], atol=1e-9)

    def test_a_world_of_code_runs_as_its_file_does_in_processes(self):
        folder = self.folder()
        world = arena().box((1, 1, 0.3), (0.4, 0.4, 0.4), movable=True)
        grid = numpy.zeros((20, 30), bool)
        grid[5, 3:20] = True
        world.map(grid, 0.1, origin=(-1.5, -1.5)).place("corner", (-2, -1, 0)).people(2, (-2.5, 0.5, 2.5, 1.5), ["corner"])
        sim = troupe.Simulation(world)
        self.assertEqual(sim.objects, ("box",))
        sim.step(60)
        self.assertEqual(sim.failures, [])
        self.assertNotEqual(tuple(sim.poses[0]), (0, 0, 0, 0))
        file = os.path.join(folder, "arena.json")
        world.save(file)
        self.assertEqual(sorted(os.listdir(folder)), ["arena.json", "arena_map.png", "arena_map.yaml"])
        self.assertEqual(troupe.Simulation(file).robots, ("anna",))
        self.assertEqual(logged(file, folder, "--ticks", 60)[60], sim.state_hash)

    def test_the_row_0_of_a_map_is_the_lowest(self):
        grid = numpy.zeros((4, 10))
        grid[0, 8] = 1
        world = World().map(grid, 0.5, origin=(0, -0.25)).robot("anna", (1, 0, 0), "position", size=[0.2, 0.2, 0.2],
                                                                children=[lidar(9, samples=5)])
        self.assertAlmostEqual(troupe.Simulation(world).read("anna", "ranger").ranges[2], 3.0, places=9)
        turned = World().map(numpy.flipud(grid), 0.5, origin=(0, -1.75)).robot(
            "anna", (1, 0, 0), "position", size=[0.2, 0.2, 0.2], children=[lidar(9, samples=5)])
        self.assertAlmostEqual(troupe.Simulation(turned).read("anna", "ranger").ranges[2], 3.0, places=9)

    def test_the_map_of_a_world_is_the_one_that_made_it(self):
        grid = numpy.random.default_rng(1).random((30, 40)) < 0.2
        sim = troupe.Simulation(World().map(grid, 0.1, origin=(-1, 2), height=0.5))
        made = sim.map()
        numpy.testing.assert_array_equal(made.occupied, grid)
        self.assertEqual((made.resolution, made.origin), (0.1, (-1.0, 2.0)))
        self.assertFalse(sim.map(z=0.6).occupied.any())
        self.assertEqual(sim.map(0.2).occupied.shape, (15, 20))
        for bad in (0, -1, math.nan):
            with self.assertRaises(troupe.InputError):
                sim.map(bad)
        office = troupe.Simulation(ROOT / "worlds/office.world").map(0.1)
        again = troupe.Simulation(World().map(office.occupied, office.resolution, origin=office.origin)).map(0.1)
        numpy.testing.assert_array_equal(again.occupied, office.occupied)

    def test_images_are_those_of_the_readings(self):
        eye = {"model": "camera", "properties": {"resolution": [24, 16]}}
        world = World(seed=1).box((2, 0, 0), (0.5, 0.5, 1), color="red")
        for i in range(2):
            world.robot(f"r{i}", (0, i, 0), children=[eye])
        sim = troupe.Simulation(world)
        images, depths = sim.images(), sim.depths()
        self.assertEqual((images.shape, images.dtype), ((2, 16, 24, 3), numpy.uint8))
        self.assertEqual((depths.shape, depths.dtype), ((2, 16, 24), numpy.float32))
        for i in range(2):
            reading = sim.read(i, "camera")
            numpy.testing.assert_array_equal(images[i], reading.colors)
            numpy.testing.assert_array_equal(depths[i], reading.depths)
        self.assertGreater(images[0].max(), images[0].min())
        vector = troupe.VectorSimulation(world, 3, seeds=[1, 1, 2])
        out = numpy.zeros((3, 2, 16, 24, 3), numpy.uint8)
        self.assertIs(vector.images(out=out), out)
        numpy.testing.assert_array_equal(out[1], images)
        numpy.testing.assert_array_equal(vector.depths()[0], depths)
        for error, call in ((ValueError, lambda: sim.images("ranger")), (ValueError, lambda: sim.images(out=numpy.zeros((2, 16, 24), numpy.uint8))),
                            (TypeError, lambda: sim.images(out=numpy.zeros((2, 16, 24, 3)))),
                            (ValueError, lambda: troupe.Simulation(world.copy().robot("blind", (0, -1, 0))).images())):
            with self.assertRaises(error):
                call()

    def test_a_world_leaves_no_file_and_can_be_copied(self):
        # A folder of its own: other programs use the usual one meanwhile.
        folder = self.folder()
        before = tempfile.tempdir
        self.addCleanup(setattr, tempfile, "tempdir", before)
        tempfile.tempdir = folder
        world = World().map(numpy.eye(9))
        other = world.copy().robot("anna", (3, 0, 0))
        self.assertEqual(troupe.Simulation(world).robots, ())
        self.assertEqual(troupe.Simulation(other).robots, ("anna",))
        self.assertEqual(os.listdir(folder), [])
        self.assertTrue(world._repr_png_().startswith(b"\x89PNG"))

    def test_bad_arguments_name_what_was_expected(self):
        world = World()
        for text, call in (("wall: found 1 points", lambda: world.wall((0, 0))),
                           ("expected a point", lambda: world.wall((0, 0), (1, 2, 3))),
                           ("thickness: found -1", lambda: world.wall((0, 0), (1, 0), thickness=-1)),
                           ("expected a pose", lambda: world.box((0, 0), (1, 1, 1))),
                           ("expected a size", lambda: world.box((0, 0, 0), (1, 1))),
                           ("size: found 0", lambda: world.box((0, 0, 0), (1, 0, 1))),
                           ("block: found 2 points", lambda: world.block([(0, 0), (1, 0)])),
                           ("map: found an array of shape", lambda: world.map([1, 2])),
                           ("expected a pose", lambda: world.robot("a", (0, math.nan, 0))),
                           ("without a controller", lambda: world.robot("a", (0, 0, 0), parameters={"speed": 1})),
                           ("ends in .json", lambda: world.save("arena.world"))):
            with self.subTest(text), self.assertRaisesRegex(ValueError, text):
                call()
        self.assertEqual(repr(world), "<troupe.World: >")

    def test_generators_give_the_same_world_for_the_same_seed(self):
        for make in (generators.rooms, generators.maze, generators.warehouse, generators.forest):
            with self.subTest(make.__name__):
                self.assertEqual(make(5).scenario, make(5).scenario)
                self.assertNotEqual(make(5).scenario["models"], make(6).scenario["models"])
                sim = troupe.Simulation(make(5).robots(3, (-4, -4, 4, 4), controller="wander"))
                self.assertEqual(sim.warnings, ())
                sim.step(50)
                self.assertEqual(sim.failures, [])
        for bad in (lambda: generators.rooms(door=5), lambda: generators.maze(columns=0),
                    lambda: generators.forest(trees=10000)):
            with self.assertRaises(ValueError):
                bad()

    def test_each_cell_of_a_maze_and_each_room_is_reached(self):
        for world, cell, columns, rows in ((generators.maze(2, columns=6, rows=5), 1.5, 6, 5),
                                           (generators.rooms(2), 4.0, 4, 3)):
            world.robot("anna", ((0.5 - columns / 2) * cell, (0.5 - rows / 2) * cell, 0), controller="go_to")
            sim = troupe.Simulation(world)
            for i in range(columns):
                for j in range(rows):
                    sim.send_to("anna", ((i + 0.5 - columns / 2) * cell, (j + 0.5 - rows / 2) * cell))  # refuses what no way leads to

    def test_worlds_of_a_vector_differ_as_asked(self):
        vector = troupe.VectorSimulation(lambda seed: generators.forest(seed).robots(2, (-8, -8, 8, 8), controller="wander"), 4)
        vector.step(20)
        for i in range(4):
            alone = troupe.Simulation(generators.forest(i + 1).robots(2, (-8, -8, 8, 8), controller="wander"), seed=i + 1)
            alone.step(20)
            self.assertEqual(int(vector.state_hashes[i]), alone.state_hash)
        sizes = [World(seed=1).box((2, 0, 0), (size, 1, 1)).robot("anna", (0, 0, 0)) for size in (1.0, 2.0)]
        vector = troupe.VectorSimulation(sizes, seeds=[1, 1], run_controllers=False)
        ranges = vector.ranges("ranger").min(axis=2)[:, 0]
        self.assertAlmostEqual(ranges[0] - ranges[1], 0.5, places=6)
        for error, text, call in ((ValueError, "num_envs: found 3", lambda: troupe.VectorSimulation(sizes, 3)),
                                  (TypeError, "num_envs", lambda: troupe.VectorSimulation(sizes[0])),
                                  (ValueError, "numbers of robots differ", lambda: troupe.VectorSimulation(
                                      [sizes[0], sizes[1].copy().robot("ben", (0, 1, 0))]))):
            with self.subTest(text), self.assertRaisesRegex(error, text):
                call()


class Classes(unittest.TestCase):
    def test_a_class_runs_as_that_of_its_file(self):
        named = arena()
        named.scenario["robots"][0]["controller"]["name"] = f"{__file__}:Bounce"
        sim, same = troupe.Simulation(arena()), troupe.Simulation(named)
        sim.step(100)
        same.step(100)
        self.assertEqual(sim.state_hash, same.state_hash)
        saved = sim.save()
        sim.step(30)
        digest = sim.state_hash
        sim.restore(saved)
        sim.step(30)
        self.assertEqual(sim.state_hash, digest)
        # For robots without one, and for a robot that comes later.
        world = World().robot("anna", (0, 0, 0))
        self.assertEqual(troupe.Simulation(world, controller=Bounce).failures, [])
        later = troupe.Simulation(World())
        later.spawn("scout", (0, 0, 0), controller=Bounce, parameters={"speed": 0.2})
        later.step(5)
        self.assertAlmostEqual(later.twists[0, 0], 0.2, places=6)

    def test_an_exception_names_its_line(self):
        sim = troupe.Simulation(World().robot("anna", (0, 0, 0), controller=Failing))
        sim.step(10)
        self.assertRegex(sim.failures[0], r"failed at tick 3: test_worlds.py:\d+: ZeroDivisionError")

    def test_a_class_of_a_cell_runs_and_cannot_be_saved(self):
        # As a notebook compiles a cell.
        scope = {"__name__": "__main__"}
        code = "class Cell:\n    def __init__(self, robot): pass\n    def update(self, seen):\n        return 1 / (3 - seen.tick), 0\n"
        exec(compile(code, "<cell 4>", "exec"), scope)
        world = World().robot("anna", (0, 0, 0), controller=scope["Cell"])
        sim = troupe.Simulation(world)
        sim.step(5)
        self.assertRegex(sim.failures[0], r"failed at tick 3: <cell 4>:4: ZeroDivisionError")
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(ValueError, "Cell is of no file"):
            world.save(os.path.join(folder, "cell.json"))
        with self.assertRaisesRegex(TypeError, "expected a name, or a class with a method 'update'"):
            troupe.Simulation(World().robot("anna", (0, 0, 0), controller=int))

    def test_another_process_has_not_the_class(self):
        from troupe._cell import name_of
        code = f"import troupe; troupe.Simulation(troupe.World().robot('anna', (0, 0, 0), controller={name_of(Bounce)!r}))"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
        self.assertIn("is a class of another process", done.stderr)


if __name__ == "__main__":
    unittest.main()
