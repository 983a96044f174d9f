#!/usr/bin/env python3
"""Runs the commands of the README and of docs as a reader would who copies them, and fails at the first that does not work.

A command is a line of a block of ```sh, or an indented line of a page that begins with `troupe`. Left out are lines with
words in CAPITALS, which stand for names of the reader, and those of NEEDS, which need what a test has not.

usage: documents.py TROUPE ROOT PREFIX [--list]     TROUPE: the program, ROOT: the source tree, PREFIX: an installed tree
"""
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

SECONDS = 300
PAGES = ["README.md", "docs/running.md", "docs/recording.md", "docs/sensors.md", "docs/viewer.md", "docs/tutorial.md"]
NEEDS = {  # a part of the line: the reason
    "scripts/run": "builds another tree",
    "scripts/test": "builds another tree",
    "scripts/package": "builds another tree",
    "--target installed": "builds another tree; PREFIX stands for it",
    "apt-get": "root",
    "eth0": "another network interface",
    "--service 10.0.0.5": "another host",
    "0.0.0.0": "another host",
    "~/": "the home of the reader",
    "troupe ctl": "a run that goes on: tests/docs/command_line.py",
    "troupe goto": "the same",
    "troupe teleop": "the same",
    "troupe top": "the same",
    "curl ": "a gateway that goes on",
    "--static": "the WebAssembly module: tests/browser/static_test.mjs",
    " &": "a run that goes on, for the next line",
}
# Until Ctrl-C, so that the first address is enough.
WATCHED = re.compile(r"^troupe (view|edit)\b|^troupe run (?!.*(--headless|--ticks))")


def commands(page):
    """The blocks of a page, each a list of commands; a here-document belongs to its command."""
    text = page.read_text()
    blocks = [block for block in re.findall(r"^```sh\n(.*?)^```", text, re.MULTILINE | re.DOTALL)]
    outside = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    blocks += [line.strip() + "\n" for line in re.findall(r"^    (troupe .*)$", outside, re.MULTILINE)]
    for block in blocks:
        found = []
        lines = iter(block.splitlines())
        for line in lines:
            command = line
            while command.endswith("\\"):
                command = command[:-1] + next(lines).strip()
            if match := re.search(r"<<'?(\w+)'?", command):
                for more in lines:
                    command += "\n" + more
                    if more == match.group(1):
                        break
            first = re.sub(r"\s{2,}#.*", "", command.split("\n")[0])
            if first.strip() and not first.startswith("#"):
                found.append("\n".join([first, *command.split("\n")[1:]]))
        if found:
            yield found


def reason_to_leave_out(command):
    line = command.split("\n")[0]
    if line.startswith("ros2 "):
        return "ROS 2"
    without_texts = re.sub(r"^PATH=\S+|'[^']*'|\"[^\"]*\"|<<'?\w+'?|-D\w+|\$\w+|\b\w*\.(?:txt|md)\b", "", line)
    if re.search(r"(?<![\w$./-])[A-Z]{2,}(?![\w/])|\.\.\.|\[", without_texts):
        return "names of the reader"
    return next((why for part, why in NEEDS.items() if part in line.replace("&&", "")), None)


def run(command, environment, folder):
    """Runs it in the shell's folder, and returns the folder afterwards, which `cd` changes."""
    is_watched = WATCHED.search(command.split("\n")[0]) and "&&" not in command
    script = command if is_watched else command + "\npwd > .folder"
    process = subprocess.Popen(["bash", "-c", ("exec " if is_watched else "set -e\n") + script], cwd=folder, env=environment,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    text = ""
    if is_watched:
        while "http://" not in text and (line := process.stdout.readline()):
            text += line
        process.send_signal(signal.SIGINT)
    text += process.communicate(timeout=SECONDS)[0]
    if process.returncode not in ((0, 130) if is_watched else (0,)):
        sys.exit(f"error: ended with {process.returncode}: {command}\n{text}")
    if is_watched:
        return folder
    for place in (folder, *folder.iterdir()):
        note = pathlib.Path(place) / ".folder"
        if note.is_file():
            folder = pathlib.Path(note.read_text().strip())
            note.unlink()
            return folder
    sys.exit(f"error: {command} left the folder")


def main():
    troupe, root, prefix = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    count = 0
    with tempfile.TemporaryDirectory() as name:
        top = pathlib.Path(name).resolve()
        for part in ("worlds", "examples", "docs"):
            (top / part).symlink_to(root / part)
        (top / "build/release").mkdir(parents=True)
        (top / "build/release/bin").symlink_to(troupe.parent)
        (top / "build/installed").symlink_to(prefix)
        (top / "simple.world").write_text(
            'include "worlds/include/robots.inc"\nscout ( name "r0" pose [ 0 0 0 0 ] ctrl "wander" )\n')
        environment = {**os.environ, "PATH": f"{troupe.parent}:{os.environ['PATH']}",
                       "TROUPE_DOMAIN": str(100 + os.getpid() % 100)}
        for page in PAGES:
            folder = top
            for block in commands(root / page):
                for command in block:
                    reason = reason_to_leave_out(command)
                    if "--list" in sys.argv:
                        print(f"{page}: {'left out, ' + reason if reason else 'run'}: {command.splitlines()[0]}")
                    elif not reason:
                        folder = run(command, environment, folder)
                    count += not reason
    print(f"{count} commands")
    if count < 30:
        sys.exit("error: expected more commands")


if __name__ == "__main__":
    main()
