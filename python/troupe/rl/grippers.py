"""Tasks of robots with grippers, which carry and stack cubes. Their actions are (forward, turn, fingers, lift)."""

from __future__ import annotations

from typing import List

import numpy

from .formulas import Formulas
from .spaces import Array
from .tasks import Task, worlds_folder

REACH = 0.4  # m: a gripped cube is so far in front of the robot's origin
CUBE = 0.2  # m, its side
LEVEL = 0.25  # of the lift: the height of a cube
COLUMNS = ("holds", "opening", "lift", "goal_lift", "goal_distance", "goal_cos", "goal_sin", "way_cos", "way_sin",
           "cube_distance", "cube_cos", "cube_sin", "robot_distance", "robot_cos", "robot_sin")


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

    def places(self) -> Array:
        """(cubes, 3): x, y (m) and level of each place, in the order in which they are used."""
        raise NotImplementedError

    def formulas(self):
        def way(x: str, y: str) -> List[str]:
            bearing = f"atan2({y}, {x}) - heading"
            return [f"min(hypot({x}, {y}) / 5, 1)", f"cos({bearing})", f"sin({bearing})"]

        return Formulas(
            define={"lift_of_level": str(LEVEL)},
            observe=["held >= 0", "opening", "lift", "goal_level * lift_of_level", *way("to_goal_x", "to_goal_y"),
                     "cos(way - heading)", "sin(way - heading)", *way("to_cube_x", "to_cube_y"), *way("to_peer_x", "to_peer_y")],
            reward="gripped + value * placed - 0.02 * stalled",
            # The last robot stays until the last cube is at its place.
            ended="idle")

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

    def places(self):
        count = self.robots * self.cubes
        y = numpy.arange(count) * 0.9
        return numpy.stack([numpy.full(count, self.size[0] / 2 - 0.6), y - y.mean(), numpy.zeros(count)], axis=-1)


class Stacking(Manipulation):
    """A robot builds a tower of three cubes. With more robots, they build as many towers. See Manipulation."""

    name = "stacking"
    cubes = 3

    def __init__(self, robots: int = 1) -> None:
        super().__init__(robots)

    def places(self):
        towers = (numpy.arange(self.robots) - (self.robots - 1) / 2) * 1.6
        return numpy.array([[self.size[0] / 2 - 1.2, y, level] for level in range(self.cubes) for y in towers])
