"""Tasks: what robots are to do. Those of troupe are formulas, which C++ evaluates (formulas.py); a task of your own may be,
or functions on arrays over all worlds and robots.

Shapes begin with (worlds, robots). Units are m, rad, s. Actions are (forward, turn) in [-1, 1], of `Task.speed` and
`Task.turn_rate`; with `Task.gripper` also (fingers, lift): above 0.3 they open, below -0.3 they close, and the lift moves up
or down at that share of its speed.
"""

from __future__ import annotations

import pathlib
from typing import Any, Dict, List, NamedTuple, Optional

import numpy

from .formulas import Formulas
from .spaces import Array


def worlds_folder() -> pathlib.Path:
    """The folder of troupe's own worlds: of the package (pip), of the Debian package, or of the sources."""
    package = pathlib.Path(__file__).resolve().parent.parent
    places = [package / "worlds", *(parent / "share/troupe/worlds" for parent in package.parents),
              *(parent / "worlds" for parent in package.parents)]
    for place in places:
        if (place / "office.world").exists():
            return place
    raise FileNotFoundError("found no worlds of troupe, expected /usr/share/troupe/worlds")


class Situation(NamedTuple):
    """What tasks see of all worlds after a step. The arrays are reused from step to step: copy what you keep."""

    poses: Array  # (worlds, robots, 4): x, y, z, heading
    twists: Array  # (worlds, robots, 3): vx, vy, wz
    stalls: Array  # (worlds, robots): 1 after a contact
    contacts: Array  # (worlds, robots): after a contact 1 if the robot drove ahead, -1 if back; then fading
    ranges: Array  # (worlds, robots, rays): m
    energy: Array  # (worlds, stores): J, in the order of the file
    steps: Array  # (worlds,): steps of the episode
    interval: float  # s, of a step
    objects: Array  # (worlds, objects, 4): x, y, z, heading of what grippers can hold
    held: Array  # (worlds, grippers): the object that each holds, -1: none
    openings: Array  # (worlds, grippers): of the fingers, 0 to 1; this and the next with `gripper`
    lifts: Array  # (worlds, grippers): 0 to 1
    memory: Dict[str, Array]  # by name, (worlds, robots): of Task.formulas
    observations: Array  # (worlds, robots, numbers), float32: ranges, motion, and those of Task.formulas
    rewards: Array  # (worlds, robots): those of Task.formulas
    ended: Array  # (worlds, robots) of bool: those of Task.formulas


class Task:
    """The base of tasks: robots in the office, which see the ranges of their sonars and their own motion.

    A task of your own has other `formulas`, or overrides the functions that differ, which work on arrays over all worlds and
    robots. It may keep such arrays from `begin` on.
    """

    name = "task"
    speed = 0.8  # m/s, of the action 1
    turn_rate = 1.5  # rad/s
    reach = 5.0  # m: ranges are divided by it
    ticks_per_step = 2
    max_steps = 400  # then the episode is truncated
    extra = 0  # numbers that `features` adds to an observation
    gripper = False  # each robot has one, with a lift: actions have four numbers
    sensor: Optional[str] = "ranger"  # whose ranges robots see; None: none

    def __init__(self, robots: int = 4) -> None:
        self.robots = robots

    def scenario(self) -> Dict[str, Any]:
        """A scenario as JSON; robots in `spawn` are placed by the seed."""
        return {"name": self.name, "world": str(worlds_folder() / "office.world"), "seed": 1,
                "spawn": [{"model": "scout", "count": self.robots, "region": [-11, -7, 11, 7], "spacing": 0.8,
                           "heading": "random", "name_prefix": "robot"}]}

    def world(self, seed: int) -> Any:
        """The world of a start: a scenario as JSON or a troupe.World, in which the seed places what is placed by chance.

        Starts may have different maps, but the same robots, joints, objects and stores.
        """
        return self.scenario()

    def formulas(self) -> Formulas:
        """What robots remember, observe and are rewarded for, by expressions."""
        return Formulas()

    def places(self) -> Array:
        """(places, 3): x, y (m) and level, of cubes that robots carry (grippers.py)."""
        return numpy.zeros((0, 3))

    def begin(self, which: Array, starts: List[Array], generators: List[numpy.random.Generator],
              seen: Situation) -> None:
        """A new episode in the worlds of the mask `which`. starts: the robots' poses in all starts, (robots, 4) each."""

    def features(self, seen: Situation) -> Array:
        """(worlds, robots, extra): what robots know beside `seen.observations`."""
        return numpy.zeros((*seen.stalls.shape, 0))

    def observe(self, seen: Situation) -> Array:
        """(worlds, robots, numbers), float32, about -1 to 1: ranges / reach, motion, those of formulas, and features."""
        if self.extra == 0:
            return seen.observations
        return numpy.concatenate([seen.observations, self.features(seen)], axis=-1, dtype=numpy.float32)

    def reward(self, seen: Situation) -> Array:
        """(worlds, robots), of the last step. Called once for each step."""
        return seen.rewards

    def ended(self, seen: Situation) -> Array:
        """(worlds, robots): the robot's task is done."""
        return seen.ended

    def scripted(self, observations: Array) -> Array:
        """The reference: actions (worlds, robots, 2) by the observations alone. Here: away from obstacles."""
        return avoid(observations, numpy.zeros(observations.shape[:2]))


SONARS = 8  # of a scout, evenly around, the first one ahead, counter-clockwise


def avoid(observations: Array, bearing: Array, clear: float = 0.2) -> Array:
    """Actions towards a bearing (rad, in R). What is nearer than `clear` (in parts of the reach) pushes away and to its left,
    so that a robot passes it and follows walls; at a contact it backs off."""
    near = observations[..., :SONARS]
    angles = sonar_bearings()
    push = numpy.maximum(0.0, clear - near) / clear
    way = numpy.arctan2(numpy.sin(bearing) - (push * numpy.sin(angles + 0.9)).sum(axis=-1),
                        numpy.cos(bearing) - (push * numpy.cos(angles + 0.9)).sum(axis=-1))
    ahead = near[..., [0, 1, -1]].min(axis=-1)
    turn = numpy.clip(1.5 * way, -1.0, 1.0)
    forward = numpy.clip(numpy.cos(way), 0.0, 1.0) ** 2 * numpy.clip((ahead - 0.03) * 8.0, 0.0, 1.0)
    contact = observations[..., SONARS + 2]
    touched = numpy.abs(contact) > 0.5  # within four steps: away from it straight, then in a curve
    forward = numpy.where(touched, -0.4 * numpy.sign(contact), forward)
    turn = numpy.where(touched, numpy.where(numpy.abs(contact) > 0.9, 0.0, 0.8), turn)
    return numpy.stack([forward, turn], axis=-1).astype(numpy.float32)


def sonar_bearings() -> Array:
    return wrap(numpy.arange(SONARS) * (2 * numpy.pi / SONARS))


def wrap(angle: Array) -> Array:
    return (angle + numpy.pi) % (2 * numpy.pi) - numpy.pi


class Navigation(Task):
    """Each robot drives to a goal of its own in the office, 1 m to `far` away, perhaps behind a wall.

    Reward: metres of progress, 5 at the goal, -0.1 for each step at a contact. Extra observations: distance / 10 m, and
    cosine and sine of the goal's bearing.
    """

    name = "navigation"
    tolerance = 0.4  # m
    far = 5.0  # m

    def formulas(self):
        return Formulas(
            memory={"goal_x": None, "goal_y": None, "left": "distance", "arrived": "0"},
            define={"distance": "hypot(goal_x - x, goal_y - y)", "bearing": "atan2(goal_y - y, goal_x - x) - heading",
                    "arrives": "distance < tolerance and not arrived"},
            observe=["min(distance / 10, 1)", "cos(bearing)", "sin(bearing)"],
            reward="(0 if arrived else left - distance - 0.1 * stalled) + 5 * arrives",
            ended="arrived or arrives",
            after={"left": "distance", "arrived": "arrived or arrives"})

    def begin(self, which, starts, generators, seen):
        free = numpy.concatenate(starts)[:, :2]  # where robots start elsewhere there is room
        for world in numpy.nonzero(which)[0]:
            for robot, (x, y) in enumerate(seen.poses[world, :, :2]):
                ways = numpy.hypot(free[:, 0] - x, free[:, 1] - y)
                choice = numpy.nonzero((ways > 1.0) & (ways < self.far))[0]
                goal = choice[generators[world].integers(len(choice))] if len(choice) else ways.argsort()[1]
                seen.memory["goal_x"][world, robot], seen.memory["goal_y"][world, robot] = free[goal]

    def scripted(self, observations):
        bearing = numpy.arctan2(observations[..., -1], observations[..., -2])
        return avoid(observations, bearing)


class Coverage(Task):
    """The robots together visit as much of the office as they can, in cells of a metre.

    Reward: 1 for each cell that a robot is the first to visit. Extra observations: for each of eight directions whether the
    cell 1.5 m ahead has been visited, and cosine and sine of the heading.
    """

    name = "coverage"
    size = (24, 16)  # m, of the office

    def formulas(self):
        def ahead(angle: float) -> str:
            cos, sin = numpy.cos(angle), numpy.sin(angle)  # by which the heading is turned: cheaper than a cosine of the sum
            return (f"visited(x + 1.5 * (cos(heading) * {cos} - sin(heading) * {sin}), "
                    f"y + 1.5 * (sin(heading) * {cos} + cos(heading) * {sin}))")

        return Formulas(
            memory={"first": "visit(x, y)"}, grid=self.size,
            observe=[*(ahead(number * numpy.pi / 4) for number in range(8)),
                     "cos(heading)", "sin(heading)"],
            reward="visit(x, y) - 0.1 * stalled")

    def scripted(self, observations):
        room = observations[..., :SONARS]  # in the same directions
        fresh = (observations[..., SONARS + 3:SONARS + 11] < 0.5) & (room > 0.3)
        directions = wrap(numpy.arange(8) * (numpy.pi / 4))
        value = 2.0 * fresh + 0.5 * room - 0.5 * numpy.abs(directions) - 4.0 * (room < 0.2)
        return avoid(observations, directions[value.argmax(axis=-1)])


class Flocking(Task):
    """The robots stay together, 1 m apart, and move.

    Reward for each step, per robot: its speed along the mean heading of its neighbours within 4 m, less 0.2 for a distance
    below 0.6 m to the nearest and 0.2 without a neighbour, and 0.1 at a contact. Extra observations: the middle of its
    neighbours in R / 4 m, cosine and sine of their mean heading in R, the nearest one's distance / 4 m, and whether there
    is one.
    """

    name = "flocking"
    radius = 4.0  # m

    def scenario(self):
        scenario = super().scenario()
        scenario["spawn"][0].update(region=[-4, -3, 4, 3])
        return scenario

    def __init__(self, robots: int = 6) -> None:
        super().__init__(robots)

    def formulas(self):
        distance = "hypot(other.x - x, other.y - y)"
        near = f"for other in others if {distance} < radius"
        return Formulas(
            define={"count": f"max(sum(1 {near}), 1)", "alone": f"not any(1 {near})",
                    "to_x": f"sum(other.x - x {near}) / count", "to_y": f"sum(other.y - y {near}) / count",
                    "mean_cos": f"sum(cos(other.heading) {near}) / count",
                    "mean_sin": f"sum(sin(other.heading) {near}) / count",
                    "ahead": "cos(heading) * mean_cos + sin(heading) * mean_sin",
                    "nearest": f"min(min({distance} for other in others), radius)"},
            observe=["(cos(heading) * to_x + sin(heading) * to_y) / radius",
                     "(cos(heading) * to_y - sin(heading) * to_x) / radius", "ahead",
                     "cos(heading) * mean_sin - sin(heading) * mean_cos", "nearest / radius", "not alone"],
            reward="vx * ahead - 0.2 * (nearest < 0.6) - 0.2 * alone - 0.1 * stalled")

    def scripted(self, observations):
        x, y, cos, sin, nearest, some = numpy.moveaxis(observations[..., -6:], -1, 0)
        pull = numpy.where(nearest * self.radius < 1.0, -1.5, 0.8)
        bearing = numpy.arctan2(sin + pull * y, cos + 0.2 + pull * x)
        return avoid(observations, numpy.where(some > 0.5, bearing, 0.0))


class Foraging(Task):
    """The robots bring units from a mine to a depot, and charge before their stores of energy are empty.

    Reward: 1 for a unit at the mine, 3 for it at the depot, -5 for an empty store, which ends the robot's task, and -0.1 for
    each step at a contact. Extra observations: whether the robot carries a unit, its energy / capacity, and distance / 10 m,
    cosine and sine of the bearing of the place where it must go, and of the nearest point of the charger.
    """

    name = "foraging"
    max_steps = 600
    mine = (-5.0, 3.0)  # m
    depot = (5.0, 3.0)  # m
    radius = 0.8  # m
    capacity = 6000.0  # J
    charger = ((-4.2, 4.2), -4.1)  # m: its middle line, x from and to, and y

    def scenario(self):
        def model(name: str, pose: List[float], size: List[float], **properties: Any) -> Dict[str, Any]:
            return {"name": name, "model": "model", "pose": pose, "properties": {"size": size, **properties}}

        walls = [model("north", [0, 5, 0], [14.1, 0.1, 1]), model("south", [0, -5, 0], [14.1, 0.1, 1]),
                 model("east", [7, 0, 0], [0.1, 9.9, 1]), model("west", [-7, 0, 0], [0.1, 9.9, 1]),
                 model("screen", [0, 1.5, 0], [0.1, 2, 1]), model("crate", [-3, -1, 20], [0.8, 0.8, 0.6]),
                 model("chest", [3, 0, 0], [0.8, 0.8, 0.6])]
        places = [model(name, [x, y, 0], [2 * self.radius, 2 * self.radius, 0.01], color=color, obstacle_return=0)
                  for name, color, (x, y) in zip(("mine", "depot"), ("green", "red"), (self.mine, self.depot))]
        charger = model("charger", [0, -4.1, 0], [9, 0.8, 0.02], color="light green", obstacle_return=0, joules=-1,
                        give_watts=400 * self.robots)
        return {"name": self.name, "include": [str(worlds_folder() / "include/robots.inc")], "seed": 1,
                "models": [*walls, *places, charger],
                "spawn": [{"model": "scout", "count": self.robots, "region": [-6, -3, 6, 4], "spacing": 0.8,
                           "heading": "random", "name_prefix": "robot"}],
                "override": [{"match": {"type": "scout"}, "properties": {
                    "joules": self.capacity, "watts": 5, "mass": 8, "take_watts": 400}}]}

    def formulas(self):
        def way(x: str, y: str) -> List[str]:
            bearing = f"atan2({y}, {x}) - heading"
            return [f"min(hypot({x}, {y}) / 10, 1)", f"cos({bearing})", f"sin({bearing})"]

        return Formulas(
            memory={"carries": "0", "empty": "0"},
            define={"to_x": "(depot[0] if carries else mine[0]) - x", "to_y": "(depot[1] if carries else mine[1]) - y",
                    "there": "hypot(to_x, to_y) < radius and not empty", "runs_empty": "energy <= 0 and not empty",
                    "charge_x": "clip(x, charger[0][0], charger[0][1]) - x", "charge_y": "charger[1] - y"},
            observe=["carries", "energy / capacity", *way("to_x", "to_y"), *way("charge_x", "charge_y")],
            reward="(3 if carries else 1) * there - 0.1 * stalled * (not empty) - 5 * runs_empty",
            ended="empty or runs_empty",
            after={"carries": "carries != there", "empty": "empty or runs_empty"})

    def scripted(self, observations):
        energy, away = observations[..., -7], 10.0 * observations[..., -3]
        charges = (energy < 0.4) | ((energy < 0.95) & (away < 0.6))
        to_target = numpy.arctan2(observations[..., -4], observations[..., -5])
        to_charger = numpy.arctan2(observations[..., -1], observations[..., -2])
        actions = avoid(observations, numpy.where(charges, to_charger, to_target))
        return numpy.where((charges & (away < 0.3))[..., None], 0.0, actions)
