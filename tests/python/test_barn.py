"""The example of BARN, with a small world in the form of the challenge's files."""

import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

from support import ROOT

SCRIPT = ROOT / "examples/barn/barn.py"
MODEL = "<model name='unit_cylinder_{0}'><static>1</static>\\<pose frame=''>{1} {2} 0 0 0 0</pose></model>"


def load():
    sys.path.insert(0, str(SCRIPT.parent))  # of its planner
    spec = importlib.util.spec_from_file_location("barn", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Barn(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.checkout = pathlib.Path(folder.name)
        worlds = self.checkout / "jackal_helper/worlds/BARN"
        (worlds / "path_files").mkdir(parents=True)
        # A wall of cylinders with an opening of 1.3 m on the right, and one elsewhere that the state moves into the wall.
        places = [(-4.5 + 0.15 * i, 8.0) for i in range(30) if not -2.0 < -4.5 + 0.15 * i < -0.6]
        models = "".join(MODEL.format(i, *place) for i, place in enumerate([(50.0, 50.0), *places[1:]]))
        state = "".join(MODEL.format(i, *place) for i, place in enumerate(places))
        (worlds / "world_0.world").write_text(
            f"<sdf version='1.6'><world name='default'><model name='ground_plane'><pose>0 0 0 0 0 0</pose></model>{models}"
            f"<state world_name='default'>{state}</state></world></sdf>")
        numpy.save(worlds / "path_files/path_0.npy", numpy.array([(15, i) for i in range(50)]))
        self.places = places

    def test_runs_are_judged_and_repeat_on_any_number_of_threads(self):
        barn = load()
        found = barn.cylinders(self.checkout / "jackal_helper/worlds/BARN/world_0.world")
        self.assertEqual({(round(x, 3), y) for x, y in found}, {(round(x, 3), y) for x, y in self.places})
        for planner in ("map", "scan", "lidar"):
            rows, hashes, ticks = barn.run(self.checkout, [0], 3, planner, threads=1)
            again = barn.run(self.checkout, [0], 3, planner, threads=2)
            self.assertEqual(rows, again[0])
            numpy.testing.assert_array_equal(hashes, again[1])
            for number, success, collided, late, taken, score in rows:
                self.assertEqual((number, success, collided, late), (0, 1, 0, 0), planner)
                self.assertTrue(7.0 < taken < 40.0 and 0.1 < score <= 0.5, (taken, score))
            self.assertEqual(len(set(hashes.tolist())), 3)  # each run starts elsewhere

    def test_an_environment_rewards_the_way_to_the_goal(self):
        from troupe import rl
        worlds = self.checkout / "jackal_helper/worlds/BARN"
        (worlds / "world_1.world").write_text((worlds / "world_0.world").read_text().replace(" 8.0 0 0 0 0", " 9.0 0 0 0 0"))
        task = load().Barn(self.checkout, [0, 1])
        for held_out in (False, True):
            env = rl.VectorEnv(task, 2, held_out=held_out, autoreset="disabled")
            observations, _ = env.reset(seed=1)
            self.assertEqual(observations.shape, (2, 1, 720 + 6))
            rows = {round(pose, 3) for pose in observations[:, 0, -3]}
            self.assertTrue(all(0.9 < row < 1.1 for row in rows))
            walls = numpy.nonzero(env.simulations[0].map(0.05).occupied.sum(axis=1) > 40)[0]
            self.assertGreater(len(walls), 0)
        scores = rl.evaluate(task, task.scripted, episodes=3, seed=1, held_out=True)
        self.assertTrue((scores > 18.0).all(), scores)  # nine metres, and the goal
        straight = rl.evaluate(task, lambda seen: numpy.ones((*seen.shape[:2], 2)) * [1, 0], episodes=3, seed=1, held_out=True)
        self.assertTrue((straight < 0.0).all(), straight)  # into the wall

    def test_the_program_prints_a_row(self):
        done = subprocess.run([sys.executable, SCRIPT, self.checkout, "--worlds", "0", "--runs", "1", "--csv", self.checkout / "runs.csv"],
                              capture_output=True, text=True, timeout=100)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"1 runs in 1 worlds, planner map: success 1.000, collided 0.000")
        self.assertRegex((self.checkout / "runs.csv").read_text(), r"^0 1 0 0 \d+\.\d+ 0\.\d+")
        done = subprocess.run([sys.executable, SCRIPT, self.checkout, "--worlds", "7"], capture_output=True, text=True, timeout=100)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^error: .*world_7.world")


if __name__ == "__main__":
    unittest.main()
