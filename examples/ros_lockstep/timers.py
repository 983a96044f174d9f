"""A node with two timers on simulated time: it drives by the newest scan, and turns back now and then.

    python3 timers.py --ros-args -r scan:=/anna/scan -r cmd_vel:=/anna/cmd_vel
"""
import rclpy
import troupe_lockstep
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Patrol(Node):
    def __init__(self):
        super().__init__("patrol")
        self._commands = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(LaserScan, "scan", self._see, 10)
        self.create_timer(0.2, self._drive)
        self.create_timer(5.0, self._turn)
        self._nearest = 0.0
        self._side = 1.0

    def _see(self, scan):
        self._nearest = min(min(scan.ranges), scan.range_max)

    def _drive(self):
        command = Twist()
        command.linear.x = 0.4 if self._nearest > 0.6 else 0.0
        command.angular.z = 0.0 if self._nearest > 0.6 else 0.8 * self._side
        self._commands.publish(command)

    def _turn(self):
        self._side = -self._side


if __name__ == "__main__":
    rclpy.init()
    troupe_lockstep.spin([Patrol()], "patrol", needs=["scan"])
