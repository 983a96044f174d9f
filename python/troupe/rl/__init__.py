"""Reinforcement learning on worlds of troupe: environments by the conventions of PettingZoo (`ParallelEnv`) and of
Gymnasium (`RobotEnv`, `VectorEnv`), neither of which has to be installed, and tasks with reference scores.

    env = troupe.rl.ParallelEnv(troupe.rl.Navigation(robots=4))
    observations, infos = env.reset(seed=1)
    vector = troupe.rl.VectorEnv(troupe.rl.Coverage(robots=8), num_envs=16, autoreset="same_step")

A task is a small class of functions on arrays over all worlds and robots: `Task` says which.
"""

from .envs import DISCRETE, HELD_OUT, Episodes, ParallelEnv, RobotEnv, VectorEnv, evaluate
from .formulas import Formulas
from .grippers import Carrying, Manipulation, Stacking
from .maps import Crowd, Rooms
from .spaces import Box, Discrete
from .tasks import Coverage, Flocking, Foraging, Navigation, Situation, Task

__all__ = ["Box", "Carrying", "Coverage", "Crowd", "DISCRETE", "Discrete", "Episodes", "Flocking", "Foraging", "Formulas",
           "HELD_OUT", "Manipulation", "Navigation", "ParallelEnv", "RobotEnv", "Rooms", "Situation", "Stacking", "Task", "VectorEnv", "evaluate"]
