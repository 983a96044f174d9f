"""Recordings as sequences of states, and pages of simulations."""
import gc
import gzip
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.request

import numpy

import troupe
from page_client import PageClient
from support import LAB, PROGRAMS, ROOT, SCENARIOS, hashes, run
from troupe.testing import Metric, Monitor

TICKS = 60


class Recordings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.file = pathlib.Path(cls.folder.name) / "run.mcap"
        log = os.path.join(cls.folder.name, "hashes")
        run(LAB, "--in-process", "--ticks", TICKS, "--record", cls.file, "--keyframe-interval", 25, "--hash-log", log)
        cls.hashes = hashes(log)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def setUp(self):
        self.recording = troupe.Recording(self.file)

    def test_states_are_those_of_a_simulation(self):
        sim = troupe.Simulation(LAB)
        events = 0
        self.assertEqual(len(self.recording), TICKS + 1)
        for state in self.recording:
            self.assertIsInstance(state, troupe.State)
            self.assertNotIsInstance(state, troupe.Simulation)
            self.assertEqual((state.tick, state.time, state.robots, state.objects),
                             (sim.tick, sim.time, sim.robots, sim.objects))
            self.assertEqual(state.state_hash, sim.state_hash)
            self.assertEqual(state.state_hash, self.hashes[sim.tick])
            for name in ("poses", "twists", "stalls", "joint_positions", "object_poses", "energy"):
                self.assertTrue((getattr(state, name) == getattr(sim, name)).all(), name)
            self.assertEqual(state.events, sim.events)
            events += len(state.events)
            if sim.tick % 20 == 0:
                for robot in sim.robots:
                    self.assertEqual(state.held(robot), sim.held(robot))
                    for number, _ in enumerate(sim.robot(robot).sensors):
                        self.assertEqual(repr(state.read(robot, number)), repr(sim.read(robot, number)))
            sim.step()
        self.assertGreater(events, 0)

    def test_positions(self):
        recording = self.recording
        order = list(range(-len(recording), len(recording)))
        random.Random(3).shuffle(order)
        for position in order:
            tick = position % len(recording)
            state = recording[position]
            self.assertEqual((state.tick, state.state_hash), (tick, self.hashes[tick]))
        self.assertEqual(recording[numpy.int64(7)].tick, 7)
        for wrong in (len(recording), -len(recording) - 1, 2**70):
            with self.assertRaises(IndexError):
                recording[wrong]
        for wrong in ("1", 1.0, None, (1, 2)):
            with self.assertRaises(TypeError):
                recording[wrong]

    def test_ticks(self):
        self.assertEqual(self.recording.ticks.tolist(), list(range(TICKS + 1)))
        self.assertEqual(self.recording.at_tick(41).state_hash, self.hashes[41])
        self.assertEqual(self.recording.position(41), 41)
        for wrong in (TICKS + 1, -1):
            with self.assertRaises(IndexError):
                self.recording.at_tick(wrong)
        with self.assertRaises(TypeError):
            self.recording.at_tick("1")

    def test_slices(self):
        part = self.recording[10:20]
        self.assertIsInstance(part, troupe.Recording)
        self.assertEqual([state.tick for state in part], list(range(10, 20)))
        self.assertEqual((part[0].tick, part[-1].tick, len(part)), (10, 19, 10))
        self.assertEqual(part.ticks.tolist(), list(range(10, 20)))
        self.assertEqual([state.tick for state in part[::-3]], [19, 16, 13, 10])
        self.assertEqual([state.tick for state in reversed(self.recording)], list(range(TICKS, -1, -1)))
        self.assertEqual(part.at_tick(12).tick, 12)
        self.assertEqual(part.position(12), 2)
        with self.assertRaises(IndexError):
            part.at_tick(9)
        empty = self.recording[5:5]
        self.assertEqual((list(empty), len(empty), empty.ticks.tolist()), ([], 0, []))
        with self.assertRaises(IndexError):
            empty[0]
        self.assertIn("10 states", repr(part))

    def test_states_outlive_the_recording(self):
        states = [self.recording[3], self.recording[50]]
        poses = states[0].poses
        del self.recording
        gc.collect()
        self.assertEqual([state.state_hash for state in states], [self.hashes[3], self.hashes[50]])
        self.assertEqual(poses.shape, (len(states[0].robots), 4))
        with self.assertRaises(ValueError):
            poses[0] = 0
        self.assertTrue(states[1].picture().startswith(b"\x89PNG"))
        for name in ("step", "drive", "restore", "save"):
            self.assertFalse(hasattr(states[0], name), name)

    def test_a_copy_of_a_state_is_a_simulation(self):
        sim = self.recording[30].copy()
        self.assertIsInstance(sim, troupe.Simulation)
        sim.drive((0.2, 0.0), 0)
        sim.step(5)
        self.assertEqual(sim.tick, 35)
        self.assertEqual(self.recording[30].state_hash, self.hashes[30])

    def test_expectations_about_a_recording(self):
        text = "forall r: always speed(r) < 0.5 m/s"
        first = self.recording[0]
        monitor, metric = Monitor(first, text), Metric(first, "max of speed(r)")
        sim = troupe.Simulation(LAB)
        live, live_metric = Monitor(sim, text), Metric(sim, "max of speed(r)")
        for state in self.recording:
            for each in (monitor, metric):
                each.push(state)
            for each in (live, live_metric):
                each.push(sim)
            sim.step()
        for each in (monitor, metric, live, live_metric):
            each.finish()
        self.assertEqual((monitor.verdict, monitor.robustness, metric.value),
                         (live.verdict, live.robustness, live_metric.value))

    def test_threads_share_a_recording(self):
        found = {}

        def read(first):
            found[first] = [self.recording[i].state_hash == self.hashes[i] for i in range(first, TICKS, 7)]

        threads = [threading.Thread(target=read, args=(first,)) for first in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(all(map(all, found.values())))
        self.assertEqual(len(found), 4)

    def test_what_is_no_recording(self):
        with tempfile.TemporaryDirectory() as folder:
            text = pathlib.Path(folder) / "text.mcap"
            text.write_text("no recording")
            for wrong in (text, folder, os.path.join(folder, "none.mcap"), LAB):
                with self.assertRaises(troupe.Error) as caught:
                    troupe.Recording(wrong)
                self.assertEqual(caught.exception.file, str(wrong))
            for wrong in (None, 3, [], object()):
                with self.assertRaises(TypeError):
                    troupe.Recording(wrong)
            damaged = pathlib.Path(folder) / "damaged.mcap"
            content = self.file.read_bytes()
            damaged.write_bytes(content[:len(content) // 2])
            recording = troupe.Recording(damaged)
            self.assertIsNotNone(recording.damage)
            self.assertIsNone(self.recording.damage)
            self.assertGreater(len(recording), 10)
            self.assertLess(len(recording), TICKS + 1)
            self.assertEqual(recording[-1].state_hash, self.hashes[recording[-1].tick])
        self.assertEqual(self.recording.program_version, troupe._troupe.__version__)
        self.assertTrue(self.recording.world_file.endswith("lab.json"))

    def test_an_edited_run(self):
        """Robots come and go, and time is set back: each state has the robots of its world."""
        file = pathlib.Path(self.folder.name) / "edited.mcap"
        environment = {**os.environ, "PATH": f"{PROGRAMS}:{os.environ['PATH']}"}
        session = f"edited-{os.getpid()}"
        child = subprocess.Popen([PROGRAMS / "troupe", "run", LAB, "--headless", "--paused",
                                  "--session", session, "--record", file], env=environment, stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT, text=True)

        def control(*words):
            done = subprocess.run([PROGRAMS / "troupe", "ctl", *words, "--session", session], capture_output=True,
                                  text=True, timeout=60)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

        try:
            control("step", "10")
            control("spawn", "scout", "--name", "guest", "--pose", "0,-3.5,0")
            control("step", "5")
            control("delete", "guest")
            control("step", "5")
            control("rewind", "3")
            control("step", "2")
        finally:
            child.send_signal(signal.SIGINT)
            text, _ = child.communicate(timeout=60)
        recording = troupe.Recording(file)
        names = [state.robots for state in recording]
        count = len(troupe.Simulation(LAB).robots)
        self.assertEqual(len(names[0]), count, text)
        self.assertEqual(max(map(len, names)), count + 1)
        self.assertTrue(any("guest" in each for each in names))
        self.assertEqual(recording[-1].tick, 5)
        self.assertLess(recording[-1].tick, recording.ticks.max())
        for state in recording:
            self.assertEqual(len(state.poses), len(state.robots))
        for state in reversed(recording):
            state.poses


class FromPython(unittest.TestCase):
    """Recordings that Simulation.record makes, by the readers of those of `troupe run`."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = pathlib.Path(folder.name) / "own.mcap"

    def replay(self, *arguments):
        done = subprocess.run([PROGRAMS / "troupe", "replay", self.file, "--verify", *arguments], text=True, capture_output=True,
                              timeout=100)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_controllers_and_commands_are_replayed(self):
        sim = troupe.Simulation(SCENARIOS / "demo.json")
        sim.record(self.file, keyframe_interval=10)
        expected = [sim.state_hash]
        for tick in range(40):
            if tick == 5:
                sim.drive((0.2, 0.3), 0)
            if tick == 20:
                sim.release()
            sim.step()
            expected.append(sim.state_hash)
        with self.assertRaisesRegex(RuntimeError, "recorded already"):
            sim.record(self.file)
        sim.stop_recording()
        sim.stop_recording()
        sim.step()
        self.assertEqual([state.state_hash for state in troupe.Recording(self.file)], expected)
        self.replay()
        self.replay("--from", "25", "--to", "30")

    def test_changes_and_restored_snapshots_are_states_of_their_own(self):
        sim = troupe.Simulation(SCENARIOS / "demo.json")
        sim.step(7)
        saved = sim.save()
        sim.record(self.file)
        expected = [sim.tick]
        ticks = []

        def step(count):
            for _ in range(count):
                sim.step()
                ticks.append((sim.tick, sim.state_hash))

        step(3)
        name = sim.spawn("scout", (0, -0.4, 0), controller="wander")
        step(4)
        sim.set_pose(name, (0, -0.4, 3.14))
        step(2)
        sim.restore(saved)
        step(5)
        other = troupe.Simulation(LAB)
        other.step(2)
        sim.restore(other.save())
        step(3)
        sim.stop_recording()
        recording = troupe.Recording(self.file)
        self.assertEqual(recording[0].tick, 0)
        self.assertEqual(recording[1].tick, expected[0])
        found = [(state.tick, state.state_hash) for state in recording]
        self.assertEqual([each for each in found if each in ticks], ticks)
        # The states between are those of the changes.
        self.assertEqual(len(found), len(ticks) + 2 + 4)
        self.assertEqual(recording[-1].robots, other.robots)
        self.replay()

    def test_worlds_of_a_vector_are_recorded_while_they_learn(self):
        from troupe import rl
        env = rl.VectorEnv(rl.Navigation(robots=2), 3, threads=2)
        env.reset(seed=1)
        env.simulations[1].record(self.file)
        generator = numpy.random.default_rng(0)
        for _ in range(20):
            env.step(generator.uniform(-1, 1, env.action_space.shape))
        last = env.simulations[1].state_hash
        env.simulations[1].stop_recording()
        self.assertEqual(troupe.Recording(self.file)[-1].state_hash, last)
        self.replay()

    def test_a_file_that_cannot_be_written_is_an_error(self):
        sim = troupe.Simulation(LAB)
        with self.assertRaises(troupe.Error):
            sim.record(self.file.parent / "none" / "run.mcap")
        for interval in (0, -1):
            with self.assertRaises(ValueError):
                sim.record(self.file, keyframe_interval=interval)
        with self.assertRaisesRegex(troupe.Error, "No space left"):
            sim.record("/dev/full")
        sim.step()  # goes on without a recording
        del sim
        sim = troupe.Simulation(LAB)
        sim.record(self.file)
        sim.step(3)
        del sim  # closes the file
        gc.collect()
        self.assertEqual(len(troupe.Recording(self.file)), 4)


class Pages(unittest.TestCase):
    def setUp(self):
        self.sim = troupe.Simulation(LAB)

    def children(self):
        return set(pathlib.Path(f"/proc/self/task/{os.getpid()}/children").read_text().split())

    def test_the_page_follows_the_simulation(self):
        before = self.children()
        address = self.sim.view()
        self.assertRegex(address, r"^http://127\.0\.0\.1:\d+")
        self.assertEqual(self.sim.view(), address)
        page = self.sim.show(height=300)
        self.assertEqual(page.address, address)
        self.assertIn('height="300"', page._repr_html_())
        with urllib.request.urlopen(address, timeout=30) as page:
            self.assertEqual(page.status, 200)
            content = page.read()
            if page.headers["Content-Encoding"] == "gzip":
                content = gzip.decompress(content)
            self.assertIn(b"<!doctype html>", content.lower())
        client = PageClient(address)
        self.assertEqual(client.wait_for(tick=0).hash, self.sim.state_hash)
        for _ in range(3):
            self.sim.step(7)
            self.assertEqual(client.wait_for(tick=self.sim.tick).hash, self.sim.state_hash)
        saved = self.sim.save()
        self.sim.step(5)
        client.wait_for(tick=26)
        self.sim.restore(saved)
        self.assertEqual(client.wait_for(tick=21).hash, self.sim.state_hash)
        self.sim.restore(troupe.Simulation(SCENARIOS / "swarm.json").save())  # another world
        self.assertEqual(client.wait_for(tick=0).hash, self.sim.state_hash)
        self.sim.step(3)
        self.assertEqual(client.wait_for(tick=3).hash, self.sim.state_hash)
        self.assertEqual(len(self.children() - before), 1)
        del self.sim
        self.assertTrue(client.wait_for(last=True).last)
        self.assertEqual(self.children(), before)
        with self.assertRaises(OSError):
            urllib.request.urlopen(address, timeout=5)

    def test_it_changes_nothing(self):
        self.sim.view()
        self.sim.step(30)
        other = troupe.Simulation(LAB)
        other.step(30)
        self.assertEqual(self.sim.state_hash, other.state_hash)
        self.sim.close_view()
        self.sim.close_view()
        self.sim.step()
        self.assertNotEqual(self.sim.view(), "")  # it opens again

    def test_the_page_cannot_change_it(self):
        client = PageClient(self.sim.view())
        reply = client.ask({"type": "control", "command": "pause"})
        self.assertFalse(reply["done"], reply)

    def test_a_program_that_dies_leaves_the_simulation(self):
        before = self.children()
        self.sim.view()
        child, = self.children() - before
        os.kill(int(child), signal.SIGKILL)
        while pathlib.Path(f"/proc/{child}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z":
            time.sleep(0.001)
        deadline = time.monotonic() + 30
        while self.sim.step() or self.children() - before == {child}:
            self.assertLess(time.monotonic(), deadline)
            self.assertRegex(self.sim.view(), r"^http://")  # as soon as the end is known, another one
        self.sim.close_view()
        self.assertEqual(self.children(), before)

    def test_errors(self):
        with self.assertRaises(troupe.Error):
            self.sim.view(program="/none/troupe")
        with self.assertRaises(troupe.Error) as caught:
            self.sim.view(program="/bin/false")
        with self.assertRaises(troupe.Error):
            self.sim.view(address="nowhere")
        for wrong in ({"port": -1}, {"port": 70000}, {"port": "x"}, {"address": 3}, {"program": 3}):
            with self.assertRaises(TypeError):
                self.sim.view(**wrong)
        self.sim.step()

    def test_the_end_of_the_process_is_that_of_the_page(self):
        code = f"import os, troupe; s = troupe.Simulation({str(LAB)!r}); print(s.view(), flush=True); os._exit(0)"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        deadline = time.monotonic() + 30
        while True:
            try:
                urllib.request.urlopen(done.stdout.strip(), timeout=5).close()
            except OSError:
                break
            self.assertLess(time.monotonic(), deadline)


if __name__ == "__main__":
    unittest.main()
