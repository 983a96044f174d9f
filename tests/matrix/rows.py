"""The list of what exists: inputs, things, modes, views and actions, a row for each. matrix.py goes over all pairs of rows.

A new feature is one row here. Its pairs with all other rows are then made and checked by the same checks, and the page
docs/matrix.md has its row and its column.
"""

import dataclasses
import pathlib

WORLDS = pathlib.Path(__file__).resolve().parents[2] / "worlds"
TICKS = 40


@dataclasses.dataclass(frozen=True)
class Input:
    """A language in which a world is written. `file`: the file that `troupe run` is given; `things`: those that can be
    written in it, None for all."""
    name: str
    file: str
    things: tuple = None


@dataclasses.dataclass(frozen=True)
class Thing:
    """A kind of thing. `parts`: keys of a scenario, whose lists are added to those of others; `table`, `row`: its table of
    the state and a row there; `holds`: an expectation that holds, because the thing is there; `stage`: the same as text
    of a world file; `site`: it is a part of a building."""
    name: str
    table: str
    row: str
    parts: dict
    holds: str
    stage: str = ""
    site: bool = False
    mark: str = ""  # of a thing without a row: a text that views have of it


@dataclasses.dataclass(frozen=True)
class Mode:
    """A way to run a world. `options`: of troupe run; `same`: the hashes are those of one process; `kills`: the programs
    that are killed while it runs."""
    name: str
    options: tuple
    same: bool = True
    in_process: bool = False
    kills: tuple = ()
    ticks: int = TICKS


@dataclasses.dataclass(frozen=True)
class View:
    """An output. `tables`: of the state that it has, None for all; `live`: of a run that goes on."""
    name: str
    tables: tuple = None
    live: bool = False


@dataclasses.dataclass(frozen=True)
class Action:
    """A request to a paused run, or what happens to it. `words`: of troupe ctl, with {name} of a thing; `of`: the tables
    whose things it is for, () for none; `refused`: what its refusal says for all other things."""
    name: str
    words: tuple
    of: tuple = ()
    refused: str = ""


def _box(size, **more):
    return {"size": size, **more}


def _robot(name, x, y, children=(), controller="idle", **properties):
    return {"name": name, "model": "position", "pose": [x, y, 0], "controller": controller, "children": list(children),
            "properties": {"size": [0.4, 0.4, 0.3], **properties}}


def _script(**command):
    return {"name": "script", "parameters": {"repeat": True, "period": 1, "commands": [{"at": 0, **command}]}}


SENSORS = {  # their models, with the properties of a small one
    "ranger": {},
    "fiducial": {"range_max": 4, "fov": 180},
    "bumper": {"bcount": 1, "bpose[0]": [0.2, 0, 0, 0], "blength": 0.3},
    "contact": {},
    "blobfinder": {"image": [20, 15], "colors_count": 1, "colors": ["red"]},
    "camera": {"resolution": [16, 12], "fov": [70, 50]},
    "imu": {},
}


def _sensor(name):
    children = [{"model": "sensor", "properties": {"range": [0, 5], "fov": 180, "samples": 5}}] if name == "ranger" else []
    return {"name": f"the_{name}", "model": name, "properties": SENSORS[name], "children": children}


THINGS = (
    Thing("robot", "robots", "rover", {"robots": [_robot("rover", 0, 0, controller="wander")]},
          "always speed(rover) >= 0 m/s", 'position ( name "rover" pose [0 0 0 0] size [0.4 0.4 0.3] ctrl "wander" )'),
    Thing("gripper", "grippers", "picker.gripper",
          {"robots": [_robot("picker", 4, 0, [{"name": "gripper", "model": "gripper", "pose": [0.3, 0, -0.3, 0]}])]},
          'always left_contact(picker, "gripper") != "picker"',
          'position ( name "picker" pose [4 0 0 0] size [0.4 0.4 0.3] gripper ( name "gripper" pose [0.3 0 -0.3 0] ) )'),
    Thing("object", "objects", "parcel",
          {"models": [{"name": "parcel", "model": "model", "pose": [8, 0, 0],
                       "properties": _box([0.2, 0.2, 0.2], gripper_return=1)}]},
          "always not falling(parcel)", 'model ( name "parcel" pose [8 0 0 0] size [0.2 0.2 0.2] gripper_return 1 )'),
    Thing("static body", "", "", {"models": [{"name": "pillar", "model": "model", "pose": [12, 0, 0],
                                              "properties": _box([0.3, 0.3, 1])}]},
          "", 'model ( name "pillar" pose [12 0 0 0] size [0.3 0.3 1] )', mark="pillar"),
    Thing("joint", "joints", "crane.arm",
          {"robots": [_robot("crane", 0, 4, [{"name": "arm", "model": "actuator", "properties": _box(
              [0.1, 0.1, 0.1], axis=[0, 0, 1], max_speed=0.2)}])]},
          'always position(crane, "arm") >= 0 m',
          'position ( name "crane" pose [0 4 0 0] size [0.4 0.4 0.3] '
          'actuator ( name "arm" size [0.1 0.1 0.1] axis [0 0 1] max_speed 0.2 ) )'),
    Thing("door", "doors", "gate",
          {"models": [{"name": "gate", "model": "door", "pose": [4, 4, 90], "properties": {"kind": "hinged", "opening": 0}}]},
          "always opening(gate) <= 1", 'door ( name "gate" pose [4 4 0 90] kind "hinged" opening 0 )'),
    Thing("lift", "lifts", "hoist",
          {"models": [{"name": "hoist", "model": "lift", "pose": [8, 4, 0, 0], "properties": {
              "size": [2, 2, 0.05], "floors": ["low", "high"], "heights": [0, 3], "speed": 1},
              "children": [{"model": "block", "properties": {
                  "points": 4, "z": [-0.05, 0], "point[0]": [-1, -1], "point[1]": [1, -1], "point[2]": [1, 1],
                  "point[3]": [-1, 1]}}]}]},
          'always floor(hoist) == "low"',
          'lift ( name "hoist" pose [8 4 0 0] size [2 2 0.05] floors ["low" "high"] heights [0 3] speed 1 '
          'block ( points 4 point[0] [-1 -1] point[1] [1 -1] point[2] [1 1] point[3] [-1 1] z [-0.05 0] ) )'),
    Thing("person", "people", "walker1",
          {"people": [{"count": 2, "region": [11, 3, 13, 5], "goals": [[12, 6], [12, 2]], "name_prefix": "walker"}]},
          "always speed(walker1) <= 2 m/s"),
    Thing("light", "lights", "signaller.lamp",
          {"robots": [_robot("signaller", 0, 8, [{"name": "lamp", "model": "blinkenlight"}])]},
          'always switched_on("signaller.lamp")',
          'position ( name "signaller" pose [0 8 0 0] size [0.4 0.4 0.3] blinkenlight ( name "lamp" ) )'),
    Thing("radio", "", "",
          {"robots": [_robot("talker", 4, 8, [{"name": "radio", "model": "radio", "properties": {"range": 9}}],
                             _script(send="hello")),
                      _robot("hearer", 5, 8, [{"name": "radio", "model": "radio", "properties": {"range": 9}}])]},
          "", mark="talker"),
    Thing("energy", "stores", "burner", {"robots": [_robot("burner", 8, 8, kjoules=1, watts=5)]},
          "always energy(burner) > 0 J",
          'position ( name "burner" pose [8 8 0 0] size [0.4 0.4 0.3] kjoules 1 watts 5 )'),
    Thing("place and region", "", "", {"places": [{"name": "dock", "pose": [0, 0, 0]}],
                                       "regions": [{"name": "yard", "region": [-20, -20, 20, 20]}],
                                       "robots": [_robot("guest", 12, 8)]},
          "always (in(guest, yard) and not at(guest, dock))", mark="guest"),
    *(Thing(name, "sensors", f"{name}_bot.the_{name}",
            {"robots": [_robot(f"{name}_bot", 4 * (i % 4), 12 + 4 * (i // 4), [_sensor(name)])]},
            f"forall s in sensors \"{name}_bot*\": always type(s) == \"{name}\"")
      for i, name in enumerate(SENSORS)),
    Thing("level", "levels", "L2", {}, "always robots(\"L2\") >= 0", site=True),
    Thing("lane", "lanes", "", {}, "forall l in lanes: always robots(l) >= 0", site=True, mark="lane"),
)

INPUTS = (
    Input("scenario", "all.json"),
    Input("Stage world", "all.world", tuple(thing.name for thing in THINGS if thing.stage)),
    Input("building", "house.building.yaml", ("robot", "door", "lift", "person", "level", "lane")),
    Input("layout (LIF)", "lanes.lif.json", ("lane",)),
    Input("ROS map", "map.yaml", ()),
    Input("recording", "all.mcap"),
    Input("test", "all.test.json"),
)

MODES = (
    Mode("one process", ("--in-process",), in_process=True),
    Mode("one thread", ("--in-process", "--threads", "1"), in_process=True),
    Mode("a process each", ()),
    Mode("packed", ("--robots-per-process", "4")),
    Mode("threads of the service", ("--threads", "2", "--robots-per-process", "20")),
    Mode("no shared memory", ("--data-sharing", "off", "--robots-per-process", "7")),
    Mode("lost messages", ("--faults", "loss=0.05,duplicate=0.05,reorder=0.05,seed=3", "--robots-per-process", "7")),
    Mode("shuffled start", ("--shuffle-start", "1", "--robots-per-process", "3")),
    Mode("real time", ("--mode", "realtime", "--speed", "20", "--robots-per-process", "20"), same=False),
    Mode("paced", ("--speed", "20", "--robots-per-process", "20")),
    Mode("ROS 2", ("--ros", "--robots-per-process", "20")),
    Mode("security", ("--security", "on", "--robots-per-process", "20")),
    Mode("rebuild", ("--on-agent-loss", "rebuild", "--robots-per-process", "7", "--speed", "20"), kills=("robot-agent",)),
    Mode("restart", ("--robots-per-process", "20", "--speed", "20"), kills=("world-service",)),
)

VIEWS = (
    View("hash log", ()),
    View("poses", ("robots", "objects", "people", "joints", "doors", "lifts")),
    View("scans", ("sensors",)),
    View("JSON lines", ("robots", "grippers", "objects", "joints", "doors", "lifts", "people", "lights", "stores", "levels",
                        "lanes")),
    View("replay", ()),
    View("CSV"),
    View("Foxglove"),
    View("ROS bag"),
    View("expectations"),
    View("picture", ()),
    View("Python"),
    View("ctl get", ("robots", "objects", "people", "doors", "lifts", "stores"), live=True),
    View("ctl list", ("robots", "objects", "people", "doors", "lifts"), live=True),
)

ACTIONS = (
    Action("step", ("step", "5")),
    Action("set pose", ("set-pose", "{name}", "--pose", "{x},{y},0"), ("robots", "objects", "people", "stores"), "{name}"),
    Action("delete", ("delete", "{name}"), ("robots", "objects", "people", "stores"), "{name}"),
    Action("restore", ("restore", "{name}", "--pose", "{x},{y},0"), ("robots", "objects", "stores"), "{name}"),
    Action("door", ("door", "{name}", "open"), ("doors",), "{name}"),
    Action("lift", ("lift", "{name}", "high"), ("lifts",), "{name}"),
    Action("light", ("light", "{name}", "off"), ("lights",), "{name}"),
    Action("speed", ("speed", "max")),
    Action("spawn", ("spawn", "position", "--name", "late", "--pose", "-4,-4,0")),
    Action("reset the states", ("reset", "--state")),
    Action("reset the time", ("reset", "--time")),
    Action("reset the spawned", ("reset", "--spawned")),
    Action("rewind", ("rewind", "3")),
    Action("reset", ("reset",)),
)
