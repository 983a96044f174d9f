"""What the library python_controllers.so calls: makes and copies controllers, and describes their exceptions.

It is Python and not C++, because loading modules, copying objects and reading tracebacks are Python's own. All functions are
called with the interpreter's lock. A file is loaded once for all robots, and again after it has changed; robots share the
classes of its module, never instances.
"""

from __future__ import annotations

import copy
import importlib.util
import os
import sys
import zlib
from types import ModuleType, TracebackType
from typing import Any, Dict, Optional, Sequence, Tuple

from .records import RobotInfo

_modules: Dict[str, Tuple[Tuple[int, int], ModuleType]] = {}  # by path


def _load(file: str) -> ModuleType:
    path = os.path.realpath(file)
    status = os.stat(path)
    version = (status.st_mtime_ns, status.st_size)  # a notebook may have changed the file
    if path in _modules and _modules[path][0] == version:
        return _modules[path][1]
    folder, name = os.path.split(path)
    if folder not in sys.path:
        sys.path.append(folder)  # for the modules beside it
    # A name of its own, by which `pickle` and `copy` find its classes.
    name = f"troupe_controller_{os.path.splitext(name)[0]}_{zlib.crc32(path.encode()):08x}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    _modules[path] = (version, module)
    return module


def make(file: str, name: str, robot: RobotInfo) -> Any:
    """An instance of the class `name` of the file, with the robot's parameters as keyword arguments."""
    module = _load(file)
    kind = getattr(module, name, None)
    if not isinstance(kind, type) or not callable(getattr(kind, "update", None)):
        found = [key for key, value in vars(module).items()
                 if isinstance(value, type) and value.__module__ == module.__name__ and hasattr(value, "update")]
        raise ValueError(f"{os.path.basename(file)} has no class {name} with a method 'update', "
                         f"found: {', '.join(found) or 'none'}")
    return kind(robot, **robot.parameters)


def subscriptions(controller: Any) -> Sequence[int]:
    sensors = getattr(controller, "subscriptions", ())
    return sensors() if callable(sensors) else sensors


def accepts_goals(controller: Any) -> bool:
    return bool(getattr(controller, "accepts_goals", False))


def clone(controller: Any) -> Any:
    # The whole memory of a controller: a snapshot and its original must not share a list.
    return copy.deepcopy(controller)


def describe(error: Optional[BaseException], trace: Optional[TracebackType], file: str) -> str:
    """ "patrol.py:12: ZeroDivisionError: division by zero": the innermost line of the user's file."""
    path, line = os.path.realpath(file), 0
    name, text = os.path.basename(file), str(error)
    if isinstance(error, SyntaxError) and error.filename:
        name, line, text = os.path.basename(error.filename), error.lineno or 0, error.msg
    while trace is not None:
        if os.path.realpath(trace.tb_frame.f_code.co_filename) == path:
            line = trace.tb_lineno
        trace = trace.tb_next
    place = f"{name}:{line}: " if line else ""
    return f"{place}{type(error).__name__}: {text}" if text else f"{place}{type(error).__name__}"
