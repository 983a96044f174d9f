#!/usr/bin/env python3
"""The rate of Python against that of C++: robots with 12 rays that are driven by their ranges, in alternation.

usage: python_rate.py BUILD_FOLDER [--robots 1000] [--rounds 5]

Prints the medians of robot-steps in a second of processor time, which other programs on the machine disturb little, and
the rate of many worlds in real time, the time of a reset, and the memory of a further copy of an office with 100 robots.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time


def scenario(robots, folder):
    """An empty square with robots of one ranger with 12 rays."""
    side = max(4.0, (robots ** 0.5) * 1.2)
    world = os.path.join(folder, "field.world")
    with open(world, "w") as file:
        file.write(f"""interval_sim 100
define dot position ( size [ 0.2 0.2 0.2 ] drive "diff"
  ranger ( sensor ( fov 330 samples 12 range [ 0 5 ] ) ) )
model ( name "wall" pose [ 0 {side / 2 + 1} 0 0 ] size [ {side + 4} 0.2 1 ] )
""")
    path = os.path.join(folder, "field.json")
    with open(path, "w") as file:
        json.dump({"world": "field.world", "spawn": [{"model": "dot", "count": robots, "spacing": 0.4, "name_prefix": "r",
                   "heading": "random", "region": [-side / 2, -side / 2, side / 2, side / 2]}]}, file)
    return path


def python_rate(path, ticks):
    import numpy
    import troupe
    sim = troupe.Simulation(path)
    robots = len(sim.robots)
    ranges = sim.ranges()
    twists = numpy.zeros((robots, 2))
    begin = time.process_time()
    for _ in range(ticks):
        sim.ranges(out=ranges)
        free = ranges.min(axis=1) > 0.5
        twists[:, 0] = numpy.where(free, 0.4, 0.0)
        twists[:, 1] = numpy.where(free, 0.0, 0.8)
        sim.drive(twists)
        sim.step()
    return robots * ticks / (time.process_time() - begin), sim.state_hash


def cpp_rate(program, path, ticks):
    rate, digest = subprocess.run([program, path, str(ticks)], capture_output=True, text=True, check=True).stdout.split()
    return float(rate), int(digest, 16)


def copy_memory():
    import resource

    import troupe
    from troupe.rl.tasks import worlds_folder

    def used():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * resource.getpagesize()
    swarm = worlds_folder() / "scenarios/swarm.json"
    first = troupe.VectorSimulation(swarm, 2, seeds=[1, 1])
    first.step()
    before = used()
    more = troupe.VectorSimulation(swarm, 41, seeds=[1] * 41)
    more.step()
    return (used() - before) / 41


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("--robots", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    sys.path.insert(0, os.path.join(arguments.build, "python"))
    import numpy
    import troupe
    with tempfile.TemporaryDirectory() as folder:
        path = scenario(arguments.robots, folder)
        ticks = max(20, 300_000 // arguments.robots)
        rates = {"C++": [], "Python": []}
        for _ in range(arguments.rounds):
            cpp, expected = cpp_rate(os.path.join(arguments.build, "bin/python_rate"), path, ticks)
            own, found = python_rate(path, ticks)
            if found != expected:
                sys.exit(f"the state hashes differ: {found:016x}, expected {expected:016x}")
            rates["C++"].append(cpp)
            rates["Python"].append(own)
        for name, values in rates.items():
            print(f"{name}: {statistics.median(values):,.0f} robot-steps/s")
        print(f"ratio: {statistics.median(o / c for o, c in zip(rates['Python'], rates['C++'])):.3f}")

        path = scenario(16, folder)
        vector = troupe.VectorSimulation(path, 64)
        actions = numpy.random.default_rng(0).uniform(-0.5, 0.5, (64, 16, 2))
        ranges = vector.ranges()
        begin, used = time.perf_counter(), time.process_time()
        for _ in range(200):
            vector.drive(actions)
            vector.step()
            vector.ranges(out=ranges)
        steps = 64 * 16 * 200
        print(f"64 worlds with 16 robots: {steps / (time.perf_counter() - begin):,.0f} robot-steps/s on {vector.threads} "
              f"threads; {steps / (time.process_time() - used):,.0f} in a second of processor time")

        sim = troupe.Simulation(scenario(100, folder))
        saved = sim.save()
        times = []
        for _ in range(200):
            sim.step()
            begin = time.perf_counter()
            sim.restore(saved)
            times.append(time.perf_counter() - begin)
        print(f"reset of 100 robots: {statistics.median(times) * 1e6:.0f} us")
        print(f"a further copy of the office with 100 robots: {copy_memory() / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
