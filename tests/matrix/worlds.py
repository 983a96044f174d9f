"""The worlds of the rows: scenarios of some things, and the same in the other languages."""

import json

from rows import INPUTS, THINGS, TICKS

ROVER = ('<robot name="rover"><link name="base"><collision><geometry><box size="0.4 0.4 0.2"/></geometry></collision></link>'
         "</robot>\n")
HOUSE = """name: house
coordinate_system: cartesian_meters
levels:
  L1:
    elevation: 0
    vertices: [[20, 0, 0, ""], [30, 0, 0, ""], [30, 10, 0, ""], [20, 10, 0, ""], [25, 0, 0, ""], [25, 5, 0, ""],
               [25, 6, 0, ""], [25, 10, 0, ""], [22, 2, 0, "start", {is_parking_spot: [4, true],
               spawn_robot_name: [1, tiny], spawn_robot_type: [1, TinyRobot]}], [22, 8, 0, "end"],
               [28, 2, 0, "seats", {human_goal_set_name: [1, seats]}]]
    walls: [[0, 1, {}], [1, 2, {}], [2, 3, {}], [3, 0, {}], [4, 5, {}], [6, 7, {}]]
    floors: [{vertices: [0, 1, 2, 3]}]
    doors: [[5, 6, {name: [1, house_door], type: [1, hinged], motion_degrees: [3, 90], motion_direction: [2, 1],
             right_left_ratio: [3, 1], plugin: [1, normal]}]]
    lanes: [[8, 9, {bidirectional: [4, true], graph_idx: [2, 0]}]]
  L2:
    elevation: 4
    vertices: [[20, 0, 0, ""], [30, 0, 0, ""], [30, 10, 0, ""], [20, 10, 0, ""]]
    walls: [[0, 1, {}], [1, 2, {}], [2, 3, {}], [3, 0, {}]]
    floors: [{vertices: [0, 1, 2, 3]}]
lifts:
  house_lift: {width: 1.6, depth: 1.6, x: 28, y: 8, yaw: 0, reference_floor_name: L1, initial_floor_name: L1,
               doors: {door: {motion_axis_orientation: 0, width: 1, x: 0, y: -0.9}},
               level_doors: {L1: [door], L2: [door]}}
crowd_sim:
  enable: 1
  update_time_step: 0.1
  agent_profiles:
    - {name: guest, class: 1, max_accel: 5, max_angle_vel: 360, max_neighbors: 10, max_speed: 1.6, neighbor_dist: 5,
       obstacle_set: 1, pref_speed: 1.2, r: 0.25, ORCA_tau: 1, ORCA_tauObst: 0.4}
  agent_groups:
    - {group_id: 1, agents_name: [], agents_number: 1, profile_selector: guest, state_selector: arriving, x: 27, y: 4}
  states:
    - {name: static, final: 1, goal_set: -1, navmesh_file_name: ""}
    - {name: arriving, final: 0, goal_set: 0, navmesh_file_name: L1.nav}
  goal_sets: [{set_id: 0, capacity: 10, set_area: [seats]}]
  transitions:
    - {from: arriving, to: "", Target: [{name: static, weight: 1}], Condition: {type: goal_reached, distance: 0.5}}
"""

LANES = {
    "metaInformation": {"projectIdentification": "lanes", "creator": "Troupe", "exportTimestamp": "2026-01-01T00:00:00Z",
                        "lifVersion": "1.0.0"},
    "layouts": [{
        "layoutId": "hall", "layoutVersion": "1", "layoutLevelId": "ground",
        "nodes": [{"nodeId": name, "mapId": "hall", "nodePosition": {"x": x, "y": 0},
                   "vehicleTypeNodeProperties": [{"vehicleTypeId": "tug"}]} for name, x in (("west", 0), ("east", 8))],
        "edges": [{"edgeId": f"e{i}", "startNodeId": a, "endNodeId": b,
                   "vehicleTypeEdgeProperties": [{"vehicleTypeId": "tug", "maxSpeed": 0.5}]}
                  for i, (a, b) in enumerate((("west", "east"), ("east", "west")))],
        "stations": []}]}

MAP = """image: map.pgm
mode: trinary
resolution: 0.5
origin: [0, 0, 0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.25
"""

HEAT = ["robots", "people", "waits"]


def scenario(things):
    """A scenario of these things: the lists of their parts are joined."""
    joined = {"name": "matrix", "seed": 5, "ticks": TICKS}
    if any(thing.site for thing in things):
        joined["world"] = "house.building.yaml"
    for thing in things:
        for key, entries in thing.parts.items():
            joined[key] = joined.get(key, []) + entries
    return joined


def test_of(things, **more):
    """A test of these things, whose expectations hold because they are there."""
    expect = [{"name": thing.name, "that": thing.holds} for thing in things if thing.holds]
    return scenario(things) | {"expect": expect, "vary": {"seed": {"values": [5]}},
                               "metrics": {"robots": "count(robots)"}, "heat": HEAT} | more


def base_of(source):
    """The begin of the names of files that are made from an input."""
    return "of_" + source.name.split()[0]


def test_of_file(source):
    """A test of the world of an input; a recording is tested by `--on`."""
    if source.name in ("scenario", "test"):
        return test_of(THINGS)
    world = {} if source.name == "recording" else {"world": source.file}
    return {**world, "ticks": TICKS, "expect": [{"name": "it runs", "that": "always count(robots) >= 0"}],
            "vary": {"seed": {"values": [5, 6]}}, "metrics": {"robots": "count(robots)"}, "heat": HEAT}


def write(folder, name, things):
    """Writes NAME.json, NAME.test.json, NAME.world and the site of these things."""
    (folder / f"{name}.json").write_text(json.dumps(scenario(things)))
    (folder / f"{name}.test.json").write_text(json.dumps(test_of(things)))
    (folder / f"{name}.world").write_text('name "matrix"\n' + "".join(thing.stage + "\n" for thing in things))
    if not (folder / "house.building.yaml").exists():
        (folder / "house.building.yaml").write_text(HOUSE)
        (folder / "rover.urdf").write_text(ROVER)
        for source in INPUTS:
            (folder / f"{base_of(source)}.test.json").write_text(json.dumps(test_of_file(source)))
        (folder / "lanes.lif.json").write_text(json.dumps(LANES))
        (folder / "map.yaml").write_text(MAP)
        (folder / "map.pgm").write_bytes(b"P5\n4 4\n255\n" + bytes([0, 254, 254, 254] * 4))


def can_be_written(thing, source):
    return source.things is None or thing.name in source.things


assert all(name in {thing.name for thing in THINGS} for source in INPUTS for name in source.things or ())
