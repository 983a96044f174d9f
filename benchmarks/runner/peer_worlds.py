"""Worlds of equal work for Troupe, ARGoS 3 and MVSim, each in its own format: robots at the same places, four walls."""
import math
import pathlib
import random

FOOT_BOT_AREA = 1.0  # m2 for each foot-bot
LIDAR_AREA = 8.4     # m2 for each robot with a lidar, as in worlds.write_swarm
WALL = 0.1           # m, thick
FOOT_BOT = 0.085     # m, its radius
FOOT_BOT_HEIGHT = 0.147
RAYS = 24


def places(robots, area):
    """(x, y, heading) of robots around the origin, each somewhere in a cell of its own; m and whole degrees. And the
    side of their square."""
    side = math.sqrt(robots * area)
    columns = math.ceil(math.sqrt(robots))
    cell = side / columns
    shift = 0.25 * cell
    chance = random.Random(1)

    def in_cell(number):
        return (number + 0.5) * cell - side / 2 + chance.uniform(-shift, shift)

    return [(in_cell(i % columns), in_cell(i // columns), i * 37 % 360) for i in range(robots)], side


def walls(side):
    """(x, y, width, depth) of four walls around a square."""
    middle, length = (side + WALL) / 2, side + 2 * WALL
    return [(0, middle, length, WALL), (0, -middle, length, WALL), (middle, 0, WALL, side), (-middle, 0, WALL, side)]


def write(folder, name, lines):
    path = pathlib.Path(folder)
    path.mkdir(parents=True, exist_ok=True)
    path = path / name
    path.write_text("\n".join(lines) + "\n")
    return path


def ring(count, radius, start=0.0):
    """(x, y, angle) of points on a circle; degrees."""
    angles = [start + 360.0 * i / count for i in range(count)]
    return [(radius * math.cos(math.radians(a)), radius * math.sin(math.radians(a)), a) for a in angles]


def write_foot_bots(folder, robots):
    """For Troupe: bodies of twelve corners with the rays of a foot-bot."""
    corners = ring(12, FOOT_BOT)
    points = " ".join(f"point[{i}] [{x:.5f} {y:.5f}]" for i, (x, y, _) in enumerate(corners))
    sensors = [f"    sensor ( pose [ {x:.5f} {y:.5f} 0 {a:g} ] range [ 0 0.1 ] samples 1 )"
               for x, y, a in ring(RAYS, FOOT_BOT, 7.5)]
    found, side = places(robots, FOOT_BOT_AREA)
    lines = ["define foot_bot position", "(",
             f"  size [ {2 * FOOT_BOT} {2 * FOOT_BOT} {FOOT_BOT_HEIGHT} ] drive \"diff\"",
             f"  block ( points {len(corners)} {points} z [ 0 1 ] )",
             f"  ranger ( pose [ 0 0 {0.06 - FOOT_BOT_HEIGHT:g} 0 ]", *sensors, "  )",
             "  ctrl \"wander speed=0.1 min_distance=0.09\"", ")"]
    lines += [f"model ( size [ {width:.3f} {depth:.3f} 0.5 ] pose [ {x:.3f} {y:.3f} 0 0 ] )"
              for x, y, width, depth in walls(side)]
    lines += [f"foot_bot ( name \"r{i}\" pose [ {x:.3f} {y:.3f} 0 {a} ] )" for i, (x, y, a) in enumerate(found)]
    return write(folder, "foot_bots.world", lines)


def write_argos(folder, robots, ticks, library):
    """For ARGoS: foot-bots with a controller of a library, in its engine for planar dynamics with a spatial hash, which
    its documentation advises for thousands of equal robots."""
    found, side = places(robots, FOOT_BOT_AREA)
    size = side + 4 * WALL
    lines = ["<?xml version=\"1.0\"?>", "<argos-configuration>", "<framework><system threads=\"0\"/>",
             f"<experiment length=\"{ticks / 10:g}\" ticks_per_second=\"10\" random_seed=\"1\"/></framework>",
             f"<controllers><wandering_foot_bot id=\"wander\" library=\"{library}\">",
             "<actuators><differential_steering implementation=\"default\"/></actuators>",
             "<sensors><footbot_proximity implementation=\"default\"/></sensors><params/>",
             "</wandering_foot_bot></controllers>",
             f"<arena size=\"{size:.3f},{size:.3f},2\" center=\"0,0,0.5\">"]
    lines += [f"<box id=\"wall{i}\" size=\"{width:.3f},{depth:.3f},0.5\" movable=\"false\">"
              f"<body position=\"{x:.3f},{y:.3f},0\" orientation=\"0,0,0\"/></box>"
              for i, (x, y, width, depth) in enumerate(walls(side))]
    lines += [f"<foot-bot id=\"r{i}\"><body position=\"{x:.3f},{y:.3f},0\" orientation=\"{a},0,0\"/>"
              "<controller config=\"wander\"/></foot-bot>" for i, (x, y, a) in enumerate(found)]
    lines += ["</arena>", "<physics_engines><dynamics2d id=\"plane\">",
              f"<spatial_hash cell_size=\"0.2\" cell_num=\"{10 * robots + 100}\"/></dynamics2d></physics_engines>",
              "<media/>", "</argos-configuration>"]
    return write(folder, f"foot_bots_{ticks}.argos", lines)


def rectangle(width, depth):
    return "".join(f"<pt>{x * width / 2:.3f} {y * depth / 2:.3f}</pt>" for x, y in [(-1, -1), (-1, 1), (1, 1), (1, -1)])


def write_mvsim(folder, robots):
    """For MVSim: robots of the size and with the 12 rays of worlds.write_swarm, on two wheels. Its steps are its own."""
    found, side = places(robots, LIDAR_AREA)
    lines = ["<mvsim_world version=\"1.0\">", "<simul_timestep>0</simul_timestep>", "<vehicle:class name=\"swarmbot\">",
             "<dynamics class=\"differential\">",
             "<l_wheel pos=\"0 0.04\" mass=\"0.1\" width=\"0.01\" diameter=\"0.04\"/>",
             "<r_wheel pos=\"0 -0.04\" mass=\"0.1\" width=\"0.01\" diameter=\"0.04\"/>",
             f"<chassis mass=\"1\" zmin=\"0.02\" zmax=\"0.1\"><shape>{rectangle(0.1, 0.1)}</shape></chassis>",
             "<controller class=\"twist_ideal\"/></dynamics>",
             "<friction class=\"default\"><mu>0.7</mu></friction></vehicle:class>"]
    lines += [f"<block><static>true</static><zmin>0</zmin><zmax>0.5</zmax><shape>{rectangle(width, depth)}</shape>"
              f"<init_pose>{x:.3f} {y:.3f} 0</init_pose></block>" for x, y, width, depth in walls(side)]
    # The ends of the fan are rays too: twelve, 30 degrees apart, span 330 degrees, and one is straight ahead.
    lidar = ("<sensor class=\"laser\" name=\"lidar\"><pose_3d>0 0 0.05 15 0 0</pose_3d><fov_degrees>330</fov_degrees>"
             "<nrays>12</nrays><max_range>2</max_range><sensor_period>0.1</sensor_period>"
             "<range_std_noise>0</range_std_noise><raytrace_3d>false</raytrace_3d></sensor>")
    lines += [f"<vehicle name=\"r{i}\" class=\"swarmbot\"><init_pose>{x:.3f} {y:.3f} {a}</init_pose>{lidar}</vehicle>"
              for i, (x, y, a) in enumerate(found)]
    return write(folder, "lidars.world.xml", [*lines, "</mvsim_world>"])
