# %% [markdown]
# # 2. A map from a lidar
# A robot drives through rooms with a lidar. From its ranges and its known poses we make an occupancy grid, and compare it with
# the true map of the world.

# %%
import numpy
import troupe

world = troupe.generators.rooms(seed=3, columns=3, rows=2)
world.robot("mapper", (-4, -2, 0), "position", size=[0.3, 0.3, 0.3], controller="wander",
            children=[troupe.lidar(6.0, samples=180)])
sim = troupe.Simulation(world)
true = sim.map(0.1)                                      # cells of 10 cm; row 0 is the lowest in y
print(true.occupied.shape, true.origin)
sim.picture(rays=True, width=600)

# %% [markdown]
# **One scan** has ranges and bearings in the robot's frame. A ray without a hit has the range's maximum.

# %%
scan = sim.read("mapper", "ranger").scans[0]
print(len(scan.ranges), "rays, nearest", scan.ranges.min(), "m")

# %% [markdown]
# **Log odds**: each cell begins at 0. A ray lowers the cells that it passes, and raises the one where it ends.

# %%
odds = numpy.zeros(true.occupied.shape)


def cells_of(x, y):
    """Rows and columns of points, and which of them are in the grid."""
    columns = ((x - true.origin[0]) / true.resolution).astype(int)
    rows = ((y - true.origin[1]) / true.resolution).astype(int)
    return rows, columns, (rows >= 0) & (rows < odds.shape[0]) & (columns >= 0) & (columns < odds.shape[1])


def add_scan():
    x, y, _, heading = sim.poses[0]
    scan = sim.read("mapper", "ranger").scans[0]
    bearings = heading + scan.bearings
    for distance in numpy.arange(0.1, scan.max, 0.1):    # all rays at once, step by step
        free = scan.ranges > distance + 0.15
        rows, columns, inside = cells_of(x + distance * numpy.cos(bearings), y + distance * numpy.sin(bearings))
        odds[rows[free & inside], columns[free & inside]] -= 0.2
    hit = scan.ranges < scan.max - 1e-6
    beyond = scan.ranges + 0.02                          # into the wall, not onto its face
    rows, columns, inside = cells_of(x + beyond * numpy.cos(bearings), y + beyond * numpy.sin(bearings))
    odds[rows[hit & inside], columns[hit & inside]] += 1.0


for _ in range(400):
    sim.step(5)
    add_scan()
print("seen:", round(float((odds != 0).mean()), 2), "of all cells")

# %% [markdown]
# **How good is it?** Of the cells that were seen: which share of the walls was found, and which share of what was found is wall?

# %%
found = odds > 0
seen = odds != 0
recall = (found & true.occupied)[seen].sum() / max(1, true.occupied[seen].sum())
precision = (found & true.occupied).sum() / max(1, found.sum())
print(f"recall {recall:.2f}, precision {precision:.2f}")
assert precision > 0.7

# %% [markdown]
# **A world from the map** that we made: the same functions that read maps make them.

# %%
again = troupe.Simulation(troupe.World().map(found, true.resolution, origin=true.origin, height=1.0))
again.picture(width=600)

# %% [markdown]
# **Exercises.** 1. Give the robot a lidar with noise (property `noise` of a sensor, docs/sensors.md). What happens to precision?
# 2. `wander` drives by chance: send the robot with `sim.send_to` (controller "go_to") to where the map is unknown instead.
