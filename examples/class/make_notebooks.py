"""Writes each lesson as a notebook. Its cells begin with "# %%" in the script, those of text with "# %% [markdown]"."""

import json
import pathlib
import re

FOLDER = pathlib.Path(__file__).parent


def cells(text):
    """(kind, lines) of each cell."""
    for kind, body in re.findall(r"^# %%( \[markdown\])?\n(.*?)(?=^# %%|\Z)", text, re.MULTILINE | re.DOTALL):
        lines = body.strip("\n").splitlines()
        if kind:
            lines = [line[2:] if line.startswith("# ") else line[1:] for line in lines]
        yield "markdown" if kind else "code", lines


def notebook(text):
    made = []
    for number, (kind, lines) in enumerate(cells(text)):
        cell = {"cell_type": kind, "id": f"cell-{number}", "metadata": {},
                "source": [line + "\n" for line in lines[:-1]] + lines[-1:]}
        if kind == "code":
            cell.update(execution_count=None, outputs=[])
        made.append(cell)
    return {"cells": made, "nbformat": 4, "nbformat_minor": 5,
            "metadata": {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
                         "language_info": {"name": "python"}}}


if __name__ == "__main__":
    for script in sorted(FOLDER.glob("[0-9]_*.py")):
        script.with_suffix(".ipynb").write_text(json.dumps(notebook(script.read_text()), indent=1) + "\n")
