"""Runs clang-tidy and the front end of gcc on the sources of a unity build, a batch at a time.

    lint_batches.py [--all] [--record] BUILD_FOLDER [FILES]      exit status 1 if there is a finding

The file .ci/linted has a hash of each batch that had no finding: of its sources, the headers that belong to it, its
command and the checks. Batches with such a hash are left out, except with --all or FILES. With --record the hashes are
written, of the batches without a finding. A header belongs to the batches with sources from its folder that include it,
or, without such a batch, to the shortest one that includes it: a change of a header that all sources include is read
once and not a hundred times, and a finding of it in another batch waits for --all. The first line of the record names
gcc's version: by another one all batches are read again.

Tests are compiled by clang, users' programs often by gcc: an error or warning of gcc is a finding.

Most of clang-tidy's time goes into headers that all sources share, so each batch of the unity build is read as one
file. The sources are copied into it, not included, because clang's analyzer skips functions of included files. Findings
are printed with the place in the original source.
"""

import argparse
import concurrent.futures
import functools
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys

ROOT = os.getcwd()
RECORD = ".ci/linted"
INCLUDE = re.compile(r'^#include "(/.*\.cc)"$')
INCLUDED = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]', re.MULTILINE)
FINDING = re.compile(r"^(/[^:]+):(\d+)(:\d+: (?:error|warning|note): .*)$")


class Batch:
    """The sources of one entry of the unity build, copied into one file. `command`: how to compile that file."""

    def __init__(self, entry, path):
        with open(entry["file"], encoding="utf-8") as unity:
            included = [match.group(1) for match in map(INCLUDE.match, unity) if match]
        self.sources = [os.path.relpath(file, ROOT) for file in included or [entry["file"]]]
        self.path = path
        self.compilation = entry["command"]  # without the path, whose number other batches may change
        self.command = {"directory": entry["directory"], "file": path,
                        "command": entry["command"].replace(f"-c {entry['file']}", f"-c {path}")}
        self.origins = []  # of each line of the file: (source, line number)
        with open(path, "w", encoding="utf-8") as joined:
            for source in self.sources:
                with open(source, encoding="utf-8") as lines:
                    for number, line in enumerate(lines, 1):
                        joined.write(line)
                        self.origins.append((source, number))

    def headers(self):
        """The headers of the project that its sources include, in any depth, sorted."""
        folders = [ROOT, *re.findall(rf"-(?:I|isystem) *({re.escape(ROOT)}\S*)", self.compilation)]
        sources = list(map(os.path.abspath, self.sources))
        found, open_files = set(), sources.copy()
        while open_files:
            file = open_files.pop()
            if file not in found:
                found.add(file)
                for name in INCLUDED.findall(read_text(file)):
                    paths = [os.path.normpath(os.path.join(at, name)) for at in (os.path.dirname(file), *folders)]
                    open_files += [path for path in paths if read_text(path) is not None][:1]
        return sorted(found - set(sources))

    def hash(self, headers, checks):
        """Of the checks, the command, the sources and `headers`."""
        contents = (part for file in [*map(os.path.abspath, self.sources), *headers] for part in (file, read_text(file)))
        text = "\0".join([checks, self.compilation, *contents])
        guard = re.sub(r"\W", "_", ROOT.upper())  # in headers that idlc has made
        return hashlib.sha256(text.replace(ROOT, "").replace(guard, "").encode()).hexdigest()[:32]

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
        """The findings, each with its notes and excerpts."""
        tidy = ["clang-tidy", "-p", os.path.dirname(self.path), "--quiet", self.path]
        gcc = ["g++", *shlex.split(self.command["command"])[1:], "-Werror", "-fsyntax-only"]
        return (self.findings_of(tidy, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE) +
                self.findings_of(gcc, cwd=self.command["directory"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT))

    def findings_of(self, command, **options):
        """A run that failed without a finding is a finding itself."""
        run = subprocess.run(command, text=True, check=False, **options)
        findings = []
        for line in map(self.located, run.stdout.splitlines()):
            if re.search(r":\d+: (error|warning): ", line) or not findings:
                findings.append(line)
            else:
                findings[-1] += "\n" + line
        return findings or ([f"{command[0]} failed on {self.path}\n{run.stderr or ''}"] if run.returncode else [])


def headers_of(batches):
    """The headers that belong to each batch: {batch: [path, ...]}, sorted."""
    owners = {}
    for batch in sorted(batches, key=lambda batch: (len(batch.origins), batch.sources)):
        folders = {os.path.dirname(os.path.abspath(source)) for source in batch.sources}
        for header in batch.headers():
            neighbours, others = owners.setdefault(header, ([], []))
            (neighbours if os.path.dirname(header) in folders else others).append(batch)
    headers = {batch: [] for batch in batches}
    for header, (neighbours, others) in sorted(owners.items()):
        for batch in neighbours or others[:1]:
            headers[batch].append(header)
    return headers


@functools.cache
def read_text(path):
    """None without a file."""
    if not os.path.isfile(path):
        return None
    with open(path, encoding="utf-8") as file:
        return file.read()


def gcc_version():
    run = subprocess.run(["g++", "-dumpfullversion"], capture_output=True, text=True, check=True)
    return f"g++ {run.stdout.strip()}"


def read_record(gcc):
    """The hashes of the record; none if it is of another version of gcc."""
    first, *hashes = (read_text(RECORD) or "").splitlines() or [""]
    return set(hashes) if first == gcc else set()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--record", action="store_true")
    parser.add_argument("build")
    parser.add_argument("files", nargs="*")
    arguments = parser.parse_args()
    build = os.path.abspath(arguments.build)
    selected = {os.path.relpath(file, ROOT) for file in arguments.files}
    folder = os.path.join(build, "batches")
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as database:
        entries = [entry for entry in json.load(database) if not entry["file"].endswith(".c")]
    batches = [Batch(entry, os.path.join(folder, f"{number}.cc")) for number, entry in enumerate(entries)]
    with open(os.path.join(folder, "compile_commands.json"), "w", encoding="utf-8") as database:
        json.dump([batch.command for batch in batches], database)

    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, text=True, check=True).stdout
    checks = re.search(r"version \S+", version).group() + read_text(".clang-tidy")
    gcc = gcc_version()
    hashes = {batch.hash(headers, checks): batch for batch, headers in headers_of(batches).items()}
    hash_of = {batch: hash_ for hash_, batch in hashes.items()}
    clean = read_record(gcc) & set(hashes)
    if selected:
        batches = [batch for batch in batches if selected & set(batch.sources)]
    elif not arguments.all:
        batches = [batch for batch in batches if hash_of[batch] not in clean]
        print(f"{len(hashes) - len(batches)} of {len(hashes)} batches are as they were when {RECORD} was written")
    batches.sort(key=lambda batch: -len(batch.origins))  # the longest first, so that all processors end together
    printed = set()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for batch, findings in zip(batches, pool.map(Batch.findings, batches)):
            if findings:
                clean.discard(hash_of[batch])
            else:
                clean.add(hash_of[batch])
            if arguments.record:  # each time, so that what has been read counts after an interruption
                with open(RECORD, "w", encoding="utf-8") as record:
                    record.write("\n".join([gcc, *sorted(clean)]) + "\n")
            for finding in findings:
                if finding not in printed:  # of headers, each batch finds the same
                    printed.add(finding)
                    print(finding, flush=True)
    sources = sum(len(batch.sources) for batch in batches)
    print(f"{len(printed)} findings in {sources} sources and their headers")
    sys.exit(1 if printed else 0)


main()
