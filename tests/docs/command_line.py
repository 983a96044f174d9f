#!/usr/bin/env python3
"""Runs the examples of all help texts as a user would, asks bash for completions, reads the scripts for zsh and fish by
these shells where they are installed, and looks for the actions and options of `troupe ctl` in the manual. Fails at the
first example that does not do what it says.

usage: command_line.py TROUPE ROOT     TROUPE: the program, ROOT: the source tree
"""
import json
import os
import pathlib
import pty
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile

SECONDS = 60
# Until Ctrl-C.
WATCHED = {"troupe run office.world", "troupe run office.world --robot rover.urdf@2,-0.4,90",
           "troupe loopback hall.yaml --robot rover.urdf --pose 2,1,90", "troupe view run.mcap",
           "troupe view --listen 0.0.0.0:8470 --view-only", "troupe edit office.world"}
AT_A_BROKER = ("troupe fleet check --vda5050",)  # fleet_check_test runs these
AT_A_TERMINAL = {"troupe teleop r0"}
LIVE = ("troupe ctl", "troupe goto", "troupe teleop", "troupe top", "troupe view --listen")
COMPLETIONS = {  # a command line, and some words of which each is offered, or is not (-)
    "troupe ": "run replay ctl help --version",
    "troupe r": "run replay -ctl",
    "troupe run --mo": "--mode -mode",
    "troupe run --mode ": "lockstep realtime -run",
    "troupe run off": "office.world",
    "troupe ctl st": "status step -spawn",
    "troupe ctl spawn --": "--name --pose --session --ticks-",
    "troupe snapshot office.world --view ": "top side",
    "troupe run office.world --journal o": "office.world",
    "troupe completions ": "bash zsh fish",
    "troupe run --ticks ": "",
    "troupe check a": "a b.world",
}


def fail(text):
    sys.exit(f"error: {text}")


def examples(troupe):
    """The lines of all help texts below 'Examples:'."""
    text = subprocess.run([troupe], capture_output=True, text=True, check=True).stdout
    commands = re.findall(r"^  ([a-z-]+) ", text[text.index("Subcommands:"):text.index("Environment:")], re.MULTILINE)
    found = []
    for command in commands:
        text = subprocess.run([troupe, "help", command], capture_output=True, text=True, check=True).stdout
        found += re.findall(r"^  (troupe .*?)(?:  .*)?$", text.partition("\nExamples:\n")[2], re.MULTILINE)
    return found


def run_at_terminal(line):
    process, terminal = pty.fork()
    if process == 0:
        os.execvp("sh", ["sh", "-c", "exec " + line])
    text = b""
    while b"Ctrl-C" not in text and b"quit" not in text:
        text += os.read(terminal, 4096)
    os.write(terminal, b"\x03")
    try:
        while os.read(terminal, 4096):
            pass
    except OSError:
        pass  # its end
    status = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
    if status not in (0, 130):
        fail(f"'{line}' ended with {status}: {text.decode()}")


def free_port():
    with socket.create_server(("", 0)) as server:
        return server.getsockname()[1]


def run(line):
    if line in AT_A_TERMINAL:
        run_at_terminal(line)
        return
    here = line.replace(":8470", f":{free_port()}")  # other tests have viewers, too
    with subprocess.Popen(["sh", "-c", "exec " + here], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        text = ""
        if line in WATCHED:
            while "http://" not in text:
                part = process.stdout.readline()
                if not part:
                    fail(f"'{line}' ended without an address: {text}")
                text += part
            process.send_signal(signal.SIGINT)
        text += process.communicate(timeout=SECONDS)[0]
        expected = (0, 130) if line in WATCHED else (0,)
        if process.returncode not in expected:
            fail(f"'{line}' ended with {process.returncode}: {text}")


def check_completions():
    probe = ("source ./troupe.bash; read -ra COMP_WORDS <<<\"$1\"; [[ $1 != *' ' ]] || COMP_WORDS+=(''); "
             "COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _troupe; printf '%s\\n' \"${COMPREPLY[@]}\"")
    for line, words in COMPLETIONS.items():
        result = subprocess.run(["bash", "-c", probe, "bash", line], capture_output=True, text=True, check=True)
        if result.stderr:
            fail(f"the completion of '{line}' printed {result.stderr}")
        offered = set(filter(None, result.stdout.splitlines()))
        if not words and offered:
            fail(f"the completions of '{line}' are {offered}, expected none")
        for word in [words] if words in offered else words.split():
            if word.startswith("-") and not word.startswith("--"):
                if word[1:] in offered:
                    fail(f"the completions of '{line}' have {word[1:]}")
            elif not word.endswith("-") and word not in offered:
                fail(f"the completions of '{line}' are {offered}, expected {word}")
    for shell in ("zsh", "fish"):
        if shutil.which(shell):
            script = subprocess.run(["troupe", "completions", shell], capture_output=True, text=True, check=True).stdout
            pathlib.Path(f"troupe.{shell}").write_text(script)
            subprocess.run([shell, "-n", f"troupe.{shell}"], check=True)


def check_reference(troupe, root):
    """Each action of `troupe ctl` and each option of it, made from the lists of the requests, is in docs/running.md."""
    page = (root / "docs/running.md").read_text(encoding="utf-8")
    section = page.partition("\n## troupe ctl\n")[2].partition("\n## ")[0]
    text = subprocess.run([troupe, "ctl", "--help"], capture_output=True, text=True, check=True).stdout
    actions = re.findall(r"^  ([a-z-]+) ", text.partition("Subcommands:")[2].partition("Examples:")[0], re.MULTILINE)
    if len(actions) < 15:
        fail(f"found the actions {actions} of troupe ctl, expected more")
    for action in actions:
        text = subprocess.run([troupe, "ctl", action, "--help"], capture_output=True, text=True, check=True).stdout
        for word in [action, *re.findall(r"^  (--[a-z-]+)", text, re.MULTILINE)]:
            if not re.search(rf"(?<![\w-]){word}(?![\w-])", section):
                fail(f"docs/running.md does not have {word} of troupe ctl {action}")


def main():
    troupe, root = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    lines = examples(troupe)
    if len(lines) < 15:
        fail(f"found the examples {lines}, expected more")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.environ.update(PATH=f"{troupe.parent}:{os.environ['PATH']}", TROUPE_DOMAIN=str(100 + os.getpid() % 100),
                          TROUPE_SESSION=f"examples-{os.getpid()}")
        pathlib.Path("office.world").write_text(
            f'include "{root}/worlds/office.world"\nscout ( name "r0" pose [ -8 0 0 0 ] ctrl "go_to" )\n')
        pathlib.Path("rover.urdf").write_text(
            '<robot name="rover"><link name="base"><collision><geometry><box size="0.4 0.4 0.2"/></geometry></collision></link>'
            '</robot>\n')
        pathlib.Path("hall.pgm").write_bytes(b"P5 40 30 255\n" + bytes(40) + bytes([254]) * 1160)  # a wall in the north
        pathlib.Path("hall.yaml").write_text(
            "image: hall.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n")
        pathlib.Path("hall.svg").write_text('<svg><path d="M0 0H400V300H0Z"/></svg>')
        pathlib.Path("office.test.json").write_text(
            '{"scenario": "office.world", "ticks": 20, "vary": {"seed": {"range": [1, 3]}}, '
            '"expect": ["forall r: always speed(r) < 10 m/s"], "metrics": {"top speed": "max of speed(r)"}}')
        pathlib.Path("fleet.jsonl").write_text(json.dumps({"time": 0, "topic": "uagv/v2/Acme/anna/connection", "payload": {
            "headerId": 1, "timestamp": "2026-01-01T00:00:00.00Z", "version": "2.1.0", "manufacturer": "Acme", "serialNumber": "anna",
            "connectionState": "ONLINE"}}) + "\n")
        pathlib.Path("a b.world").touch()
        for line in lines:
            if not line.startswith(LIVE + AT_A_BROKER):
                run(line)
        live = "exec troupe run office.world --headless --speed 20"
        with subprocess.Popen(["sh", "-c", live], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
            while "ready" not in (text := process.stdout.readline()):
                if not text:
                    fail(f"'{live}' ended")
            for line in lines:
                if line.startswith(LIVE):
                    run(line)
                    if line == "troupe ctl step 10":
                        run("troupe ctl play")
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=SECONDS)
        check_completions()
    check_reference(troupe, root)


if __name__ == "__main__":
    main()
