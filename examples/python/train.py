"""Trains a small policy for a task of troupe.rl from nothing, by evolution strategies with numpy alone:

    python3 train.py [TASK] [--iterations 120] [--curve CURVE.csv] [--picture CURVE.png] [--save POLICY.npy] [--threads 0]

Each of 64 worlds runs another policy: 32 random directions in the space of the weights, forward and backward. All
worlds have the same episodes, so that the policies are compared on equal terms. The same iterations give the same weights,
bit for bit, with any number of threads; their digest is printed. Scores are of episodes at starts that no training has.
"""

import argparse
import hashlib
import time

import numpy

from troupe import rl

TASKS = ("Navigation", "Rooms", "Crowd", "Coverage", "Flocking", "Foraging", "Carrying", "Stacking")
PAIRS, STEPS, HIDDEN, SIGMA, RATE = 32, 120, 16, 0.1, 0.05


def act(weights: numpy.ndarray, seen: numpy.ndarray, actions: int = 2) -> numpy.ndarray:
    """Actions (worlds, robots, actions) of policies (worlds, weights), or of one for all."""
    size = seen.shape[-1]
    weights = numpy.broadcast_to(weights, (len(seen), weights.shape[-1]))
    first, bias, second, last = numpy.split(weights, numpy.cumsum([size * HIDDEN, HIDDEN, actions * HIDDEN]), axis=1)
    hidden = numpy.tanh(seen @ first.reshape(-1, size, HIDDEN) + bias[:, None])
    return numpy.tanh(hidden @ second.reshape(-1, HIDDEN, actions) + last[:, None])


def train(task: rl.Task, iterations: int, threads: int = 0, report=print):
    """The weights, and the rows (seconds, iteration, mean reward of an episode) of the curve."""
    task.max_steps = STEPS
    env = rl.VectorEnv(task, 2 * PAIRS, autoreset="disabled", threads=threads)
    generator = numpy.random.default_rng(0)
    size, actions = env.single_observation_space.shape[1], env.single_action_space.shape[1]
    weights = numpy.zeros(size * HIDDEN + HIDDEN + actions * HIDDEN + actions)
    weights[: size * HIDDEN] = generator.normal(0.0, 0.3, size * HIDDEN)
    mean, square = numpy.zeros_like(weights), numpy.zeros_like(weights)  # of the gradient, as Adam has them
    curve, begin = [], time.perf_counter()
    for iteration in range(1, iterations + 1):
        noise = generator.normal(size=(PAIRS, weights.size))
        policies = weights + SIGMA * numpy.concatenate([noise, -noise])
        seen, _ = env.reset(seed=[iteration] * (2 * PAIRS))
        scores, running = numpy.zeros(2 * PAIRS), numpy.ones(2 * PAIRS, bool)
        for _ in range(STEPS):
            seen, rewards, terminations, _, _ = env.step(act(policies, seen, actions))
            scores += rewards * running
            running &= ~terminations
            if not running.any():
                break
        ranks = scores.argsort(kind="stable").argsort() / (2 * PAIRS - 1) - 0.5  # the scale of the rewards does not matter
        gradient = (ranks[:PAIRS] - ranks[PAIRS:]) @ noise / PAIRS
        mean, square = 0.9 * mean + 0.1 * gradient, 0.99 * square + 0.01 * gradient**2
        step = mean / (1 - 0.9**iteration) / (numpy.sqrt(square / (1 - 0.99**iteration)) + 1e-8)
        weights = weights + RATE * step
        curve.append((time.perf_counter() - begin, iteration, scores.mean()))
        if iteration % 10 == 0:
            report(f"iteration {iteration}: mean reward {scores.mean():.2f} after {curve[-1][0]:.0f} s")
    return weights, curve


def draw(curve, picture: str) -> None:
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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("task", nargs="?", default="Navigation", choices=TASKS)
    parser.add_argument("--iterations", type=int, default=120)
    parser.add_argument("--curve")
    parser.add_argument("--picture")
    parser.add_argument("--save")
    parser.add_argument("--threads", type=int, default=0, help="0: one for each core")
    arguments = parser.parse_args()
    begin = time.process_time()
    weights, curve = train(getattr(rl, arguments.task)(), arguments.iterations, arguments.threads,
                           lambda line: print(line, flush=True))
    print(f"{time.process_time() - begin:.0f} s of processor time; "
          f"weights {hashlib.sha256(weights.tobytes()).hexdigest()[:16]}")
    task = getattr(rl, arguments.task)()
    actions = 4 if task.gripper else 2
    chance = numpy.random.default_rng(0)
    policies = {"learned": lambda seen: act(weights, seen, actions), "scripted": task.scripted,
                "random": lambda seen: chance.uniform(-1, 1, (*seen.shape[:2], actions))}
    scores = {name: rl.evaluate(task, policy, episodes=32, seed=1000, held_out=True) for name, policy in policies.items()}
    print("score of 32 new episodes:", ", ".join(f"{name} {score.mean():.2f}" for name, score in scores.items()))
    if arguments.curve:
        numpy.savetxt(arguments.curve, curve, fmt=["%.1f", "%d", "%.3f"], delimiter=",", header="s,iteration,reward", comments="")
    if arguments.save:
        numpy.save(arguments.save, weights)
    if arguments.picture:
        draw(curve, arguments.picture)


if __name__ == "__main__":
    main()
