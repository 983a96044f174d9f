"""Environments for libraries of multi-agent learning that take neither a ParallelEnv nor a RobotEnv as it is.

docs/learners.md has a section for each library.
"""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple

import numpy

from .envs import ParallelEnv
from .spaces import Array
from .tasks import Task

try:
    from gymnasium import Env
    from gymnasium.spaces import Tuple as TupleSpace
except ImportError:
    raise ImportError("troupe.rl.adapters: found no gymnasium, which the libraries of these environments need") from None


class TeamEnv(Env):  # type: ignore[misc,type-arg]
    """A task as an environment of tuples with a place for each robot, as EPyMARL expects it (`--env-config=gymma`).

    Robots whose tasks are done keep their places: they stand, and their rewards are 0. The episode has terminated when all are
    done. info["robot_ended"] has a truth for each robot. discrete: as of ParallelEnv.
    """

    def __init__(self, task: Task, *, discrete: bool = True, render_mode: Optional[str] = None) -> None:
        self._env = ParallelEnv(task, discrete=discrete, render_mode=render_mode)
        self.task = self._env.task
        self.metadata = {**self._env.metadata, "render_fps": 10}
        self.render_mode = render_mode
        names = self._env.possible_agents
        self.n_agents = len(names)
        self.observation_space = TupleSpace(tuple(self._env.observation_space(name) for name in names))
        self.action_space = TupleSpace(tuple(self._env.action_space(name) for name in names))
        self._last: Dict[str, Array] = {}

    def reset(self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None
              ) -> Tuple[Tuple[Array, ...], Dict[str, Any]]:
        super().reset(seed=seed)
        self._last, _ = self._env.reset(seed=seed, options=options)
        return tuple(self._last.values()), {}

    def step(self, actions: Any) -> Tuple[Tuple[Array, ...], List[float], bool, bool, Dict[str, Any]]:
        names = self._env.possible_agents
        if len(actions) != self.n_agents:
            raise ValueError(f"actions: found {len(actions)}, expected {self.n_agents}")
        seen, rewards, terminations, truncations, _ = self._env.step(dict(zip(names, actions)))
        self._last.update(seen)
        over = not self._env.agents
        truncated = over and any(truncations.values())
        ended = numpy.array([name not in self._env.agents and not truncations.get(name, False) for name in names])
        return (tuple(self._last[name] for name in names), [rewards.get(name, 0.0) for name in names], over and not truncated,
                truncated, {"robot_ended": ended})

    def render(self) -> Any:
        return self._env.render()

    @property
    def state_hash(self) -> int:
        return self._env.state_hash

    def close(self) -> None:
        self._env.close()
