"""Navigation where each start of an episode is another map, and where people are in the way."""

from __future__ import annotations

from .. import generators
from .tasks import Navigation


class Rooms(Navigation):
    """Each robot drives to a goal of its own through rooms side by side. Each start has rooms with other doors. See Navigation.

    What has been learned is told from what is remembered by an evaluation with held_out=True: in rooms that no training has.
    """

    name = "rooms"
    far = 4.0  # m

    def world(self, seed):
        world = generators.rooms(seed, columns=3, rows=3, room=(3.0, 3.0))
        world.robots(self.robots, (-4.2, -4.2, 4.2, 4.2), prefix="robot", spacing=0.8, heading="random")
        return world


class Crowd(Navigation):
    """Each robot drives to a goal of its own through an office with people, who walk between its rooms. See Navigation.

    People avoid robots, but do not always make room. A robot that touches a person has a contact, as with a wall.
    """

    name = "crowd"
    people = 12

    def scenario(self):
        scenario = super().scenario()
        scenario["people"] = [{"count": self.people, "region": [-11, -7, 11, 7],
                               "goals": [[-9, -5], [9, 5], [-9, 5], [9, -5], [0, 0]], "wait": [0, 4]}]
        return scenario
