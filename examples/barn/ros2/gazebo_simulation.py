"""The side of the simulator of the BARN Challenge's runner for ROS 2, for Troupe in place of Gazebo.

`barn_runner.py` of the port (Saadmaghani/The-Barn-Challenge-Ros2) asks a `GazeboSimulationController` for the pose and the
contacts of the robot, resets it and pauses: this class answers from a run of Troupe with `--ros --ros-names plain`, so that the
runner, its score and its lines of results stay as they are.

| the runner asks for | here |
|---|---|
| get_model_state() | /ground_truth (nav_msgs/Odometry), in the frame of the world |
| get_hard_collision() | /stalled (std_msgs/Bool): a contact cut a motion short since the last call |
| get_laser_scan() | /scan |
| reset_model() | /world/set_entity_state (simulation_interfaces) |
| pause(), unpause() | /world/set_simulation_state |
"""

import math

import rclpy
from geometry_msgs.msg import Pose
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from simulation_interfaces.msg import SimulationState
from simulation_interfaces.srv import SetEntityState, SetSimulationState
from std_msgs.msg import Bool

ROBOT = "jackal"  # as the file of its URDF is called


class GazeboSimulationController(Node):
    """`init_position`: x and y in m and the heading in rad, to which reset_model() moves the robot."""

    def __init__(self, init_position=(0.0, 0.0, 0.0)):
        super().__init__("barn_simulation")
        self.start = tuple(map(float, init_position))
        self.pose, self.scan, self.contacts = Pose(), None, 0
        self.create_subscription(Odometry, "/ground_truth", self._see_pose, 10)
        self.create_subscription(Bool, "/stalled", self._see_contact, 10)
        self.create_subscription(LaserScan, "/scan", self._see_scan, 10)
        self.placing = self.create_client(SetEntityState, "/world/set_entity_state")
        self.pausing = self.create_client(SetSimulationState, "/world/set_simulation_state")

    def _see_pose(self, message):
        self.pose = message.pose.pose

    def _see_contact(self, message):
        self.contacts += bool(message.data)

    def _see_scan(self, message):
        self.scan = message

    def get_model_state(self):
        return self.pose

    def get_hard_collision(self):
        found, self.contacts = self.contacts > 0, 0
        return found

    def get_laser_scan(self):
        while self.scan is None:
            rclpy.spin_once(self, timeout_sec=0.1)
        return self.scan

    def _call(self, client, request):
        while not client.wait_for_service(timeout_sec=1.0):
            self.get_logger().info(f"waiting for {client.srv_name}")
        future = client.call_async(request)
        rclpy.spin_until_future_complete(self, future)
        return future

    def reset_model(self):
        request = SetEntityState.Request()
        request.entity = ROBOT
        pose = request.state.pose
        pose.position.x, pose.position.y = self.start[:2]
        pose.orientation.z, pose.orientation.w = math.sin(self.start[2] / 2), math.cos(self.start[2] / 2)
        future = self._call(self.placing, request)
        # A pose that was published after the answer, so that the runner judges no older one.
        self.pose = None
        while self.pose is None and rclpy.ok():
            rclpy.spin_once(self, timeout_sec=0.1)
        return future

    def reset_init_model_state(self, init_position=(0.0, 0.0, 0.0)):
        self.start = tuple(map(float, init_position))

    def _set_state(self, state):
        request = SetSimulationState.Request()
        request.state.state = state
        return self._call(self.pausing, request)

    def pause(self):
        return self._set_state(SimulationState.STATE_PAUSED)

    def unpause(self):
        return self._set_state(SimulationState.STATE_PLAYING)
