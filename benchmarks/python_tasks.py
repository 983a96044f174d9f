#!/usr/bin/env python3
"""The cost of a step of the environments of troupe.rl, of driving and stepping the same worlds, and of VMAS, if it is there.

usage: PYTHONPATH=build/release/python[:GYM:VMAS] python_tasks.py [--tasks Navigation,...] [--vmas navigation,...] [--seconds 1]

VMAS is the simulator of github.com/proroklab/VectorizedMultiAgentSimulator, on torch, here with one thread; its sources and
those of a gym are enough. Each row is a number of worlds and of robots in each; microseconds of processor time for a robot
and a step, on one thread: the least of three rounds, which take turns.
"""
import argparse
import time

import numpy

SIZES = ((1, 1000), (32, 4), (64, 16), (1024, 4), (1024, 1))


def troupe_steps(name, worlds, robots):
    """(step of the environment, drive and step of its worlds): functions."""
    from troupe import rl
    env = rl.VectorEnv(getattr(rl, name)(robots=robots), worlds, autoreset="same_step", threads=1)
    env.reset(seed=1)
    generator = numpy.random.default_rng(0)
    actions = generator.uniform(-1, 1, env.action_space.shape).astype(numpy.float32)
    alone = rl.VectorEnv(getattr(rl, name)(robots=robots), worlds, threads=1)
    alone.reset(seed=1)
    vector, ticks = alone.simulations, alone.task.ticks_per_step
    motion = actions[..., :2].astype(float)

    def drive_and_step():
        vector.drive(motion)
        vector.step(ticks)

    return lambda: env.step(actions), drive_and_step


def vmas_step(name, worlds, robots):
    import torch
    from vmas import make_env
    torch.set_num_threads(1)
    env = make_env(name, num_envs=worlds, n_agents=robots, device="cpu", continuous_actions=True, seed=0)
    env.reset()
    actions = [torch.rand(worlds, env.get_agent_action_size(agent)) * 2 - 1 for agent in env.agents]
    return lambda: env.step(actions)


def measure(functions, steps_of_robots, seconds):
    """The least of three rounds for each function, us."""
    counts = []
    for function in functions:
        begin = time.process_time()
        function()
        counts.append(max(1, int(seconds / 3 / max(time.process_time() - begin, 1e-6))))
    least = [float("inf")] * len(functions)
    for _ in range(3):
        for i, function in enumerate(functions):
            begin = time.process_time()
            for _ in range(counts[i]):
                function()
            least[i] = min(least[i], (time.process_time() - begin) / counts[i] / steps_of_robots * 1e6)
    return least


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", default="Navigation,Coverage,Flocking,Foraging,Carrying")
    parser.add_argument("--vmas", default="navigation,flocking,discovery")
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--sizes", default=",".join(f"{worlds}x{robots}" for worlds, robots in SIZES))
    arguments = parser.parse_args()
    try:
        import vmas  # noqa: F401
    except ImportError as problem:
        print(f"without VMAS: {problem}")
        arguments.vmas = ""
    for size in arguments.sizes.split(","):
        worlds, robots = map(int, size.split("x"))
        for name in filter(None, arguments.tasks.split(",")):
            try:
                functions = troupe_steps(name, worlds, robots)
            except Exception as problem:  # no room for so many robots
                print(f"{size:>8} {name:>11}: {str(problem)[:90]}")
                continue
            step, base = measure(functions, worlds * robots, arguments.seconds)
            print(f"{size:>8} {name:>11}: rl {step:7.2f} us, drive and step {base:7.2f} us, ratio {step / base:.2f}", flush=True)
        for name in filter(None, arguments.vmas.split(",")):
            step, = measure([vmas_step(name, worlds, robots)], worlds * robots, arguments.seconds)
            print(f"{size:>8} VMAS {name:>9}: {step:7.2f} us", flush=True)


if __name__ == "__main__":
    main()
