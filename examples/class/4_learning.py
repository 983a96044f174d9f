# %% [markdown]
# # 4. Learning
# A policy learns to drive to goals: a linear function of what the robot sees, found by the cross-entropy method with numpy alone.
# Each of 32 worlds tries another policy at the same time.

# %%
import numpy
from troupe import rl

task = rl.Navigation(robots=2)
task.max_steps = 100
WORLDS, BEST, ITERATIONS = 32, 8, 12
env = rl.VectorEnv(task, WORLDS, autoreset="disabled")
size = env.single_observation_space.shape[1]
print("an observation has", size, "numbers; an action has", env.single_action_space.shape[1])

# %%
def act(weights, observations):
    """Actions (worlds, robots, 2) of policies (worlds, size * 2 + 2)."""
    matrix = weights[:, : 2 * size].reshape(-1, size, 2)
    return numpy.tanh(observations @ matrix + weights[:, None, 2 * size:])


def scores_of(weights, seed):
    observations, _ = env.reset(seed=[seed] * len(weights))    # all policies have the same episode
    scores = numpy.zeros(len(weights))
    for _ in range(task.max_steps):
        observations, rewards, _, _, _ = env.step(act(weights, observations))
        scores += rewards
    return scores


# %% [markdown]
# The cross-entropy method: draw policies around a mean, keep the best, and draw again around these.

# %%
random = numpy.random.default_rng(0)
mean, deviation = numpy.zeros(2 * size + 2), numpy.full(2 * size + 2, 0.7)
curve = []
for iteration in range(ITERATIONS):
    weights = random.normal(mean, deviation, (WORLDS, len(mean)))
    # Several episodes: one alone could be won by luck.
    scores = numpy.mean([scores_of(weights, 10 * iteration + episode) for episode in range(3)], axis=0)
    best = weights[numpy.argsort(scores)[-BEST:]]
    mean, deviation = best.mean(axis=0), best.std(axis=0) + 0.05
    curve.append(scores.mean())
    print(f"{iteration:2}: mean {scores.mean():6.2f}, best {scores.max():6.2f}")

# %%
learned = rl.evaluate(task, lambda seen: act(numpy.tile(mean, (len(seen), 1)), seen), episodes=16, seed=1000)
scripted = rl.evaluate(task, task.scripted, episodes=16, seed=1000)
still = rl.evaluate(task, lambda seen: numpy.zeros((*seen.shape[:2], 2)), episodes=16, seed=1000)
print(f"learned {learned.mean():.2f}, scripted {scripted.mean():.2f}, standing still {still.mean():.2f}")
assert learned.mean() > still.mean()

# %% [markdown]
# **A video** of one episode: frames as arrays, `env.render()` of an environment with one robot.

# %%
single = rl.RobotEnv(rl.Navigation(robots=1), render_mode="rgb_array")
observation, _ = single.reset(seed=5)
frames = [single.render()]
for _ in range(5):
    observation, reward, ended, truncated, _ = single.step(act(mean[None], observation[None, None])[0, 0])
    frames.append(single.render())
print(len(frames), frames[0].shape)

# %% [markdown]
# **Exercises.** 1. Which numbers of an observation have the largest weights? 2. Add a hidden layer. 3. Train with
# Stable-Baselines3 (docs/python.md), and compare the number of steps.
