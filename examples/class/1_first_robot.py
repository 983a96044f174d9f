# %% [markdown]
# # 1. A first robot
# A world, a robot, and a program that drives it. Run the cells one after another; each picture is the world as it is now.
# Metres, radians and seconds; x points to the right in pictures, y up.

# %%
import numpy
import troupe

world = troupe.World(name="arena", seed=1)
world.wall((-4, -3), (4, -3), (4, 3), (-4, 3), closed=True)
world.box((1.5, 1, 0.4), (1, 0.5, 0.6), color="tan")
world.model("table", (-1.5, -1, 0))                      # low robots drive under it
world.robot("anna", (0, 0, 0))
sim = troupe.Simulation(world)
sim.picture(rays=True, width=500)

# %% [markdown]
# The robot stands still: it has no program yet. You can drive it yourself: forward (m/s) and turn (rad/s), until `release`.

# %%
sim.drive((0.5, 0.3), "anna")
sim.step(30)                                             # 30 ticks of 0.1 s
print(sim.time, "s:", sim.poses[0])                      # x, y, z, heading
sim.picture(rays=True, width=500)

# %% [markdown]
# **A controller** is a class with `update`. In each tick it sees what the robot's sensors see, and returns (forward, turn).

# %%
class Bounce:
    """Drives ahead, and turns on the spot while something is near."""

    def __init__(self, robot, speed=0.4, distance=0.6):
        self.ranger = robot.sensor("ranger")
        self.speed, self.distance = speed, distance

    def subscriptions(self):
        return [self.ranger]                             # the sensors that update reads

    def update(self, seen):
        reading = seen.sensors[self.ranger]
        if reading is None:
            return 0.0, 0.0
        ahead = reading.ranges[[0, 1, -1]].min()         # of the eight sonars, the first one looks ahead
        return (self.speed, 0.0) if ahead > self.distance else (0.0, 1.0)


world.scenario["robots"][0]["controller"] = Bounce
sim = troupe.Simulation(world)
path = []
for _ in range(600):
    sim.step()
    path.append(sim.poses[0, :2])
path = numpy.array(path)
print("driven:", round(float(numpy.hypot(*numpy.diff(path, axis=0).T).sum()), 1), "m; contacts:", int(sim.stalls.sum()))
assert not sim.failures                                  # an exception in update would be here, with its line

# %%
try:
    import matplotlib.pyplot as plt
    plt.plot(path[:, 0], path[:, 1])
    plt.axis("equal")
    plt.title("the way of anna")
except ImportError:
    print("matplotlib is not installed")
sim.picture(rays=True, width=500)

# %% [markdown]
# **The same again.** A simulation depends on its world and seed alone: every run gives the same states, bit by bit. The hash
# of a state proves it.

# %%
again = troupe.Simulation(world)
again.step(600)
assert again.state_hash == sim.state_hash
print(hex(sim.state_hash))

# %% [markdown]
# **Exercises.** 1. The robot turns to the left, always: let it turn to the side with more room. 2. Put a second robot into the
# world. Do they meet? 3. What is the largest speed at which it touches nothing in 600 ticks?
