"""Formulas of tasks: C++ computes what numpy computes from the same arrays, and mistakes are errors that name them."""
import math
import unittest

import numpy

from troupe import _troupe, rl


class Yard(rl.Task):
    """Robots near each other in the office, with the formulas of a test."""

    far = 2.5
    corners = ((1.0, 2.0), (3.0, -4.0))
    text = "yard"

    def __init__(self, robots=4, **formulas):
        super().__init__(robots)
        self.of_test = formulas

    def scenario(self):
        scenario = super().scenario()
        scenario["spawn"][0].update(region=[-4, -3, 4, 3])
        return scenario

    def formulas(self):
        return rl.Formulas(**self.of_test)


def stepped(task, steps=6, worlds=3, threads=2, seed=3):
    """The environment, and the results of its last step."""
    env = rl.VectorEnv(task, worlds, threads=threads, autoreset="disabled")
    env.reset(seed=seed)
    generator = numpy.random.default_rng(0)
    for _ in range(steps):
        result = env.step(generator.uniform(-1, 1, env.action_space.shape))
    return env, result


class Values(unittest.TestCase):
    def test_expressions_of_one_robot(self):
        expressions = ["x + 2 * y - 1", "-x / (abs(y) + 1)", "sin(heading)", "cos(heading)", "atan2(y, x)", "hypot(x, y)",
                       "sqrt(abs(x))", "floor(x)", "wrap(3 * heading)", "min(x, y, 0.5)", "max(x, y)", "clip(x, -1, 1)",
                       "x < y", "x <= x", "x > y", "x >= y + 1", "x == x", "x != x", "-1 < x <= 1", "x < 0 and y < 0",
                       "x < 0 or y < 0", "not x < 0", "x if x > y else y", "vx + vy + wz", "stalled", "contact", "far",
                       "corners[1][0]", "True", "speed", "2 if stalled else 1"]
        env, result = stepped(Yard(observe=expressions))
        seen = env._episodes._seen
        x, y, heading = seen.poses[..., 0], seen.poses[..., 1], seen.poses[..., 3]
        turned = 3 * heading
        zero = numpy.zeros_like(x)
        expected = [x + 2 * y - 1, -x / (abs(y) + 1), numpy.sin(heading), numpy.cos(heading), numpy.arctan2(y, x),
                    numpy.hypot(x, y), numpy.sqrt(abs(x)), numpy.floor(x), turned - 2 * math.pi * numpy.round(turned / (2 * math.pi)),
                    numpy.minimum(numpy.minimum(x, y), 0.5), numpy.maximum(x, y), x.clip(-1, 1), x < y, zero + 1, x > y,
                    x >= y + 1, zero + 1, zero, (-1 < x) & (x <= 1), (x < 0) & (y < 0), (x < 0) | (y < 0), ~(x < 0),
                    numpy.maximum(x, y), seen.twists.sum(axis=-1), seen.stalls, seen.contacts, zero + 2.5, zero + 3, zero + 1,
                    numpy.hypot(seen.twists[..., 0], seen.twists[..., 1]), 1 + seen.stalls]
        found = result[0][..., -len(expressions):]
        for number, (expression, each) in enumerate(zip(expressions, expected)):
            numpy.testing.assert_allclose(found[..., number], each, atol=1e-5, err_msg=expression)

    def test_numbers_of_the_other_robots(self):
        near = "for other in others if hypot(other.x - x, other.y - y) < far"
        expressions = [f"sum(1 {near})", f"sum(other.x - x {near})", f"mean(other.heading {near})",
                       "min(hypot(other.x - x, other.y - y) for other in others)", "max(other.y for each in others)",
                       f"any(other.x > x {near})", f"all(other.x > x {near})", "any(1 for other in others if 0)",
                       "all(0 for other in others if 0)", "sum(vx for other in others)"]
        expressions[4] = "max(each.y for each in others)"
        env, result = stepped(Yard(5, observe=expressions))
        poses, twists = env._episodes._seen.poses, env._episodes._seen.twists
        found = result[0][..., -len(expressions):]
        for world, robot in numpy.ndindex(3, 5):
            x, y, _, _ = poses[world, robot]
            others = numpy.delete(poses[world], robot, axis=0)
            way = numpy.hypot(others[:, 0] - x, others[:, 1] - y)
            close = others[way < 2.5]
            expected = [len(close), (close[:, 0] - x).sum(), close[:, 3].mean() if len(close) else 0.0, way.min(),
                        others[:, 1].max(), (close[:, 0] > x).any(), (close[:, 0] > x).all(), 0, 1, 4 * twists[world, robot, 0]]
            numpy.testing.assert_allclose(found[world, robot], expected, atol=1e-5)

    def test_memory_changes_all_at_once_and_begins_anew(self):
        class Kept(Yard):
            def begin(self, which, starts, generators, seen):
                seen.memory["given"][which] = 7.0

        task = Kept(memory={"given": None, "a": "1", "b": "x"}, after={"a": "b", "b": "a + given"}, observe=["a", "b", "given"],
                    reward="a", ended="b > 15")
        env = rl.VectorEnv(task, 2, autoreset="disabled")
        first, _ = env.reset(seed=1)
        x = env._episodes._seen.poses[..., 0].copy()
        numpy.testing.assert_allclose(first[..., -3:], numpy.stack([x * 0 + 1, x, x * 0 + 7], axis=-1), rtol=1e-6)
        still = numpy.zeros(env.action_space.shape)
        observations, rewards, terminations, _, infos = env.step(still)
        numpy.testing.assert_allclose(rewards, 1.0)  # by the memory before the step
        numpy.testing.assert_allclose(observations[..., -3:-1], numpy.stack([x, x * 0 + 8], axis=-1), rtol=1e-6)
        env.step(still)
        terminations = env.step(still)[2]
        self.assertEqual(terminations.tolist(), [False, False])
        env.reset(options={"reset_mask": numpy.array([False, True])})
        memory = env._episodes._seen.memory
        self.assertTrue((memory["a"][1] == 1).all() and (memory["a"][0] == x[0] + 7).all())

    def test_cells_are_visited_once_in_the_order_of_robots(self):
        env, _ = stepped(Yard(memory={"first": "visit(x, y)"}, grid=(6, 4), reward="visit(x, y)",
                              observe=["visited(x, y)", "visited(1000, 1000)", "first"]), steps=1, worlds=2)
        visited = numpy.zeros((2, 6, 4), bool)
        env.reset(seed=2)
        generator = numpy.random.default_rng(1)

        def visit():
            fresh = numpy.zeros((2, 4))
            for world, robot in numpy.ndindex(2, 4):
                x, y = env._episodes._seen.poses[world, robot, :2]
                cell = world, int(numpy.clip(numpy.floor(x + 3), 0, 5)), int(numpy.clip(numpy.floor(y + 2), 0, 3))
                fresh[world, robot] = not visited[cell]
                visited[cell] = True
            return fresh

        numpy.testing.assert_array_equal(env._episodes._seen.memory["first"], visit())
        total = 0
        for _ in range(60):
            observations, _, _, _, infos = env.step(generator.uniform(0, 1, env.action_space.shape))
            fresh = visit()
            total += fresh.sum()
            numpy.testing.assert_array_equal(infos["robot_rewards"], fresh)
            self.assertTrue((observations[..., -3] == 1).all())
            numpy.testing.assert_array_equal(observations[..., -2], visited[:, 5, 3][:, None] * numpy.ones(4))
        self.assertGreater(total, 1)
        env.reset(seed=2)
        self.assertEqual(env._episodes._seen.memory["first"][:, 0].tolist(), [1, 1])  # forgotten

    def test_functions_of_numpy_give_the_same_as_formulas(self):
        class InNumpy(rl.Navigation):
            extra = 3

            def formulas(self):
                return rl.Formulas(memory={"goal_x": None, "goal_y": None})

            def begin(self, which, starts, generators, seen):
                super().begin(which, starts, generators, seen)
                if not hasattr(self, "left"):
                    self.left, self.arrived = numpy.zeros(seen.stalls.shape), numpy.zeros(seen.stalls.shape, bool)
                self.left[which] = self.way(seen)[0][which]
                self.arrived[which] = False

            def way(self, seen):
                to_x, to_y = seen.memory["goal_x"] - seen.poses[..., 0], seen.memory["goal_y"] - seen.poses[..., 1]
                return numpy.hypot(to_x, to_y), numpy.arctan2(to_y, to_x) - seen.poses[..., 3]

            def features(self, seen):
                distance, bearing = self.way(seen)
                return numpy.stack([numpy.minimum(distance / 10, 1), numpy.cos(bearing), numpy.sin(bearing)], axis=-1)

            def reward(self, seen):
                distance = self.way(seen)[0]
                now = (distance < self.tolerance) & ~self.arrived
                reward = numpy.where(self.arrived, 0.0, self.left - distance - 0.1 * seen.stalls) + 5.0 * now
                self.left, self.arrived = distance, self.arrived | now
                return reward

            def ended(self, seen):
                return self.arrived

        envs = [rl.VectorEnv(kind(3), 4, autoreset="same_step") for kind in (InNumpy, rl.Navigation)]
        seen = [env.reset(seed=5)[0] for env in envs]
        for _ in range(150):
            actions = envs[0].task.scripted(seen[0])
            results = [env.step(actions) for env in envs]
            seen = [result[0] for result in results]
            for mine, theirs in zip(results[0][:4], results[1][:4]):
                numpy.testing.assert_allclose(mine, theirs, atol=1e-5)
        self.assertEqual(envs[0].state_hashes.tolist(), envs[1].state_hashes.tolist())

    def test_bits_do_not_depend_on_the_threads(self):
        for kind in (rl.Navigation, rl.Flocking, rl.Foraging, rl.Carrying):
            bits = []
            for threads in (1, 2):
                env, result = stepped(kind(), steps=30, worlds=5, threads=threads)
                bits.append((result[0].tobytes(), result[4]["robot_rewards"].tobytes(), env.state_hashes.tolist()))
            self.assertEqual(*bits, kind)

    def test_an_idle_world_stays_as_it_is(self):
        env = rl.VectorEnv(rl.Navigation(), 3, autoreset="disabled")
        env.reset(seed=1)
        before = env.state_hashes
        env._episodes.step(numpy.ones(env.action_space.shape), idle=numpy.array([False, True, False]))
        self.assertEqual((env.state_hashes == before).tolist(), [False, True, False])
        self.assertEqual(env._episodes._seen.steps.tolist(), [1, 0, 1])


class Mistakes(unittest.TestCase):
    def test_mistakes_are_errors_that_name_them(self):
        for formulas, message in (
                ({"reward": "distance"}, "reward: found distance, expected a number of the task, or one of .*heading"),
                ({"reward": "1 +"}, "reward: 1 \\+: "),
                ({"observe": ["x", "text"]}, r"observe\[1\]: found text, expected a number of the task"),
                ({"ended": "f(x)"}, r"ended: found f\(x\), expected one of the functions abs, "),
                ({"ended": "sin(x, y)"}, r"ended: found sin\(x, y\), expected 1 numbers"),
                ({"ended": "x ** 2"}, r"ended: found x \*\* 2, expected numbers, names"),
                ({"ended": "'x'"}, "ended: found 'x', expected"),
                ({"ended": "x in y"}, "ended: found x in y, expected <"),
                ({"ended": "corners[7]"}, r"ended: found corners\[7\], expected a number of the task"),
                ({"ended": "other.x"}, "ended: found other.x, expected"),
                ({"ended": "sum(other.x for other in robots)"}, "ended: found sum.*expected sum, min"),
                ({"ended": "visit(x, y)"}, r"ended: found visit\(x, y\), expected a grid"),
                ({"define": {"a": "b", "b": "a"}, "reward": "a"}, "reward: found a in the definition of itself"),
                ({"after": {"a": "1"}}, "after: found a, expected a name of the memory"),
                ({"memory": {"x": "1"}}, "memory: found x, which is the name of something else"),
                ({"grid": (10**6, 10**6)}, "grid: found 1000000 x 1000000 cells")):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                rl.VectorEnv(Yard(**formulas), 1)

    def test_wrong_masks_and_actions_are_errors(self):
        env = rl.VectorEnv(rl.Navigation(), 2)
        env.reset(seed=1)
        for actions in (numpy.zeros((2, 4, 3)), numpy.zeros((4, 2)), None, "x"):
            with self.assertRaises((TypeError, ValueError)):
                env.step(actions)
        for which in (numpy.ones(3, bool), numpy.ones((2, 1), bool)):
            with self.assertRaises(ValueError):
                env._episodes._native.look(which)
        before = env.state_hashes.tolist()
        env.step(numpy.full((2, 4, 2), numpy.nan))  # stands still, as a policy that diverges
        self.assertNotEqual(env.state_hashes.tolist(), before)  # of the next tick

    def test_programs_that_would_write_elsewhere_are_refused(self):
        sim = _troupe.VectorSimulation(rl.Navigation().scenario(), 1)
        inputs = len(_troupe.FORMULA_INPUTS)
        add, own, total = (_troupe.FORMULA_OPS.index(name) for name in ("add", "own", "sum"))
        good = {"start": ([], []), "step": ([], [0, 0]), "observe": ([(add, inputs, 0, 1, 1)], [inputs]), "signals": [],
                "memory": 0, "pairs": [False] * (inputs + 1), "constants": [], "grid": (0, 0), "speed": 1.0, "turn_rate": 1.0,
                "reach": 1.0, "ticks": 1, "interval": 0.1, "lift": None, "fingers": None, "places": []}
        _troupe.Episodes(sim, "ranger", good)
        for changes in ({"observe": ([(add, inputs + 1, 0, 1, 1)], [])}, {"observe": ([(add, 0, 0, 1, 1)], [])},
                        {"observe": ([(add, inputs, 0, 999, 1)], [])}, {"observe": ([(own, inputs, 0, 1, 1)], [])},
                        {"observe": ([(total, inputs, 0, 1, 1)], [])}, {"observe": ([(200, inputs, 0, 1, 1)], [])},
                        {"observe": ([], [999])}, {"step": ([], [0])}, {"memory": 3}, {"memory": 10**6},
                        {"pairs": [False] * 3}, {"pairs": [True] * (inputs + 1)}, {"constants": [(999, 1.0)]},
                        {"signals": ["none"]}, {"lift": [(0, 0.0, 1.0, 1.0)], "fingers": []}):
            with self.subTest(changes), self.assertRaises((ValueError, IndexError)):
                _troupe.Episodes(sim, "ranger", {**good, **changes})


if __name__ == "__main__":
    unittest.main()
