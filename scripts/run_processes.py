"""The processes of a run, their DDS domain, and the memory that they share. For the scripts that start runs, and benchmarks."""
import os
import pathlib
import socket

LAST_DOMAIN = 100  # higher ones use ports of the range that Linux assigns to any socket


def descendants(pid):
    """The processes that a process has started, and those that these have started, as (pid, program)."""
    found = []
    for thread in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            for child in map(int, thread.read_text().split()):
                found.append((child, pathlib.Path(os.readlink(f"/proc/{child}/exe")).name))
                found += descendants(child)
        except OSError:
            pass  # it has just ended
    return found


def is_alive(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def segments(pid):
    """The shared memory that a process maps, each as its inode."""
    try:
        maps = pathlib.Path(f"/proc/{pid}/maps").read_text(errors="replace")
    except OSError:
        return set()
    return {int(line.split()[4]) for line in maps.splitlines() if "/memfd:troupe-" in line}


def open_segments(pid):
    """The shared memory of which a process has a descriptor, each as its inode."""
    found = set()
    try:
        for descriptor in pathlib.Path(f"/proc/{pid}/fd").iterdir():
            if "/memfd:troupe-" in os.readlink(descriptor):
                found.add(descriptor.stat().st_ino)
    except OSError:
        pass  # it has just ended
    return found


def users_of(inodes):
    """The processes of this machine that map one of these, or have it open: without one the memory is gone."""
    pids = [int(entry.name) for entry in pathlib.Path("/proc").iterdir() if entry.name.isdigit()]
    return [pid for pid in pids if inodes & (segments(pid) | open_segments(pid))] if inodes else []


def memory(pid):
    """MiB of a process: `private` to it, its `share` (the private pages, and of each shared one the part that falls to it),
    and `resident`."""
    kib = {}
    for line in pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()[1:]:
        name, value = line.split()[:2]
        kib[name.rstrip(":")] = int(value)
    return {"private": (kib["Private_Clean"] + kib["Private_Dirty"]) / 1024, "share": kib["Pss"] / 1024,
            "resident": kib["Rss"] / 1024}


def reserve_domain(first):
    """A DDS domain from `first` on that no test and no other script uses, and the socket whose name reserves it until it is
    closed; as in tests/support/dds_domain.h."""
    # A name in the abstract namespace: it ends with its process, so that no lock file can be left behind.
    holder = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    for domain in range(first, LAST_DOMAIN + 1):
        try:
            holder.bind(f"\0troupe-test-domain-{domain}")
            return domain, holder
        except OSError:
            continue  # another one has it
    raise OSError(f"found no free DDS domain from {first} to {LAST_DOMAIN}")
