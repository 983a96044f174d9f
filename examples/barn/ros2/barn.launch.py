"""The BARN Challenge for ROS 2 with Troupe in place of Gazebo: the port's Nav2 and runner, unchanged but for gazebo_simulation.py.

    cp gazebo_simulation.py PORT/jackal_helper/scripts/ && colcon build
    ros2 launch barn.launch.py world_idx:=6 out_file:=out.txt

`troupe` has to be in PATH. The robot, its scanner and its start are those of jackal.urdf beside this file.
"""

import pathlib

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import (DeclareLaunchArgument, ExecuteProcess, GroupAction, IncludeLaunchDescription, OpaqueFunction,
                            RegisterEventHandler, Shutdown, TimerAction)
from launch.event_handlers import OnProcessExit
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, SetRemap

GOAL = "{pose: {header: {frame_id: odom}, pose: {position: {x: 10.0}, orientation: {w: 1.0}}}}"


def start(context):
    index = int(LaunchConfiguration("world_idx").perform(context))
    if not 0 <= index < 300:
        raise ValueError(f"found world_idx {index}, expected 0 to 299")
    share = pathlib.Path(get_package_share_directory("jackal_helper"))
    robot = pathlib.Path(__file__).resolve().parent / "jackal.urdf"
    simulator = ExecuteProcess(
        cmd=["troupe", "run", str(share / f"worlds/BARN/world_{index}.world"), "--robot", f"{robot}@-2.25,3,90", "--headless",
             "--speed", "1", "--ros", "--ros-names", "plain", "--ros-cmd-vel", "stamped"],
        output="screen")
    # Troupe's names in place of those of Clearpath's drivers.
    navigation = GroupAction([
        SetRemap("/sensors/lidar2d_0/scan", "/scan"),
        SetRemap("/platform/odom/filtered", "/odom"),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(str(share / "launch/nav2_bringup.launch.py")),
            launch_arguments=[("use_sim_time", "true"), ("setup_path", str(share / "config")), ("scan_topic", "/scan"),
                              ("nav2_params_file", "nav2.yaml"), ("log_level", "WARN")]),
    ])
    runner = Node(package="jackal_helper", executable="barn_runner.py", output="screen", emulate_tty=True,
                  parameters=[{"world_idx": index, "out_file": LaunchConfiguration("out_file"), "timeout": 100,
                               "logging_throttle_duration_s": 1}])
    # `send_goal` waits for the server; the runner's clock starts with the motion.
    goal = ExecuteProcess(cmd=["ros2", "action", "send_goal", "/navigate_to_pose", "nav2_msgs/action/NavigateToPose", GOAL],
                          output="log")
    end = RegisterEventHandler(OnProcessExit(target_action=runner, on_exit=[Shutdown()]))
    return [simulator, navigation, runner, TimerAction(period=10.0, actions=[goal]), end]


def generate_launch_description():
    return LaunchDescription([DeclareLaunchArgument("world_idx", default_value="0"),
                              DeclareLaunchArgument("out_file", default_value="out.txt"), OpaqueFunction(function=start)])
