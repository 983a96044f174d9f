"""Trains a small policy for the navigation task from nothing, by evolution strategies with numpy alone:

    python3 train.py [ITERATIONS [CURVE.csv [CURVE.png]]]

Each of 64 worlds runs another policy: 32 random directions in the space of the weights, forward and backward. All
worlds have the same episodes, so that the policies are compared on equal terms.
"""

import sys
import time

import numpy

from troupe import rl

PAIRS, STEPS, HIDDEN, SIGMA, RATE = 32, 120, 16, 0.1, 0.05


def act(weights: numpy.ndarray, seen: numpy.ndarray) -> numpy.ndarray:
    """Actions (worlds, robots, 2) of policies (worlds, weights), or of one for all."""
    size = seen.shape[-1]
    weights = numpy.broadcast_to(weights, (len(seen), weights.shape[-1]))
    first, bias, second, last = numpy.split(weights, numpy.cumsum([size * HIDDEN, HIDDEN, 2 * HIDDEN]), axis=1)
    hidden = numpy.tanh(seen @ first.reshape(-1, size, HIDDEN) + bias[:, None])
    return numpy.tanh(hidden @ second.reshape(-1, HIDDEN, 2) + last[:, None])


def train(iterations: int, report=print):
    """The weights, and the rows (seconds, iteration, mean reward of an episode) of the curve."""
    task = rl.Navigation()
    task.max_steps = STEPS
    env = rl.VectorEnv(task, 2 * PAIRS, autoreset="disabled")
    generator = numpy.random.default_rng(0)
    size = env.single_observation_space.shape[1]
    weights = numpy.zeros(size * HIDDEN + HIDDEN + 2 * HIDDEN + 2)
    weights[: size * HIDDEN] = generator.normal(0.0, 0.3, size * HIDDEN)
    mean, square = numpy.zeros_like(weights), numpy.zeros_like(weights)  # of the gradient, as Adam has them
    curve, begin = [], time.perf_counter()
    for iteration in range(1, iterations + 1):
        noise = generator.normal(size=(PAIRS, weights.size))
        policies = weights + SIGMA * numpy.concatenate([noise, -noise])
        seen, _ = env.reset(seed=[iteration] * (2 * PAIRS))
        scores, running = numpy.zeros(2 * PAIRS), numpy.ones(2 * PAIRS, bool)
        for _ in range(STEPS):
            seen, rewards, terminations, _, _ = env.step(act(policies, seen))
            scores += rewards * running
            running &= ~terminations
        ranks = scores.argsort().argsort() / (2 * PAIRS - 1) - 0.5  # the scale of the rewards does not matter
        gradient = (ranks[:PAIRS] - ranks[PAIRS:]) @ noise / PAIRS
        mean, square = 0.9 * mean + 0.1 * gradient, 0.99 * square + 0.01 * gradient**2
        step = mean / (1 - 0.9**iteration) / (numpy.sqrt(square / (1 - 0.99**iteration)) + 1e-8)
        weights = weights + RATE * step
        curve.append((time.perf_counter() - begin, iteration, scores.mean()))
        if iteration % 10 == 0:
            report(f"iteration {iteration}: mean reward {scores.mean():.2f} after {curve[-1][0]:.0f} s")
    return weights, curve


def main(iterations: str = "120", table: str = "", picture: str = "") -> None:
    weights, curve = train(int(iterations), lambda line: print(line, flush=True))
    task = rl.Navigation()
    learned = rl.evaluate(task, lambda seen: act(weights, seen), episodes=32, seed=1000)
    scripted = rl.evaluate(task, task.scripted, episodes=32, seed=1000)
    print(f"score of 32 new episodes: learned {learned.mean():.2f}, scripted {scripted.mean():.2f}, standing still 0")
    if table:
        numpy.savetxt(table, curve, fmt=["%.1f", "%d", "%.3f"], delimiter=",", header="s,iteration,reward", comments="")
    if picture:
        try:
            from matplotlib import pyplot
        except ImportError:
            return print("no picture: matplotlib is not installed (python3-matplotlib)")
        times, _, rewards = numpy.array(curve).T
        pyplot.plot(times, rewards, linewidth=0.6, alpha=0.5, label="one iteration: other starts and goals")
        smooth = numpy.convolve(rewards, numpy.ones(15) / 15, "valid")
        pyplot.plot(times[len(times) - len(smooth):], smooth, label="mean of the last 15")
        pyplot.legend()
        pyplot.xlabel("time (s)")
        pyplot.ylabel("mean reward of an episode")
        pyplot.grid(alpha=0.3)
        pyplot.savefig(picture, dpi=120)


if __name__ == "__main__":
    main(*sys.argv[1:4])
