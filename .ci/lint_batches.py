"""Runs clang-tidy on the sources of a unity build, a batch at a time.

    lint_batches.py BUILD_FOLDER [FILES]      exit status 1 if there is a finding

Most of clang-tidy's time goes into headers that all sources share, so each batch of the unity build is read as one file.
The sources are copied into it, not included, because clang's analyzer skips functions of included files. Findings are
printed with the place in the original source.
"""

import concurrent.futures
import json
import os
import re
import subprocess
import sys

ROOT = os.getcwd()
INCLUDE = re.compile(r'^#include "(/.*\.cc)"$')
FINDING = re.compile(r"^(/[^:]+):(\d+)(:\d+: (?:error|warning|note): .*)$")


class Batch:
    """The sources of one entry of the unity build, copied into one file. `command`: how to compile that file."""

    def __init__(self, entry, path):
        with open(entry["file"], encoding="utf-8") as unity:
            included = [match.group(1) for match in map(INCLUDE.match, unity) if match]
        self.sources = [os.path.relpath(file, ROOT) for file in included or [entry["file"]]]
        self.path = path
        self.command = {"directory": entry["directory"], "file": path,
                        "command": entry["command"].replace(f"-c {entry['file']}", f"-c {path}")}
        self.origins = []  # of each line of the file: (source, line number)
        with open(path, "w", encoding="utf-8") as joined:
            for source in self.sources:
                with open(source, encoding="utf-8") as lines:
                    for number, line in enumerate(lines, 1):
                        joined.write(line)
                        self.origins.append((source, number))

    def located(self, line):
        """A line of clang-tidy's output, with the place in the original source if it has one."""
        match = FINDING.match(line)
        if not match:
            return line
        file, number, text = match.groups()
        if file == self.path:
            file, number = self.origins[int(number) - 1]
        return f"{os.path.relpath(file, ROOT)}:{number}{text}"

    def findings(self):
        """The findings, each with its notes and excerpts. A run that failed without one is a finding itself."""
        run = subprocess.run(["clang-tidy", "-p", os.path.dirname(self.path), "--quiet", self.path],
                             capture_output=True, text=True, check=False)
        findings = []
        for line in map(self.located, run.stdout.splitlines()):
            if re.search(r":\d+: (error|warning): ", line) or not findings:
                findings.append(line)
            else:
                findings[-1] += "\n" + line
        return findings or ([f"clang-tidy failed on {self.path}\n{run.stderr}"] if run.returncode else [])


def main():
    build = os.path.abspath(sys.argv[1])
    selected = {os.path.relpath(file, ROOT) for file in sys.argv[2:]}
    folder = os.path.join(build, "batches")
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as database:
        entries = [entry for entry in json.load(database) if not entry["file"].endswith(".c")]
    batches = [Batch(entry, os.path.join(folder, f"{number}.cc")) for number, entry in enumerate(entries)]
    with open(os.path.join(folder, "compile_commands.json"), "w", encoding="utf-8") as database:
        json.dump([batch.command for batch in batches], database)

    batches = [batch for batch in batches if not selected or selected & set(batch.sources)]
    batches.sort(key=lambda batch: -len(batch.origins))  # the longest first, so that all processors end together
    printed = set()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for findings in pool.map(Batch.findings, batches):
            for finding in findings:
                if finding not in printed:  # of headers, each batch finds the same
                    printed.add(finding)
                    print(finding, flush=True)
    sources = sum(len(batch.sources) for batch in batches)
    print(f"{len(printed)} findings in {sources} sources and their headers")
    sys.exit(1 if printed else 0)


main()
