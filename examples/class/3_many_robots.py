# %% [markdown]
# # 3. Many robots
# How does a swarm get on as it grows? Runs with 5, 10, 20 and 40 robots, each with eight seeds, all at once on all cores.

# %%
import numpy
import troupe

COUNTS, SEEDS, TICKS = (5, 10, 20, 40), 8, 300


def arena(count):
    """A function of the seed, as VectorSimulation takes it."""
    def world(seed):
        made = troupe.generators.forest(seed, size=(12, 12), trees=15)
        return made.robots(count, (-5.5, -5.5, 5.5, 5.5), controller="wander", spacing=0.6)
    return world


vector = troupe.VectorSimulation(arena(20), SEEDS)
vector.step(50)
vector[0].picture(width=500)

# %% [markdown]
# **Arrays over worlds and robots**: `poses` is (worlds, robots, 4).

# %%
print(vector.poses().shape, "mean speed", float(numpy.abs(vector.twists()[..., 0]).mean()))

# %%
rows = []
for count in COUNTS:
    vector = troupe.VectorSimulation(arena(count), SEEDS)
    way = numpy.zeros((SEEDS, count))
    stalled = numpy.zeros((SEEDS, count))
    before = vector.poses()
    for _ in range(TICKS):
        vector.step()
        now = vector.poses()
        way += numpy.hypot(*numpy.moveaxis(now - before, -1, 0)[:2])
        stalled += vector.stalls()
        before = now
    per_world = way.mean(axis=1) / (TICKS * vector[0].interval)
    rows.append((count, per_world.mean(), per_world.std(), stalled.mean() / TICKS))
    print(f"{count:3} robots: {rows[-1][1]:.2f} m/s, from world to world {rows[-1][2]:.2f}; stalled {100 * rows[-1][3]:.1f} %")
assert rows[0][1] > rows[-1][1]                          # more robots, slower robots

# %%
try:
    import matplotlib.pyplot as plt
    counts, means, deviations, _ = zip(*rows)
    plt.errorbar(counts, means, deviations)
    plt.xlabel("robots")
    plt.ylabel("m/s")
except ImportError:
    print("matplotlib is not installed")

# %% [markdown]
# **Tables** have all that is known of things by their names; a data frame is one call away: `pandas.DataFrame(sim.table("robots"))`.

# %%
sim = vector[0]
table = sim.table("robots")
print(sorted(table))
fastest = int(numpy.argmax(table["speed"]))
print("fastest:", table["name"][fastest], table["speed"][fastest])

# %% [markdown]
# **Exercises.** 1. Replace `wander` by `flock` (docs/controllers.md). 2. Is the result the same for another eight seeds? 3. Let
# robots have half the size: at which number are they as slow as 40 large ones?
