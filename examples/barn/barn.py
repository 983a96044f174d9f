"""The static worlds of the BARN Challenge (Perille, Truong, Xiao, Stone, 2020: "Benchmarking Metric Ground Navigation").

    git clone --depth 1 https://github.com/Daffan/the-barn-challenge
    python3 barn.py the-barn-challenge                            # 50 worlds, 10 runs of each
    python3 barn.py the-barn-challenge --planner lidar --worlds 0 6 12 --csv runs.csv

Robot, start, goal, end and score are those of the challenge: a Jackal of 0.508 m x 0.43 m with at most 2 m/s and a lidar of
720 rays over 270 degrees, from (-2.25, 3) to within 1 m of (-2.25, 13), without a contact, in 100 s. Where Gazebo's runs
differ by its physics, these differ by the start, which each run shifts by up to 5 cm and 3 degrees.

Planners: "map" is the controller `go_to`, which knows the map; "scan" draws a map of its own from its ranges, and plans in that
(mapper.py); "lidar" knows its ranges and the direction of the goal alone.
"""

import argparse
import csv
import math
import pathlib
import random
import sys
import time
import xml.etree.ElementTree as xml

import numpy
import troupe
from troupe import rl

from mapper import Mapper

START, GOAL, LIMIT, TOP_SPEED = (-2.25, 3.0, 1.57), (-2.25, 13.0), 100.0, 2.0
RADIUS = 0.075  # m, of the cylinders
SIDES = 16
RAYS, FIELD = 720, math.radians(270)


def cylinders(file):
    """(n, 2): where the cylinders of a world stand. Poses of <state> win, as in Gazebo."""
    world = xml.parse(file).getroot().find("world")
    places = {}
    for models in (world.findall("model"), world.findall("state/model")):
        for model in models:
            name = model.get("name", "")
            if name.startswith("unit_cylinder") and model.find("pose") is not None:
                places[name] = [float(word) for word in model.find("pose").text.split()[:2]]
    if not places:
        raise ValueError(f"{file}: found no cylinders, expected a world of BARN")
    return numpy.array([places[name] for name in sorted(places)])


def path_length(file):
    """m, of the shortest way, as the challenge counts it."""
    cells = numpy.load(file)
    way = numpy.column_stack([cells[:, 0] * 2 * RADIUS - RADIUS - 60 * RADIUS, cells[:, 1] * 2 * RADIUS + RADIUS + 5])
    way = numpy.vstack([START[:2], way, GOAL])
    return float(numpy.hypot(*numpy.diff(way, axis=0).T).sum())


def world_of(places, planner):
    """A world without a robot's start."""
    world = troupe.World(name="barn", include=[])
    # Of the area of the circle.
    radius = RADIUS * math.sqrt(2 * math.pi / (SIDES * math.sin(2 * math.pi / SIDES)))
    corners = [(radius * math.cos(2 * math.pi * i / SIDES), radius * math.sin(2 * math.pi * i / SIDES)) for i in range(SIDES)]
    for x, y in places:
        world.block([(x + dx, y + dy) for dx, dy in corners], color="gray50", name="cylinder")
    controller = "go_to" if planner == "map" else "idle"
    parameters = {"speed": 0.9, "turn_rate": 1.6} if planner == "map" else None
    scanner = troupe.lidar(10.0, FIELD, RAYS)
    scanner["pose"] = [-0.065, 0.0, 0.25, 0.0]
    return world.robot("jackal", (*START[:2], 0.0), "position", controller=controller, parameters=parameters,
                       size=[0.508, 0.43, 0.25], drive="diff", children=[scanner],
                       velocity_bounds=[-TOP_SPEED, TOP_SPEED, 0, 0, 0, 0, -230, 230],
                       acceleration_bounds=[-6, 6, 0, 0, 0, 0, -1400, 1400])


def started(world, run):
    """A copy with the robot at the start of a run."""
    chance = random.Random(run)
    copy = world.copy()
    copy.scenario["seed"] = run
    copy.scenario["robots"][0]["pose"] = [START[0] + chance.uniform(-0.05, 0.05), START[1] + chance.uniform(-0.05, 0.05),
                                          math.degrees(START[2] + chance.uniform(-0.05, 0.05))]
    return copy


def gap_motion(ranges, poses):
    """The planner "lidar": twists (runs, 2) from ranges (runs, rays) and poses.

    Of sixty directions it takes the one that is free far ahead and near to that of the goal. A direction is as free as the
    nearest point in a corridor of the robot's width along it.
    """
    bearings = numpy.linspace(-FIELD / 2, FIELD / 2, RAYS)
    directions = numpy.linspace(-1.9, 1.9, 61)
    offset = bearings[None, :] - directions[:, None]                       # (directions, rays)
    along, across = numpy.cos(offset), numpy.abs(numpy.sin(offset))
    ahead = along > 0.0
    free = numpy.empty((len(ranges), len(directions)))
    for i in range(len(directions)):
        in_way = ahead[i] & (across[i][None, :] * ranges < 0.30)
        free[:, i] = numpy.where(in_way, along[i][None, :] * ranges, 3.0).min(axis=1)
    free = numpy.minimum(free, 3.0)
    to_goal = numpy.arctan2(GOAL[1] - poses[:, 1], GOAL[0] - poses[:, 0]) - poses[:, 3]
    to_goal = (to_goal + math.pi) % (2 * math.pi) - math.pi
    value = free - 0.9 * numpy.abs(directions[None, :] - to_goal[:, None]) - 0.2 * numpy.abs(directions)[None, :]
    value[free < 0.5] -= 10.0
    best = value.argmax(axis=1)
    angle, clear = directions[best], free[numpy.arange(len(best)), best]
    nearest = ranges[:, 180:540].min(axis=1)                               # 67 degrees to both sides
    speed = numpy.clip(0.7 * (numpy.minimum(clear, nearest * 2.0) - 0.35), 0.0, 1.2) * numpy.clip(1.2 - numpy.abs(angle), 0.0, 1.0)
    turn = numpy.clip(2.5 * angle, -2.0, 2.0)
    stuck = clear < 0.5
    return numpy.column_stack([numpy.where(stuck, 0.0, speed), numpy.where(stuck, 1.2, turn)])


class Barn(rl.Task):
    """The challenge as a task of troupe.rl: each start is another world; those with held_out=True are the challenge's fifty for
    tests, 0, 6, ... 294, and the others are for training.

    Reward: metres of progress towards the goal, 10 at the goal, and -10 for a contact, both of which end the episode. Actions
    are (forward, turn) in [-1, 1], of 2 m/s and 2 rad/s, for 0.2 s each. Observations: the 720 ranges / 10 m, the motion,
    the contact, and distance / 10 m and bearing of the goal.
    """

    name = "barn"
    speed, turn_rate, reach = TOP_SPEED, 2.0, 10.0
    max_steps = 500  # 100 s
    goal = GOAL

    def __init__(self, checkout, numbers=range(300)):
        super().__init__(1)
        self.folder = pathlib.Path(checkout) / "jackal_helper/worlds/BARN"
        self.training = [number for number in numbers if number % 6 != 0]
        self.tests = [number for number in numbers if number % 6 == 0]

    def world(self, seed):
        numbers, first = (self.tests, rl.HELD_OUT) if seed >= rl.HELD_OUT else (self.training, 1)
        number = numbers[(seed - first) % len(numbers)]
        return started(world_of(cylinders(self.folder / f"world_{number}.world"), "lidar"), seed)

    def formulas(self):
        return rl.Formulas(
            memory={"left": "distance"},
            define={"distance": "hypot(goal[0] - x, goal[1] - y)", "bearing": "atan2(goal[1] - y, goal[0] - x) - heading"},
            observe=["distance / 10", "cos(bearing)", "sin(bearing)"],
            reward="left - distance + 10 * (distance <= 1) - 10 * stalled",
            ended="distance <= 1 or stalled",
            after={"left": "distance"})

    def scripted(self, observations):
        """gap_motion, from the observations."""
        ranges = observations[:, 0, :RAYS].astype(float) * self.reach
        distance, cos, sin = numpy.moveaxis(observations[:, 0, -3:].astype(float), -1, 0)
        bearing = numpy.arctan2(sin, cos)
        # Poses at the origin would see the goal elsewhere: such that it is where the observation says.
        poses = numpy.stack([GOAL[0] - 10 * distance * numpy.cos(bearing), GOAL[1] - 10 * distance * numpy.sin(bearing),
                             0 * bearing, 0 * bearing], axis=-1)
        return (gap_motion(ranges, poses) / [self.speed, self.turn_rate])[:, None]


def run(checkout, numbers, runs, planner, threads=0):
    """A row (world, success, collided, timeout, time, score) for each run, the state hashes, and the robot's ticks."""
    folder = pathlib.Path(checkout) / "jackal_helper/worlds/BARN"
    bases = [world_of(cylinders(folder / f"world_{number}.world"), planner) for number in numbers]
    vector = troupe.VectorSimulation([started(base, i) for base in bases for i in range(runs)],
                                     seeds=[i for _ in bases for i in range(runs)], threads=threads)
    count = vector.num_envs
    refused = numpy.zeros(count, bool)
    if planner == "map":
        for i in range(count):
            try:
                vector[i].send_to("jackal", GOAL)
            except troupe.InputError:
                refused[i] = True                                          # no way is wide enough for its radius
    interval = vector[0].interval
    times, collided = numpy.full(count, numpy.nan), numpy.zeros(count, bool)
    begin = numpy.full(count, numpy.nan)                                   # the clock starts with the motion
    running = ~refused
    at = vector.poses()[:, 0]
    origin = at.copy()
    motion = numpy.zeros((count, 1, 2))
    mappers = [Mapper(numpy.linspace(-FIELD / 2, FIELD / 2, RAYS), GOAL) for _ in range(count if planner == "scan" else 0)]
    ticks = 0
    while running.any() and ticks * interval < LIMIT + 5:
        if planner != "map":
            motion[:] = 0.0
            ranges = vector.ranges()[:, 0]
            if planner == "lidar":
                motion[running, 0] = gap_motion(ranges[running], at[running])
            for i in numpy.flatnonzero(running) if planner == "scan" else ():
                motion[i, 0] = mappers[i].motion(ranges[i], at[i])
            vector.drive(motion)
        vector.step()
        ticks += 1
        at = vector.poses()[:, 0]
        moved = numpy.hypot(*(at - origin)[:, :2].T) >= 0.1
        begin[running & moved & numpy.isnan(begin)] = ticks * interval
        collided |= running & (vector.stalls()[:, 0] > 0)
        arrived = running & ~collided & (numpy.hypot(at[:, 0] - GOAL[0], at[:, 1] - GOAL[1]) <= 1.0)
        times[arrived] = ticks * interval - begin[arrived]
        late = running & (ticks * interval - numpy.nan_to_num(begin) >= LIMIT)
        running &= ~(collided | arrived | late)
    rows = []
    for i, number in enumerate(numpy.repeat(numbers, runs)):
        best = path_length(folder / "path_files" / f"path_{number}.npy") / TOP_SPEED
        success = bool(numpy.isfinite(times[i]))
        taken = times[i] if success else LIMIT
        score = best / min(max(taken, 2 * best), 8 * best) if success else 0.0
        rows.append((int(number), int(success), int(collided[i]), int(not success and not collided[i]), round(float(taken), 2), score))
    return rows, vector.state_hashes, count * ticks


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkout", help="folder of the challenge's repository")
    parser.add_argument("--worlds", type=int, nargs="*", default=list(range(0, 300, 6)), help="numbers, by default 0, 6, ... 294")
    parser.add_argument("--runs", type=int, default=10, help="of each world (10)")
    parser.add_argument("--planner", choices=("map", "scan", "lidar"), default="map")
    parser.add_argument("--threads", type=int, default=0, help="0: one for each core")
    parser.add_argument("--csv", help="a file for the runs: world success collided timeout time score")
    options = parser.parse_args()
    start, processor = time.perf_counter(), time.process_time()
    try:
        rows, hashes, ticks = run(options.checkout, options.worlds, options.runs, options.planner, options.threads)
    except (OSError, ValueError, xml.ParseError) as error:
        sys.exit(f"error: {error}")
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            csv.writer(file, delimiter=" ").writerows(rows)
    success, collided, late, taken, score = (numpy.array(column, float) for column in list(zip(*rows))[1:])
    mean_time = taken[success > 0].mean() if success.any() else math.nan
    print(f"{len(rows)} runs in {len(options.worlds)} worlds, planner {options.planner}: success {success.mean():.3f}, "
          f"collided {collided.mean():.3f}, timeout {late.mean():.3f}, time {mean_time:.1f} s, score {score.mean():.4f}")
    print(f"{time.perf_counter() - start:.1f} s, {time.process_time() - processor:.1f} s of processor time for {ticks} robot-ticks; "
          f"hash of all runs {int(numpy.bitwise_xor.reduce(hashes * numpy.arange(1, len(hashes) + 1, dtype=numpy.uint64))):016x}")


if __name__ == "__main__":
    main()
