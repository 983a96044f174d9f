"""Controller: the base class of robot controllers in Python, which may be used or not.

A scenario names a controller as FILE.py:CLASS, with parameters that arrive as keyword arguments:

    "controller": {"name": "patrol.py:Patrol", "parameters": {"speed": 0.4}}
"""

from __future__ import annotations

from typing import Sequence, Tuple, Union

from .records import *  # noqa: F401,F403
from .records import Command, Observation, RobotInfo


class Controller:
    """Decides the motion of one robot. docs/python.md has an example.

    A controller depends on its observations and parameters alone: no clock, no random numbers but those of
    `Observation.random`. Its memory is its attributes, which `copy.deepcopy` copies when a run is rewound or rebuilt.
    """

    def __init__(self, robot: RobotInfo) -> None:
        """`robot`, and the parameters as keyword arguments. An exception ends the start of the run."""

    def subscriptions(self) -> Sequence[int]:
        """The numbers of the sensors that `update` reads. The others are not measured."""
        return ()

    def update(self, seen: Observation) -> Union[Command, Tuple[float, float], Tuple[float, float, float], None]:
        """The command for the next tick: a Command, a pair (vx, wz), a triple (vx, vy, wz), or None to stand still.

        An exception stops the robot and is reported with its file and line; the run goes on.
        """
        raise NotImplementedError

    accepts_goals = False  # True: `update` reads `seen.goal`
