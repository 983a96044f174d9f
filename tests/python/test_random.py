"""Random calls, which must not crash the interpreter, and random actions, which must give equal hashes.

    python3 tests/python/test_random.py SECONDS [SEED]      makes random calls from three threads for so long, and counts them
"""
import collections
import os
import sys
import tempfile
import threading
import time
import unittest

import numpy

import troupe
from support import LAB, SCENARIOS, SWARM, run
from troupe import rl, testing

try:
    import hypothesis
    from hypothesis import strategies
except ImportError:
    hypothesis = None

STACKING = SCENARIOS / "stacking.json"
# Python's own, and troupe's: anything else is a defect.
EXPECTED = (TypeError, ValueError, IndexError, KeyError, AttributeError, RuntimeError, OverflowError, OSError, MemoryError,
            troupe.Error)
NAMES = {
    troupe.Simulation: ["step", "drive", "release", "read", "ranges", "held", "robot", "restore", "save", "copy", "picture",
                        "events", "poses", "stalls", "energy", "object_poses", "state_hash", "close_view", "__copy__",
                        "__repr__", "reports", "failures", "grippers", "__init__", "send_to", "cancel_goal", "set_door",
                        "call_lift", "find_pose", "set_pose", "spawn", "delete", "map", "images", "depths"],
    troupe.State: ["read", "ranges", "held", "robot", "copy", "picture", "events", "poses", "twists", "state_hash", "tick",
                   "__init__", "__repr__"],
    troupe.VectorSimulation: ["step", "drive", "reset", "save", "poses", "twists", "stalls", "object_poses", "joint_positions",
                              "energy", "ranges", "held", "__getitem__", "__len__", "state_hashes", "ticks", "images",
                              "depths"],
    troupe.World: ["wall", "box", "block", "model", "map", "robot", "robots", "people", "place", "copy", "save", "__repr__",
                   "_repr_png_"],
    troupe.Recording: ["__getitem__", "at_tick", "position", "ticks", "__len__", "__iter__", "__reversed__", "damage"],
    testing.Monitor: ["push", "finish", "verdict", "robustness", "cause", "history", "formula"],
}


class Caller:
    """Makes random calls with random arguments. Values that calls return become arguments; a few are kept."""

    def __init__(self, seed, recording, shared=()):
        self.random = numpy.random.default_rng(seed)
        self.counts = collections.Counter()
        sims = [troupe.Simulation(LAB), troupe.Simulation(SWARM, run_controllers=False), troupe.Simulation(STACKING)]
        recorded = troupe.Recording(recording)
        self.objects = [*sims, troupe.VectorSimulation(STACKING, 3, threads=2), recorded, recorded[3], recorded[5:9],
                        testing.Monitor(sims[0], "forall r: always speed(r) < 0.35 m/s"), troupe.World(), *shared]
        self.values = [None, -1, 0, 1, 3, 2**64, -2**70, 1.5, float("nan"), float("inf"), "scout0", "ranger", "stacker", "png",
                       b"x", [], {}, (0, 0), (1, 2, 3), object(), slice(2, 9, 3), slice(None, None, -1), True,
                       numpy.zeros((100, 3)), numpy.zeros((100, 3), "f4")[::-1], numpy.array(7), numpy.zeros((3, 1, 2)),
                       numpy.full((3, 1, 2), numpy.nan), numpy.array([True, False, True]), troupe.Command(vx=1),
                       troupe.Command(grippers=[troupe.GripperCommand(lift=50.0)]), *self.objects,
                       sims[1].save(), sims[0].save(), sims[0].poses, str(LAB), "scout", "body_at_table", (1, 1, 0.5),
                       *(kind.__new__(kind) for kind in (troupe.Simulation, troupe.State, troupe.Snapshot, troupe.Recording,
                                                         troupe.VectorSimulation, testing.Monitor))]
        self.objects += self.values[-6:]
        self.kept = []

    def choose(self, items):
        return items[self.random.integers(len(items))]

    def call(self):
        subject = self.choose(self.objects)
        names = next((names for kind, names in NAMES.items() if isinstance(subject, kind)), ["tick"])
        name = self.choose(names)
        arguments = [self.choose(self.values + self.kept) for _ in range(self.random.integers(4))]
        if name == "step":
            arguments = [int(self.random.integers(4))] if arguments else []
        try:
            found = getattr(subject, name)
            if callable(found):
                found = found(*arguments)
            if isinstance(found, numpy.ndarray) and found.size:
                found.sum()
            self.counts["returned"] += 1
        except EXPECTED as error:
            self.counts[type(error).__name__] += 1
            return
        self.kept = [*self.kept, found][-20:]


def record(folder):
    file = os.path.join(folder, "run.mcap")
    run(LAB, "--in-process", "--ticks", 30, "--record", file)
    return file


class RandomCalls(unittest.TestCase):
    def test_they_never_crash(self):
        with tempfile.TemporaryDirectory() as folder:
            caller = Caller(5, record(folder))
            for _ in range(3000):
                caller.call()
        self.assertGreater(caller.counts["returned"], 300)
        self.assertGreater(caller.counts["TypeError"], 300)
        for sim in caller.objects[:3]:
            sim.step(2)


@unittest.skipUnless(hypothesis, "hypothesis is not installed")
class RandomActions(unittest.TestCase):
    """The same seed and actions give the same hashes: of a simulation, its copy, a copy restored, and a world of many."""

    def test_simulations(self):
        numbers = strategies.floats(-2, 2)
        percents = strategies.one_of(strategies.none(), strategies.floats(0, 100))
        action = strategies.one_of(
            strategies.tuples(strategies.just("step"), strategies.integers(1, 12)),
            strategies.tuples(strategies.just("drive"), numbers, numbers),
            strategies.tuples(strategies.just("grip"), percents, percents),
            strategies.tuples(strategies.just("release")), strategies.tuples(strategies.just("read")),
            strategies.tuples(strategies.just("turn back")),
            strategies.tuples(strategies.just("place"), numbers, numbers),
            strategies.tuples(strategies.just("spawn"), numbers, numbers), strategies.tuples(strategies.just("delete")))

        def attempt(change, *arguments, **options):
            try:
                change(*arguments, **options)
            except troupe.Error:
                pass  # something stands there, or it is there already or not yet

        def play(sim, actions, is_copied):
            found = []
            for name, *values in actions:
                if name == "step":
                    sim.step(*values)
                elif name == "drive":
                    sim.drive(values, 0)
                elif name == "grip":
                    sim.drive(troupe.Command(grippers=[troupe.GripperCommand(opening=values[0], lift=values[1])]), 0)
                elif name == "release":
                    sim.release()
                elif name == "read" and is_copied:  # which must change nothing
                    sim.picture()
                elif name == "place":
                    attempt(sim.set_pose, sim.robots[0], (*values, 0.5))
                elif name == "spawn":
                    attempt(sim.spawn, "position", (*values, 0.5), controller="wander")
                elif name == "delete":
                    attempt(sim.delete, "position")
                elif name == "turn back":
                    saved = sim.save()
                    if is_copied:
                        sim = sim.copy()
                    else:
                        sim.step(3)
                        sim.restore(saved)
                found.append(sim.state_hash)
            return found

        @hypothesis.settings(max_examples=25, deadline=None, derandomize=True, database=None)
        @hypothesis.given(strategies.integers(0, 2**64 - 1), strategies.lists(action, max_size=12))
        def check(seed, actions):
            first = play(troupe.Simulation(STACKING, seed=seed), actions, False)
            self.assertEqual(first, play(troupe.Simulation(STACKING, seed=seed), actions, True))

        check()

    def test_environments(self):
        @hypothesis.settings(max_examples=10, deadline=None, derandomize=True, database=None)
        @hypothesis.given(strategies.integers(0, 1000), strategies.sampled_from([rl.Navigation, rl.Carrying, rl.Stacking]),
                          strategies.lists(strategies.floats(-1, 1, width=32), min_size=4, max_size=24))
        def check(seed, kind, numbers):
            found = []
            for threads in (1, 2):
                env = rl.VectorEnv(kind(), 2, threads=threads, autoreset="same_step")
                env.reset(seed=seed)
                for step in range(12):
                    env.step(numpy.resize(numpy.roll(numbers, step), env.action_space.shape))
                found.append(env.state_hashes.tolist())
            self.assertEqual(*found)

        check()


def main(seconds, seed=0):
    end = time.monotonic() + seconds
    with tempfile.TemporaryDirectory() as folder:
        file = record(folder)
        first = Caller(seed, file)
        callers = [first, *(Caller(seed + i, file, first.objects[:5]) for i in (1, 2))]  # some objects are of all threads
        problems = []

        def work(caller):
            try:
                while time.monotonic() < end and not problems:
                    caller.call()
            except BaseException as error:
                problems.append(error)
                raise

        threads = [threading.Thread(target=work, args=(caller,)) for caller in callers]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        print(sum((caller.counts for caller in callers), collections.Counter()), flush=True)
    return 1 if problems else 0


if __name__ == "__main__":
    if sys.argv[1:2] and sys.argv[1].isdigit():
        sys.exit(main(float(sys.argv[1]), *map(int, sys.argv[2:3])))
    unittest.main()
