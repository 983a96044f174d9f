"""The machine that the measurements are from."""
import os
import platform
import subprocess
import time


def processor():
    with open("/proc/cpuinfo") as file:
        for line in file:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.machine()


def virtual():
    with open("/proc/cpuinfo") as file:
        return any(line.startswith("flags") and " hypervisor" in line for line in file)


def package_version(name):
    done = subprocess.run(["dpkg-query", "--show", "--showformat=${Version}", name], capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else "unknown"


def describe():
    """One line: a figure is meaningless without its machine."""
    kind = "virtual machine" if virtual() else "machine"
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    load = os.getloadavg()[0]
    return (f"{time.strftime('%Y-%m-%d')}, {kind} with {len(os.sched_getaffinity(0))} cores ({processor()}), "
            f"{memory:.0f} GiB, Linux {platform.release().split('-')[0]}, Cyclone DDS {package_version('cyclonedds-dev')}, "
            f"load before the first scene {load:.1f}")
