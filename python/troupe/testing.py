"""Expectations about runs, for tests in Python: the language of `troupe test` (docs/testing.md).

    from troupe.testing import check

    def test_patrol():
        check("patrol.json", "forall a, b: always distance(a, b) > 1 cm", ticks=600, seeds=range(20))

`check` raises an AssertionError that names the tick and the robots, and the shortest run that fails. With pytest,
`*.test.json` files are tests too (troupe.pytest_plugin).
"""

from __future__ import annotations

import os
from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from ._troupe import Metric, Monitor, Simulation, watch
from .world import World

__all__ = ["Failure", "Metric", "Monitor", "Outcome", "Run", "check", "run", "watch"]

_World = Union[str, "os.PathLike[str]", Mapping[str, Any], World]
_Controller = Union[None, str, type]
_Outline = Sequence[Tuple[float, float]]
_Regions = Optional[Mapping[str, Union[_Outline, Tuple[_Outline, float]]]]


class Outcome(NamedTuple):
    """What became of an expectation."""

    text: str
    formula: str  # without shorthands
    holds: bool
    robustness: float  # how far from the other verdict, in the unit of the comparison that decides
    decided_at: int  # the tick after which it was known
    cause_tick: Optional[int]  # what decides the robustness
    cause_names: Tuple[str, ...]


class Run(NamedTuple):
    """A run that has ended."""

    seed: int
    ticks: int
    state_hash: int
    outcomes: Tuple[Outcome, ...]  # in the order of the expectations
    metrics: Dict[str, Optional[float]]  # by name, SI units; None: it does not exist

    @property
    def passed(self) -> bool:
        return all(outcome.holds for outcome in self.outcomes)


class Failure(AssertionError):
    """An expectation is false. `run` is the shortest run that shows it."""

    def __init__(self, text: str, run: Run) -> None:
        super().__init__(text)
        self.run = run


def run(world: Union[_World, Simulation], expectations: Union[str, Iterable[str]] = (), *,
        ticks: int = 600, metrics: Optional[Mapping[str, str]] = None, regions: _Regions = None,
        seed: Optional[int] = None, controller: _Controller = None, stop: bool = False) -> Run:
    """Steps a world, or a simulation from its present tick on, and judges each tick.

    ticks: of the run; the present one counts, too. metrics: {name: metric}. regions: {name: [(x, y), ...]}, or
    {name: ([(x, y), ...], z)} of one level of a building, m in W.
    stop: no further than the tick at which an expectation is false. InputError for a wrong file or expectation.
    """
    sim = world if isinstance(world, Simulation) else Simulation(world, seed=seed, controller=controller)
    texts = [expectations] if isinstance(expectations, str) else list(expectations)
    monitors = [Monitor(sim, text, regions) for text in texts]
    numbers = {name: Metric(sim, text, regions) for name, text in (metrics or {}).items()}
    # A given simulation may be at any tick.
    begin = sim.tick
    watch(sim, ticks, [*monitors, *numbers.values()], stop=stop)
    for monitor in monitors:
        monitor.finish()
    for metric in numbers.values():
        metric.finish()
    return Run(sim.seed, sim.tick - begin, sim.state_hash, tuple(map(_outcome, monitors)),
               {name: metric.value for name, metric in numbers.items()})


def _outcome(monitor: Monitor) -> Outcome:
    tick, names = monitor.cause
    return Outcome(monitor.text, monitor.formula, monitor.verdict is True, monitor.robustness[0],
                   monitor.decided_at or 0, tick, names)


def check(world: _World, *expectations: str, ticks: int = 600,
          seeds: Optional[Iterable[int]] = None, regions: _Regions = None, controller: _Controller = None) -> List[Run]:
    """Runs a world with each of the seeds, by default the file's, and raises a Failure if an expectation is false.

    A failing run is repeated and ends at the first tick that shows it, so that the call in the message is the shortest.
    """
    runs = []
    for seed in [None] if seeds is None else seeds:
        done = run(world, expectations, ticks=ticks, regions=regions, seed=seed, controller=controller)
        if not done.passed:
            raise _failure(world, done, ticks, regions, controller)
        runs.append(done)
    return runs


def _names(world: _World) -> Tuple[str, str]:
    """Of the world in messages, and in a call."""
    if isinstance(world, (World, Mapping)):
        scenario = world.scenario if isinstance(world, World) else world
        return str(scenario.get("name", "world")), "world"
    return os.fspath(world), repr(os.fspath(world))


def _failure(world: _World, done: Run, ticks: int, regions: _Regions,
             controller: _Controller) -> Failure:
    outcome = min((each for each in done.outcomes if not each.holds), key=lambda each: each.decided_at)
    # A shorter run may fail by another reason, `eventually` for instance: only the same one counts.
    short = run(world, [outcome.text], ticks=ticks, regions=regions, seed=done.seed, controller=controller, stop=True)
    shown = short.outcomes[0]
    name, argument = _names(world)
    if shown.holds:
        return Failure(f"{name}: seed {done.seed}: {outcome.text} was false, and true when the run was repeated: "
                       "a controller depends on more than its observations", short)
    by = f" by {' and '.join(shown.cause_names)}" if shown.cause_names else ""
    at = f" at tick {shown.cause_tick}" if shown.cause_tick is not None else ""
    formula = f"\n  that is: {shown.formula}" if shown.formula != shown.text else ""
    extra = "".join(f", {name}={value!r}" for name, value in (("regions", regions), ("controller", controller)) if value)
    return Failure(f"{name}: the expectation is false: {outcome.text}{formula}\n"
                   f"  decided{by}{at}, robustness {shown.robustness:.6g}, known at tick {shown.decided_at}\n"
                   f"  again: troupe.testing.check({argument}, {outcome.text!r}, ticks={short.ticks}, "
                   f"seeds=[{done.seed}]{extra})", short)
