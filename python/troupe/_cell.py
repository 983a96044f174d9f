"""Controllers that are classes of this process: of a cell of a notebook, or of a script.

A world names a controller as FILE.py:CLASS. That of such a class is this file, with the number of the class: other processes
do not have it.
"""

from __future__ import annotations

import inspect
from typing import Any, Dict, List, Set

_classes: List[type] = []  # that were named, each once
_numbers: Dict[type, int] = {}


def name_of(kind: Any) -> str:
    """The name by which this process finds the class."""
    if not isinstance(kind, type) or not callable(getattr(kind, "update", None)):
        raise TypeError(f"controller: found {kind!r}, expected a name, or a class with a method 'update'")
    if kind not in _numbers:
        _numbers[kind] = len(_classes)
        _classes.append(kind)
    return f"{__file__}:{kind.__name__}-{_numbers[kind]}"


def find(name: str) -> type:
    number = name.rpartition("-")[2]
    if not number.isdigit() or int(number) >= len(_classes):
        raise ValueError(f"{name} is a class of another process, expected FILE.py:CLASS")
    return _classes[int(number)]


def files() -> Set[str]:
    """Where the methods of these classes are written; those of a cell have a name like "<ipython-input-3>"."""
    return {file for kind in _classes for file in _files_of(kind)}


def _files_of(kind: type) -> Set[str]:
    return {value.__code__.co_filename for value in vars(kind).values() if inspect.isfunction(value)}


def file_name_of(kind: Any) -> str:
    """FILE.py:CLASS. Raises ValueError for a class that no file has."""
    name_of(kind)
    try:
        file = inspect.getsourcefile(kind)
    except (OSError, TypeError):
        file = None
    if file is None or not file.endswith(".py") or "." in kind.__qualname__ or not _files_of(kind) <= {file}:
        raise ValueError(f"the class {kind.__qualname__} is of no file, expected one that other processes can load")
    return f"{file}:{kind.__name__}"
