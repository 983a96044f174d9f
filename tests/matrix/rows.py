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
    """A language in which a world is written. `file`: with all its things, for `troupe run`, or of a test for `troupe test`;
    `things`: those that can be written in it, None for all."""
    name: str
    file: str
    things: tuple = None
    runs: bool = True


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
    topic: str = ""  # of ROS 2, in which it is


@dataclasses.dataclass(frozen=True)
class Mode:
    """A way to run a world. `options`: of troupe run; `same`: the hashes are those of one process; `kills`: the programs
    that are killed while it runs; `answers`: a node of ROS 2 answers its ticks; `test`: options of `troupe test` for the same,
    None if it has none."""
    name: str
    options: tuple
    same: bool = True
    in_process: bool = False
    kills: tuple = ()
    answers: bool = False
    test: tuple = None


@dataclasses.dataclass(frozen=True)
class View:
    """An output. `tables`: of the state that it has, None for all; `marks`: it has the things without a table, too; `live`: of
    a run that goes on; `of_run`: it is an option of the run, and not made from the recording."""
    name: str
    tables: tuple = None
    marks: bool = False
    live: bool = False
    of_run: bool = False


@dataclasses.dataclass(frozen=True)
class Action:
    """A request to a paused run (`words`: of troupe, with {name} of a thing), or what happens to a run as a whole (no words:
    a function of commands.py). `of`: the tables, or names of rows, of the things that it is for, () for the whole run. `edits`:
    it is an edit of the world."""
    name: str
    words: tuple = ()
    of: tuple = ()
    edits: bool = False


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
          "always speed(rover) >= 0 m/s", 'position ( name "rover" pose [0 0 0 0] size [0.4 0.4 0.3] ctrl "wander" )',
          topic="/rover/odom"),
    Thing("robot with goals", "robots", "goer", {"robots": [_robot("goer", -4, 4, controller="go_to")]},
          "always speed(goer) <= 1 m/s", topic="/goer/odom"),
    Thing("gripper", "grippers", "picker.gripper",
          {"robots": [_robot("picker", 4, 0, [{"name": "gripper", "model": "gripper", "pose": [0.3, 0, -0.3, 0]}])]},
          'always left_contact(picker, "gripper") != "picker"',
          'position ( name "picker" pose [4 0 0 0] size [0.4 0.4 0.3] gripper ( name "gripper" pose [0.3 0 -0.3 0] ) )',
          topic="/picker/gripper/state"),
    Thing("object", "objects", "parcel",
          {"models": [{"name": "parcel", "model": "model", "pose": [8, 0, 0],
                       "properties": _box([0.2, 0.2, 0.2], gripper_return=1)}]},
          "always not falling(parcel)", 'model ( name "parcel" pose [8 0 0 0] size [0.2 0.2 0.2] gripper_return 1 )',
          topic="/objects"),
    Thing("static body", "", "", {"models": [{"name": "pillar", "model": "model", "pose": [12, 0, 0],
                                              "properties": _box([0.3, 0.3, 1])}]},
          "", 'model ( name "pillar" pose [12 0 0 0] size [0.3 0.3 1] )', mark="pillar", topic="/blocks"),
    Thing("joint", "joints", "crane.arm",
          {"robots": [_robot("crane", 0, 4, [{"name": "arm", "model": "actuator", "properties": _box(
              [0.1, 0.1, 0.1], axis=[0, 0, 1], max_speed=0.2)}])]},
          'always position(crane, "arm") >= 0 m',
          'position ( name "crane" pose [0 4 0 0] size [0.4 0.4 0.3] '
          'actuator ( name "arm" size [0.1 0.1 0.1] axis [0 0 1] max_speed 0.2 ) )', topic="/crane/joint_states"),
    Thing("door", "doors", "gate",
          {"models": [{"name": "gate", "model": "door", "pose": [4, 4, 90], "properties": {"kind": "hinged", "opening": 0}}]},
          "always opening(gate) <= 1", 'door ( name "gate" pose [4 4 0 90] kind "hinged" opening 0 )', topic="/door_states"),
    Thing("lift", "lifts", "hoist",
          {"models": [{"name": "hoist", "model": "lift", "pose": [8, 4, 0, 0], "properties": {
              "size": [2, 2, 0.05], "floors": ["low", "high"], "heights": [0, 3], "speed": 1},
              "children": [{"model": "block", "properties": {
                  "points": 4, "z": [-0.05, 0], "point[0]": [-1, -1], "point[1]": [1, -1], "point[2]": [1, 1],
                  "point[3]": [-1, 1]}}]}]},
          'always floor(hoist) == "low"',
          'lift ( name "hoist" pose [8 4 0 0] size [2 2 0.05] floors ["low" "high"] heights [0 3] speed 1 '
          'block ( points 4 point[0] [-1 -1] point[1] [1 -1] point[2] [1 1] point[3] [-1 1] z [-0.05 0] ) )', topic="/lift_states"),
    Thing("person", "people", "walker1",
          {"people": [{"count": 2, "region": [11, 3, 13, 5], "goals": [[12, 6], [12, 2]], "name_prefix": "walker"}]},
          "always speed(walker1) <= 2 m/s", topic="/people"),
    Thing("visitor", "visitors", "caller1",
          {"people": [{"count": 2, "region": [15, 3, 17, 5], "goals": [[16, 6]], "name_prefix": "caller", "wait": 1,
                       "visits": {"per_hour": 36000, "exits": [[16, 8]]}}]},
          "always visits(caller1) <= 40", topic="/people"),
    Thing("light", "lights", "signaller.lamp",
          {"robots": [_robot("signaller", 0, 8, [{"name": "lamp", "model": "blinkenlight"}])]},
          'always switched_on("signaller.lamp")',
          'position ( name "signaller" pose [0 8 0 0] size [0.4 0.4 0.3] blinkenlight ( name "lamp" ) )'),
    Thing("radio", "", "",
          {"robots": [_robot("talker", 4, 8, [{"name": "radio", "model": "radio", "properties": {"range": 9}}],
                             _script(send="hello")),
                      _robot("hearer", 5, 8, [{"name": "radio", "model": "radio", "properties": {"range": 9}}])]},
          "", mark="talker", topic="/talker/radio/received"),
    Thing("energy", "stores", "burner", {"robots": [_robot("burner", 8, 8, kjoules=1, watts=5)]},
          "always energy(burner) > 0 J",
          'position ( name "burner" pose [8 8 0 0] size [0.4 0.4 0.3] kjoules 1 watts 5 )', topic="/burner/battery"),
    Thing("place and region", "", "", {"places": [{"name": "dock", "pose": [0, 0, 0]}],
                                       "regions": [{"name": "yard", "region": [-20, -20, 20, 20]}],
                                       "robots": [_robot("guest", 12, 8)]},
          "always (in(guest, yard) and not at(guest, dock))", mark="guest"),
    *(Thing(name, "sensors", f"{name}_bot.the_{name}",
            {"robots": [_robot(f"{name}_bot", 4 * (i % 4), 12 + 4 * (i // 4), [_sensor(name)])]},
            f"forall s in sensors \"{name}_bot*\": always type(s) == \"{name}\"", topic=f"/{name}_bot/the_{name}")
      for i, name in enumerate(SENSORS)),
    Thing("robot on lanes", "robots", "courier",
          {"robots": [_robot("courier", 22, 8, controller={
              "name": "lanes", "parameters": {"planned": True, "places": ["end", "start"]}})]},
          "eventually arrivals(courier) >= 1", site=True, topic="/courier/odom"),
    Thing("zone", "zones", "wet", {"zones": [{"name": "wet", "kind": "cleaning", "region": [-2, -2, 2, 2]}]},
          "always share(wet) <= 1"),
    Thing("flow of goods", "flows", "parcels",
          {"flows": [{"name": "parcels", "from": "start", "to": "end", "per_hour": 3600, "robots": "courier"}]},
          "eventually arrived(parcels) >= 1", site=True),
    Thing("level", "levels", "L2", {}, "always robots(\"L2\") >= 0", site=True, topic="/building_map"),
    Thing("lane", "lanes", "", {}, "forall l in lanes: always robots(l) >= 0", site=True, mark="lane", topic="/building_map"),
)

INPUTS = (
    Input("scenario", "all.json"),
    Input("Stage world", "all.world", tuple(thing.name for thing in THINGS if thing.stage)),
    Input("building", "house.building.yaml", ("robot", "door", "lift", "person", "level", "lane")),
    Input("layout (LIF)", "lanes.lif.json", ("lane",)),
    Input("ROS map", "map.yaml", ()),
    Input("recording", "all.mcap"),
    Input("test", "all.test.json", runs=False),
)

PACKED = ("--robots-per-process", "20")
ROS = ("--ros", "--ros-interface", "lo", "--ros-domain", "{ros_domain}")
MODES = (
    Mode("one process", ("--in-process",), in_process=True, test=()),
    Mode("one thread", ("--in-process", "--threads", "1"), in_process=True, test=("--jobs", "1")),
    Mode("a process each", (), test=("--processes",)),
    Mode("packed", ("--robots-per-process", "4")),
    Mode("threads of the service", ("--threads", "2", *PACKED)),
    Mode("hosts", ("--hosts", "127.0.0.1", "--host-start", "{{command}}", "--interface", "lo", "--robots-per-process", "7")),
    Mode("no shared memory", ("--data-sharing", "off", "--robots-per-process", "7")),
    Mode("lost messages", ("--faults", "loss=0.05,duplicate=0.05,reorder=0.05,seed=3", "--robots-per-process", "7")),
    Mode("shuffled start", ("--shuffle-start", "1", "--robots-per-process", "7")),
    Mode("real time", ("--mode", "realtime", "--speed", "20", *PACKED), same=False),
    Mode("paced", ("--speed", "20", *PACKED)),
    Mode("ROS 2", (*ROS, *PACKED)),
    Mode("ROS 2 in the lockstep", (*ROS, "--ros-lockstep", "answerer", *PACKED), answers=True),
    Mode("security", ("--security", "on", *PACKED)),
    Mode("rebuild", ("--on-agent-loss", "rebuild", "--robots-per-process", "7", "--speed", "20"), kills=("robot-agent",)),
    Mode("restart", ("--speed", "20", *PACKED), kills=("world-service",)),
)

VIEWS = (
    View("hash log", (), of_run=True),
    View("poses", ("robots", "objects", "people", "joints", "doors", "lifts"), of_run=True),
    View("scans", ("sensors",), of_run=True),
    View("JSON lines", ("robots", "grippers", "objects", "joints", "doors", "lifts", "people", "lights", "stores", "levels",
                        "lanes"), of_run=True),
    View("replay", ()),
    View("CSV"),
    View("Foxglove"),
    View("ROS bag"),
    View("expectations"),
    View("report"),
    View("picture", ()),
    View("static page", marks=True),
    View("Python"),
    View("ctl get", ("robots", "objects", "people", "doors", "lifts", "stores"), live=True),
    View("ctl list", ("robots", "objects", "people", "doors", "lifts"), live=True),
    View("page", marks=True, live=True),
    View("plots", live=True),
    View("Foxglove live", live=True),
    View("ROS topics", live=True),
)

MOVED = ("robots", "objects", "people", "stores")
RESTORED = ("robots", "objects", "stores")
ACTIONS = (
    Action("step", ("ctl", "step", "5")),
    Action("set pose", ("ctl", "set-pose", "{name}", "--pose", "{x},{y},0"), MOVED, edits=True),
    Action("delete", ("ctl", "delete", "{name}"), MOVED, edits=True),
    Action("restore", ("ctl", "restore", "{name}", "--pose", "{x},{y},0"), RESTORED, edits=True),
    Action("goto", ("goto", "{name}", "{x},{y}", "--no-wait"), ("robot with goals",)),
    Action("door", ("ctl", "door", "{name}", "open"), ("doors",)),
    Action("lift", ("ctl", "lift", "{name}", "high"), ("lifts",)),
    Action("zone", ("ctl", "zone", "{name}", "off"), ("zones",)),
    Action("lane", ("ctl", "lane", "start", "end", "close"), ("lane",)),
    Action("light", ("ctl", "light", "{name}", "off"), ("lights",)),
    Action("reset", ("ctl", "reset"), edits=True),
    Action("speed", ("ctl", "speed", "max")),
    Action("spawn", ("ctl", "spawn", "position", "--name", "late", "--pose", "-4,-4,0"), edits=True),
    Action("reset the states", ("ctl", "reset", "--state"), edits=True),
    Action("reset the time", ("ctl", "reset", "--time"), edits=True),
    Action("reset the spawned", ("ctl", "reset", "--spawned"), edits=True),
    Action("rewind", ("ctl", "rewind", "3"), edits=True),
    Action("kill"),
    Action("replay"),
    Action("branch"),
    Action("test"),
    Action("sweep"),
    Action("shard"),
    Action("search"),
)
