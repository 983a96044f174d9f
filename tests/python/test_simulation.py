import copy
import ctypes
import gc
import pickle
import subprocess
import sys
import tempfile
import threading
import time
import random
import unittest

import numpy

import troupe
from support import LAB, ROOT, SCENARIOS, SWARM, interrupted, logged


class Reading(unittest.TestCase):
    def setUp(self):
        self.sim = troupe.Simulation(SWARM)

    def test_arrays_have_the_documented_shapes_and_types(self):
        n = len(self.sim.robots)
        self.assertEqual(n, 100)
        for name, shape, kind in [("poses", (n, 4), "f8"), ("twists", (n, 3), "f8"), ("stalls", (n,), "?")]:
            array = getattr(self.sim, name)
            self.assertEqual((array.shape, array.dtype), (shape, numpy.dtype(kind)), name)

    def test_writing_into_an_array_is_refused_and_changes_no_state(self):
        snapshot, fork, before = self.sim.save(), self.sim.copy(), self.sim.state_hash
        for name in ("poses", "twists", "stalls", "joint_positions", "object_poses", "energy"):
            array = getattr(self.sim, name)
            if array.size:
                with self.assertRaises(ValueError):
                    array.flat[0] = 1.0
            # As torch does, which ignores the flag.
            ctypes.memset(array.ctypes.data, 0, array.nbytes)
        self.assertEqual((self.sim.state_hash, fork.state_hash), (before, before))
        self.sim.restore(snapshot)
        self.assertEqual(self.sim.state_hash, before)
        self.assertTrue(self.sim.poses.any())

    def test_arrays_keep_their_tick_and_outlive_the_simulation(self):
        before = self.sim.poses
        copied = before.copy()
        self.sim.step(20)
        self.assertTrue((before == copied).all())
        self.assertFalse((self.sim.poses == copied).all())
        del self.sim
        gc.collect()
        trash = [numpy.random.rand(1000) for _ in range(100)]
        self.assertTrue((before == copied).all())
        del trash

    def test_readings_are_records_with_views(self):
        reading = self.sim.read("scout0", "ranger")
        scan = reading.scans[0]
        self.assertEqual(reading.tick, 0)
        self.assertEqual(scan.ranges.shape, scan.intensities.shape)
        self.assertTrue(((scan.ranges >= scan.min) & (scan.ranges <= scan.max)).all())
        self.assertFalse(scan.ranges.flags.writeable)
        ranges = scan.ranges.copy()
        del reading
        self.sim.step(30)
        gc.collect()
        self.assertTrue((scan.ranges == ranges).all())
        self.assertEqual(len(scan.bearings), len(scan.ranges))

    def test_ranges_of_all_robots_equal_those_of_each(self):
        self.sim.step(5)
        name = self.sim.robot(0).sensors[0].name
        together = self.sim.ranges(name)
        single = numpy.zeros(together.shape, numpy.float32)
        self.assertIs(self.sim.ranges(name, out=single), single)
        self.assertTrue((single == together.astype(numpy.float32)).all())
        for i in (0, 7, 99):
            self.assertTrue((together[i] == self.sim.read(i, 0).ranges).all())

    def test_robots_with_grippers(self):
        sim = troupe.Simulation(SCENARIOS / "stacking.json", run_controllers=False)
        info = sim.robot("builder")
        gripper = info.grippers[0]
        self.assertEqual([info.joints[i].type for i in (gripper.left, gripper.right, gripper.lift)], ["prismatic"] * 3)
        self.assertEqual(info.sensors[gripper.beams].type, "break_beam")
        self.assertEqual(sim.held("builder"), [None])
        for robot in range(len(sim.robots)):
            self.assertEqual(sim.robot(robot).name, sim.robots[robot])
        before = sim.joint_positions
        sim.drive(troupe.Command(grippers=[troupe.GripperCommand(0, "close", lift=50)]), "builder")
        sim.step(20)
        self.assertTrue((sim.joint_positions != before).any())

    def test_kinds_of_sensors(self):
        sim = troupe.Simulation(SCENARIOS / "sensors.json")
        sim.step(10)
        kinds = set()
        for robot in sim.robots:
            for number, sensor in enumerate(sim.robot(robot).sensors):
                kinds.add(sensor.type)
                reading = sim.read(robot, number)
                if sensor.type == "camera":
                    self.assertEqual(reading.colors.shape, (*reading.depths.shape, 3))
                    self.assertEqual(reading.points.shape[1], 3)
                if sensor.type == "ranger":
                    self.assertEqual(reading.points.shape[1], 3)
                self.assertEqual(reading.tick, 10)
        self.assertLessEqual({"ranger", "camera"}, kinds)

    def test_points_of_a_ranger_lie_on_its_rays(self):
        reading = self.sim.read(0, 0)
        distances = [numpy.hypot(p[0], p[1]) for p in reading.points]
        self.assertEqual(len(distances), sum((scan.ranges < scan.max).sum() for scan in reading.scans))

    def test_picture_is_png_or_svg(self):
        self.assertTrue(self.sim._repr_png_().startswith(b"\x89PNG"))
        picture = self.sim.picture(view="side", rays=True, width=300, format="svg")
        self.assertIn("<svg", picture._repr_svg_())
        self.assertIsNone(picture._repr_png_())
        with tempfile.TemporaryDirectory() as folder:
            picture.save(folder + "/x.svg")
        with self.assertRaises(troupe.InputError):
            self.sim.picture(width=3)


class Stepping(unittest.TestCase):
    def test_hashes_are_those_of_troupe_run(self):
        with tempfile.TemporaryDirectory() as folder:
            for scenario in (SWARM, LAB):
                expected = logged(scenario, folder, "--ticks", 100, "--in-process")
                sim = troupe.Simulation(scenario)
                for tick in range(1, 101):
                    sim.step()
                    self.assertEqual(sim.state_hash, expected[tick], f"{scenario} tick {tick}")

    def test_seed_and_controller(self):
        one, other = (troupe.Simulation(SWARM, seed=seed) for seed in (1, 2))
        self.assertEqual((one.seed, other.seed), (1, 2))
        self.assertNotEqual(one.state_hash, other.state_hash)
        still = troupe.Simulation(SWARM, run_controllers=False)
        still.step(10)
        self.assertFalse(still.twists.any())

    def test_save_restore_and_copy_continue_alike(self):
        sim = troupe.Simulation(SWARM)
        sim.step(50)
        saved = sim.save()
        self.assertEqual(saved.tick, 50)
        fork = sim.copy()
        sim.step(30)
        expected = sim.state_hash
        sim.restore(saved)
        self.assertEqual(sim.tick, 50)
        for each in (sim, fork, copy.deepcopy(sim.copy())):
            if each.tick == 50:
                each.step(30)
            self.assertEqual(each.state_hash, expected)
        fork.restore(saved)
        fork.step(30)
        self.assertEqual(fork.state_hash, expected)

    def test_a_pickled_snapshot_continues_alike_in_another_process(self):
        sim = troupe.Simulation(SWARM, run_controllers=False)
        sim.drive(numpy.random.default_rng(1).uniform(-1, 1, (100, 2)))
        sim.step(20)
        pickled = pickle.dumps(sim.save())
        sim.step(30)
        code = "import pickle, sys, troupe; sim = troupe.Simulation(sys.argv[1]); " \
               "sim.restore(pickle.load(sys.stdin.buffer)); print(sim.tick); sim.step(30); print(sim.state_hash)"
        done = subprocess.run([sys.executable, "-c", code, SCENARIOS / "lab.json"], input=pickled, capture_output=True, check=True)
        self.assertEqual(done.stdout.decode().split(), ["20", str(sim.state_hash)])
        again = pickle.loads(pickled)
        self.assertEqual(again.tick, 20)
        self.assertEqual(pickle.dumps(again), pickled)
        for world, reason in ((SWARM, "has the controller"), (LAB, "has the controller")):
            with self.assertRaisesRegex(troupe.Error, reason):
                pickle.dumps(troupe.Simulation(world).save())
        grippers = troupe.Simulation(SCENARIOS / "stacking.json", run_controllers=False)
        with self.assertRaisesRegex(troupe.Error, "has joints"):
            pickle.dumps(grippers.save())
        state = again.__getstate__()
        generator = random.Random(2)
        for _ in range(200):
            broken = bytearray(state)
            for _ in range(generator.randint(1, 3)):
                broken[generator.randrange(len(broken))] = generator.randrange(256)
            if generator.random() < 0.5:
                del broken[generator.randrange(len(broken)):]
            other = troupe.Snapshot.__new__(troupe.Snapshot)
            try:
                other.__setstate__(bytes(broken))
            except troupe.Error:
                continue
            sim.restore(other)  # a change of a number, of which nothing can be said
            sim.step()

    def test_events_of_a_call_have_their_ticks_and_names(self):
        sim = troupe.Simulation(LAB)
        sim.step(300)
        events = sim.events
        self.assertTrue(events)
        self.assertEqual(sorted(event.tick for event in events), [event.tick for event in events])
        self.assertTrue(any(event.type == "stall_began" and event.robot in sim.robots for event in events))
        self.assertEqual(pickle.loads(pickle.dumps(events)), events)
        sim.step(0)
        self.assertEqual(sim.events, [])

    def test_driving(self):
        sim = troupe.Simulation(SWARM, run_controllers=False)
        sim.drive((0.2, 0.5), "scout3")
        sim.step()
        self.assertTrue(sim.twists[3, 0] > 0)
        self.assertEqual(numpy.count_nonzero(sim.twists[:, 0]), 1)
        sim.drive(numpy.tile(numpy.float32([0.1, 0.0]), (100, 1)))
        sim.step(3)
        self.assertGreater(numpy.count_nonzero(sim.twists[:, 0]), 50)
        sim.release()
        sim.step(20)
        self.assertFalse(sim.twists.any())

    def test_driving_from_python_equals_the_script(self):
        sim = troupe.Simulation(LAB)
        own = troupe.Simulation(LAB)
        robot = "body_at_cabinet"
        for _ in range(50):
            own.drive((0.4, 0.0, 0.0), robot)
            sim.step()
            own.step()
            self.assertEqual(sim.state_hash, own.state_hash)

    def test_errors_have_the_place(self):
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            file.write('{\n  "world": "x.world",\n  "sed": 1\n}')
            file.flush()
            with self.assertRaises(troupe.InputError) as caught:
                troupe.Simulation(file.name)
        error = caught.exception
        self.assertEqual((error.file, error.line), (file.name, 3))
        self.assertGreater(error.column, 0)
        self.assertTrue(str(error).startswith(f"{file.name}:3:"))
        with self.assertRaises(troupe.Error):
            troupe.Simulation("/no/such/file.world")
        self.assertEqual(str(pickle.loads(pickle.dumps(error))), str(error))


class Robustness(unittest.TestCase):
    def test_wrong_arguments_are_errors(self):
        sim = troupe.Simulation(SWARM, run_controllers=False)
        readonly = sim.poses
        wrong = [lambda: sim.step(-1), lambda: sim.step("1"), lambda: sim.step(1.5), lambda: sim.step(10**30),
                 lambda: sim.step(None), lambda: sim.robot("nobody"), lambda: sim.robot(100), lambda: sim.robot(-1),
                 lambda: sim.robot(2**70), lambda: sim.robot(None), lambda: sim.robot([]), lambda: sim.read(0, 99),
                 lambda: sim.read(0, "x"), lambda: sim.read(0, -1), lambda: sim.read(None, 0),
                 lambda: sim.ranges("none"), lambda: sim.ranges(77), lambda: sim.ranges(0, out=readonly),
                 lambda: sim.ranges(0, out=[1, 2]), lambda: sim.ranges(0, out=numpy.zeros(3)),
                 lambda: sim.ranges(0, out=numpy.zeros((100, 99), object)), lambda: sim.drive(None),
                 lambda: sim.drive([[1, 2, 3]]), lambda: sim.drive("fast"), lambda: sim.drive(numpy.zeros((100, 4))),
                 lambda: sim.drive(numpy.full((100, 3), numpy.nan)), lambda: sim.drive((1, "x"), 0),
                 lambda: sim.drive((float("inf"), 0), 0), lambda: sim.drive((1, 2), "nobody"),
                 lambda: sim.drive(troupe.Command(grippers=[troupe.GripperCommand(5, "open")]), 0),
                 lambda: sim.drive(troupe.Command(grippers=5), 0), lambda: sim.drive(troupe.Command(joints=[1]), 0),
                 lambda: sim.drive(troupe.Command(messages=[troupe.RadioMessage(0, "text")]), 0),
                 lambda: sim.restore(None), lambda: sim.restore(sim), lambda: sim.held("x"),
                 lambda: sim.picture(view="x"), lambda: sim.picture(width="x"), lambda: sim.picture(meters=-1.0),
                 lambda: troupe.Simulation(None), lambda: troupe.Simulation(5), lambda: troupe.Simulation(b"\0"),
                 lambda: troupe.Simulation(SWARM, seed=-1), lambda: troupe.Simulation(SWARM, seed="x"),
                 lambda: troupe.Snapshot(),
                 lambda: troupe.Snapshot.__new__(troupe.Snapshot).tick,
                 lambda: sim.restore(troupe.Snapshot.__new__(troupe.Snapshot)),
                 lambda: troupe.VectorSimulation.__new__(troupe.VectorSimulation).step(),
                 lambda: troupe.VectorSimulation.__new__(troupe.VectorSimulation).poses(),
                 lambda: troupe.Simulation.__new__(troupe.Simulation).restore(sim.save()),
                 lambda: troupe.Simulation.__new__(troupe.Simulation).tick]
        before = sim.state_hash
        for i, call in enumerate(wrong):
            with self.assertRaises((TypeError, ValueError, IndexError, OverflowError, RuntimeError, troupe.Error,
                                    OSError), msg=i):
                call()
        self.assertEqual(sim.state_hash, before)

    def test_threads_step_side_by_side_and_a_shared_one_refuses(self):
        sims = [troupe.Simulation(SWARM) for _ in range(3)]
        workers = [threading.Thread(target=sim.step, args=(40,)) for sim in sims]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.assertEqual(len({sim.state_hash for sim in sims}), 1)
        sim = sims[0]
        worker = threading.Thread(target=sim.step, args=(100000,), daemon=True)
        refused = 0
        failure = []

        def long_run():
            try:
                sim.step(400)
            except RuntimeError as error:
                failure.append(error)

        worker = threading.Thread(target=long_run)
        worker.start()
        while worker.is_alive():
            try:
                sim.poses
                sim.step(1)
            except RuntimeError:
                refused += 1
            time.sleep(0)
        worker.join()
        self.assertGreater(refused + len(failure), 0)

    def test_ctrl_c_ends_a_long_step(self):
        code = f"s = troupe.Simulation({str(SWARM)!r})\n" \
               "try:\n print('on', flush=True); s.step(10**9)\n" \
               "except KeyboardInterrupt:\n s.step(1); print('stopped', s.tick > 0)"
        self.assertEqual(interrupted(self, code), ("stopped True\n", 0))

    def test_python_ends_while_a_daemon_thread_steps(self):
        code = "import sys, threading, time, troupe\n" \
               f"s = troupe.Simulation({str(SWARM)!r})\n" \
               "threading.Thread(target=s.step, args=(10**9,), daemon=True).start()\n" \
               f"v = troupe.VectorSimulation({str(SWARM)!r}, 2)\n" \
               "threading.Thread(target=v.step, args=(10**9,), daemon=True).start()\n" \
               "time.sleep(0.2)"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))

    def test_a_seed_is_a_whole_number_of_python_or_numpy(self):
        for seed, kind, text in [(-1, ValueError, "found -1, expected 0 to"), (2**64, ValueError, "found 18446744073709551616"),
                                 (1.5, TypeError, "found float, expected a whole number"), ("7", TypeError, "found str")]:
            with self.assertRaisesRegex(kind, text):
                troupe.Simulation(SWARM, seed=seed)
            with self.assertRaisesRegex(kind, text):
                troupe.VectorSimulation(SWARM, 2, seeds=[1, seed])
        with self.assertRaisesRegex(TypeError, "seeds: found NoneType"):
            troupe.VectorSimulation(SWARM, 2, seeds=[1, None])
        expected = troupe.Simulation(SWARM, seed=5).state_hash
        self.assertEqual(troupe.Simulation(SWARM, seed=numpy.uint32(5)).state_hash, expected)
        vector = troupe.VectorSimulation(SWARM, 2, seeds=numpy.array([4, 5]))
        self.assertEqual(int(vector.state_hashes[1]), expected)

    def test_an_array_that_is_not_finite_drives_no_robot(self):
        sim = troupe.Simulation(SWARM, run_controllers=False)
        motion = numpy.full((len(sim.robots), 2), 0.3)
        motion[7, 1] = numpy.nan
        with self.assertRaisesRegex(ValueError, r"motion\[7, 1\]: found nan, expected a finite number"):
            sim.drive(motion)
        before = sim.poses
        sim.step(5)
        self.assertTrue((sim.poses == before).all())

    def test_import_needs_neither_numpy_nor_the_library(self):
        code = "import sys, troupe; print('numpy' in sys.modules, 'troupe._troupe' in sys.modules, 'Pose' in dir(troupe))"
        out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        self.assertEqual(out, "False False True\n")

    def test_unknown_names_are_attribute_errors(self):
        with self.assertRaises(AttributeError):
            troupe.nonesuch
        self.assertFalse(hasattr(troupe, "__wrapped__"))


class Package(unittest.TestCase):
    def test_stub_lists_what_the_classes_have(self):
        import ast
        tree = ast.parse((ROOT / "python/troupe/_troupe.pyi").read_text())
        for node in tree.body:
            if not isinstance(node, ast.ClassDef):
                continue
            listed = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
            real = {name for name in vars(getattr(troupe._troupe, node.name)) if not name.startswith("_")}
            self.assertEqual({name for name in listed if not name.startswith("_")}, real, node.name)

    def test_everything_has_a_docstring(self):
        for kind in (troupe.Simulation, troupe.VectorSimulation, troupe.Snapshot, troupe._troupe.Monitor,
                     troupe._troupe.Metric):
            self.assertTrue(kind.__doc__)
            for name, value in vars(kind).items():
                if not name.startswith("_"):
                    self.assertTrue(value.__doc__, f"{kind.__name__}.{name}")


if __name__ == "__main__":
    unittest.main()
