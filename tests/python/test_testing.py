"""Expectations in Python, and the plugin for pytest."""
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap
import threading
import unittest

import troupe
from support import LAB, PROGRAMS, ROOT, SWARM
from troupe import testing

SPEED = "forall r: always speed(r) < 0.35 m/s"


class Monitors(unittest.TestCase):
    def test_a_run_is_judged(self):
        run = testing.run(LAB, ["all_alive", "forall r: always not stalled(r)"], ticks=300,
                          metrics={"top": "max of speed(r)", "never": "time of first exists r: speed(r) > 100 m/s"})
        self.assertEqual([outcome.holds for outcome in run.outcomes], [True, False])
        self.assertFalse(run.passed)
        self.assertEqual(run.outcomes[0].formula, "forall r: always alive(r)")
        self.assertGreater(run.metrics["top"], 0.1)
        self.assertIsNone(run.metrics["never"])
        sim = troupe.Simulation(LAB)
        speeds = []
        stalled = None
        for _ in range(300):
            sim.step()
            speeds.append(abs(sim.twists[:, 0]).max())
            if stalled is None and sim.stalls.any():
                stalled = sim.tick
        self.assertEqual(run.state_hash, sim.state_hash)
        self.assertEqual(run.outcomes[1].decided_at, stalled)
        self.assertEqual((run.ticks, run.seed), (300, sim.seed))

    def test_monitors_follow_a_simulation_by_hand(self):
        sim = troupe.Simulation(SWARM, seed=4)
        monitor = testing.Monitor(sim, "eventually[0, 1 s] time > 0.5 s")
        self.assertIsNone(monitor.verdict)
        while monitor.verdict is None:
            monitor.push(sim)
            monitor.push(sim)  # the same tick counts once
            sim.step()
        self.assertTrue(monitor.verdict)
        self.assertEqual(monitor.decided_at, 6)
        monitor.finish()
        monitor.finish()
        self.assertEqual(*monitor.robustness)
        self.assertTrue(monitor.history)
        metric = testing.Metric(sim, "final of time")
        self.assertIsNone(metric.value)
        testing.watch(sim, 3, [metric])
        metric.finish()
        self.assertEqual((metric.value, metric.unit), (sim.time, "s"))

    def test_watch_stops(self):
        sim = troupe.Simulation(LAB)
        monitor = testing.Monitor(sim, "always time < 2 s")
        testing.watch(sim, 1000, [monitor], stop=True)
        self.assertEqual(monitor.decided_at, sim.tick)
        self.assertIs(monitor.verdict, False)

    def test_regions(self):
        corner = {"everywhere": [(-100, -100), (100, -100), (100, 100), (-100, 100)]}
        self.assertTrue(testing.run(SWARM, "within(everywhere)", ticks=10, regions=corner).passed)
        with self.assertRaises(troupe.InputError):
            testing.run(SWARM, "within(everywhere)", ticks=10)

    def test_a_failure_is_the_shortest_run(self):
        self.assertEqual(len(testing.check(SWARM, "all_alive", ticks=20, seeds=range(3))), 3)
        with self.assertRaises(AssertionError) as caught:
            testing.check(SWARM, "all_alive", SPEED, ticks=200, seeds=[5, 6])
        failure = caught.exception
        text = str(failure)
        self.assertIn("seeds=[5]", text)
        self.assertIn(SPEED, text)
        self.assertLess(failure.run.ticks, 200)
        self.assertRegex(text, r"decided by scout\d+ at tick \d+, robustness -0")
        again = re.search(r"again: (.*)", text)[1]
        with self.assertRaises(testing.Failure) as repeated:
            eval(again, {"troupe": troupe})
        self.assertEqual(repeated.exception.run, failure.run)
        shorter = testing.run(SWARM, SPEED, ticks=failure.run.ticks - 1, seed=5)
        self.assertTrue(shorter.passed)

    def test_wrong_arguments_are_errors(self):
        sim = troupe.Simulation(LAB)
        swarm = troupe.Simulation(SWARM)
        monitor = testing.Monitor(sim, "all_alive")
        with self.assertRaises(troupe.InputError) as caught:
            testing.Monitor(sim, "always x(nobody) < 1 m")
        self.assertEqual(caught.exception.column, 10)
        for call in (lambda: testing.Monitor(None, "all_alive"), lambda: testing.Monitor(sim, 5),
                     lambda: testing.Monitor(sim, "all_alive", {"a": [(0, 0)]}),
                     lambda: testing.Monitor(sim, "all_alive", {"a": [(0,)]}), lambda: monitor.finish(),
                     lambda: monitor.push(swarm), lambda: monitor.push(None), lambda: testing.watch(sim, -1, [monitor]),
                     lambda: testing.watch(sim, 1, [None]), lambda: testing.watch(sim, 1, [monitor, monitor]),
                     lambda: testing.watch(None, 1, []), lambda: testing.Monitor.__new__(testing.Monitor).push(sim),
                     lambda: testing.Metric.__new__(testing.Metric).value, lambda: testing.Monitor(sim, "")):
            with self.assertRaises((TypeError, ValueError, RuntimeError, troupe.Error)):
                call()
        monitor.push(sim)
        sim.step(2)
        with self.assertRaises(troupe.Error):
            monitor.push(sim)  # a tick is missing
        monitor.finish()
        with self.assertRaises(troupe.Error):
            monitor.push(sim)

    def test_a_monitor_is_for_one_thread(self):
        sims = [troupe.Simulation(SWARM) for _ in range(2)]
        monitor = testing.Monitor(sims[0], "all_alive")
        failures = []

        def work(sim):
            try:
                testing.watch(sim, 200, [monitor])
            except (RuntimeError, troupe.Error) as error:
                failures.append(error)

        workers = [threading.Thread(target=work, args=(sim,)) for sim in sims]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.assertTrue(failures)


@unittest.skipUnless(importlib.util.find_spec("pytest"), "pytest is not installed")
class Plugin(unittest.TestCase):
    def test_files_and_functions_are_tests(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, speed in (("good", "2 m/s"), ("bad", "0.01 m/s")):
                pathlib.Path(folder, f"{name}.test.json").write_text(
                    '{"scenario": "%s", "ticks": 20, "expect": [{"name": "slow", "that": '
                    '"forall r: always speed(r) < %s"}]}' % (LAB, speed))
            pathlib.Path(folder, "test_lab.py").write_text(textwrap.dedent(f"""
                from troupe.testing import check
                def test_lab():
                    check({str(LAB)!r}, "all_alive", ticks=20)
                """))
            done = subprocess.run([sys.executable, "-m", "pytest", "-p", "troupe.pytest_plugin", "-p", "no:cacheprovider",
                                   folder], cwd=folder, capture_output=True, text=True,
                                  env={**os.environ, "TROUPE": str(PROGRAMS / "troupe")})
            self.assertIn("1 failed, 2 passed", done.stdout, done.stderr)
            self.assertIn("smallest: troupe test", done.stdout)


if __name__ == "__main__":
    unittest.main()
