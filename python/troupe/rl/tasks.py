"""Tasks: what robots are to do, as functions on arrays over all worlds and robots.

Shapes begin with (worlds, robots). Units are m, rad, s. Actions are (forward, turn) in [-1, 1], of `Task.speed` and
`Task.turn_rate`; with `Task.gripper` also (fingers, lift): above 0.3 they open, below -0.3 they close, and the lift moves up
or down at that share of its speed.
"""

from __future__ import annotations

import pathlib
from typing import Any, Dict, List, NamedTuple, Optional

import numpy

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
    """What tasks see of all worlds after a step."""

    poses: Array  # (worlds, robots, 4): x, y, z, heading
    twists: Array  # (worlds, robots, 3): vx, vy, wz
    stalls: Array  # (worlds, robots): 1 after a contact
    contacts: Array  # (worlds, robots): after a contact 1 if the robot drove ahead, -1 if back; then fading
    ranges: Array  # (worlds, robots, rays): m
    energy: Array  # (worlds, stores): J, in the order of the file
    steps: Array  # (worlds,): steps of the episode
    interval: float  # s, of a step
    objects: Array  # (worlds, objects, 4): x, y, z, heading of what grippers can hold
    held: Array  # (worlds, grippers): the object that each holds, -1: none; this and the next two with `gripper`
    openings: Array  # (worlds, grippers): of the fingers, 0 to 1
    lifts: Array  # (worlds, grippers): 0 to 1


class Task:
    """The base of tasks: robots in the office, which see the ranges of their sonars and their own motion.

    A task of your own overrides the functions that differ. It may keep arrays over all worlds from `begin` on.
    """

    name = "task"
    speed = 0.8  # m/s, of the action 1
    turn_rate = 1.5  # rad/s
    reach = 5.0  # m: ranges are divided by it
    ticks_per_step = 2
    max_steps = 400  # then the episode is truncated
    extra = 0  # numbers of an observation after ranges and motion
    gripper = False  # each robot has one, with a lift: actions have four numbers
    sensor: Optional[str] = "ranger"  # whose ranges robots see; None: none

    def __init__(self, robots: int = 4) -> None:
        self.robots = robots

    def scenario(self) -> Dict[str, Any]:
        """A scenario as JSON; robots in `spawn` are placed by the seed."""
        return {"name": self.name, "world": str(worlds_folder() / "office.world"), "seed": 1,
                "spawn": [{"model": "scout", "count": self.robots, "region": [-11, -7, 11, 7], "spacing": 0.8,
                           "heading": "random", "name_prefix": "robot"}]}

    def begin(self, which: Array, starts: List[Array], generators: List[numpy.random.Generator],
              seen: Situation) -> None:
        """A new episode in the worlds of the mask `which`. starts: the robots' poses in all starts, (robots, 4) each."""

    def features(self, seen: Situation) -> Array:
        """(worlds, robots, extra): what robots know beside their ranges and motion."""
        return numpy.zeros((*seen.stalls.shape, 0))

    def observe(self, seen: Situation) -> Array:
        """(worlds, robots, numbers), float32, about -1 to 1."""
        motion = numpy.stack([seen.twists[..., 0] / self.speed, seen.twists[..., 2] / self.turn_rate,
                              seen.contacts], axis=-1)
        near = numpy.minimum(seen.ranges / self.reach, 1.0)
        return numpy.concatenate([near, motion, self.features(seen)], axis=-1).astype(numpy.float32)

    def reward(self, seen: Situation) -> Array:
        """(worlds, robots), of the last step. Called once for each step."""
        raise NotImplementedError

    def ended(self, seen: Situation) -> Array:
        """(worlds, robots): the robot's task is done."""
        return numpy.zeros(seen.stalls.shape, bool)

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
    extra = 3
    tolerance = 0.4  # m
    far = 5.0  # m

    def begin(self, which, starts, generators, seen):
        # A task object may be used for another number of worlds, by an evaluation for instance.
        if not hasattr(self, "goals") or self.goals.shape[:2] != seen.stalls.shape:
            self.goals = numpy.zeros((*seen.stalls.shape, 2))
            self.left = numpy.zeros(seen.stalls.shape)
            self.arrived = numpy.zeros(seen.stalls.shape, bool)
        free = numpy.concatenate(starts)[:, :2]  # where robots start elsewhere there is room
        for world in numpy.nonzero(which)[0]:
            for robot in range(self.robots):
                ways = numpy.hypot(*(free - seen.poses[world, robot, :2]).T)
                choice = numpy.nonzero((ways > 1.0) & (ways < self.far))[0]
                self.goals[world, robot] = free[generators[world].choice(choice) if len(choice) else ways.argsort()[1]]
        self.left[which] = self._distance(seen)[which]
        self.arrived[which] = False

    def _distance(self, seen: Situation) -> Array:
        return numpy.hypot(*numpy.moveaxis(self.goals - seen.poses[..., :2], -1, 0))

    def features(self, seen):
        to_goal = self.goals - seen.poses[..., :2]
        bearing = numpy.arctan2(to_goal[..., 1], to_goal[..., 0]) - seen.poses[..., 3]
        distance = numpy.minimum(self._distance(seen) / 10.0, 1.0)
        return numpy.stack([distance, numpy.cos(bearing), numpy.sin(bearing)], axis=-1)

    def reward(self, seen):
        distance = self._distance(seen)
        now = (distance < self.tolerance) & ~self.arrived
        reward = numpy.where(self.arrived, 0.0, self.left - distance - 0.1 * seen.stalls) + 5.0 * now
        self.left = distance
        self.arrived = self.arrived | now
        return reward

    def ended(self, seen):
        return self.arrived.copy()

    def scripted(self, observations):
        bearing = numpy.arctan2(observations[..., -1], observations[..., -2])
        return avoid(observations, bearing)


class Coverage(Task):
    """The robots together visit as much of the office as they can, in cells of a metre.

    Reward: 1 for each cell that a robot is the first to visit. Extra observations: for each of eight directions whether the
    cell 1.5 m ahead has been visited, and cosine and sine of the heading.
    """

    name = "coverage"
    extra = 10
    size = (24, 16)  # m, of the office

    def begin(self, which, starts, generators, seen):
        if not hasattr(self, "visited") or len(self.visited) != len(which):
            self.visited = numpy.zeros((len(which), *self.size), bool)
        self.visited[which] = False
        self._visit(seen)

    def _cells(self, points: Array):
        half = numpy.array(self.size) / 2
        cells = numpy.floor(points + half).astype(int)
        return tuple(numpy.moveaxis(numpy.clip(cells, 0, numpy.array(self.size) - 1), -1, 0))

    def _visit(self, seen: Situation) -> Array:
        columns, rows = self._cells(seen.poses[..., :2])
        fresh = numpy.zeros(seen.stalls.shape)
        worlds = numpy.arange(len(fresh))
        for robot in range(fresh.shape[1]):  # in order: the first of several in a cell counts
            fresh[:, robot] = ~self.visited[worlds, columns[:, robot], rows[:, robot]]
            self.visited[worlds, columns[:, robot], rows[:, robot]] = True
        return fresh

    def features(self, seen):
        directions = numpy.arange(8) * (numpy.pi / 4)
        angles = seen.poses[..., 3, None] + directions
        points = seen.poses[..., None, :2] + 1.5 * numpy.stack([numpy.cos(angles), numpy.sin(angles)], axis=-1)
        columns, rows = self._cells(points)
        worlds = numpy.arange(len(self.visited))[:, None, None]
        heading = seen.poses[..., 3, None]
        return numpy.concatenate([self.visited[worlds, columns, rows], numpy.cos(heading), numpy.sin(heading)], axis=-1)

    def reward(self, seen):
        return self._visit(seen) - 0.1 * seen.stalls

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
    extra = 6
    radius = 4.0  # m

    def scenario(self):
        scenario = super().scenario()
        scenario["spawn"][0].update(region=[-4, -3, 4, 3])
        return scenario

    def __init__(self, robots: int = 6) -> None:
        super().__init__(robots)

    def features(self, seen):
        offsets = seen.poses[:, None, :, :2] - seen.poses[:, :, None, :2]  # from robot i to robot j
        distances = numpy.hypot(offsets[..., 0], offsets[..., 1])
        others = ~numpy.eye(self.robots, dtype=bool)
        near = (distances < self.radius) & others
        count = numpy.maximum(near.sum(axis=-1), 1)
        middle = (offsets * near[..., None]).sum(axis=2) / count[..., None]
        cos, sin = numpy.cos(seen.poses[..., 3]), numpy.sin(seen.poses[..., 3])
        mean_cos = (near * cos[:, None, :]).sum(axis=-1) / count
        mean_sin = (near * sin[:, None, :]).sum(axis=-1) / count

        def turned(x, y):
            return cos * x + sin * y, cos * y - sin * x

        nearest = numpy.where(others, distances, numpy.inf).min(axis=-1)
        return numpy.stack([*(part / self.radius for part in turned(middle[..., 0], middle[..., 1])),
                            *turned(mean_cos, mean_sin), numpy.minimum(nearest / self.radius, 1.0), near.any(axis=-1)],
                           axis=-1)

    def reward(self, seen):
        features = self.features(seen)
        along = seen.twists[..., 0] * features[..., 2]
        alone = features[..., 5] < 0.5
        return along - 0.2 * (features[..., 4] * self.radius < 0.6) - 0.2 * alone - 0.1 * seen.stalls

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
    extra = 8
    max_steps = 600
    places = numpy.array([[-5.0, 3.0], [5.0, 3.0]])  # m: the mine, the depot
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
                  for name, color, (x, y) in zip(("mine", "depot"), ("green", "red"), self.places)]
        charger = model("charger", [0, -4.1, 0], [9, 0.8, 0.02], color="light green", obstacle_return=0, joules=-1,
                        give_watts=400 * self.robots)
        return {"name": self.name, "include": [str(worlds_folder() / "include/robots.inc")], "seed": 1,
                "models": [*walls, *places, charger],
                "spawn": [{"model": "scout", "count": self.robots, "region": [-6, -3, 6, 4], "spacing": 0.8,
                           "heading": "random", "name_prefix": "robot"}],
                "override": [{"match": {"type": "scout"}, "properties": {
                    "joules": self.capacity, "watts": 5, "mass": 8, "take_watts": 400}}]}

    def begin(self, which, starts, generators, seen):
        if not hasattr(self, "carries") or self.carries.shape != seen.stalls.shape:
            self.carries = numpy.zeros(seen.stalls.shape, bool)
            self.empty = numpy.zeros(seen.stalls.shape, bool)
        self.carries[which] = False
        self.empty[which] = False

    def _energy(self, seen: Situation) -> Array:
        return seen.energy[:, -self.robots:]  # the charger's store is before those of the robots

    def _to_target(self, seen: Situation) -> Array:
        return self.places[self.carries.astype(int)] - seen.poses[..., :2]

    def features(self, seen):
        (left, right), y = self.charger
        x = numpy.clip(seen.poses[..., 0], left, right)
        to_charger = numpy.stack([x, numpy.full_like(x, y)], axis=-1) - seen.poses[..., :2]
        columns = [self.carries, self._energy(seen) / self.capacity]
        for way in (self._to_target(seen), to_charger):
            bearing = numpy.arctan2(way[..., 1], way[..., 0]) - seen.poses[..., 3]
            distance = numpy.hypot(way[..., 0], way[..., 1])
            columns += [numpy.minimum(distance / 10.0, 1.0), numpy.cos(bearing), numpy.sin(bearing)]
        return numpy.stack(columns, axis=-1)

    def reward(self, seen):
        way = self._to_target(seen)
        there = (numpy.hypot(way[..., 0], way[..., 1]) < self.radius) & ~self.empty
        reward = numpy.where(there, numpy.where(self.carries, 3.0, 1.0), 0.0) - 0.1 * seen.stalls * ~self.empty
        self.carries ^= there
        empty = self._energy(seen) <= 0.0
        reward -= 5.0 * (empty & ~self.empty)
        self.empty |= empty
        return reward

    def ended(self, seen):
        return self.empty.copy()

    def scripted(self, observations):
        energy, away = observations[..., -7], 10.0 * observations[..., -3]
        charges = (energy < 0.4) | ((energy < 0.95) & (away < 0.6))
        to_target = numpy.arctan2(observations[..., -4], observations[..., -5])
        to_charger = numpy.arctan2(observations[..., -1], observations[..., -2])
        actions = avoid(observations, numpy.where(charges, to_charger, to_target))
        return numpy.where((charges & (away < 0.3))[..., None], 0.0, actions)
