"""Changes of a simulation from outside: those of the tools of a run, with the same hashes."""

import math
import os
import signal
import subprocess
import tempfile
import unittest

import numpy

import troupe
from support import PROGRAMS, ROOT, hashes

HOUSE = ROOT / "worlds/sites/guesthouse_guests.json"
OFFICE = {
    "world": str(ROOT / "worlds/office.world"), "include": ["robots.inc", "furniture.inc"],
    "robots": [{"name": "anna", "model": "scout", "pose": [-8, 0, 0], "controller": "go_to"},
               {"name": "ben", "model": "scout", "pose": [4, 0, 180], "controller": "wander"}],
    "models": [{"name": "crate", "model": "carton", "pose": [0, 0.5, 0]}]}


class Run:
    """A run of processes, paused at tick 0, that the tools step and change."""

    def __init__(self, test, scenario):
        folder = tempfile.TemporaryDirectory()
        test.addCleanup(folder.cleanup)
        self.session = f"changes-{os.getpid()}"
        self.log = os.path.join(folder.name, "hashes")
        self.program = subprocess.Popen(
            [PROGRAMS / "troupe", "run", str(scenario), "--headless", "--paused", "--session", self.session, "--hash-log",
             self.log, "--robots-per-process", "4"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        test.addCleanup(self.program.stdout.close)
        test.addCleanup(self.program.wait)
        test.addCleanup(self.program.kill)

    def tool(self, *words):
        done = subprocess.run([PROGRAMS / "troupe", *map(str, words), "--session", self.session], text=True,
                              capture_output=True, timeout=60)
        if done.returncode != 0:
            raise AssertionError(f"{words}: {done.stdout}{done.stderr}")

    def hashes(self):
        self.program.send_signal(signal.SIGINT)
        output, _ = self.program.communicate(timeout=60)
        if self.program.returncode != 130:
            raise AssertionError(output)
        return hashes(self.log)


class Changes(unittest.TestCase):
    def test_are_those_of_the_tools_of_a_run(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "office.json")
            with open(file, "w") as out:
                out.write(troupe.world.WorldText(OFFICE).scenario)
            run = Run(self, file)
            sim = troupe.Simulation(file)
            seen = {}

            def step(ticks):
                run.tool("ctl", "step", ticks)
                seen[sim.tick] = sim.state_hash  # after an edit
                for _ in range(ticks):
                    sim.step()
                    seen[sim.tick] = sim.state_hash

            step(5)
            run.tool("goto", "anna", "-2,0.3,90", "--no-wait")
            sim.send_to("anna", (-2, 0.3), heading=math.radians(90))
            step(20)
            run.tool("ctl", "set-pose", "ben", "--pose", "2,0,0,90")
            sim.set_pose("ben", (2, 0, math.radians(90)))
            run.tool("ctl", "spawn", "scout", "--name", "late", "--pose", "-10,0,0,0", "--controller", "wander")
            self.assertEqual(sim.spawn("scout", (-10, 0, 0), "late", controller="wander"), "late")
            step(20)
            run.tool("ctl", "set-pose", "crate", "--pose", "-6,0.2,0,0")
            sim.set_pose("crate", (-6, 0.2, 0))
            run.tool("goto", "anna", "--cancel")
            sim.cancel_goal("anna")
            step(10)
            run.tool("ctl", "delete", "ben")
            sim.delete("ben")
            step(10)
            self.assertEqual(sim.failures, [])
            found = run.hashes()
            self.assertEqual({tick: found[tick] for tick in seen}, seen)

    def test_doors_and_lifts_move_as_in_a_run(self):
        run = Run(self, HOUSE)
        sim = troupe.Simulation(HOUSE)
        run.tool("ctl", "step", 1)
        sim.step()
        for floor in ("L2", "L1"):
            run.tool("ctl", "door", "lobby_door", 0.5)
            sim.set_door("lobby_door", 0.5)
            run.tool("ctl", "lift", "guest_lift", floor)
            sim.call_lift("guest_lift", floor)
            run.tool("ctl", "step", 50)
            sim.step(50)
        self.assertGreater(sim.table("doors")["opening"][sim.doors.index("lobby_door")], 0.1)
        self.assertEqual(run.hashes()[101], sim.state_hash)

    def test_a_spawned_thing_has_the_next_number_and_a_deleted_one_keeps_its_row(self):
        sim = troupe.Simulation(OFFICE)
        saved = sim.save()
        self.assertEqual(sim.spawn("scout", (0, -0.4, 0)), "scout")
        self.assertEqual(sim.spawn("scout", (1, -0.4, 0)), "scout0")
        self.assertEqual(sim.robots, ("anna", "ben", "scout", "scout0"))
        numpy.testing.assert_allclose(sim.poses[2:, :2], [(0, -0.4), (1, -0.4)])
        sim.drive((0.3, 0.0), "scout0")
        sim.step(10)
        self.assertGreater(sim.poses[3, 0], 1.1)
        self.assertGreater(sim.read("scout", "ranger").ranges.min(), 0.0)
        before = sim.poses[2]
        sim.delete("scout")
        sim.step(5)
        numpy.testing.assert_array_equal(sim.poses[2], before)
        self.assertEqual(len(sim.poses), 4)
        with self.assertRaises(troupe.InputError):
            sim.set_pose("scout", (0, 0, 0))
        fork = sim.copy()
        sim.step(20)
        fork.step(20)
        self.assertEqual(sim.state_hash, fork.state_hash)
        sim.restore(saved)
        self.assertEqual(sim.robots, ("anna", "ben"))
        self.assertEqual(sim.spawn("table", (-6, 0, 0)), "table")

    def test_readings_events_and_pictures_are_of_the_changed_state_at_once(self):
        sim = troupe.Simulation(OFFICE, run_controllers=False)
        far = sim.read("anna", "ranger").ranges.min()
        sim.set_pose("crate", (-7, 0, 0))
        self.assertLess(sim.read("anna", "ranger").ranges.min(), min(far, 0.8))
        self.assertEqual(sim.find_pose("crate"), troupe.Pose(-7.0, 0.0, 0.0, 0.0))
        self.assertEqual(sim.find_pose("anna").x, -8.0)

    def test_refuses_what_the_tools_refuse_and_changes_nothing(self):
        sim = troupe.Simulation(OFFICE)
        before = sim.state_hash
        for error, text, change in (
                (troupe.InputError, "accepts no goals", lambda: sim.send_to("ben", (0, 0))),
                (troupe.InputError, "cannot reach the goal", lambda: sim.send_to("anna", (-100, 0))),
                (ValueError, "goal: expected a point", lambda: sim.send_to("anna", (1, 2, 3, 4))),
                (ValueError, "found robot 'carl'", lambda: sim.send_to("carl", (0, 0))),
                (troupe.Error, "would be inside", lambda: sim.set_pose("anna", (4, 0, 0))),
                (troupe.InputError, "carl", lambda: sim.set_pose("carl", (0, 0, 0))),
                (ValueError, "pose: expected", lambda: sim.set_pose("anna", (0, 0))),
                (troupe.InputError, "nan|finite", lambda: sim.set_pose("anna", (math.nan, 0, 0))),
                (troupe.Error, "anna", lambda: sim.spawn("scout", (0, -0.4, 0), "anna")),
                (troupe.InputError, "scuot", lambda: sim.spawn("scuot", (0, 0, 0))),
                (troupe.InputError, "no robot", lambda: sim.spawn("table", (0, 0, 0), controller="wander")),
                (troupe.InputError, "wanders", lambda: sim.spawn("scout", (0, -0.4, 0), controller="wanders")),
                (ValueError, "without a controller", lambda: sim.spawn("scout", (0, 0, 0), parameters={"speed": 1})),
                (troupe.InputError, "carl", lambda: sim.delete("carl")),
                (ValueError, "doors: found 'front'", lambda: sim.set_door("front")),
                (IndexError, "lifts: found 3", lambda: sim.call_lift(3, "L1"))):
            with self.subTest(text), self.assertRaisesRegex(error, text):
                change()
        self.assertEqual(sim.state_hash, before)
        self.assertEqual(sim.robots, ("anna", "ben"))
        house = troupe.Simulation(HOUSE)
        with self.assertRaisesRegex(ValueError, "floor: the lift has no 'L9'"):
            house.call_lift("guest_lift", "L9")
        with self.assertRaises(troupe.InputError):
            house.set_door("lobby_door", 2.0)


if __name__ == "__main__":
    unittest.main()
