"""Environments: a task as PettingZoo's ParallelEnv and as Gymnasium's VectorEnv, by their conventions alone.

Neither package has to be installed; where one is, its class is the base, since its wrappers accept no other. Both are thin:
`Episodes` has the worlds. A step of all of them, with rewards and observations by the formulas of the task, is one call of
its native part.

The same seed and actions give the same observations and state hashes: all chance comes from a generator for each world.
"""

from __future__ import annotations

import copy
import importlib
import operator
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import numpy

from .._troupe import Episodes as NativeEpisodes
from .._troupe import Simulation, VectorSimulation
from .formulas import compiled
from .spaces import Array, Box, Discrete
from .tasks import Situation, Task


def _base(module: str, name: str) -> type:
    """The class of the package, if that is installed: its wrappers accept instances of it alone."""
    try:
        return getattr(importlib.import_module(module), name)
    except ImportError:
        return object


# The motions (forward, turn) of discrete actions, by their numbers: stand, ahead, in a curve, on the spot, back.
DISCRETE = numpy.array([(0.0, 0.0), (1.0, 0.0), (0.7, 0.6), (0.7, -0.6), (0.0, 1.0), (0.0, -1.0), (-0.5, 0.0)])


# The seeds of the starts for tests begin here, far from those of trainings.
HELD_OUT = 1_000_001


def _whole(seed: Any) -> int:
    try:
        number = operator.index(seed)
    except TypeError:
        raise TypeError(f"seed: found {type(seed).__name__}, expected a whole number") from None
    if number < 0:
        raise ValueError(f"seed: found {number}, expected a number from 0")
    return number


def _travel(sim: Simulation, part: str) -> List[Tuple[int, float, float, float]]:
    """A joint of each robot's gripper: its number, minimum and range, and its speed in ranges in a second."""
    infos = [sim.robot(name) for name in sim.robots]
    if len(sim.grippers) != len(infos) or any(not info.grippers for info in infos):
        raise ValueError("found another number of grippers, expected one for each robot")
    rows = []
    for info in infos:
        joint = info.joints[getattr(info.grippers[0], part)]
        rows.append((sim.joints.index(f"{info.name}.{joint.name}"), joint.min, joint.max - joint.min,
                     joint.max_speed / (joint.max - joint.min)))
    return rows


class Episodes:
    """Copies of a task's world, and the episodes in them. All environments are made of it.

    A world begins each episode at one of `starts` starts, which `Task.world` makes of the seeds 1, 2, ..., by the generator
    of its own: the same seed and actions give the same episodes and state hashes. held_out: the seeds are HELD_OUT and those
    after it, for scores at starts that no training has. `task` is copied: a task keeps what its episodes need, so that each
    environment has one of its own.
    """

    def __init__(self, task: Task, count: int, *, threads: int = 0, starts: int = 16, held_out: bool = False) -> None:
        self.task = copy.deepcopy(task)
        seeds = range(HELD_OUT if held_out else 1, (HELD_OUT if held_out else 1) + starts)
        self._starts = []
        self._start_poses: List[Array] = []
        for seed in seeds:
            sim = Simulation(self.task.world(seed), seed=seed)
            self._starts.append(sim.save())
            self._start_poses.append(sim.poses)
        self.worlds = VectorSimulation(self.task.world(seeds[0]), count, seeds=[seeds[0]] * count, threads=threads)
        self.robots = sim.robots
        formulas = self.task.formulas()
        interval = sim.interval * self.task.ticks_per_step
        signals = [name for name, column in sim.table("robots").items() if not isinstance(column, tuple)]
        lift, fingers = (_travel(sim, part) for part in ("lift", "left")) if self.task.gripper else (None, None)
        self._native = NativeEpisodes(self.worlds, self.task.sensor, {
            **compiled(formulas, self.task, signals), "speed": self.task.speed, "turn_rate": self.task.turn_rate,
            "reach": self.task.reach, "ticks": self.task.ticks_per_step, "interval": interval, "lift": lift, "fingers": fingers,
            "places": [tuple(map(float, place)) for place in self.task.places()]})
        arrays = self._native.arrays
        arrays["memory"] = dict(zip(formulas.memory, arrays["memory"]))
        self._seen = Situation(interval=interval, **arrays)
        self._nobody = numpy.zeros((count, len(self.robots)), bool)
        self._none = numpy.zeros(count, bool)
        self.seed(None)

    def __len__(self) -> int:
        return len(self.worlds)

    @property
    def observation_size(self) -> int:
        return int(self._seen.observations.shape[2]) + self.task.extra

    def seed(self, seed: Any, which: Optional[Array] = None) -> None:
        """Of the generators of the worlds of a mask, or of all: a list with a seed for each world, or n for n, n + 1, ...; None: of
        the operating system's chance."""
        if seed is None:
            seeds = [None] * len(self)
        elif numpy.ndim(seed) == 0:
            seeds = [_whole(seed) + i for i in range(len(self))]
        else:
            seeds = [None if each is None else _whole(each) for each in seed]
        if len(seeds) != len(self):
            raise ValueError(f"seed: found {len(seeds)} seeds, expected {len(self)}")
        if which is None:
            self.generators = [numpy.random.default_rng(each) for each in seeds]
            return
        for i in numpy.nonzero(which)[0]:
            self.generators[i] = numpy.random.default_rng(seeds[i])

    @property
    def action_size(self) -> int:
        return 4 if self.task.gripper else 2

    def begin(self, which: Array) -> None:
        """New episodes in the worlds of a mask."""
        numbers = numpy.nonzero(which)[0]
        self.worlds.reset(numbers, [self._starts[self.generators[i].integers(len(self._starts))] for i in numbers])
        self._native.look(which)
        self.task.begin(which, self._start_poses, self.generators, self._seen)
        self._native.start(which)

    def observe(self) -> Array:
        """(worlds, robots, numbers), float32."""
        return numpy.array(self.task.observe(self._seen), numpy.float32)

    def step(self, actions: Any, frozen: Optional[Array] = None, idle: Optional[Array] = None) -> Tuple[Array, Array, Array]:
        """One step of all worlds by actions (worlds, robots, 2 or 4) in [-1, 1]; robots of the mask `frozen` stand, and worlds
        of the mask `idle` are left as they are.

        Returns rewards (worlds, robots), ended (worlds, robots) and truncated (worlds,).
        """
        self._native.step(actions, self._nobody if frozen is None else frozen, self._none if idle is None else idle)
        seen = self._seen
        # Copies: the arrays are written again at the next step.
        return numpy.array(self.task.reward(seen), float), numpy.array(self.task.ended(seen), bool), seen.steps >= self.task.max_steps


class _OneWorld:
    """What environments of one world have."""

    _episodes: Episodes
    render_mode: Optional[str]

    @property
    def state_hash(self) -> int:
        return self._episodes.worlds[0].state_hash

    @property
    def simulation(self) -> Simulation:
        return self._episodes.worlds[0]

    def render(self) -> Any:
        """The picture of the world as PNG bytes, or with render_mode "rgb_array" as an array."""
        picture = self.simulation.picture(rays=True)
        return picture.array()[..., :3].copy() if self.render_mode == "rgb_array" else picture


def _action_space(episodes: Episodes, discrete: bool) -> Any:
    """Of a robot."""
    if discrete and episodes.task.gripper:
        raise ValueError("discrete: found a task with grippers, expected one of motion alone")
    return Discrete(len(DISCRETE)) if discrete else Box(-1.0, 1.0, (episodes.action_size,))


def _remade(kind: Any, arguments: Tuple[Any, ...], options: Dict[str, Any]) -> Any:
    """What pickle calls: an environment of the same kind, which begins anew."""
    return kind(*arguments, **options)


class ParallelEnv(_OneWorld, _base("pettingzoo", "ParallelEnv")):  # type: ignore[misc]
    """One world as PettingZoo's ParallelEnv: dictionaries by robot. A robot whose task is done leaves `agents`.

    discrete: as of RobotEnv.
    """

    def __init__(self, task: Task, *, discrete: bool = False, render_mode: Optional[str] = None) -> None:
        self.metadata = {"name": f"troupe_{task.name}_v0", "render_modes": ["rgb_array", "png"], "is_parallelizable": True}
        self.render_mode = render_mode
        self._episodes = Episodes(task, 1, threads=1)
        self.task = self._episodes.task
        self.possible_agents = list(self._episodes.robots)
        self.agents: List[str] = []
        size = self._episodes.observation_size
        self.observation_spaces = {name: Box(-numpy.inf, numpy.inf, (size,)) for name in self.possible_agents}
        self.discrete = discrete
        self.action_spaces = {name: _action_space(self._episodes, discrete) for name in self.possible_agents}

    @property
    def unwrapped(self) -> "ParallelEnv":
        return self

    @property
    def num_agents(self) -> int:
        return len(self.agents)

    @property
    def max_num_agents(self) -> int:
        return len(self.possible_agents)

    def observation_space(self, agent: str) -> Any:
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Any:
        return self.action_spaces[agent]

    def reset(self, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None
              ) -> Tuple[Dict[str, Array], Dict[str, Dict[str, Any]]]:
        if seed is not None:
            self._episodes.seed(seed)
        self._episodes.begin(numpy.array([True]))
        self.agents = list(self.possible_agents)
        return self._by_name(self._episodes.observe()[0]), {name: {} for name in self.agents}

    def step(self, actions: Dict[str, Any]) -> Tuple[Dict[str, Array], Dict[str, float], Dict[str, bool], Dict[str, bool],
                                                    Dict[str, Dict[str, Any]]]:
        motion = numpy.zeros((1, len(self.possible_agents), self._episodes.action_size))
        for i, name in enumerate(self.possible_agents):
            if name in self.agents and name in actions:
                motion[0, i] = DISCRETE[int(actions[name])] if self.discrete else actions[name]
        rewards, ended, truncated = self._episodes.step(motion)
        observations = self._by_name(self._episodes.observe()[0])
        result = (observations, self._by_name(rewards[0], float), self._by_name(ended[0], bool),
                  {name: bool(truncated[0]) for name in self.agents}, {name: {} for name in self.agents})
        self.agents = [name for name in self.agents if not result[2][name] and not result[3][name]]
        return result

    def _by_name(self, rows: Array, kind: Callable[[Any], Any] = lambda row: row) -> Dict[str, Any]:
        return {name: kind(row) for name, row in zip(self.possible_agents, rows) if name in self.agents}

    @property
    def state_space(self) -> Any:
        return Box(-numpy.inf, numpy.inf, (4 * len(self.possible_agents),))

    def state(self) -> Array:
        """The poses of all robots, (robots * 4,), float32."""
        return self._episodes.worlds[0].poses.astype(numpy.float32).reshape(-1)

    def __reduce__(self) -> Any:
        # Of a process that a learner starts: there it begins its own episodes.
        return _remade, (type(self), (self.task,), {"discrete": self.discrete, "render_mode": self.render_mode})

    def close(self) -> None:
        self.agents = []


class RobotEnv(_OneWorld, _base("gymnasium", "Env")):  # type: ignore[misc]
    """A task with one robot as Gymnasium's Env.

    discrete: actions are numbers of DISCRETE, in place of (forward, turn) in [-1, 1]; not of robots with grippers.
    """

    def __init__(self, task: Task, *, discrete: bool = False, render_mode: Optional[str] = None) -> None:
        self.metadata = {"render_modes": ["rgb_array", "png"], "render_fps": 10}
        self.render_mode = render_mode
        self.spec = None
        self._episodes = Episodes(task, 1, threads=1)
        self.task = self._episodes.task
        if len(self._episodes.robots) != 1:
            raise ValueError(f"task: found {len(self._episodes.robots)} robots, expected 1; ParallelEnv and VectorEnv have more")
        self.discrete = discrete
        self.observation_space = Box(-numpy.inf, numpy.inf, (self._episodes.observation_size,))
        self.action_space = _action_space(self._episodes, discrete)

    def reset(self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None
              ) -> Tuple[Array, Dict[str, Any]]:
        if seed is not None:
            self._episodes.seed(seed)
            self._np_random, self._np_random_seed = self._episodes.generators[0], seed
        self._episodes.begin(numpy.array([True]))
        return self._episodes.observe()[0, 0], {}

    def step(self, action: Any) -> Tuple[Array, float, bool, bool, Dict[str, Any]]:
        motion = DISCRETE[int(action)] if self.discrete else action
        rewards, ended, truncated = self._episodes.step(numpy.asarray(motion, float).reshape(1, 1, -1))
        over = bool(ended[0, 0])
        return self._episodes.observe()[0, 0], float(rewards[0, 0]), over, bool(truncated[0]) and not over, {}

    def close(self) -> None:
        pass

    def __reduce__(self) -> Any:
        return _remade, (type(self), (self.task,), {"discrete": self.discrete, "render_mode": self.render_mode})


AUTORESET = ("next_step", "same_step", "disabled")


def _autoreset_value(mode: str) -> Any:
    try:
        from gymnasium.vector import AutoresetMode
    except ImportError:
        return mode
    return AutoresetMode[mode.upper()]


class VectorEnv(_base("gymnasium.vector", "VectorEnv")):  # type: ignore[misc]
    """Many worlds as Gymnasium's VectorEnv: one environment is one world, with the robots in the rows of its arrays.

    The reward of a world is the mean of its robots' rewards, which infos["robot_rewards"] has, (worlds, robots); it has
    terminated when the tasks of all robots are done (infos["robot_ended"]).
    autoreset: "next_step", "same_step" or "disabled", as Gymnasium defines them; then `reset` with
    options={"reset_mask": mask} begins single worlds. held_out: at starts that no training has.
    """

    def __init__(self, task: Task, num_envs: int, *, autoreset: str = "next_step", threads: int = 0,
                 held_out: bool = False) -> None:
        if autoreset not in AUTORESET:
            raise ValueError(f"autoreset: found {autoreset!r}, expected one of {', '.join(AUTORESET)}")
        self.num_envs = num_envs
        self.render_mode = None
        self.spec = None
        self.closed = False
        self.autoreset = autoreset
        self.metadata = {"autoreset_mode": _autoreset_value(autoreset), "render_modes": []}
        self.held_out = held_out
        self._episodes = Episodes(task, num_envs, threads=threads, held_out=held_out)
        self.task = self._episodes.task
        robots, size = len(self._episodes.robots), self._episodes.observation_size
        actions = self._episodes.action_size
        self.single_observation_space = Box(-numpy.inf, numpy.inf, (robots, size))
        self.single_action_space = Box(-1.0, 1.0, (robots, actions))
        self.observation_space = Box(-numpy.inf, numpy.inf, (num_envs, robots, size))
        self.action_space = Box(-1.0, 1.0, (num_envs, robots, actions))
        self._over = numpy.zeros(num_envs, bool)  # worlds whose episodes have ended
        self._done = numpy.zeros((num_envs, robots), bool)

    @property
    def unwrapped(self) -> "VectorEnv":
        return self

    def _begin(self, which: Array) -> None:
        if which.any():
            self._episodes.begin(which)
            self._done[which] = False
            self._over[which] = False

    def reset(self, *, seed: Union[None, int, Sequence[Optional[int]]] = None,
              options: Optional[Dict[str, Any]] = None) -> Tuple[Array, Dict[str, Any]]:
        which = numpy.ones(self.num_envs, bool)
        if options and "reset_mask" in options:
            which = numpy.asarray(options["reset_mask"])
            if which.shape != (self.num_envs,) or which.dtype != bool:
                raise ValueError(f"reset_mask: found {which.dtype} of the shape {which.shape}, expected bool ({self.num_envs},)")
        if seed is not None:
            self._episodes.seed(seed, which)
        self._begin(which)
        return self._episodes.observe(), {}

    def step(self, actions: Any) -> Tuple[Array, Array, Array, Array, Dict[str, Any]]:
        again = self._over.copy() if self.autoreset == "next_step" else numpy.zeros(self.num_envs, bool)
        rewards, ended, truncated = self._episodes.step(actions, self._done, again)
        self._done |= ended
        terminations = self._done.all(axis=1)
        truncations = truncated & ~terminations
        totals = rewards.mean(axis=1)
        every = numpy.ones(self.num_envs, bool)
        # Of each robot, for learners that share a policy among them.
        infos: Dict[str, Any] = {"robot_rewards": rewards, "_robot_rewards": every,
                                 "robot_ended": self._done.copy(), "_robot_ended": every}
        if again.any():  # the action of a world that was over does not count: it begins again
            # Gymnasium's "next_step": the step after the end begins the next episode and returns its first observation.
            self._begin(again)
            totals[again], terminations[again], truncations[again] = 0.0, False, False
            rewards[again], infos["robot_ended"][again] = 0.0, False
        self._over = terminations | truncations
        observations = self._episodes.observe()
        if self.autoreset == "same_step" and self._over.any():
            final = numpy.full(self.num_envs, None, object)
            for i in numpy.nonzero(self._over)[0]:
                final[i] = observations[i]
            infos.update({"final_obs": final, "_final_obs": self._over.copy(), "final_info": {}, "_final_info": self._over.copy()})
            # A copy: the beginning clears the mask while it is read.
            self._begin(self._over.copy())
            observations = self._episodes.observe()
        return observations, totals, terminations, truncations, infos

    def __reduce__(self) -> Any:
        return _remade, (type(self), (self.task, self.num_envs), {"autoreset": self.autoreset, "held_out": self.held_out})

    @property
    def state_hashes(self) -> Array:
        """uint64 (num_envs,)."""
        return self._episodes.worlds.state_hashes

    @property
    def simulations(self) -> VectorSimulation:
        return self._episodes.worlds

    def close(self, **kwargs: Any) -> None:
        self.closed = True


def evaluate(task: Task, policy: Callable[[Array], Array], *, episodes: int = 16, seed: int = 0, held_out: bool = False
             ) -> Array:
    """The score of a policy, the sum of each episode's rewards, mean over the robots: (episodes,).

    policy: from observations (worlds, robots, numbers) to actions (worlds, robots, 2 or 4); `task.scripted` is the reference.
    held_out: at starts that no training has.
    """
    env = VectorEnv(task, episodes, autoreset="disabled", held_out=held_out)
    observations, _ = env.reset(seed=seed)
    scores = numpy.zeros(episodes)
    running = numpy.ones(episodes, bool)
    while running.any():
        observations, rewards, terminations, truncations, _ = env.step(policy(observations))
        scores += numpy.where(running, rewards, 0.0)
        running &= ~(terminations | truncations)
    return scores
