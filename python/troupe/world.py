"""World: a world from code. It is a scenario (docs/scenarios.md) with functions that add to it.

    world = troupe.World()
    world.wall((-3, -2), (3, -2), (3, 2), (-3, 2), closed=True)
    world.robot("anna", (0, 0, 0), controller="wander")
    sim = troupe.Simulation(world)

Metres, radians and seconds here, as everywhere in the package; the scenario itself has degrees.
"""

from __future__ import annotations

import copy
import json
import math
import os
import shutil
import tempfile
import zlib
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy

from . import _cell

if TYPE_CHECKING:
    from os import PathLike

_Path = Union[str, "PathLike[str]"]
_Point = Sequence[float]
_Controller = Union[None, str, type, Mapping[str, Any]]


class World:
    """A world that is described by code: for Simulation, VectorSimulation, or a file (`save`).

    `scenario` is the description, a dict with the keys of docs/scenarios.md, to be read and changed: all that has no function
    here is done there, as `world.scenario["regions"] = [...]`. All functions return the world, and raise ValueError for an
    argument that is no number or out of range; what does not fit together is an InputError of Simulation.
    """

    def __init__(self, base: Optional[_Path] = None, *, name: Optional[str] = None, interval: Optional[float] = None,
                 seed: Optional[int] = None, include: Sequence[_Path] = ("robots.inc", "furniture.inc", "grippers.inc")
                 ) -> None:
        """base: a file to begin with, .world or .yaml. interval: s, of a tick, 0.1 by default. include: files with models."""
        self.scenario: Dict[str, Any] = {}
        self._maps: Dict[str, Tuple[numpy.ndarray[Any, Any], float, Tuple[float, float, float], float]] = {}
        self._counts: Dict[str, int] = {}  # of names that were made from one
        if base is not None:
            self.scenario["world"] = os.fspath(base)
        if include:
            self.scenario["include"] = [os.fspath(file) for file in include]
        if name is not None:
            self.scenario["name"] = name
        if seed is not None:
            self.scenario["seed"] = int(seed)
        if interval is not None:
            self.scenario["properties"] = {"interval_sim": 1000 * _positive(interval, "interval")}

    # Bodies.

    def wall(self, *points: _Point, thickness: float = 0.1, height: float = 1.0, closed: bool = False,
             color: str = "gray30", name: str = "wall") -> "World":
        """Walls from point (x, y) to point; closed: and back to the first one."""
        corners = [_numbers(point, (2,), "a point (x, y)") for point in points]
        if closed:
            corners.append(corners[0])
        if len(corners) < 2:
            raise ValueError(f"wall: found {len(corners)} points, expected 2 or more")
        width = _positive(thickness, "thickness")
        for (x, y), (to_x, to_y) in zip(corners, corners[1:]):
            length = math.hypot(to_x - x, to_y - y)
            # Half a thickness longer at each end: two walls meet without a gap.
            self.box(((x + to_x) / 2, (y + to_y) / 2, math.atan2(to_y - y, to_x - x)),
                     (length + width, width, height), color=color, name=name)
        return self

    def box(self, pose: _Point, size: _Point, *, movable: bool = False, color: Optional[str] = None,
            name: str = "box") -> "World":
        """A box at (x, y, heading) or (x, y, z, heading), of (x, y, z) metres. movable: grippers may lift it."""
        length, width, height = (_positive(part, "size") for part in _numbers(size, (3,), "a size (x, y, z)"))
        return self._body("model", pose, {"size": [length, width, height]}, [], movable, color, name)

    def block(self, points: Sequence[_Point], *, z: Tuple[float, float] = (0.0, 1.0), movable: bool = False,
              color: Optional[str] = None, name: str = "block") -> "World":
        """A body with the outline of `points` (x, y) in the world, at the heights `z`, from and to, m."""
        outline = numpy.array([_numbers(point, (2,), "a point (x, y)") for point in points])
        if len(outline) < 3:
            raise ValueError(f"block: found {len(outline)} points, expected 3 or more")
        low, high = outline.min(axis=0), outline.max(axis=0)
        # A body is stretched to its size, so that of the outline leaves it as it is.
        middle, size = (low + high) / 2, high - low
        bottom, top = _numbers(z, (2,), "heights (from, to)")
        properties: Dict[str, Any] = {"points": len(outline), "z": [0.0, _positive(top - bottom, "height")]}
        for i, point in enumerate(outline - middle):
            properties[f"point[{i}]"] = [float(part) for part in point]
        children = [{"model": "block", "properties": properties}]
        return self._body("model", (*middle, bottom, 0.0), {"size": [*map(float, size), top - bottom]}, children, movable,
                          color, name)

    def model(self, model: str, pose: _Point, *, name: Optional[str] = None, children: Sequence[Mapping[str, Any]] = (),
              **properties: Any) -> "World":
        """A model of an included file, such as "table", with properties of docs/world-files.md (in its units)."""
        entry = _entry(model, pose, properties, children)
        if name is not None:
            entry["name"] = self._free_name(name)
        return self._add("models", entry)

    def map(self, occupied: Any, resolution: float = 0.05, *, origin: _Point = (0.0, 0.0, 0.0), height: float = 2.0,
            name: str = "map") -> "World":
        """Walls from an array (rows, columns): where it is True, or not 0.

        As in an occupancy grid of ROS, row 0 is the lowest in y; `numpy.flipud` turns an image. resolution: m, of a cell.
        origin: (x, y) or (x, y, heading) of the lower left corner.
        """
        cells = numpy.asarray(occupied)
        if cells.ndim != 2 or cells.size == 0:
            raise ValueError(f"map: found an array of shape {cells.shape}, expected (rows, columns)")
        corner = _numbers(origin, (2, 3), "an origin (x, y) or (x, y, heading)")
        name = self._free_name(name)
        self._maps[name] = (cells.astype(bool), _positive(resolution, "resolution"),
                            (corner[0], corner[1], corner[2] if len(corner) == 3 else 0.0), _positive(height, "height"))
        return self._add("models", {"model": "model", "name": name, "properties": {"map_yaml": name + ".yaml"}})

    # What moves.

    def robot(self, name: str, pose: _Point, model: str = "scout", *, controller: _Controller = None,
              parameters: Optional[Mapping[str, Any]] = None, children: Sequence[Mapping[str, Any]] = (),
              **properties: Any) -> "World":
        """A robot at (x, y, heading) or (x, y, z, heading).

        model: a define of an included file (scout, porter, cart ...) or "position". controller: a name, FILE.py:CLASS, or a
        class. children: parts such as `lidar()`. properties: of docs/world-files.md, in its units.
        """
        entry = _entry(model, pose, properties, children)
        entry["name"] = name
        _set_controller(entry, controller, parameters)
        return self._add("robots", entry)

    def robots(self, count: int, region: Sequence[Any], model: str = "scout", *, prefix: Optional[str] = None,
               controller: _Controller = None, parameters: Optional[Mapping[str, Any]] = None,
               **rule: Any) -> "World":
        """Robots at free places by chance in a region: (xmin, ymin, xmax, ymax) or a polygon. rule: keys of "spawn"."""
        entry: Dict[str, Any] = {"model": model, "count": int(count), "region": _plain(region), **rule}
        if prefix is not None:
            entry["name_prefix"] = prefix
        _set_controller(entry, controller, parameters)
        return self._add("spawn", entry)

    def people(self, count: int, region: Sequence[Any], goals: Sequence[Any] = (), **rule: Any) -> "World":
        """People at free places by chance in a region, who walk to goals: (x, y), (x, y, z) or names of places.

        rule: further keys of "people" in docs/scenarios.md: wait, speed, reaction, group ...
        """
        entry: Dict[str, Any] = {"count": int(count), "region": _plain(region), **rule}
        if len(goals) > 0:
            entry["goals"] = [_plain(goal) for goal in goals]
        return self._add("people", entry)

    def place(self, name: str, pose: _Point) -> "World":
        """A pose with a name, as a goal of people and of tools."""
        return self._add("places", {"name": name, "pose": _degrees(pose)})

    # Its text.

    def copy(self) -> "World":
        """Another one, to be changed."""
        other = copy.copy(self)
        other.scenario = _deep_copy(self.scenario)
        other._maps = dict(self._maps)
        other._counts = dict(self._counts)
        return other

    def save(self, file: _Path) -> None:
        """Writes the scenario (.json), and its maps beside it. ValueError for a controller that no file has."""
        path = os.path.abspath(os.fspath(file))
        if not path.endswith(".json"):
            raise ValueError(f"found {path}, expected a name that ends in .json")
        scenario = _deep_copy(self.scenario)
        folder = os.path.dirname(path)
        _place_paths(scenario, lambda name: os.path.relpath(name, folder) if os.path.exists(name) else name)
        prefix = os.path.splitext(os.path.basename(path))[0] + "_"
        text = _text(scenario, self._maps, lambda name: prefix + name + ".yaml", _cell.file_name_of)
        for name in self._maps:
            _write_map(folder, prefix + name, *self._maps[name])
        with open(path, "w", encoding="utf-8") as out:
            out.write(text + "\n")

    def __repr__(self) -> str:
        count = {key: len(self.scenario.get(key, ())) for key in ("models", "robots", "spawn", "people")}
        return f"<troupe.World: {', '.join(f'{number} {key}' for key, number in count.items() if number)}>"

    def _repr_png_(self) -> bytes:
        from ._troupe import Simulation
        return Simulation(self, run_controllers=False)._repr_png_()

    def _body(self, model: str, pose: _Point, properties: Dict[str, Any], children: List[Dict[str, Any]], movable: bool,
              color: Optional[str], name: str) -> "World":
        if movable:
            properties["gripper_return"] = 1
        if color is not None:
            properties["color"] = color
        entry = _entry(model, pose, properties, children)
        entry["name"] = self._free_name(name)
        return self._add("models", entry)

    def _add(self, key: str, entry: Dict[str, Any]) -> "World":
        self.scenario.setdefault(key, []).append(entry)
        return self

    def _free_name(self, name: str) -> str:
        """The name, or the first of name0, name1, ... that was not made before."""
        if name in self._counts:
            number = self._counts[name]
            self._counts[name] = number + 1
            return f"{name}{number}"
        self._counts[name] = 0
        used = {entry.get("name") for key in ("models", "robots") for entry in self.scenario.get(key, ())}
        return self._free_name(name) if name in used else name


def lidar(range: float = 8.0, fov: float = 2 * math.pi, samples: int = 180, *, z: Optional[float] = None,
          **properties: Any) -> Dict[str, Any]:
    """A ranger for `World.robot(..., children=[lidar()])`: range in m, fov in rad."""
    sensor = {"range": [0.0, _positive(range, "range")], "fov": math.degrees(_positive(fov, "fov")), "samples": int(samples),
              **properties}
    part: Dict[str, Any] = {"model": "ranger", "children": [{"model": "sensor", "properties": sensor}]}
    if z is not None:
        part["pose"] = [0.0, 0.0, float(z), 0.0]
    return part


class WorldText:
    """What the native part loads of a dict, a World, or a function of the seed that returns one of them."""

    def __init__(self, world: Any, seed: Optional[int] = None) -> None:
        if callable(world):
            world = world(seed)
        maps: Dict[str, Any] = {}
        if isinstance(world, World):
            maps, world = world._maps, world.scenario
        if not isinstance(world, Mapping):
            raise TypeError(f"world: found {type(world).__name__}, expected a path, a dict (a scenario) or a troupe.World")
        world = {"name": "world", **world}
        self.path = "<world>"  # in messages; paths start at the working directory
        self._folder = tempfile.mkdtemp(prefix="troupe-") if maps else None
        folder = self._folder or ""
        self.scenario = _text(_deep_copy(world), maps, lambda name: os.path.join(folder, name + ".yaml"), _cell.name_of)
        for name in maps:
            _write_map(folder, name, *maps[name])

    def __del__(self) -> None:
        # It was read: a world holds no file.
        folder = getattr(self, "_folder", None)
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)


def _deep_copy(value: Any) -> Any:
    """Of dicts and lists alone: classes of controllers stay as they are."""
    if isinstance(value, Mapping):
        return {key: _deep_copy(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_deep_copy(each) for each in value]
    return value


def _text(scenario: Dict[str, Any], maps: Mapping[str, Any], map_file: Callable[[str], str],
          controller_name: Callable[[Any], str]) -> str:
    for entry in scenario.get("models", ()):
        if isinstance(entry, dict) and entry.get("name") in maps:
            entry["properties"]["map_yaml"] = map_file(entry["name"])

    def encode(value: Any) -> Any:
        if isinstance(value, (numpy.generic, numpy.ndarray)):
            return value.tolist()
        if isinstance(value, os.PathLike):
            return os.fspath(value)
        return controller_name(value)  # a TypeError for all that is no class

    return json.dumps(scenario, indent=1, default=encode, allow_nan=False)


def _place_paths(scenario: Dict[str, Any], place: Callable[[str], str]) -> None:
    if "world" in scenario:
        scenario["world"] = place(scenario["world"])
    if "include" in scenario:
        scenario["include"] = [place(file) for file in scenario["include"]]


def _write_map(folder: str, name: str, occupied: numpy.ndarray[Any, Any], resolution: float, origin: Tuple[float, float, float],
               height: float) -> None:
    with open(os.path.join(folder, name + ".png"), "wb") as image:
        image.write(_png(numpy.where(occupied[::-1], 0, 255).astype(numpy.uint8)))
    with open(os.path.join(folder, name + ".yaml"), "w", encoding="utf-8") as text:
        text.write(f"image: {name}.png\nresolution: {resolution!r}\norigin: [{', '.join(map(repr, origin))}]\nnegate: 0\n"
                   f"occupied_thresh: 0.65\nfree_thresh: 0.196\nwall_height: {height!r}\n")


def _png(grey: numpy.ndarray[Any, Any]) -> bytes:
    def chunk(kind: bytes, content: bytes) -> bytes:
        body = kind + content
        return len(content).to_bytes(4, "big") + body + zlib.crc32(body).to_bytes(4, "big")

    rows, columns = grey.shape
    header = columns.to_bytes(4, "big") + rows.to_bytes(4, "big") + bytes((8, 0, 0, 0, 0))  # 8 bits of grey
    filtered = numpy.zeros((rows, columns + 1), numpy.uint8)  # each row after the number of its filter, none
    filtered[:, 1:] = grey
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(filtered.tobytes(), 6)) +
            chunk(b"IEND", b""))


def _entry(model: str, pose: _Point, properties: Mapping[str, Any], children: Sequence[Mapping[str, Any]]
           ) -> Dict[str, Any]:
    entry: Dict[str, Any] = {"model": model, "pose": _degrees(pose)}
    if properties:
        entry["properties"] = {key: _plain(value) for key, value in properties.items()}
    if children:
        entry["children"] = [_deep_copy(child) for child in children]
    return entry


def _set_controller(entry: Dict[str, Any], controller: _Controller, parameters: Optional[Mapping[str, Any]]) -> None:
    if controller is None:
        if parameters:
            raise ValueError("parameters: found some without a controller")
        return
    entry["controller"] = {"name": controller, "parameters": dict(parameters)} if parameters else controller


def _degrees(pose: _Point) -> List[float]:
    numbers = _numbers(pose, (3, 4), "a pose (x, y, heading) or (x, y, z, heading)")
    return [*numbers[:-1], math.degrees(numbers[-1])]


def _numbers(values: Any, lengths: Tuple[int, ...], what: str) -> List[float]:
    try:
        numbers = [float(value) for value in values]
    except (TypeError, ValueError):
        numbers = []
    if len(numbers) not in lengths or not all(map(math.isfinite, numbers)):
        raise ValueError(f"found {values!r}, expected {what}")
    return numbers


def _positive(value: Any, what: str) -> float:
    number = _numbers((value,), (1,), f"a number for {what}")[0]
    if number <= 0:
        raise ValueError(f"{what}: found {number}, expected more than 0")
    return number


def _plain(value: Any) -> Any:
    if isinstance(value, (numpy.generic, numpy.ndarray)):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    return value
