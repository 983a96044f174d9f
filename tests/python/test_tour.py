"""Runs the code of docs/python.md, and the examples. Without the program troupe, as after `pip install`, the code that needs it
is left out."""
import importlib.util
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

from support import PROGRAMS, ROOT


def blocks(text):
    """(language, file or "", code, line) of each block of code."""
    program = shutil.which("troupe", path=f"{PROGRAMS}:{os.environ['PATH']}")
    pattern = r"^```(python|json|sh)(?: file=(\S+)| needs=(\w+))?\n(.*?)^```"
    for match in re.finditer(pattern, text, re.MULTILINE | re.DOTALL):
        # The program troupe, or a package for Python.
        if not match[3] or (program if match[3] == "troupe" else importlib.util.find_spec(match[3])):
            yield match[1], match[2] or "", match[4], text.count("\n", 0, match.start()) + 1


class Tour(unittest.TestCase):
    def test_the_page_runs(self):
        page = ROOT / "docs/python.md"
        found = list(blocks(page.read_text()))
        self.assertGreater(len(found), 10)
        code = ""
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(ROOT / "worlds", os.path.join(folder, "worlds"))
            for language, file, text, line in found:
                if file:
                    (pathlib.Path(folder) / file).write_text(text)
                elif language == "sh":
                    for command in filter(re.compile("troupe run ").match, text.splitlines() if PROGRAMS.exists() else []):
                        subprocess.run([PROGRAMS / "troupe", *shlex.split(command)[1:]], cwd=folder, check=True,
                                       stdout=subprocess.DEVNULL)
                elif language == "python":
                    code += "\n" * (line - code.count("\n")) + text
            script = os.path.join(folder, "tour.py")
            pathlib.Path(script).write_text(code)
            done = subprocess.run([sys.executable, script], cwd=folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, f"lines are those of {page}\n{done.stdout}{done.stderr}")
            self.assertIn("<troupe.Simulation 'swarm': 100 robots, tick 100", done.stdout)
            self.assertIn("worlds/none.world", done.stdout)
            self.assertEqual("http://127.0.0.1:" in done.stdout, any("needs=troupe" in line for line in page.read_text().splitlines())
                             and PROGRAMS.exists())
            for picture in ("swarm.png", "swarm.svg"):
                self.assertGreater(os.path.getsize(os.path.join(folder, picture)), 1000)

    def test_the_page_of_learning_runs(self):
        page = ROOT / "docs/learning.md"
        code = ""
        for language, file, text, line in blocks(page.read_text()):
            if language == "python":
                code += "\n" * (line - code.count("\n")) + text
        self.assertIn("class Race", code)
        done = subprocess.run([sys.executable, "-c", code], cwd=tempfile.gettempdir(), capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, f"lines are those of {page}\n{done.stdout}{done.stderr}")

    def test_the_page_shows_the_example(self):
        shown = {file: text for _, file, text, _ in blocks((ROOT / "docs/python.md").read_text()) if file}
        scenario = json.loads((ROOT / "examples/python/patrol.json").read_text())
        self.assertEqual(json.loads(shown["patrol.json"])["spawn"][0]["controller"], scenario["spawn"][0]["controller"])

    def test_the_examples_run(self):
        examples = ROOT / "examples/python"
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, examples / "drive.py", ROOT / "worlds/scenarios/swarm.json", "x.png"],
                                  cwd=folder, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertRegex(done.stdout, r"100 robots are [1-9]\.\d\d m from their starts")
            digests = []
            for threads in "12":
                done = subprocess.run([sys.executable, examples / "train.py", "--iterations", "1", "--curve", "curve.csv",
                                       "--threads", threads], cwd=folder, capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertIn("score of 32 new episodes", done.stdout)
                digests += re.findall(r"weights (\w{16})", done.stdout)
            self.assertEqual(digests[0], digests[1])
            self.assertEqual(len((pathlib.Path(folder) / "curve.csv").read_text().splitlines()), 2)
            code = "import sweep; sweep.COUNTS, sweep.SPEEDS, sweep.TICKS = (3,), (0.5,), 20; sweep.main('sweep.csv')"
            done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True,
                                  env={**os.environ, "PYTHONPATH": f"{examples}:{os.environ['PYTHONPATH']}"})
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertRegex(done.stdout, r"3 robots at 0.5 m/s: 0\.[1-9]")
            if not PROGRAMS.exists():
                return
            summary = os.path.join(folder, "summary")
            done = subprocess.run([PROGRAMS / "troupe", "run", examples / "patrol.json", "--headless", "--ticks", "100",
                                   "--in-process", "--summary", summary], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn("failed", done.stdout + done.stderr)
            self.assertEqual(json.loads(pathlib.Path(summary).read_text())["ticks"], 100)


if __name__ == "__main__":
    unittest.main()
