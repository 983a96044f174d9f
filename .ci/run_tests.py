"""Runs ctest, counts what was skipped, and fails if a test fails or is skipped for a reason that is not expected here.

    run_tests.py BUILD_FOLDER [OPTION OF CTEST ...]      the last lines printed are the closing lines of ctest
"""

import collections
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MAKE_HOSTS = ("ip link add name host type veth peer name end && ip link add name bridge type bridge && "
              "ip netns add check-$$ && ip netns del check-$$")


def cannot(*command):
    """Without root, or on a kernel without such namespaces."""
    return lambda: subprocess.run(["unshare", *command], capture_output=True, check=False).returncode != 0


def is_missing(*paths):
    return lambda: not any(os.path.exists(ROOT / path) for path in paths)


# Where a test may skip itself: what it says, and when that is expected.
EXPECTED = (
    (r"network namespaces|cannot make networks|needs? root", cannot("--net", "sh", "-c", MAKE_HOSTS)),
    (r"cannot mount a file system", cannot("--mount", "mount", "-t", "tmpfs", "none", "/mnt")),
    (r"no Stage worlds|TROUPE_STAGE_WORLDS",
     is_missing(os.environ.get("TROUPE_STAGE_WORLDS") or "../shared/stage-worlds")),
    (r"TROUPE_RMF_SITES is not set", lambda: not os.environ.get("TROUPE_RMF_SITES")),
    (r"needs libfastrtps-dev", is_missing("/usr/bin/fastddsgen")),
    (r"chromium is not installed", is_missing("/usr/bin/chromium", "/usr/bin/chromium-browser")),
    (r"no node and npm", lambda: not (shutil.which("node") and shutil.which("npm"))),
    # npm has no network.
    (r"packages of viewer/web are not installed", is_missing("viewer/web/node_modules")),
    (r"npm cannot install", is_missing("build/mcap/node_modules")),
    (r"sanitizers need more addresses", lambda: True),
    (r"the file system of .* cannot free parts of a file", lambda: True),
    (r"no /dev/full", is_missing("/dev/full")),
    (r"mosquitto is not installed", is_missing("/usr/sbin/mosquitto", "/usr/local/sbin/mosquitto")),
    (r"no slurmctld", is_missing("/usr/sbin/slurmctld")),
    (r"no buildah", is_missing("/usr/bin/buildah")),
    (r"no module yaml", is_missing("/usr/lib/python3/dist-packages/yaml")),
    (r"no mypy", is_missing("/usr/bin/mypy")),
    (r"no emscripten", lambda: not shutil.which("em++") or is_missing("build/wasm-root/yaml-cpp")()),
    (r"no build of the preset gcc", is_missing("build/gcc/bin/troupe-core")),
    (r"no build of the preset arm64",
     lambda: is_missing("build/arm64/bin/troupe")() or is_missing("build/arm64/bin/robot-agent")()),
    (r"no qemu-aarch64-static", lambda: not shutil.which("qemu-aarch64-static")),
    (r"needs Linux 6.7", cannot("--user", "--map-root-user", "--mount", "mount", "-t", "binfmt_misc", "none", "/mnt")),
    (r"no git repository", is_missing(".git")),
    (r"no WebAssembly module", is_missing("build/wasm/bin/troupe-core.wasm")),
    (r"debootstrap makes no base image", lambda: True),  # without a mirror of Debian
    (r"forbidden here", lambda: True),  # personality(), in some containers
)


def run(build, options):
    """ctest's exit status, its closing lines, and the tests whose command was skipped. Prints the lines before them."""
    closing, skipped = [], set()
    command = ["ctest", "--test-dir", build, "--output-on-failure", "--no-tests=error", "--no-label-summary", *options]
    output = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True, "errors": "replace"}
    with subprocess.Popen(command, **output) as ctest:
        for line in ctest.stdout:
            if closing or re.match(r"\d+% tests passed, ", line):
                closing.append(line)
                continue
            if match := re.search(r"Test +#\d+: (\S+) .*\*\*\*Skipped", line):
                skipped.add(match.group(1))
            print(line, end="", flush=True)
    return ctest.returncode, closing, skipped


def outputs(build):
    """The name, output and result of each test, according to the log of the last run."""
    log = (pathlib.Path(build) / "Testing/Temporary/LastTest.log").read_text(errors="replace")
    entry = r"^\d+/\d+ Testing: (\S+)$.*?^Output:\n-+\n(.*?)^<end of output>$.*?^Test ([A-Z]\w+)"
    return re.findall(entry, log, re.M | re.S)


def print_failures(build):
    """What each failed test printed last, once more: what is above the closing lines survives where logs are cut."""
    for test, output, result in outputs(build):
        if result.startswith(("Failed", "Timeout")):
            print(f"--- {test} failed; the end of its output:", *output.rstrip().split("\n")[-30:], sep="\n")


def skips(build, skipped):
    """What was skipped, with the reason."""
    for test, output, _ in outputs(build):
        if test in skipped:
            yield test, (output.split("\n")[-2:] or [""])[0] if output.strip() else "no reason"
        for name, reason in re.findall(r"^SKIPPED (\S+): (.*)$", output, re.M):
            yield f"{test}: {name}", reason


def main():
    build = sys.argv[1]
    status, closing, skipped = run(build, sys.argv[2:])
    if not closing:  # nothing was run
        sys.exit(status)
    expected = collections.Counter()
    for test, reason in skips(build, skipped):
        if any(re.search(pattern, reason) and holds() for pattern, holds in EXPECTED):
            expected[reason] += 1
        else:
            print(f"error: unexpected skip of {test}: {reason or 'without a reason'} (see .ci/run_tests.py)")
            status = status or 1
    print(f"{sum(expected.values())} tests skipped")
    for reason, count in sorted(expected.items()):
        print(f"  {count}: {reason}")
    print_failures(build)
    print("\n" + "".join(closing), end="", flush=True)
    sys.exit(status)


main()
