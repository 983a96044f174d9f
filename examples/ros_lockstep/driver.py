"""A reactive driver: for each scan a command. docs/ros2-lockstep.md of Troupe explains the runs that wait for it.

    python3 driver.py --ros-args -r scan:=/anna/scan -r cmd_vel:=/anna/cmd_vel
"""
import rclpy
import troupe_lockstep
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self._commands = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(LaserScan, "scan", self._drive, 10)

    def _drive(self, scan):
        ranges = [min(value, scan.range_max) for value in scan.ranges]
        third = len(ranges) // 3
        right, ahead, left = ranges[:third], ranges[third:-third], ranges[-third:]
        command = Twist()
        blocked = min(ahead) < 0.7
        command.linear.x = 0.0 if blocked else 0.4
        command.angular.z = 0.8 if blocked else 0.5 * (sum(left) - sum(right)) / (sum(left) + sum(right))
        self._commands.publish(command)


if __name__ == "__main__":
    rclpy.init()
    troupe_lockstep.spin([Driver()], "driver", needs=["scan"])
