"""The native part of troupe. Units: m, rad, s. Frames: W world, R robot."""

import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from .picture import Page, Picture
from .records import Command, Event, Map, Pose, Reading, RobotInfo
from .world import World

_File = Union[str, bytes, "os.PathLike[str]"]
_World = Union[_File, Mapping[str, Any], World]
_Controller = Union[str, type]
_Robot = Union[int, str]
_Array = NDArray[numpy.float64]

__version__: str

class Snapshot:
    """The whole of a simulation at one tick. Never changes."""

    @property
    def tick(self) -> int: ...

class State:
    """A world at a tick: what can be read of it. A Simulation is one, and so is each state of a Recording.

    Arrays of the state are views of the state at the tick at which they were taken: they can only be read, and stay as
    they are when the simulation steps on or ends.
    """

    @property
    def tick(self) -> int: ...
    @property
    def time(self) -> float:
        """s, simulated."""
    @property
    def interval(self) -> float:
        """s, the length of a tick."""
    @property
    def seed(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def state_hash(self) -> int:
        """Equal states have equal hashes, on every machine."""
    @property
    def robots(self) -> Tuple[str, ...]: ...
    @property
    def joints(self) -> Tuple[str, ...]: ...
    @property
    def grippers(self) -> Tuple[str, ...]: ...
    @property
    def objects(self) -> Tuple[str, ...]: ...
    @property
    def doors(self) -> Tuple[str, ...]: ...
    @property
    def lifts(self) -> Tuple[str, ...]: ...
    @property
    def people(self) -> Tuple[str, ...]: ...
    @property
    def stores(self) -> Tuple[str, ...]: ...
    @property
    def imus(self) -> Tuple[str, ...]: ...
    @property
    def visitors(self) -> Tuple[str, ...]: ...
    @property
    def visitor_flows(self) -> Tuple[str, ...]: ...
    @property
    def lights(self) -> Tuple[str, ...]: ...
    @property
    def cameras(self) -> Tuple[str, ...]: ...
    @property
    def levels(self) -> Tuple[str, ...]: ...
    @property
    def lanes(self) -> Tuple[str, ...]: ...
    @property
    def zones(self) -> Tuple[str, ...]: ...
    @property
    def coverage(self) -> Tuple[str, ...]: ...
    @property
    def flows(self) -> Tuple[str, ...]: ...
    @property
    def sensors(self) -> Tuple[str, ...]: ...
    @property
    def tables(self) -> Tuple[str, ...]:
        """The names of the tables of things: robots, joints, doors, people, levels ..."""
    def table(self, name: str) -> Dict[str, Union[numpy.ndarray[Any, Any], Tuple[str, ...]]]:
        """A table of things: "name" and the signals of docs/testing.md, each an array or a tuple of texts."""
    def robot(self, robot: _Robot) -> RobotInfo: ...
    @property
    def poses(self) -> _Array:
        """(robots, 4): x, y, z (m), heading (rad) in W."""
    @property
    def twists(self) -> _Array:
        """(robots, 3): vx, vy (m/s), wz (rad/s) in R, executed in the last tick."""
    @property
    def stalls(self) -> NDArray[numpy.bool_]:
        """(robots,): a contact ended the last motion."""
    @property
    def joint_positions(self) -> _Array:
        """(joints,): m or rad."""
    @property
    def object_poses(self) -> _Array:
        """(objects, 4), as poses."""
    @property
    def energy(self) -> _Array:
        """(stores,): J."""
    def read(self, robot: _Robot, sensor: _Robot) -> Reading:
        """The reading of a sensor, by name, type or number. Whether it is read changes nothing."""
    def ranges(self, sensor: _Robot = "ranger", out: Optional[numpy.ndarray[Any, Any]] = None) -> numpy.ndarray[Any, Any]:
        """(robots, rays), m. ValueError if the numbers of rays differ."""
    def images(self, sensor: _Robot = "camera", out: Optional[NDArray[numpy.uint8]] = None) -> NDArray[numpy.uint8]:
        """(robots, height, width, 3), of all robots' cameras."""
    def depths(self, sensor: _Robot = "camera", out: Optional[NDArray[numpy.float32]] = None) -> NDArray[numpy.float32]:
        """(robots, height, width), m ahead; -inf: too near, inf: no hit."""
    def map(self, resolution: Optional[float] = None, z: Optional[float] = None) -> Map:
        """The static bodies that reach through the height z (m)."""
    def held(self, robot: _Robot) -> List[Optional[str]]:
        """The object that each gripper holds."""
    def copy(self) -> "Simulation":
        """A Simulation from here; constant parts are shared. That of a recorded state has no controllers."""
    @property
    def events(self) -> List[Event]:
        """Of the last call of step; of a recorded state: of its tick."""
    def picture(self, *, view: str = "top", rays: bool = False, width: Optional[int] = None,
                center: Optional[Tuple[float, float]] = None, meters: Optional[float] = None,
                format: str = "png") -> Picture:
        """InputError for options out of bounds."""
    def _repr_png_(self) -> bytes: ...

class Simulation(State):
    """A world in this process. One thread at a time may use it; another one gets a RuntimeError."""

    def __init__(self, world: Union[_World, Callable[[Optional[int]], _World]], *, seed: Optional[int] = None,
                 controller: Optional[_Controller] = None, run_controllers: bool = True) -> None:
        """Loads a .world, a scenario (.json) or a ROS map (.yaml); or a scenario as a dict, or a World.

        Raises InputError with file, line and column.
        """

    def step(self, ticks: int = 1) -> None:
        """Advances. Other threads run meanwhile; Ctrl-C ends it between two ticks."""
    @property
    def warnings(self) -> Tuple[str, ...]: ...
    def drive(self, motion: Union[ArrayLike, Command], robot: Optional[_Robot] = None) -> None:
        """One robot by (vx, wz), (vx, vy, wz) or a Command; all by an array (robots, 2 or 3). Until `release`."""
    def release(self, robot: Optional[_Robot] = None) -> None:
        """Returns a robot, or all, to its controller."""
    def send_to(self, robot: _Robot, goal: ArrayLike, heading: Optional[float] = None) -> None:
        """To a point (x, y) or (x, y, z), or to several. InputError if the controller accepts no goals or no way leads there."""
    def cancel_goal(self, robot: _Robot) -> None: ...
    def send_message(self, robot: _Robot, topic: str, message: Union[str, Mapping[str, Any]]) -> None:
        """Of a fleet control to a vehicle of VDA 5050: order, instantActions, zoneSet or responses, for the next tick."""
    def set_door(self, door: _Robot, opening: float = 1.0) -> None:
        """From the next tick on; opening: 0, closed, to 1."""
    def call_lift(self, lift: _Robot, floor: str) -> None:
        """From the next tick on."""
    def find_pose(self, name: str) -> Pose: ...
    def set_pose(self, name: str, pose: ArrayLike) -> None:
        """(x, y, heading) or (x, y, z, heading). RunError where something stands."""
    def spawn(self, source: _File, pose: ArrayLike, name: str = "", *, controller: Optional[_Controller] = None,
              parameters: Optional[Mapping[str, Any]] = None) -> str:
        """Adds a model of the world's file, a file with one model, or "FILE#NAME"; returns its name."""
    def delete(self, name: str) -> None:
        """Removes it; arrays keep its row."""
    def record(self, file: _File, keyframe_interval: int = 100) -> None:
        """Records all that follows into a file as `troupe run --record` makes it; whole after stop_recording()."""
    def stop_recording(self) -> None: ...
    def save(self) -> Snapshot:
        """RunError if a controller cannot be copied."""
    def restore(self, snapshot: Snapshot) -> None:
        """The same steps from it give the same hashes."""
    @property
    def reports(self) -> List[str]:
        """Of the last call of step."""
    @property
    def messages(self) -> List[Tuple[int, str, str, Any]]:
        """What vehicles of VDA 5050 sent to their fleet control in the last call of step: tick, robot, topic, message."""
    @property
    def failures(self) -> List[str]:
        """A line for each controller that has failed."""
    def view(self, *, address: str = "127.0.0.1", port: int = 0, program: Optional[_File] = None) -> str:
        """Opens the page on this simulation, and returns its address. RunError without the program troupe."""
    def show(self, height: int = 500) -> Page:
        """The page of `view` in the cell of a notebook."""
    def close_view(self) -> None:
        """The page shows that the run is over."""

class RecordedStates:
    """The native part of troupe.Recording."""

    def __init__(self, file: _File) -> None: ...
    def __len__(self) -> int: ...
    def at(self, position: int) -> State: ...
    @property
    def ticks(self) -> NDArray[numpy.int64]: ...
    @property
    def damage(self) -> Optional[str]: ...
    @property
    def program_version(self) -> str: ...
    @property
    def world_file(self) -> str: ...

class VectorSimulation:
    """Many copies of one world, or worlds with equal numbers of robots, each with a seed, stepped together by all cores."""

    def __init__(self, world: Union[_World, Sequence[_World], Callable[[int], _World]], num_envs: Optional[int] = None, *,
                 seeds: Optional[Sequence[int]] = None, threads: int = 0, controller: Optional[_Controller] = None,
                 run_controllers: bool = True) -> None:
        """seeds: by default the file's (of a function 1) and the numbers after it. threads: 0 is one for each core."""

    def __len__(self) -> int: ...
    def __getitem__(self, index: int) -> Simulation: ...
    @property
    def num_envs(self) -> int: ...
    @property
    def num_robots(self) -> int: ...
    @property
    def threads(self) -> int: ...
    def step(self, ticks: int = 1) -> None: ...
    def drive(self, motion: ArrayLike, grippers: Optional[ArrayLike] = None) -> None:
        """(worlds, robots, 3) of vx, vy (m/s), wz (rad/s), or (worlds, robots, 2) of vx, wz.

        grippers: (worlds, grippers, 2) of opening (0 closes) and lift, percent; nan: as commanded last.
        """
    def held(self, out: Optional[numpy.ndarray[Any, Any]] = None) -> numpy.ndarray[Any, Any]:
        """(worlds, grippers): the number of the object that each holds, or -1."""
    def reset(self, which: Optional[ArrayLike] = None,
              snapshots: Union[None, Snapshot, Sequence[Snapshot]] = None) -> None:
        """which: a mask (worlds,) or numbers; None: all. To their start, or to the snapshots."""
    def save(self) -> List[Snapshot]: ...
    def poses(self, out: Optional[numpy.ndarray[Any, Any]] = None) -> numpy.ndarray[Any, Any]:
        """(worlds, robots, 4): x, y, z (m), heading (rad)."""
    def twists(self, out: Optional[numpy.ndarray[Any, Any]] = None) -> numpy.ndarray[Any, Any]:
        """(worlds, robots, 3): vx, vy (m/s), wz (rad/s)."""
    def stalls(self, out: Optional[numpy.ndarray[Any, Any]] = None) -> numpy.ndarray[Any, Any]:
        """(worlds, robots): 1 where a contact ended the last motion."""
    def object_poses(self, out: Optional[numpy.ndarray[Any, Any]] = None) -> numpy.ndarray[Any, Any]:
        """(worlds, objects, 4), as poses."""
    def joint_positions(self, out: Optional[numpy.ndarray[Any, Any]] = None) -> numpy.ndarray[Any, Any]:
        """(worlds, joints): m or rad."""
    def energy(self, out: Optional[numpy.ndarray[Any, Any]] = None) -> numpy.ndarray[Any, Any]:
        """(worlds, stores): J."""
    def ranges(self, sensor: _Robot = "ranger", out: Optional[numpy.ndarray[Any, Any]] = None) -> numpy.ndarray[Any, Any]:
        """(worlds, robots, rays), m."""
    def points(self, sensor: _Robot = "ranger", out: Optional[numpy.ndarray[Any, Any]] = None) -> numpy.ndarray[Any, Any]:
        """(worlds, robots, rays, 3): where the rays have hit, m in R; nan without a hit."""
    def receptions(self, sensor: _Robot = "radio") -> Dict[str, Any]:
        """The radio messages that arrive at this tick: columns (worlds, rows), "rows" (worlds,), and "data" as bytes."""
    def images(self, sensor: _Robot = "camera", out: Optional[NDArray[numpy.uint8]] = None) -> NDArray[numpy.uint8]:
        """(worlds, robots, height, width, 3)."""
    def depths(self, sensor: _Robot = "camera", out: Optional[NDArray[numpy.float32]] = None) -> NDArray[numpy.float32]:
        """(worlds, robots, height, width), m ahead."""
    def table(self, name: str) -> Dict[str, Union[numpy.ndarray[Any, Any], Tuple[Tuple[str, ...], ...]]]:
        """As Simulation.table, with the worlds as first axis: arrays (worlds, rows), and a tuple of texts for each world.

        "rows", int64 (worlds,): how many each world has; a world with fewer has nan or False in the others.
        """
    @property
    def state_hashes(self) -> NDArray[numpy.uint64]: ...
    @property
    def ticks(self) -> NDArray[numpy.int64]: ...

FORMULA_OPS: Tuple[str, ...]
FORMULA_INPUTS: Tuple[str, ...]

class Episodes:
    """The native part of troupe.rl.Episodes."""

    def __init__(self, worlds: VectorSimulation, sensor: Optional[str], task: Dict[str, Any]) -> None: ...
    def look(self, which: NDArray[numpy.bool_]) -> None:
        """Episodes have begun in the worlds of a mask: reads them."""
    def start(self, which: NDArray[numpy.bool_]) -> None:
        """Then sets their memory to its start, and observes."""
    def step(self, actions: ArrayLike, frozen: NDArray[numpy.bool_], idle: NDArray[numpy.bool_]) -> None:
        """Drives, steps, reads, rewards and observes all worlds but the idle ones."""
    @property
    def arrays(self) -> Dict[str, Any]:
        """By name; written at each step."""

_Outline = Sequence[Tuple[float, float]]
_Regions = Optional[Mapping[str, Union[_Outline, Tuple[_Outline, float]]]]

class Monitor:
    """Judges an expectation, tick by tick: docs/testing.md."""

    def __init__(self, simulation: State, text: str, regions: _Regions = None) -> None:
        """InputError with the column in `text`."""
    def push(self, simulation: State) -> None:
        """Adds the present tick; the same tick twice counts once."""
    def finish(self) -> None:
        """The run has ended: decides what has been open."""
    @property
    def text(self) -> str: ...
    @property
    def formula(self) -> str: ...
    @property
    def verdict(self) -> Optional[bool]:
        """None as long as later ticks can change it."""
    @property
    def decided_at(self) -> Optional[int]: ...
    @property
    def robustness(self) -> Tuple[float, float]:
        """(min, max), equal when it is known."""
    @property
    def cause(self) -> Tuple[Optional[int], Tuple[str, ...]]:
        """(tick, names): what decides the robustness so far."""
    @property
    def history(self) -> List[Tuple[int, float]]:
        """(tick, robustness) of the formula below the outermost temporal operator."""

class Metric:
    """A number of a run: docs/testing.md."""

    def __init__(self, simulation: State, text: str, regions: _Regions = None) -> None: ...
    def push(self, simulation: State) -> None: ...
    def finish(self) -> None: ...
    @property
    def text(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def value(self) -> Optional[float]:
        """After `finish`, in SI units; None if it does not exist."""

def pixels(file: bytes) -> NDArray[numpy.uint8]:
    """Of the bytes of a PNG file: (height, width, 3 or 4)."""

def watch(simulation: Simulation, ticks: int, monitors: Sequence[Union[Monitor, Metric]], stop: bool = False) -> None:
    """Steps, and adds each tick to the monitors, the present one first. stop: when an expectation is false."""
