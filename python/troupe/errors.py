"""Errors: what troupe raises, beside Python's own errors for wrong arguments (TypeError, ValueError, IndexError).

The two kinds are the exit statuses 2 and 3 of the programs: input that its author must change, and work that failed. The
arguments of an exception are all that it has, so that it can be pickled, from a worker process for instance.
"""

from __future__ import annotations

from typing import Optional


class Error(Exception):
    """The base of all errors of troupe. Its text is `file:line:column: error: message`."""

    def __init__(self, message: str, file: Optional[str] = None, line: Optional[int] = None,
                 column: Optional[int] = None, text: Optional[str] = None) -> None:
        super().__init__(message, file, line, column, text)
        self.message = message  # what was found, and what was expected
        self.file = file  # the place in a user's file; None: unknown
        self.line = line  # from 1
        self.column = column

    def __str__(self) -> str:
        return self.args[4] or self.message


class InputError(Error):
    """A file, a scenario or a command is wrong."""


class RunError(Error):
    """The input is good, but the work cannot be done: no memory, a full disk, a controller that cannot be copied."""
