"""The environments by the rules of PettingZoo's parallel_api_test and of Gymnasium's vector environments, whose own tests
run where the packages are installed."""
import importlib.util
import pickle
import unittest

import numpy

from troupe import rl

TASKS = (rl.Navigation, rl.Rooms, rl.Crowd, rl.Coverage, rl.Flocking, rl.Foraging, rl.Carrying, rl.Stacking)
# What the mean of rl.evaluate(task(), task.scripted, episodes=8, seed=0) exceeds; docs/learning.md has the scores.
REFERENCE = {rl.Navigation: 3.5, rl.Rooms: 2.0, rl.Crowd: 2.0, rl.Coverage: 17.0, rl.Flocking: 80.0, rl.Foraging: 4.0,
             rl.Carrying: 9.0, rl.Stacking: 14.0}


class Short(rl.Navigation):
    max_steps = 5


class Parallel(unittest.TestCase):
    def test_the_conventions(self):
        for kind in TASKS:
            env = rl.ParallelEnv(kind())
            self.assertEqual(env.unwrapped, env)
            observations, infos = env.reset(seed=3)
            self.assertEqual(env.agents, env.possible_agents)
            self.assertEqual(env.num_agents, env.max_num_agents)
            self.assertEqual(set(observations), set(env.agents))
            self.assertEqual(set(infos), set(env.agents))
            self.assertEqual(len(set(map(id, observations.values()))), len(env.agents))
            for agent in env.agents:
                self.assertIs(env.observation_space(agent), env.observation_space(agent))
                self.assertIs(env.action_space(agent), env.action_space(agent))
            ended = set()
            for _ in range(60):
                actions = {agent: env.action_space(agent).sample() for agent in env.agents}
                before = set(env.agents)
                results = env.step(actions)
                for part in results:
                    self.assertEqual(set(part), before)
                observations, rewards, terminations, truncations, _ = results
                for agent in before:
                    self.assertTrue(env.observation_space(agent).contains(observations[agent]), kind)
                    self.assertIsInstance(rewards[agent], float)
                    if terminations[agent] or truncations[agent]:
                        ended.add(agent)
                self.assertEqual(set(env.agents), before - ended)
                self.assertFalse(ended & set(env.agents))
            self.assertEqual(env.state().dtype, numpy.float32)
            env.close()

    def test_truncation_empties_the_agents(self):
        env = rl.ParallelEnv(Short())
        env.reset(seed=0)
        for _ in range(5):
            self.assertTrue(env.agents)
            _, _, terminations, truncations, _ = env.step({})
        self.assertEqual(env.agents, [])
        self.assertTrue(all(truncations.values()))
        env.reset()
        self.assertEqual(len(env.agents), 4)

    def test_the_same_seed_gives_the_same_episodes(self):
        hashes = []
        for _ in range(2):
            env = rl.ParallelEnv(rl.Navigation())
            generator = numpy.random.default_rng(5)
            found = []
            for episode in range(2):
                env.reset(seed=8 if episode == 0 else None)
                for _ in range(20):
                    result = env.step({agent: generator.uniform(-1, 1, 2) for agent in env.agents})
                    found.append((env.state_hash, tuple(result[1].items())))
            hashes.append(found)
        self.assertEqual(*hashes)
        env.reset(seed=9)
        self.assertNotEqual(env.state_hash, hashes[0][0][0])

    def test_the_space_of_states(self):
        env = rl.ParallelEnv(rl.Navigation())
        env.reset(seed=1)
        self.assertTrue(env.state_space.contains(env.state()))

    def test_render(self):
        env = rl.ParallelEnv(rl.Navigation())
        env.reset(seed=0)
        self.assertTrue(env.render().startswith(b"\x89PNG"))

    def test_discrete_actions_are_motions(self):
        env, same = rl.ParallelEnv(rl.Navigation(2), discrete=True), rl.ParallelEnv(rl.Navigation(2))
        env.reset(seed=1)
        same.reset(seed=1)
        names = env.possible_agents
        self.assertEqual(env.action_space(names[0]).n, len(rl.DISCRETE))
        for i in range(1, 7):
            env.step({name: i for name in names})
            same.step({name: rl.DISCRETE[i] for name in names})
            self.assertEqual(env.state_hash, same.state_hash)
        self.assertEqual(pickle.loads(pickle.dumps(env)).discrete, True)
        with self.assertRaises(ValueError):
            rl.ParallelEnv(rl.Carrying(), discrete=True)

    @unittest.skipUnless(importlib.util.find_spec("gymnasium"), "gymnasium is not installed")
    def test_an_environment_of_tuples(self):
        from troupe.rl.adapters import TeamEnv
        env = TeamEnv(Short(3))
        observations, infos = env.reset(seed=4)
        self.assertEqual((len(observations), env.n_agents, infos), (3, 3, {}))
        same = rl.ParallelEnv(Short(3), discrete=True)
        same.reset(seed=4)
        for step in range(5):
            self.assertTrue(env.observation_space.contains(observations))
            observations, rewards, terminated, truncated, infos = env.step((1, 2, 3))
            _, expected, _, _, _ = same.step(dict(zip(same.possible_agents, (1, 2, 3))))
            self.assertEqual((rewards, env.state_hash), (list(expected.values()), same.state_hash))
            self.assertEqual((terminated, truncated, infos["robot_ended"].tolist()), (False, step == 4, [False] * 3))
        with self.assertRaises(ValueError):
            env.step((1, 2))

    @unittest.skipUnless(importlib.util.find_spec("pettingzoo"), "pettingzoo is not installed")
    def test_pettingzoo(self):
        from pettingzoo.test import parallel_api_test, parallel_seed_test
        for kind in TASKS:
            parallel_api_test(rl.ParallelEnv(kind()), num_cycles=200)
        parallel_seed_test(lambda: rl.ParallelEnv(rl.Navigation()))


class Single(unittest.TestCase):
    def test_the_conventions(self):
        for kind in TASKS:
            env = rl.RobotEnv(kind(robots=1) if kind is not rl.Stacking else kind())
            observation, info = env.reset(seed=5)
            self.assertTrue(env.observation_space.contains(observation))
            self.assertEqual(info, {})
            first = env.state_hash
            for _ in range(3):
                observation, reward, ended, truncated, info = env.step(env.action_space.sample())
                self.assertTrue(env.observation_space.contains(observation))
                self.assertEqual((type(reward), type(ended), type(truncated), info), (float, bool, bool, {}))
            env.reset(seed=5)
            self.assertEqual(env.state_hash, first)
        with self.assertRaisesRegex(ValueError, "found 4 robots, expected 1"):
            rl.RobotEnv(rl.Navigation())

    def test_discrete_actions_are_motions(self):
        env, same = rl.RobotEnv(rl.Navigation(robots=1), discrete=True), rl.RobotEnv(rl.Navigation(robots=1))
        self.assertEqual(env.action_space.n, len(rl.DISCRETE))
        env.reset(seed=1)
        same.reset(seed=1)
        for i in (1, 2, 3, 4, 5, 6, 0):
            numpy.testing.assert_array_equal(env.step(i)[0], same.step(rl.DISCRETE[i])[0])
        with self.assertRaises(ValueError):
            rl.RobotEnv(rl.Stacking(), discrete=True)

    def test_a_pickled_environment_begins_anew(self):
        for env in (rl.RobotEnv(rl.Navigation(robots=1), discrete=True), rl.ParallelEnv(rl.Navigation()),
                    rl.VectorEnv(Short(), 2, autoreset="same_step")):
            env.reset(seed=1)
            other = pickle.loads(pickle.dumps(env))
            self.assertEqual(type(other), type(env))
            observations, _ = other.reset(seed=1)
            again, _ = env.reset(seed=1)
            if isinstance(env, rl.ParallelEnv):
                observations, again = numpy.stack(list(observations.values())), numpy.stack(list(again.values()))
            numpy.testing.assert_array_equal(observations, again)

    def test_frames_for_videos(self):
        env = rl.RobotEnv(rl.Navigation(robots=1), render_mode="rgb_array")
        env.reset(seed=0)
        frame = env.render()
        self.assertEqual((frame.ndim, frame.shape[2], frame.dtype), (3, 3, numpy.uint8))
        picture = env.simulation.picture()
        self.assertEqual(picture.array().shape[:2], frame.shape[:2])
        with self.assertRaises(ValueError):
            env.simulation.picture(format="svg").array()

    @unittest.skipUnless(importlib.util.find_spec("gymnasium"), "gymnasium is not installed")
    def test_gymnasium(self):
        from gymnasium.utils.env_checker import check_env
        for kind in TASKS:
            check_env(rl.RobotEnv(kind(robots=1) if kind is not rl.Stacking else kind(), render_mode="rgb_array"),
                      skip_render_check=True)
        check_env(rl.RobotEnv(rl.Navigation(robots=1), discrete=True), skip_render_check=True)

    @unittest.skipUnless(importlib.util.find_spec("stable_baselines3"), "stable_baselines3 is not installed")
    def test_stable_baselines(self):
        from stable_baselines3 import PPO
        from stable_baselines3.common.env_checker import check_env
        for kind in TASKS:
            check_env(rl.RobotEnv(kind(robots=1) if kind is not rl.Stacking else kind(), render_mode="rgb_array"))
        for discrete in (False, True):
            env = rl.RobotEnv(rl.Navigation(robots=1), discrete=discrete)
            check_env(env)
            PPO("MlpPolicy", env, n_steps=64, batch_size=32, n_epochs=1, device="cpu").learn(128)


class Vector(unittest.TestCase):
    def test_shapes(self):
        for kind in TASKS:
            env = rl.VectorEnv(kind(), 3, threads=2)
            observations, infos = env.reset(seed=1)
            self.assertEqual(observations.shape, env.observation_space.shape)
            self.assertEqual(observations.dtype, numpy.float32)
            self.assertEqual(env.observation_space.shape[1:], env.single_observation_space.shape)
            self.assertEqual(infos, {})
            observations, rewards, terminations, truncations, infos = env.step(env.action_space.sample())
            robots = env.single_action_space.shape[0]
            self.assertEqual((infos["robot_rewards"].shape, infos["robot_ended"].shape), ((3, robots), (3, robots)))
            numpy.testing.assert_allclose(infos["robot_rewards"].mean(axis=1), rewards)
            self.assertTrue(env.observation_space.contains(observations))
            self.assertEqual((rewards.shape, terminations.shape, truncations.shape), ((3,), (3,), (3,)))
            self.assertEqual((rewards.dtype, terminations.dtype, truncations.dtype), (float, bool, bool))

    def test_autoreset(self):
        still = numpy.zeros((2, 4, 2))
        seen = {}
        for mode in ("next_step", "same_step", "disabled"):
            env = rl.VectorEnv(Short(), 2, autoreset=mode)
            env.reset(seed=4)
            seen[mode] = [env.step(still) + (env.simulations.ticks.tolist(),) for _ in range(7)]
            self.assertEqual([step[3].all() for step in seen[mode][:5]], [False] * 4 + [True])
        last, after = seen["next_step"][4], seen["next_step"][5]
        self.assertEqual(last[5], [10, 10])  # the final observation itself
        self.assertEqual((after[1].tolist(), after[2].any(), after[3].any(), after[5]), ([0, 0], False, False, [0, 0]))
        last = seen["same_step"][4]
        self.assertEqual(last[5], [0, 0])
        self.assertEqual(last[4]["_final_obs"].tolist(), [True, True])
        self.assertTrue((last[4]["final_obs"][0] == seen["next_step"][4][0][0]).all())
        self.assertTrue((last[0] == seen["next_step"][5][0]).all())
        self.assertEqual(seen["same_step"][5][5], [2, 2])
        self.assertEqual(seen["disabled"][6][5], [14, 14])
        env.reset(options={"reset_mask": numpy.array([False, True])})
        self.assertEqual(env.simulations.ticks.tolist(), [14, 0])
        self.assertEqual(seen["same_step"][4][4]["_final_info"].tolist(), [True, True])
        for wrong in ([True], [1, 0]):
            with self.assertRaises(ValueError):
                env.reset(options={"reset_mask": wrong})
        with self.assertRaises(ValueError):
            rl.VectorEnv(Short(), 1, autoreset="never")

    def test_an_evaluation_between_two_steps_changes_nothing(self):
        for kind in TASKS:
            task = kind()
            train, alone = (rl.VectorEnv(each, 4, autoreset="disabled") for each in (task, kind()))
            still = numpy.zeros(train.action_space.shape)
            train.reset(seed=1)
            alone.reset(seed=1)
            for episodes in (4, 2):
                rl.ParallelEnv(task).reset(seed=3)
                rl.VectorEnv(task, episodes).reset(seed=2)
                for one, other in zip(train.step(still)[:4], alone.step(still)[:4]):
                    self.assertTrue((one == other).all(), kind)

    def test_seeds_may_be_numbers_of_numpy_and_are_those_of_the_mask(self):
        env = rl.VectorEnv(rl.Navigation(), 2, autoreset="disabled")
        both = env.reset(seed=[5, 6])[0]
        for seeds in (numpy.array([5, 6]), (5, 6), numpy.int64(5), 5):
            self.assertTrue((env.reset(seed=seeds)[0] == both).all(), seeds)
        env.reset(seed=[1, 2])
        self.assertTrue((env.reset(seed=[5, 6], options={"reset_mask": numpy.array([False, True])})[0][1] == both[1]).all())
        again = env.reset(options={"reset_mask": numpy.array([True, False])})[0][0]
        env.reset(seed=[1, 2])
        self.assertTrue((env.reset()[0][0] == again).all())  # the other world's generator was not touched
        env.reset(seed=[None, 3])
        for wrong, kind in ((1.5, TypeError), (-1, ValueError), ([1], ValueError), ([1, -2], ValueError)):
            with self.assertRaises(kind):
                env.reset(seed=wrong)

    def test_held_out_starts_are_others(self):
        for kind in (rl.Navigation, rl.Rooms):
            poses = {}
            for held_out in (False, True):
                env = rl.VectorEnv(kind(), 40, held_out=held_out)
                again = pickle.loads(pickle.dumps(env))
                self.assertEqual(env.reset(seed=1)[0].tolist(), again.reset(seed=1)[0].tolist())
                poses[held_out] = {tuple(world.ravel()) for world in env.simulations.poses()}
                self.assertGreater(len(poses[held_out]), 8)  # of sixteen
            self.assertFalse(poses[False] & poses[True])

    def test_each_start_of_rooms_has_walls_of_its_own(self):
        env = rl.VectorEnv(rl.Rooms(), 12)
        env.reset(seed=1)
        maps = {env.simulations[i].map(0.1).occupied.tobytes() for i in range(12)}
        self.assertGreater(len(maps), 4)
        before = env.state_hashes.tolist()
        actions = numpy.random.default_rng(0).uniform(-1, 1, (30, *env.action_space.shape))
        for action in actions:
            env.step(action)
        after = env.state_hashes.tolist()
        env.reset(seed=1)
        self.assertEqual(env.state_hashes.tolist(), before)
        for action in actions:
            env.step(action)
        self.assertEqual(env.state_hashes.tolist(), after)

    def test_people_walk_in_a_crowd(self):
        env = rl.ParallelEnv(rl.Crowd())
        env.reset(seed=1)
        before = env.simulation.table("people")["x"]
        self.assertEqual(len(before), rl.Crowd.people)
        for _ in range(20):
            env.step({})
        self.assertGreater(numpy.abs(env.simulation.table("people")["x"] - before).max(), 0.5)

    def test_hashes_do_not_depend_on_the_threads(self):
        found = []
        for threads in (1, 2):
            env = rl.VectorEnv(rl.Flocking(), 3, autoreset="same_step", threads=threads)
            env.reset(seed=2)
            generator = numpy.random.default_rng(0)
            for _ in range(20):
                env.step(generator.uniform(-1, 1, env.action_space.shape))
            found.append(env.state_hashes.tolist())
        self.assertEqual(*found)

    def test_scripted_policies_reach_their_scores(self):
        for kind, expected in REFERENCE.items():
            task = kind()
            scores = rl.evaluate(task, task.scripted, episodes=8, seed=0)
            print(kind.__name__, scores.mean(), scores.std())
            self.assertGreater(scores.mean(), expected, kind)
            task = kind()
            task.max_steps = 50
            idle = rl.evaluate(task, lambda seen: numpy.zeros((*seen.shape[:2], 4 if task.gripper else 2)), episodes=4, seed=0)
            self.assertLessEqual(idle.mean(), 0.0, kind)

    def test_grippers(self):
        """Each number of an action moves its part, and what is carried and put down is what the scores say."""
        env = rl.ParallelEnv(rl.Stacking())
        sim = env.simulation
        env.reset(seed=1)
        name, = env.agents
        self.assertEqual(env.action_space(name).shape, (4,))
        lift, left = (sim.joints.index(f"{name}.{sim.robot(name).joints[number].name}")
                      for number in (sim.robot(name).grippers[0].lift, sim.robot(name).grippers[0].left))

        def act(count, *action):
            for _ in range(count):
                env.step({name: numpy.array(action)})
            return sim.joint_positions[lift], sim.joint_positions[left]

        start = act(1, 0, 0, 0, 0)
        up = act(3, 0, 0, 0, 1)
        self.assertAlmostEqual(up[0] - start[0], 3 * 0.2 * 0.4, 2)  # steps of 0.2 s at 0.4 m/s
        self.assertEqual(up[1], start[1])
        closed = act(3, 0, 0, -1, 0)
        self.assertAlmostEqual(closed[0], up[0], 6)
        self.assertNotEqual(closed[1], up[1])
        half = act(2, 0, 0, 0, -0.5)
        self.assertAlmostEqual(closed[0] - half[0], 2 * 0.5 * 0.2 * 0.4, 2)
        self.assertAlmostEqual(act(5, 0, 0, 1, 0)[1], start[1], 6)

        observations, _ = env.reset(seed=2)
        total = 0.0
        while env.agents:
            observations, rewards, terminations, _, _ = env.step(
                {name: env.task.scripted(observations[name][None, None])[0, 0]})
            total += rewards[name]
        self.assertTrue(terminations[name])
        self.assertAlmostEqual(total, 3 * (1.0 + 4.0), 1)
        numpy.testing.assert_allclose(sorted(sim.object_poses[:, 2]), [0.0, 0.2, 0.4], atol=1e-3)
        self.assertLess(numpy.ptp(sim.object_poses[:, :2], axis=0).max(), 0.2)

    def test_seeds(self):
        env = rl.VectorEnv(rl.Navigation(), 3)
        first, _ = env.reset(seed=[5, 6, 5])
        self.assertTrue((first[0] == first[2]).all())
        self.assertFalse((first[0] == first[1]).all())
        again, _ = env.reset(seed=5)  # 5, 6, 7
        self.assertTrue((first[:2] == again[:2]).all())
        with self.assertRaises(ValueError):
            env.reset(seed=[1, 2])


if __name__ == "__main__":
    unittest.main()
