"""A user's program, for type checkers: all of the package that it uses, by its types."""

from typing import List, Optional, Sequence, Tuple

import numpy
import troupe
from troupe import generators, rl, testing
from troupe.controller import Controller


class Patrol(Controller):
    """Drives until something is near."""

    def __init__(self, robot: troupe.RobotInfo, speed: float = 0.4) -> None:
        super().__init__(robot)
        self.ranger: int = robot.sensor("ranger")
        self.speed = speed

    def subscriptions(self) -> Sequence[int]:
        return [self.ranger]

    def update(self, seen: troupe.Observation) -> Tuple[float, float]:
        reading = seen.sensors[self.ranger]
        assert isinstance(reading, troupe.RangerReading)
        nearest: float = float(reading.ranges.min())
        return (self.speed, 0.0) if nearest > 0.8 else (0.0, 1.0)


def arena(seed: int) -> troupe.World:
    world = troupe.World(name="arena", seed=seed, interval=0.1)
    world.wall((-3, -2), (3, -2), (3, 2), (-3, 2), closed=True).box((1, 1, 0), (0.3, 0.3, 0.3), movable=True)
    world.map(numpy.zeros((10, 10), bool), 0.1, origin=(-0.5, -0.5))
    return world.robot("anna", (0, 0, 0), controller=Patrol, parameters={"speed": 0.5}, children=[troupe.lidar(6)])


def run(file: Optional[str] = None) -> List[float]:
    sim = troupe.Simulation(file if file is not None else arena(1), seed=3)
    sim.step(10)
    sim.drive((0.1, 0.2), "anna")
    sim.drive(troupe.Command(vx=0.1, report="on"), 0)
    name: str = sim.spawn("scout", (0, 1, 0), controller=Patrol)
    sim.set_pose(name, numpy.array([0.0, -1.0, 0.0]))
    pose: troupe.Pose = sim.find_pose(name)
    snapshot: troupe.Snapshot = sim.save()
    sim.restore(snapshot)
    sim.picture(rays=True, width=300).save("arena.png")
    events: List[troupe.Event] = sim.events
    words: Tuple[str, ...] = sim.robots
    outcome = testing.run(sim, "forall r: always speed(r) < 1 m/s", ticks=5)
    vector = troupe.VectorSimulation(arena, 4, threads=1)
    vector.drive(numpy.zeros((4, vector.num_robots, 2)))
    vector.step()
    maze = troupe.Simulation(generators.maze(2))
    print(len(events), words, outcome.passed, maze.name, vector.state_hashes)
    return [pose.x, *sim.poses[:, 0].tolist()]


def learn() -> None:
    env = rl.ParallelEnv(rl.Navigation(robots=2))
    observations, infos = env.reset(seed=1)
    print(sorted(observations), infos)
    try:
        troupe.Simulation("none.world")
    except troupe.InputError as error:
        print(error.file, error.line, error.message)


if __name__ == "__main__":
    print(run())
    learn()
