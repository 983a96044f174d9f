"""The types of the package, as a user's type checker sees them: a program without an error, and one with mistakes."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import troupe
from support import ROOT

TYPES = ROOT / "tests/python/types"


def pyright_of_npm():
    """The program, or None. npm installs it the first time, which needs a network."""
    folder = ROOT / "build/pyright"
    program = folder / "node_modules/.bin/pyright"
    if not program.exists() and shutil.which("node") and shutil.which("npm"):
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / "tests/peers/pyright/package.json", folder)
        try:
            subprocess.run(["npm", "install", "--prefix", folder, "--no-audit", "--no-fund", "--silent"], capture_output=True,
                           check=False, timeout=100)
        except subprocess.TimeoutExpired:
            pass
    return program if program.exists() else shutil.which("pyright")


PYRIGHT = pyright_of_npm()


def mypy(file):
    """(exit status, output) of mypy, which says nothing of an installed package's own sources."""
    package = os.path.dirname(os.path.dirname(troupe.__file__))
    done = subprocess.run(["/usr/bin/mypy", "--strict", "--follow-imports=silent", "--cache-dir", os.devnull,
                           "--python-executable", "/usr/bin/python3", TYPES / file],
                          env={**os.environ, "MYPYPATH": package, "PYTHONPATH": ""}, text=True, capture_output=True, timeout=200)
    return done.returncode, done.stdout + done.stderr


def pyright(file):
    """The same of pyright, in its strict mode."""
    package = os.path.dirname(os.path.dirname(troupe.__file__))
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(TYPES / file, folder)
        # Numbers of arrays are of no known type in numpy's own stubs.
        settings = {"include": [file], "extraPaths": [package], "typeCheckingMode": "strict", "useLibraryCodeForTypes": False,
                    **{f"reportUnknown{kind}Type": False for kind in ("Member", "Variable", "Argument", "Parameter")}}
        (pathlib.Path(folder) / "pyrightconfig.json").write_text(json.dumps(settings))
        done = subprocess.run([PYRIGHT, "--pythonpath", "/usr/bin/python3", "--project", folder], cwd=folder, text=True,
                              capture_output=True, timeout=200)
    return done.returncode, done.stdout + done.stderr


CHECKERS = [check for check, program in ((mypy, os.path.exists("/usr/bin/mypy")), (pyright, PYRIGHT)) if program]


@unittest.skipUnless(CHECKERS, "no mypy and no pyright")
class Types(unittest.TestCase):
    def test_a_program_has_no_error_and_runs(self):
        for check in CHECKERS:
            status, output = check("user_program.py")
            self.assertEqual(status, 0, output)
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, TYPES / "user_program.py"], cwd=folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_each_mistake_is_found_at_its_line(self):
        lines = (TYPES / "mistakes.py").read_text().splitlines()
        planted = {number for number, line in enumerate(lines, 1) if "  # " in line}
        self.assertGreater(len(planted), 4)
        for check in CHECKERS:
            status, output = check("mistakes.py")
            self.assertEqual(status, 1, output)
            found = {int(line) for line in re.findall(r"^.*mistakes\.py:(\d+):(?:\d+ -)? error", output, re.MULTILINE)}
            self.assertEqual(found, planted, output)


if __name__ == "__main__":
    unittest.main()
