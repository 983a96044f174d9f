"""For pytest: `*.test.json` files are tests, which `troupe test` runs, with their cases in several processes; the
message of a failing one has the shrunk case. Loaded by `-p troupe.pytest_plugin`, or by itself after `pip install`.

The program is TROUPE (a path), or `troupe` on the PATH.
"""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
from typing import Any, Iterator, Optional, Tuple

import pytest


class Failed(Exception):
    """The output of a test that has failed."""


class FleetTest(pytest.Item):
    """A file, with all its cases."""

    def runtest(self) -> None:
        program = os.environ.get("TROUPE") or shutil.which("troupe")
        if program is None:
            pytest.skip("found no program `troupe`: expected it on the PATH, or TROUPE to be its path")
        done = subprocess.run([program, "test", str(self.path)], capture_output=True, text=True)
        if done.returncode != 0:
            raise Failed(done.stdout + done.stderr)

    def repr_failure(self, excinfo: Any, style: Any = None) -> Any:
        return str(excinfo.value) if isinstance(excinfo.value, Failed) else super().repr_failure(excinfo)

    def reportinfo(self) -> Tuple[pathlib.Path, int, str]:
        return self.path, 0, self.path.name


class FleetTestFile(pytest.File):
    def collect(self) -> Iterator[FleetTest]:
        yield FleetTest.from_parent(self, name=self.path.name)


def pytest_collect_file(file_path: pathlib.Path, parent: Any) -> Optional[FleetTestFile]:
    if file_path.name.endswith(".test.json"):
        return FleetTestFile.from_parent(parent, path=file_path)
    return None
