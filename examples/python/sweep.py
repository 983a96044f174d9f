"""Sweeps the number of robots and their speed in an office, over several seeds, and plots how much they hinder each other:

    python3 sweep.py [TABLE.csv [PLOT.png]]

The robots drive as in patrol.py, but by arrays over all worlds, and back off from what they touch.
"""

import json
import pathlib
import sys
import tempfile

import numpy

import troupe
from troupe.rl.tasks import worlds_folder

COUNTS, SPEEDS, SEEDS, TICKS = (5, 10, 20, 40, 80), (0.3, 0.6, 0.9), range(1, 9), 300


def measure(folder: pathlib.Path, count: int, speed: float):
    """Of all seeds: the way of a robot (m), mean and standard deviation, and the share of ticks at a contact."""
    scenario = {"world": str(worlds_folder() / "office.world"), "spawn": [
        {"model": "scout", "count": count, "region": [-12, -8, 12, 8], "spacing": 0.4, "heading": "random",
         "name_prefix": "scout"}]}
    file = folder / "sweep.json"
    file.write_text(json.dumps(scenario))
    worlds = troupe.VectorSimulation(file, len(SEEDS), seeds=SEEDS)
    ways, stalls = numpy.zeros(len(SEEDS)), 0.0
    motion, touched = numpy.zeros((len(SEEDS), count, 2)), numpy.zeros((len(SEEDS), count))
    for _ in range(TICKS):
        free = worlds.ranges()[..., [0, 1, 7]].min(axis=-1) > 0.6
        motion[..., 0] = numpy.where(touched > 0.3, -0.3, numpy.where(free, speed, 0.0))  # after a contact 1 s back
        motion[..., 1] = numpy.where(free & (touched < 0.3), 0.0, 1.0)
        worlds.drive(motion)
        worlds.step()
        ways += worlds.twists()[..., 0].mean(axis=1) * worlds[0].interval
        now = worlds.stalls()
        stalls += now.mean() / TICKS
        touched = numpy.where((now > 0) & (motion[..., 0] >= 0), 1.0, numpy.where(now > 0, 0.0, 0.9 * touched))
    return ways.mean(), ways.std(), stalls


def main(table: str = "", plot: str = "") -> None:
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for speed in SPEEDS:
            for count in COUNTS:
                rows.append((count, speed, *measure(pathlib.Path(folder), count, speed)))
                print("{} robots at {} m/s: {:.2f} m each (deviation {:.2f} m), {:.1%} of the ticks at a contact".format(
                    *rows[-1]), flush=True)
    if table:
        numpy.savetxt(table, rows, fmt="%g", delimiter=",", header="robots,speed,way,deviation,contacts", comments="")
    if not plot:
        return
    try:
        from matplotlib import pyplot
    except ImportError:
        return print("no plot: matplotlib is not installed (python3-matplotlib)")
    figure, axes = pyplot.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for speed in SPEEDS:
        counts, _, ways, deviations, contacts = numpy.array([row for row in rows if row[1] == speed]).T
        axes[0].errorbar(counts, ways / (speed * TICKS * 0.1), deviations / (speed * TICKS * 0.1), capsize=3,
                         label=f"{speed} m/s")
        axes[1].plot(counts, 100 * contacts, marker="o", label=f"{speed} m/s")
    axes[0].set(xlabel="robots", ylabel="way / (speed x time)", title=f"mean of {len(SEEDS)} seeds, and deviation")
    axes[1].set(xlabel="robots", ylabel="ticks at a contact (%)")
    for each in axes:
        each.set_xscale("log")
        each.set_xticks(COUNTS, COUNTS)
        each.legend()
    figure.savefig(plot, dpi=120)


if __name__ == "__main__":
    main(*sys.argv[1:3])
