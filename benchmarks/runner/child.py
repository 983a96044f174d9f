"""Runs a program and writes to FILE, as JSON, what it and its child processes used. A process of its own for each: the
system tells the peak memory of all children together only.

    child.py FILE PROGRAM [ARGUMENT ...]
"""
import json
import pathlib
import resource
import subprocess
import sys
import time

begin = time.monotonic()
status = subprocess.run(sys.argv[2:], stdout=sys.stderr, check=False).returncode
used = resource.getrusage(resource.RUSAGE_CHILDREN)
pathlib.Path(sys.argv[1]).write_text(json.dumps({
    "wall": time.monotonic() - begin, "user": used.ru_utime, "system": used.ru_stime, "mib": used.ru_maxrss / 1024}))
sys.exit(min(abs(status), 125))
