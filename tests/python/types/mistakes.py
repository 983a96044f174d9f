import troupe

sim = troupe.Simulation("office.world")
sim.step("ten")  # not a number
sim.pose  # no such attribute
troupe.World().robot("anna")  # without a pose
x: str = sim.find_pose("anna")  # a Pose
troupe.Command(vxx=1.0)  # no such field
for state in troupe.Recording("run.mcap"):
    state.step()  # a recorded state has no steps
