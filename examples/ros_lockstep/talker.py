"""A talker: a text for each tick, on a timer with the period of the ticks.

    python3 talker.py --ros-args -p period:=0.1
"""
import rclpy
import troupe_lockstep
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self._texts = self.create_publisher(String, "chatter", 10)
        self._count = 0
        self.create_timer(self.declare_parameter("period", 0.1).value, self._talk)

    def _talk(self):
        self._count += 1
        self._texts.publish(String(data=f"{self._count} at {self.get_clock().now().nanoseconds} ns"))


if __name__ == "__main__":
    rclpy.init()
    troupe_lockstep.spin([Talker()], "talker")
