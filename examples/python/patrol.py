"""Patrol: drives ahead, and turns where something is near. A complete controller in Python.

    troupe run patrol.json
"""

from troupe.controller import Command


class Patrol:
    def __init__(self, robot, speed=0.4, distance=0.8):
        self.ranger = robot.sensor("ranger")
        self.speed = speed  # m/s
        self.distance = distance  # m, to what it turns away from
        self.turns = 0

    def subscriptions(self):
        return [self.ranger]

    def update(self, seen):
        reading = seen.sensors[self.ranger]
        if reading is None or reading.ranges.min() > self.distance:
            return self.speed, 0.0
        self.turns += 1
        report = f"{self.turns} turns" if self.turns % 100 == 0 else ""
        return Command(wz=0.8, report=report)
