"""Drives all robots of a world from Python, by their ranges, and saves a picture:

    python3 drive.py WORLD PICTURE
"""

import sys

import numpy

import troupe


def main(world: str, picture: str) -> None:
    sim = troupe.Simulation(world, run_controllers=False)
    start = sim.poses
    for _ in range(300):
        ranges = sim.ranges()  # (robots, rays), m; of a ring of eight sonars, the first one ahead
        free = ranges[:, [0, 1, 7]].min(axis=1) > 0.6
        sim.drive(numpy.column_stack([numpy.where(free, 0.4, 0.0), numpy.where(free, 0.0, 0.8)]))
        sim.step()
    ways = numpy.hypot(*(sim.poses - start)[:, :2].T)
    print(f"{len(ways)} robots are {ways.mean():.2f} m from their starts on average; state {sim.state_hash:016x}")
    sim.picture(rays=True).save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:3])
