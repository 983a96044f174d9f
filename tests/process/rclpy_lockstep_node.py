#!/usr/bin/python3
"""Nodes of rclpy for which ticks wait, for ros_lockstep_load.py: those of lockstep_node, and two that run by the executor of
examples/ros_lockstep.

usage: rclpy_lockstep_node.py topic|counter|protocol|executor|memory|echo NAME SPACE DELAY SEED DOMAIN INTERFACE

The domain and the interface come from ROS_DOMAIN_ID and CYCLONEDDS_URI.
"""
import math
import pathlib
import random
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples/ros_lockstep"))
import rclpy  # noqa: E402
import troupe_lockstep  # noqa: E402
from geometry_msgs.msg import Twist  # noqa: E402
from rclpy.duration import Duration  # noqa: E402
from rclpy.node import Node  # noqa: E402
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # noqa: E402
from sensor_msgs.msg import LaserScan  # noqa: E402
from std_msgs.msg import Header  # noqa: E402


class Driver(Node):
    """Writes a command to each scan: one that the scan alone gives, or, `counts`, one that the number of its scans gives."""

    def __init__(self, name, space, delay, seed, counts):
        super().__init__(name)
        self.delay, self.random, self.counts, self.scans = delay, random.Random(seed), counts, 0
        self.commands = self.create_publisher(Twist, f"{space}/cmd_vel", 10)
        self.create_subscription(LaserScan, f"{space}/scan", self.drive, 10)

    def drive(self, scan):
        if self.delay:
            time.sleep(self.random.uniform(0.0, self.delay))
        self.scans += 1
        self.commands.publish(self.command(scan))

    def command(self, scan):
        command = Twist()
        if self.counts:
            command.linear.x = 0.3
            command.angular.z = 0.5 * math.sin(0.1 * self.scans)
            return command
        ranges = [min(value, scan.range_max) for value in scan.ranges]
        third = len(ranges) // 3
        right, ahead, left = ranges[:third], ranges[third:-third], ranges[-third:]
        blocked = min(ahead) < 0.7
        command.linear.x = 0.0 if blocked else 0.4
        command.angular.z = 0.8 if blocked else 0.5 * (sum(left) - sum(right)) / (sum(left) + sum(right))
        return command


class Answering(Driver):
    """Answers each tick, as docs/ros2-lockstep.md describes the protocol."""

    def __init__(self, name, space, delay, seed):
        super().__init__(name, space, delay, seed, False)
        kept = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.space, self.scan, self.received, self.tick, self.last = space, None, 0, None, None
        self.create_subscription(Header, "/world/tick", self.note, kept)
        self.done = self.create_publisher(Header, "/world/tick_done", 10)

    def drive(self, scan):
        self.scan = scan
        self.received += 1

    def note(self, tick):
        self.tick = tick

    def answer(self):
        if self.tick is None:
            return
        tick = self.tick
        entries = dict(entry.rsplit(":", 1) for entry in tick.frame_id.split())
        key = (tick.stamp.sec, tick.stamp.nanosec, entries.get("edition"))
        if self.last is not None and key[:2] < self.last[:2]:
            self.last = None  # a reset or a rewind
        if key != self.last:
            count = int(entries.get(f"{self.space}/scan", 0))
            if self.received < (max(count, 1) if self.last is None else count):
                return
            if self.last is None and self.scan.header.stamp != tick.stamp:
                return  # one that was shown before this program came
            if self.delay:
                time.sleep(self.random.uniform(0.0, self.delay))
            self.commands.publish(self.command(self.scan))
            self.commands.wait_for_all_acked(Duration(seconds=60))
            self.received = 0
        self.last, self.tick = key, None
        self.done.publish(Header(stamp=tick.stamp, frame_id=f"{self.get_name()} edition:{entries['edition']}"))


def main():
    way, name, space, delay, seed = sys.argv[1], sys.argv[2], sys.argv[3], float(sys.argv[4]) / 1000, int(sys.argv[5])
    rclpy.init(args=[])
    if way == "echo":
        node = Node(name)
        node.create_subscription(LaserScan, f"{space}/scan", lambda scan: None, 10)
        rclpy.spin(node)
    elif way in ("topic", "counter"):
        rclpy.spin(Driver(name, space, delay, seed, way == "counter"))
    elif way in ("executor", "memory"):
        troupe_lockstep.spin([Driver(name, space, delay, seed, way == "memory")], name, needs=[f"{space}/scan"])
    else:
        node = Answering(name, space, delay, seed)
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=0.1)
            node.answer()


if __name__ == "__main__":
    main()
