"""Drives all robots of a world from Python, by their ranges, saves a picture, and plots their paths:

    python3 drive.py WORLD PICTURE.png [PATHS.png]
"""

import sys

import numpy

import troupe


def main(world: str, picture: str, plot: str = "") -> None:
    sim = troupe.Simulation(world, run_controllers=False)
    poses = [sim.poses]  # each a view of its tick, not a copy
    for _ in range(300):
        ranges = sim.ranges()  # (robots, rays), m; of a ring of eight sonars, the first one ahead
        free = ranges[:, [0, 1, 7]].min(axis=1) > 0.6
        sim.drive(numpy.column_stack([numpy.where(free, 0.4, 0.0), numpy.where(free, 0.0, 0.8)]))
        sim.step()
        poses.append(sim.poses)
    ways = numpy.hypot(*(sim.poses - poses[0])[:, :2].T)
    print(f"{len(ways)} robots are {ways.mean():.2f} m from their starts on average; state {sim.state_hash:016x}")
    sim.picture(rays=True).save(picture)
    if not plot:
        return
    try:
        from matplotlib import pyplot
    except ImportError:
        return print("no plot: matplotlib is not installed (python3-matplotlib)")
    paths = numpy.stack(poses)  # (ticks, robots, 4)
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11, 4), width_ratios=[3, 2], layout="constrained")
    left.plot(paths[..., 0], paths[..., 1], linewidth=0.7)
    left.plot(*paths[-1, :, :2].T, "k.", markersize=3)
    left.set(xlabel="x (m)", ylabel="y (m)", aspect="equal", title="paths")
    times = numpy.arange(len(paths)) * sim.interval
    away = numpy.hypot(*numpy.moveaxis(paths[..., :2] - paths[0, :, :2], -1, 0))
    for share in (10, 50, 90):
        right.plot(times, numpy.percentile(away, share, axis=1), label=f"{share} %")
    right.set(xlabel="time (s)", ylabel="distance from the start (m)", title="percentiles of the robots")
    right.legend()
    figure.savefig(plot, dpi=120)


if __name__ == "__main__":
    main(*sys.argv[1:4])
