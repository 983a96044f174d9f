"""What the library python_controllers.so calls: makes and copies controllers, and describes their exceptions.

It is Python and not C++, because loading modules, copying objects and reading tracebacks are Python's own. All functions are
called with the interpreter's lock. A file is loaded once for all robots, and again after it, or a module beside it, has
changed; robots share the classes of its module, never instances.

A controller imports the modules in its folder by their names. Two folders may have modules of one name, and a process may have
controllers of both: so each folder is a package of its own, and an `import` in one of its files looks there first, as in a
script that is started from there.
"""

from __future__ import annotations

import builtins
import copy
import importlib
import importlib.abc
import importlib.machinery
import importlib.util
import os
import sys
import zlib
from types import ModuleType, TracebackType
from typing import Any, Dict, Optional, Sequence, Tuple

from . import _cell
from .records import RobotInfo

_PREFIX = "troupe_controllers_"


class _Loader(importlib.machinery.SourceFileLoader):
    """Of a file in a folder of controllers."""

    folder: "_Folder"

    def exec_module(self, module: ModuleType) -> None:
        status = os.stat(self.path)
        self.folder.versions[self.path] = (status.st_mtime_ns, status.st_size)
        module.__dict__["__builtins__"] = {**vars(builtins), "__import__": self.folder.import_module}
        super().exec_module(module)

    def get_code(self, fullname: str) -> Any:
        # Of the source: the bytecode beside it is known by a time in whole seconds.
        return self.source_to_code(self.get_data(self.path), self.path)


class _Folder:
    """A folder of controllers, as a package whose name no other folder has."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.name = f"{_PREFIX}{zlib.crc32(path.encode()):08x}"
        self.versions: Dict[str, Tuple[int, int]] = {}  # of the loaded files, by path

    def load(self, file: str) -> ModuleType:
        if any(not _is_version(path, version) for path, version in self.versions.items()):
            self.forget()
        if self.name not in sys.modules:
            package = ModuleType(self.name)
            package.__path__ = [self.path]
            sys.modules[self.name] = package
        name = f"{self.name}.{os.path.splitext(file)[0].replace('.', '_')}"
        if name not in sys.modules:
            loader = self.loader(name, os.path.join(self.path, file))
            spec = importlib.util.spec_from_file_location(name, loader.path, loader=loader)
            assert spec is not None
            sys.modules[name] = importlib.util.module_from_spec(spec)
            try:
                loader.exec_module(sys.modules[name])
            except BaseException:
                self.forget()  # all of it is tried again
                raise
        return sys.modules[name]

    def loader(self, name: str, path: str) -> _Loader:
        loader = _Loader(name, path)
        loader.folder = self
        return loader

    def forget(self) -> None:
        self.versions.clear()
        for name in [name for name in sys.modules if name == self.name or name.startswith(f"{self.name}.")]:
            del sys.modules[name]
        importlib.invalidate_caches()

    def has(self, name: str) -> bool:
        path = os.path.join(self.path, name)
        return os.path.exists(f"{path}.py") or os.path.exists(os.path.join(path, "__init__.py"))

    def import_module(self, name: str, scope: Any = None, local: Any = None, fromlist: Any = (), level: int = 0) -> Any:
        """As builtins.__import__."""
        top = name.partition(".")[0]
        if level > 0 or not self.has(top):
            return builtins.__import__(name, scope, local, fromlist, level)
        if fromlist:
            return builtins.__import__(f"{self.name}.{name}", scope, local, fromlist, 0)
        importlib.import_module(f"{self.name}.{name}")
        return sys.modules[f"{self.name}.{top}"]


def _is_version(path: str, version: Tuple[int, int]) -> bool:
    try:
        status = os.stat(path)
    except OSError:
        return False
    return version == (status.st_mtime_ns, status.st_size)  # a notebook may have changed the file


class _Finder(importlib.abc.MetaPathFinder):
    """Of the modules of all folders."""

    def __init__(self) -> None:
        self.folders: Dict[str, _Folder] = {}  # by name

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> Any:
        folder = self.folders.get(fullname.partition(".")[0])
        if folder is None or path is None:
            return None
        spec = importlib.machinery.PathFinder.find_spec(fullname, path)
        if spec is not None and type(spec.loader) is importlib.machinery.SourceFileLoader:
            spec.loader = folder.loader(spec.loader.name, spec.loader.path)
        return spec


_finder = _Finder()
sys.meta_path.insert(0, _finder)


def _load(file: str) -> ModuleType:
    path, name = os.path.split(os.path.realpath(file))
    folder = _Folder(path)
    return _finder.folders.setdefault(folder.name, folder).load(name)


def _is_cell(file: str) -> bool:
    return os.path.realpath(file) == os.path.realpath(_cell.__file__)


def make(file: str, name: str, robot: RobotInfo) -> Any:
    """An instance of the class `name` of the file, with the robot's parameters as keyword arguments."""
    if _is_cell(file):
        return _cell.find(name)(robot, **robot.parameters)
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
    """ "patrol.py:12: ZeroDivisionError: division by zero": the innermost line of a file in the folder of the user's."""
    folder, line = os.path.dirname(os.path.realpath(file)), 0
    name, text = os.path.basename(file), str(error)
    cells = _cell.files() if _is_cell(file) else set()
    while trace is not None:
        code_file = trace.tb_frame.f_code.co_filename
        path = os.path.realpath(code_file)
        if code_file in cells:
            name, line = os.path.basename(code_file), trace.tb_lineno
        elif not cells and path.startswith(os.path.join(folder, "")) and path.endswith(".py"):
            name, line = os.path.relpath(path, folder), trace.tb_lineno
        trace = trace.tb_next
    if isinstance(error, SyntaxError) and error.filename:
        name, line, text = os.path.basename(error.filename), error.lineno or 0, error.msg
    place = f"{name}:{line}: " if line else ""
    return f"{place}{type(error).__name__}: {text}" if text else f"{place}{type(error).__name__}"
