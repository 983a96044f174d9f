"""The types of the package, as a user's type checker sees them: a program without an error, and one with mistakes."""

import os
import re
import subprocess
import sys
import tempfile
import unittest

import troupe
from support import ROOT

TYPES = ROOT / "tests/python/types"


def check(file):
    """(exit status, output) of mypy, which says nothing of an installed package's own sources."""
    package = os.path.dirname(os.path.dirname(troupe.__file__))
    done = subprocess.run(["/usr/bin/mypy", "--strict", "--follow-imports=silent", "--cache-dir", os.devnull,
                           "--python-executable", "/usr/bin/python3", TYPES / file],
                          env={**os.environ, "MYPYPATH": package, "PYTHONPATH": ""}, text=True, capture_output=True, timeout=200)
    return done.returncode, done.stdout + done.stderr


@unittest.skipUnless(os.path.exists("/usr/bin/mypy"), "no mypy")
class Types(unittest.TestCase):
    def test_a_program_has_no_error_and_runs(self):
        status, output = check("user_program.py")
        self.assertEqual(status, 0, output)
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, TYPES / "user_program.py"], cwd=folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_each_mistake_is_found_at_its_line(self):
        status, output = check("mistakes.py")
        self.assertEqual(status, 1, output)
        lines = (TYPES / "mistakes.py").read_text().splitlines()
        planted = {number for number, line in enumerate(lines, 1) if "  # " in line}
        self.assertGreater(len(planted), 4)
        self.assertEqual({int(line) for line in re.findall(r"^.*mistakes\.py:(\d+): error", output, re.MULTILINE)}, planted)


if __name__ == "__main__":
    unittest.main()
