# %% [markdown]
# # 5. Testing robots
# What should never happen, or always, or at some time? Expectations say it in one line, and are judged in each tick.

# %%
import troupe
from troupe.testing import Failure, check, run


class Careful:
    """Stops before obstacles; `distance` is how early."""

    def __init__(self, robot, distance=0.5):
        self.ranger = robot.sensor("ranger")
        self.distance = distance

    def subscriptions(self):
        return [self.ranger]

    def update(self, seen):
        reading = seen.sensors[self.ranger]
        if reading is None or reading.ranges[[0, 1, -1]].min() > self.distance:
            return 0.5, 0.0
        return 0.0, 0.8


def world(distance):
    made = troupe.generators.forest(seed=2, size=(8, 8), trees=12, gap=0.6)
    return made.robot("anna", (0, 0, 0), controller=Careful, parameters={"distance": distance})


# %%
passed = run(world(0.5), ["always not stalled(anna)", "eventually[0, 60 s] x(anna) > 1 m"], ticks=600,
             metrics={"fastest": "max of speed(anna)"})
for outcome in passed.outcomes:
    print(outcome.text, "->", outcome.holds, f"(robustness {outcome.robustness:.2f})")
print(passed.metrics)
assert passed.passed

# %% [markdown]
# **A robot that looks too late** touches something. The message names the tick, and the shortest run that shows it.

# %%
try:
    check(world(0.02), "always not stalled(anna)", ticks=600)
    raise SystemExit("it should have failed")
except Failure as failure:
    print(failure)

# %% [markdown]
# **Many cases**: the same expectation in twenty forests. Which share holds?

# %%
def in_forest(seed, distance):
    made = troupe.generators.forest(seed=seed, size=(8, 8), trees=12, gap=0.6)
    return made.robot("anna", (0, 0, 0), controller=Careful, parameters={"distance": distance})


for distance in (0.1, 0.3, 0.5):
    held = sum(run(in_forest(seed, distance), "always not stalled(anna)", ticks=300).passed for seed in range(20))
    print(f"distance {distance}: {held} of 20 forests without a contact")

# %% [markdown]
# `troupe test` runs such cases on all cores and machines, makes a failing one as small as it can, and writes a page with its
# moving picture: docs/testing.md. `World.save` writes these worlds as its files.
#
# **Exercises.** 1. Find the smallest distance that holds in all forests. 2. State in one line that anna never stands still for
# more than 5 s, and find out whether that is so.
