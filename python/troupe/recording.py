"""Recordings of runs (`troupe run --record RUN.mcap`, docs/recording.md) as sequences of states.

    recording = troupe.Recording("run.mcap")
    recording[-1].poses                  # a State: what can be read of a Simulation
    recording.at_tick(100).events

States are stepped again from the recorded inputs, and compared with the recorded hashes; no controller runs.
"""

from __future__ import annotations

import operator
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Iterator, Optional, Union, overload

from ._troupe import RecordedStates, State

if TYPE_CHECKING:
    import numpy


class Recording(Sequence[State]):
    """The states of a recorded run, in their order. Positions count from 0; a slice is a Recording of these states.

    Any thread may use it. States in order are read quickest. InputError: the file is no recording, is damaged before its
    first tick, or was made by another version of the step; a state raises it where the file is damaged, or where the
    step leads to another state than the recorded one.
    """

    def __init__(self, file: Union[str, bytes, "os.PathLike[str]"]) -> None:
        self._states = RecordedStates(file)
        self._positions = range(len(self._states))
        self.file = os.fsdecode(file)

    def __len__(self) -> int:
        return len(self._positions)

    @overload
    def __getitem__(self, key: int) -> State: ...
    @overload
    def __getitem__(self, key: slice) -> "Recording": ...

    def __getitem__(self, key: Union[int, slice]) -> Union[State, "Recording"]:
        if isinstance(key, slice):
            part = Recording.__new__(Recording)
            part._states, part._positions, part.file = self._states, self._positions[key], self.file
            return part
        try:
            position = self._positions[operator.index(key)]
        except IndexError:
            raise IndexError(f"found state {key}, expected one of {len(self)}") from None
        return self._states.at(position)

    def __iter__(self) -> Iterator[State]:
        return map(self._states.at, self._positions)

    def __reversed__(self) -> Iterator[State]:
        return iter(self[::-1])

    def __repr__(self) -> str:
        return f"<troupe.Recording {self.file!r}: {len(self)} states>"

    @property
    def ticks(self) -> "numpy.ndarray[Any, Any]":
        """int64 (states,): of each state. They ascend, but an edit of the run keeps the tick or sets it back."""
        return self._states.ticks[list(self._positions)] if self._positions else self._states.ticks[:0]

    def at_tick(self, tick: int) -> State:
        """The last of these states with a tick. IndexError if there is none."""
        return self[self.position(tick)]

    def position(self, tick: int) -> int:
        """The position of the last of these states with a tick. IndexError if there is none."""
        ticks = self.ticks
        found = (ticks == operator.index(tick)).nonzero()[0]
        if not len(found):
            some = f", expected one of {ticks.min()} to {ticks.max()}" if len(ticks) else ""
            raise IndexError(f"found tick {tick}{some}")
        return int(found[-1])

    @property
    def damage(self) -> Optional[str]:
        """Why the states end before the run; None: they do not."""
        return self._states.damage

    @property
    def program_version(self) -> str:
        """Of the program that has recorded it."""
        return self._states.program_version

    @property
    def world_file(self) -> str:
        """The world or scenario, as the run was given it."""
        return self._states.world_file
