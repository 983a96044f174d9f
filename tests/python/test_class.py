"""The lessons of examples/class run, and their notebooks are those of the scripts."""

import importlib.util
import json
import subprocess
import sys
import tempfile
import unittest

from support import ROOT

FOLDER = ROOT / "examples/class"


class Lessons(unittest.TestCase):
    def test_each_script_runs(self):
        scripts = sorted(FOLDER.glob("[0-9]_*.py"))
        self.assertEqual(len(scripts), 5)
        for script in scripts:
            with self.subTest(script.name), tempfile.TemporaryDirectory() as folder:
                done = subprocess.run([sys.executable, script], cwd=folder, capture_output=True, text=True, timeout=250)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_notebooks_are_those_of_the_scripts(self):
        spec = importlib.util.spec_from_file_location("make_notebooks", FOLDER / "make_notebooks.py")
        maker = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(maker)
        for script in sorted(FOLDER.glob("[0-9]_*.py")):
            with self.subTest(script.name):
                notebook = json.loads(script.with_suffix(".ipynb").read_text())
                self.assertEqual(notebook, maker.notebook(script.read_text()))
                code = "\n".join("".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code")
                compile(code, script.name, "exec")
                self.assertGreater(len(notebook["cells"]), 6)


if __name__ == "__main__":
    unittest.main()
