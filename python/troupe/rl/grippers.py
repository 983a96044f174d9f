"""Tasks of robots with grippers, which carry and stack cubes. Their actions are (forward, turn, fingers, lift)."""

from __future__ import annotations

import math
from typing import Tuple

import numpy

from .spaces import Array
from .tasks import Task, worlds_folder

REACH = 0.4  # m: a gripped cube is so far in front of the robot's origin
CUBE = 0.2  # m, its side
LEVEL = 0.25  # of the lift: the height of a cube
COLUMNS = ("holds", "opening", "lift", "goal_lift", "goal_distance", "goal_cos", "goal_sin", "way_cos", "way_sin",
           "cube_distance", "cube_cos", "cube_sin", "robot_distance", "robot_cos", "robot_sin")


def _polar(way: Array, heading: Array) -> Tuple[Array, Array, Array]:
    """Distance / 5 m, up to 1, cosine and sine of the bearing, of vectors in W seen at a heading."""
    bearing = numpy.arctan2(way[..., 1], way[..., 0]) - heading
    return numpy.minimum(numpy.hypot(way[..., 0], way[..., 1]) / 5.0, 1.0), numpy.cos(bearing), numpy.sin(bearing)


class Manipulation(Task):
    """The base of tasks in which each robot brings cubes to places, one after another.

    A robot knows its gripper and the way to its next goal: the nearest cube that is not at a place and in no gripper, or
    with a cube the place for it. Observations after the motion are those of COLUMNS: whether it holds a cube, the opening
    of its fingers and its lift, 0 to 1, the lift at the goal, the goal's distance / 5 m and bearing, the bearing of the
    direction in which to arrive, and distance and bearing of the nearest other cube and robot.

    Reward: 1 for a cube that is gripped the first time, `value` for one that is put down at its place, -0.02 for each
    step at a contact. A robot's task is done when no cube is left for it.
    """

    gripper = True
    sensor = None
    extra = len(COLUMNS)
    max_steps = 500
    cubes = 2  # for each robot
    value = 4.0
    size = (10.0, 7.0)  # m, of the yard

    def __init__(self, robots: int = 2) -> None:
        super().__init__(robots)

    def scenario(self):
        length, width = self.size
        walls = [{"name": name, "model": "model", "pose": pose, "properties": {"size": size}} for name, pose, size in (
            ("north", [0, width / 2, 0], [length, 0.1, 1]), ("south", [0, -width / 2, 0], [length, 0.1, 1]),
            ("east", [length / 2, 0, 0], [0.1, width, 1]), ("west", [-length / 2, 0, 0], [0.1, width, 1]))]
        x, y = length / 2 - 1.0, width / 2 - 1.0
        return {"name": self.name, "include": [str(worlds_folder() / "include/grippers.inc")], "seed": 1, "models": walls,
                "spawn": [{"model": "cube", "count": self.robots * self.cubes, "region": [-x, -y, 0.5, y], "spacing": 1.0,
                           "heading": 0, "name_prefix": "cube"},
                          {"model": "stacker", "count": self.robots, "region": [-x, -y, 1.5, y], "spacing": 1.0,
                           "heading": "random", "name_prefix": "robot"}]}

    def slots(self) -> Array:
        """(cubes, 3): x, y (m) and level of each place, in the order in which they are used."""
        raise NotImplementedError

    def begin(self, which, starts, generators, seen):
        shape = (len(which), self.robots * self.cubes)
        if not hasattr(self, "placed") or self.placed.shape != shape:
            self.placed = numpy.zeros(shape, int)  # the place of each cube, from 1; 0: none
            self.gripped = numpy.zeros(shape, bool)
            self.carried = numpy.full(seen.held.shape, -1)
        self.placed[which] = 0
        self.gripped[which] = False
        self.carried[which] = -1

    def place_of(self, world: int, robot: int) -> Array:
        """The place for the cube in a robot's gripper: the first free one."""
        slots = self.slots()
        free = sorted(set(range(len(slots))) - set(self.placed[world] - 1))
        carriers = [other for other in range(self.robots) if self.carried[world, other] >= 0]
        return slots[free[min(carriers.index(robot) if robot in carriers else 0, len(free) - 1)]]

    def features(self, seen):
        robots = seen.poses[..., :2]
        cubes = seen.objects[..., :2]
        heading = seen.poses[..., 3]
        rows = numpy.zeros((*heading.shape, self.extra))
        rows[..., 0] = seen.held >= 0
        rows[..., 1], rows[..., 2] = seen.openings, seen.lifts
        far = numpy.array([1e3, 0.0])
        for world, robot in numpy.ndindex(heading.shape):
            at, angle = robots[world, robot], heading[world, robot]
            ways = cubes[world] - at
            left = self.placed[world] == 0
            held = seen.held[world]
            left[held[held >= 0].astype(int)] = False
            if held[robot] >= 0:
                slot = self.place_of(world, robot)
                goal, lift, direction = slot[:2] - at, slot[2] * LEVEL, 0.0  # places are approached towards the east
            elif left.any():
                # A cube that is nearer to another robot without one is for that robot, if there are others.
                goal = ways[self._choice(cubes[world], robots[world], held, left, robot)]
                lift, direction = 0.0, math.atan2(goal[1], goal[0])
            else:
                goal, lift, direction = numpy.zeros(2), 0.0, angle
            others = numpy.hypot(*(ways - (goal if held[robot] < 0 else far)).T) > 1e-9
            if held[robot] >= 0:
                others[int(held[robot])] = False
            distances = numpy.where(others, numpy.hypot(*ways.T), numpy.inf)
            cube = ways[distances.argmin()] if others.any() else far
            peers = numpy.delete(robots[world], robot, axis=0) - at
            peer = peers[numpy.hypot(*peers.T).argmin()] if len(peers) else far
            rows[world, robot, 3:] = (lift, *_polar(goal, angle), math.cos(direction - angle), math.sin(direction - angle),
                                      *_polar(cube, angle), *_polar(peer, angle))
        return rows

    def _choice(self, cubes, robots, held, left, robot):
        numbers = numpy.nonzero(left)[0]
        for peer in range(self.robots):  # in order, so that two robots never choose the same
            if held[peer] >= 0 or not len(numbers):
                continue
            best = numbers[numpy.hypot(*(cubes[numbers] - robots[peer]).T).argmin()]
            if peer == robot:
                return best
            if len(numbers) > 1:
                numbers = numbers[numbers != best]
        return numbers[0]

    def reward(self, seen):
        reward = -0.02 * seen.stalls
        slots = self.slots()
        for world, robot in numpy.ndindex(seen.held.shape):
            now, before = int(seen.held[world, robot]), int(self.carried[world, robot])
            if now >= 0 and not self.gripped[world, now]:
                self.gripped[world, now] = True
                reward[world, robot] += 1.0
            if now < 0 <= before and self.placed[world, before] == 0:
                where = seen.objects[world, before]
                wrong = numpy.hypot(*(slots[:, :2] - where[:2]).T) + 10.0 * (abs(slots[:, 2] * CUBE - where[2]) > 0.05)
                wrong[self.placed[world][self.placed[world] > 0] - 1] = numpy.inf  # taken
                if wrong.min() < 0.15:
                    self.placed[world, before] = 1 + wrong.argmin()
                    reward[world, robot] += self.value
        self.carried = seen.held.astype(int)
        return reward

    def ended(self, seen):
        # The last robot stays until the last cube is at its place.
        left = (self.placed == 0).sum(axis=1)
        busy = (seen.held >= 0).sum(axis=1)
        return (seen.held < 0) & (left - busy <= 0)[:, None]

    def scripted(self, observations):
        part = dict(zip(COLUMNS, numpy.moveaxis(observations[..., -len(COLUMNS):], -1, 0)))
        holds = part["holds"] > 0.5
        distance = 5.0 * part["goal_distance"]
        bearing = numpy.arctan2(part["goal_sin"], part["goal_cos"])
        x, y = distance * part["goal_cos"], distance * part["goal_sin"]  # of the goal, in R
        # With a cube the way leads to a point before the place, and then straight on.
        aside = part["way_cos"] * y - part["way_sin"] * x
        along = part["way_cos"] * x + part["way_sin"] * y
        turned = numpy.arctan2(part["way_sin"], part["way_cos"])
        straight = (abs(aside) < 0.13) & (abs(turned) < 0.15) & (along > 0.2) | (distance < 0.62) & (abs(bearing) < 0.2)
        early = holds & ~straight
        point_x, point_y = x - 1.2 * part["way_cos"], y - 1.2 * part["way_sin"]
        at_point = early & (numpy.hypot(point_x, point_y) < 0.12)
        way = numpy.where(early, numpy.where(at_point, turned, numpy.arctan2(point_y, point_x)), bearing)
        gap = numpy.where(early, numpy.hypot(point_x, point_y), distance - REACH)
        at = ~early & (abs(distance - REACH) < 0.03) & (abs(bearing) < 0.12)

        # Past a cube that is in the way.
        cube, beside = 5.0 * part["cube_distance"], numpy.arctan2(part["cube_sin"], part["cube_cos"])
        passes = (gap > 0.6) & (cube < gap + 0.2)
        side = numpy.where(beside > 0, -1.0, 1.0)
        way = way + passes * side * numpy.clip((1.2 - cube) / 0.4, 0.0, 1.0) * numpy.maximum(0.0, 1.0 - abs(beside) / 1.2)

        turn = numpy.clip(2.0 * way, -1.0, 1.0)
        forward = numpy.clip(1.5 * gap, -0.3, 1.0) * numpy.where(abs(way) < 0.1 + 0.3 * (gap > 0.6), 1.0, 0.0)
        # Too near to turn: the paddles would push the cube away.
        back = ~early & (distance < 0.8) & (abs(bearing) > 0.15)
        forward, turn = numpy.where(back, numpy.where(part["goal_cos"] > 0, -0.5, 0.5), forward), numpy.where(back, 0.0, turn)
        forward = numpy.where(at_point, 0.0, forward)

        # Up before the way, and down at the place.
        high = part["goal_lift"] + 0.12
        wanted = numpy.where(holds & ~at, high, numpy.where(holds, part["goal_lift"] - 0.02, 0.0))
        lift = numpy.clip(10.0 * (wanted - part["lift"]), -1.0, 1.0)
        waits = (holds & ~at & (part["lift"] < high - 0.04)) | (~holds & (distance < 1.0) & (part["lift"] > 0.05))
        down = part["lift"] < part["goal_lift"] + 0.015
        fingers = numpy.where(holds, numpy.where(at & down, 1.0, -1.0), numpy.where(at, -1.0, 1.0))
        forward, turn = numpy.where(at | waits, 0.0, forward), numpy.where(at | waits, 0.0, turn)

        # A cube between the paddles that is not the goal has been put down: back from it.
        leaves = ~holds & (cube < 0.75) & (abs(beside) < 0.4)
        forward, turn = numpy.where(leaves, -0.6, forward), numpy.where(leaves, 0.0, turn)
        lift, fingers = numpy.where(leaves, 0.0, lift), numpy.where(leaves, 1.0, fingers)
        # Robots give way to one ahead of them.
        near = (part["robot_distance"] * 5.0 < 0.9) & (part["robot_cos"] > 0.5) & ~leaves & ~at
        forward = numpy.where(near, numpy.minimum(forward, -0.3), forward)
        contact = observations[..., 2]
        forward = numpy.where((abs(contact) > 0.5) & ~at, -0.5 * numpy.sign(contact), forward)
        return numpy.stack([forward, turn, fingers, lift], axis=-1).astype(numpy.float32)


class Carrying(Manipulation):
    """The robots bring scattered cubes to a row of places along the east wall. See Manipulation."""

    name = "carrying"

    def slots(self):
        count = self.robots * self.cubes
        y = numpy.arange(count) * 0.9
        return numpy.stack([numpy.full(count, self.size[0] / 2 - 0.6), y - y.mean(), numpy.zeros(count)], axis=-1)


class Stacking(Manipulation):
    """A robot builds a tower of three cubes. With more robots, they build as many towers. See Manipulation."""

    name = "stacking"
    cubes = 3

    def __init__(self, robots: int = 1) -> None:
        super().__init__(robots)

    def slots(self):
        towers = (numpy.arange(self.robots) - (self.robots - 1) / 2) * 1.6
        return numpy.array([[self.size[0] / 2 - 1.2, y, level] for level in range(self.cubes) for y in towers])
