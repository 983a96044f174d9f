"""Starts Nav2 for each robot of a run of Troupe, one stack in each ROS domain.

    ros2 launch examples/nav2/nav2.launch.py                            # in the domain of the environment
    ros2 launch examples/nav2/nav2.launch.py domains:=11,12,13          # three robots
    ros2 launch examples/nav2/nav2.launch.py localization:=amcl         # with troupe run --no-ros-map-odom
"""
import os
import pathlib

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

FOLDER = pathlib.Path(__file__).resolve().parent
OF_DISTRIBUTION = "params_humble.yaml" if os.environ.get("ROS_DISTRO") == "humble" else "params_jazzy.yaml"
# By package, in the order in which the lifecycle manager activates them.
SERVERS = {
    "nav2_controller": "controller_server",
    "nav2_planner": "planner_server",
    "nav2_behaviors": "behavior_server",
    "nav2_bt_navigator": "bt_navigator",
}


def manager(name, nodes, domain):
    return Node(package="nav2_lifecycle_manager", executable="lifecycle_manager", name=name, output="screen",
                additional_env=domain,
                parameters=[{"use_sim_time": True, "autostart": True, "node_names": nodes, "bond_timeout": 10.0}])


def nodes_of_domain(number, localization, navigation, ekf, params):
    domain = {"ROS_DOMAIN_ID": number} if number else {}
    nodes = []

    def add(package, executable):
        nodes.append(Node(package=package, executable=executable, name=executable, output="screen",
                          additional_env=domain, parameters=params))

    if ekf == "true":
        nodes.append(Node(package="robot_localization", executable="ekf_node", name="ekf_filter_node", output="screen",
                          additional_env=domain, parameters=params))
    if localization == "amcl":
        add("nav2_amcl", "amcl")
        nodes.append(manager("lifecycle_manager_localization", ["amcl"], domain))
    if localization == "slam":
        # Its map is not Troupe's.
        nodes.append(Node(package="slam_toolbox", executable="async_slam_toolbox_node", name="slam_toolbox",
                          output="screen", additional_env=domain, parameters=params,
                          remappings=[("/map", "/slam_map"), ("/map_metadata", "/slam_map_metadata")]))
    if navigation == "true":
        for package, executable in SERVERS.items():
            add(package, executable)
        nodes.append(manager("lifecycle_manager_navigation", list(SERVERS.values()), domain))
    return nodes


def start(context):
    def value(name):
        return LaunchConfiguration(name).perform(context)

    nodes = []
    for number in value("domains").split(","):
        nodes += nodes_of_domain(number, value("localization"), value("navigation"), value("ekf"),
                                 [value("params_file"), os.fspath(FOLDER / OF_DISTRIBUTION)])
    return nodes


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("domains", default_value="", description="ROS domains of the robots, separated by commas"),
        DeclareLaunchArgument("localization", default_value="troupe", choices=["troupe", "amcl", "slam"],
                              description="Node that publishes map to odom"),
        DeclareLaunchArgument("navigation", default_value="true", choices=["true", "false"]),
        DeclareLaunchArgument("ekf", default_value="false", choices=["true", "false"],
                              description="Filter of odometry and IMU, which publishes odom to base_link"),
        DeclareLaunchArgument("params_file", default_value=os.fspath(FOLDER / "params.yaml")),
        OpaqueFunction(function=start),
    ])
