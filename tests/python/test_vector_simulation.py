import subprocess
import sys
import unittest

import numpy

import troupe
from support import LAB, SCENARIOS, SWARM, interrupted


class VectorSimulation(unittest.TestCase):
    def test_hashes_are_those_of_single_simulations(self):
        seeds = [3, 4, 5, 3]
        singles = [troupe.Simulation(SWARM, seed=seed) for seed in seeds]
        for threads in (1, 2):
            vector = troupe.VectorSimulation(SWARM, 4, seeds=seeds, threads=threads)
            for sim in singles:
                sim.step(25) if sim.tick == 0 else None
            for _ in range(5):
                vector.step(5)
            self.assertEqual([sim.state_hash for sim in singles], vector.state_hashes.tolist())
            self.assertEqual(vector.ticks.tolist(), [25] * 4)

    def test_seeds_follow_the_files_by_default(self):
        vector = troupe.VectorSimulation(SWARM, 3)
        self.assertEqual([vector[i].seed for i in range(3)], [1, 2, 3])
        self.assertEqual((len(vector), vector.num_envs, vector.num_robots), (3, 3, 100))

    def test_random_actions_give_equal_hashes(self):
        generator = numpy.random.default_rng(1)
        vector = troupe.VectorSimulation(SWARM, 3, run_controllers=False)
        singles = [troupe.Simulation(SWARM, seed=seed, run_controllers=False) for seed in (1, 2, 3)]
        saved = None
        for round_ in range(30):
            actions = generator.uniform(-1, 1, (3, 100, 3)).astype(numpy.float32)
            ticks = int(generator.integers(1, 4))
            vector.drive(actions)
            vector.step(ticks)
            for sim, action in zip(singles, actions):
                sim.drive(action)
                sim.step(ticks)
            if round_ == 10:
                saved = vector.save()
            if round_ == 20:
                vector.reset([1], [saved[1]])
                singles[1].restore(saved[1])
            self.assertEqual([sim.state_hash for sim in singles], vector.state_hashes.tolist())

    def test_reset_of_a_subset(self):
        vector = troupe.VectorSimulation(SWARM, 4)
        start = vector.state_hashes
        vector.step(10)
        moved = vector.state_hashes
        vector.reset(numpy.array([True, False, True, False]))
        self.assertEqual(vector.ticks.tolist(), [0, 10, 0, 10])
        vector.reset([1])
        self.assertEqual(vector.ticks.tolist(), [0, 0, 0, 10])
        vector.reset()
        self.assertEqual(vector.state_hashes.tolist(), start.tolist())
        vector.step(10)
        self.assertEqual(vector.state_hashes.tolist(), moved.tolist())

    def test_observations_go_into_the_callers_arrays(self):
        vector = troupe.VectorSimulation(SWARM, 2)
        vector.step(7)
        rays = vector.ranges().shape[2]
        for kind in (numpy.float32, numpy.float64):
            poses = numpy.zeros((2, 100, 4), kind)
            twists = numpy.zeros((2, 100, 3), kind)
            stalls = numpy.zeros((2, 100), kind)
            ranges = numpy.zeros((2, 100, rays), kind)
            for name, out in [("poses", poses), ("twists", twists), ("stalls", stalls)]:
                self.assertIs(getattr(vector, name)(out=out), out)
            vector.ranges(out=ranges)
            for i in range(2):
                self.assertTrue((poses[i] == vector[i].poses.astype(kind)).all())
                self.assertTrue((twists[i] == vector[i].twists.astype(kind)).all())
                self.assertTrue((stalls[i] == vector[i].stalls).all())
                self.assertTrue((ranges[i] == vector[i].ranges().astype(kind)).all())

    def test_tables_of_objects_joints_and_energy(self):
        for name, tables in (("stacking", ("object_poses", "joint_positions")), ("foraging_energy", ("energy",))):
            vector = troupe.VectorSimulation(SCENARIOS / f"{name}.json", 2)
            vector.step(60)
            for table in tables:
                found = getattr(vector, table)()
                self.assertGreater(found.size, 0)
                for i in range(2):
                    self.assertTrue((found[i] == getattr(vector[i], table)).all())
                out = numpy.zeros(found.shape, numpy.float32)
                self.assertIs(getattr(vector, table)(out=out), out)
                self.assertTrue((out == found.astype(numpy.float32)).all())
        vector[1].restore(troupe.Simulation(LAB).save())  # a world with another number of stores
        with self.assertRaises(ValueError):
            vector.energy()

    def test_points_are_those_of_single_readings(self):
        vector = troupe.VectorSimulation(SWARM, 2)
        vector.step(3)
        points, ranges = vector.points(), vector.ranges()
        self.assertEqual(points.shape, (*ranges.shape, 3))
        for world, robot in ((0, 0), (1, 57)):
            reading = vector[world].read(robot, "ranger")
            found = points[world, robot]
            numpy.testing.assert_allclose(found[~numpy.isnan(found[:, 0])], reading.points, atol=1e-9)
        single = numpy.zeros(points.shape, numpy.float32)
        self.assertIs(vector.points("ranger", out=single), single)
        numpy.testing.assert_allclose(single, points, atol=1e-5)
        for wrong in (lambda: vector.points("none"), lambda: vector.points(out=numpy.zeros((2, 100, 3)))):
            with self.assertRaises(ValueError):
                wrong()

    def test_receptions_are_those_of_single_readings(self):
        vector = troupe.VectorSimulation(SCENARIOS / "radio.json", 3)
        total = 0
        for _ in range(60):
            vector.step()
            found = vector.receptions()
            self.assertEqual(found["sender"].shape, (3, found["rows"].max()))
            for world in range(3):
                expected = [(robot, each) for robot in range(vector.num_robots)
                            for each in vector[world].read(robot, "radio").receptions]
                total += len(expected)
                self.assertEqual(found["rows"][world], len(expected))
                for row, (robot, each) in enumerate(expected):
                    self.assertEqual((found["receiver"][world, row], found["sender"][world, row], found["tick"][world, row],
                                      found["to_all"][world, row], found["rssi"][world, row], found["data"][world][row]),
                                     (robot, each.sender, each.tick, each.to_all, each.rssi, each.data))
                    if each.place is not None:
                        self.assertEqual(found["bearing"][world, row], each.place.bearing)
                self.assertTrue((found["sender"][world, len(expected):] == -1).all())
        self.assertGreater(total, 0)
        with self.assertRaises(ValueError):
            troupe.VectorSimulation(SWARM, 2).receptions("ranger")

    def test_dlpack(self):
        vector = troupe.VectorSimulation(SWARM, 2)
        poses = vector.poses()
        again = numpy.from_dlpack(poses)
        self.assertTrue(numpy.shares_memory(again, poses))

    def test_wrong_arguments_are_errors(self):
        vector = troupe.VectorSimulation(SWARM, 2)
        other = troupe.Simulation(LAB)
        wrong = [lambda: troupe.VectorSimulation(SWARM, 0), lambda: troupe.VectorSimulation(SWARM, -3),
                 lambda: troupe.VectorSimulation(SWARM, 10**9), lambda: troupe.VectorSimulation(SWARM, 2, seeds=[1]),
                 lambda: troupe.VectorSimulation(SWARM, 2, threads=-1), lambda: vector.step(-1),
                 lambda: vector.drive(numpy.zeros((2, 99, 3))), lambda: vector.drive(None),
                 lambda: vector.drive(numpy.full((2, 100, 3), numpy.inf)), lambda: vector.reset([2]),
                 lambda: vector.reset([-1]), lambda: vector.reset(numpy.array([True])), lambda: vector.reset(5),
                 lambda: vector.reset([0], [1]), lambda: vector.reset([0], []), lambda: vector.reset([0], [None]), lambda: vector[2], lambda: vector["x"],
                 lambda: vector.poses(out=numpy.zeros((2, 100, 3))), lambda: vector.poses(out=numpy.zeros((2, 100, 4), int)),
                 lambda: vector.ranges("none"), lambda: vector.ranges(3, out=None),
                 lambda: vector.poses(out=numpy.zeros((2, 100, 8))[:, :, ::2])]
        for i, call in enumerate(wrong):
            with self.assertRaises((TypeError, ValueError, IndexError, RuntimeError, troupe.Error), msg=i):
                call()
        vector[0].restore(other.save())  # another world
        for call in (vector.poses, vector.twists, vector.stalls, vector.ranges,
                     lambda: vector.drive(numpy.zeros((2, 100, 3)))):
            with self.assertRaises(ValueError):
                call()
        vector.reset()
        vector.poses()

    @unittest.skipIf("/sanitized/" in sys.executable, "the sanitizer needs memory of its own")
    def test_a_copy_is_small(self):
        code = f"""
import resource, troupe
def used(): return int(open('/proc/self/statm').read().split()[1]) * resource.getpagesize()
first = troupe.VectorSimulation({str(SWARM)!r}, 2, seeds=[1, 1], threads=1); first.step()
before = used()
more = troupe.VectorSimulation({str(SWARM)!r}, 33, seeds=[1] * 33, threads=1); more.step()
print((used() - before) / 33)
"""
        out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        self.assertLess(float(out), 1e6)  # bytes


class Misuse(unittest.TestCase):
    def test_ctrl_c_ends_a_long_step(self):
        code = f"v = troupe.VectorSimulation({str(SWARM)!r}, 3, threads=2)\n" \
               "try:\n print('on', flush=True); v.step(10**9)\n" \
               "except KeyboardInterrupt:\n v.step(1); print('stopped', v.ticks.min() > 0)"
        self.assertEqual(interrupted(self, code), ("stopped True\n", 0))

    def test_a_command_that_is_wrong_in_one_place_drives_no_world(self):
        vector = troupe.VectorSimulation(SWARM, 2, run_controllers=False)
        motion = numpy.full((2, vector.num_robots, 2), 0.3)
        motion[1, 4, 0] = numpy.inf
        with self.assertRaisesRegex(ValueError, r"motion\[1, 4, 0\]: found inf"):
            vector.drive(motion)
        before = vector.poses()
        vector.step(5)
        self.assertTrue((vector.poses() == before).all())

    def test_a_mask_of_whole_numbers_is_refused(self):
        vector = troupe.VectorSimulation(SWARM, 3)
        vector.step(2)
        for mask in ([1, 0, 1], numpy.array([0, 0, 1])):
            with self.assertRaisesRegex(ValueError, "twice, expected each once, or a mask of bool"):
                vector.reset(mask)
        self.assertEqual(vector.ticks.tolist(), [2, 2, 2])
        vector.reset([2, 0])
        self.assertEqual(vector.ticks.tolist(), [0, 2, 0])


if __name__ == "__main__":
    unittest.main()
