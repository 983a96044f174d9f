"""Troupe: a deterministic 2.5D simulator of many mobile robots.

    import troupe
    sim = troupe.Simulation("office.world")
    sim.step(100)
    sim.poses          # (robots, 4): x, y, z (m), heading (rad)

`Simulation` runs a world in this process, with the state hashes of `troupe run`; `World` describes one by code;
`VectorSimulation` runs many copies of one on all cores; `Recording` has the states of a recorded run; `Controller` decides for one robot, wherever a controller is named. Units are metres, seconds and
radians; x points forward, y to the left, z up. docs/python.md is a tour.
"""

from typing import TYPE_CHECKING, Any, List

__version__ = "0.2.0"

if TYPE_CHECKING:
    # "as": what is named anew is exported, for type checkers.
    from ._troupe import Simulation as Simulation
    from ._troupe import Snapshot as Snapshot
    from ._troupe import State as State
    from ._troupe import VectorSimulation as VectorSimulation
    from .controller import Controller as Controller
    from .errors import Error as Error
    from .errors import InputError as InputError
    from .errors import RunError as RunError
    from .picture import Page as Page
    from .picture import Picture as Picture
    from .recording import Recording as Recording
    from .records import *  # noqa: F403
    from .world import World as World
    from .world import lidar as lidar

_MODULES = {"Simulation": "_troupe", "VectorSimulation": "_troupe", "Snapshot": "_troupe", "State": "_troupe",
            "Recording": "recording", "Controller": "controller", "World": "world", "lidar": "world",
            "Error": "errors", "InputError": "errors", "RunError": "errors", "Picture": "picture", "Page": "picture"}


def __getattr__(name: str) -> Any:
    # On demand: an agent that runs controllers needs the records alone.
    import importlib
    if name.startswith("__"):
        raise AttributeError(name)
    if name in ("records", "controller", "errors", "generators", "picture", "recording", "rl", "testing",
                "world", "_troupe"):
        return importlib.import_module(f"{__name__}.{name}")
    value = getattr(importlib.import_module(f"{__name__}.{_MODULES.get(name, 'records')}"), name, None)
    if value is None:
        raise AttributeError(f"module 'troupe' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> List[str]:
    from . import records
    return sorted({*globals(), *_MODULES, *records.__all__})
