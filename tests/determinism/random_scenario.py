"""Scenarios of random bodies, robots, sensors, controllers, people, doors and lifts, half of them in a random building:
functions of a seed.

    random_scenario.py FOLDER FIRST COUNT      writes those of the seeds from FIRST on, and prints the names of their files
"""

import json
import math
import os
import pathlib
import random
import sys

DOORS = ("hinged", "double_hinged", "sliding", "double_sliding")
STOREY = 4  # m
WORLDS = pathlib.Path(__file__).resolve().parents[2] / "worlds"

INCLUDES = ("robots.inc", "furniture.inc", "grippers.inc")
CONTROLLERS = ("wander", "expand", "dynamic", "rasterize", "pioneer_flocking", "lasernoise")
COLORS = ("red", "blue", "green", "gold", "purple", "gray40")


class Generator(random.Random):
    def pose(self, half_width, z=0.0):
        # Some headings along an axis, for parallel edges.
        heading = 90 * self.randrange(4) if self.random() < 0.3 else self.uniform(-180, 180)
        return [self.uniform(-half_width, half_width), self.uniform(-half_width, half_width), z, heading]

    def block(self):
        """A polygon around the middle, often concave, in a height interval."""
        count = self.randint(3, 8)
        points = []
        for i in range(count):
            angle = 2 * math.pi * (i + self.uniform(0.1, 0.9)) / count
            radius = self.uniform(0.2, 1)
            points.append([radius * math.cos(angle), radius * math.sin(angle)])
        low = self.choice((0, self.uniform(0, 1)))
        return {"model": "block", "properties": {"points": count, "z": [low, low + self.uniform(0.1, 1)]} |
                {f"point[{i}]": point for i, point in enumerate(points)}}

    def body(self, half_width):
        properties = {"size": [self.uniform(0.1, 1.5) for _ in range(3)], "color": self.choice(COLORS),
                      "fiducial_return": self.randint(0, 3)}
        if self.random() < 0.2:
            properties["obstacle_return"] = 0
        if self.random() < 0.2:
            properties["ranger_return"] = self.choice((-1, 0.5))
        return {"model": self.choice(("model", "model", "blinkenlight")), "properties": properties,
                "pose": self.pose(half_width, self.choice((0, self.uniform(0, 0.5)))),
                "children": [self.block() for _ in range(self.randint(1, 2))]}

    def scanner(self):
        sensor = {"range": [0, self.uniform(2, 10)], "fov": self.uniform(60, 360), "samples": self.randint(20, 200)}
        if self.random() < 0.4:
            sensor["noise"] = [self.uniform(0, 1e-3), self.uniform(0, 0.02), self.uniform(0, 1)]
        if self.random() < 0.2:
            sensor |= {"planes": self.randint(2, 8), "vertical_fov": self.uniform(5, 40)}
        return {"model": "ranger", "pose": self.pose(0.1, -0.1),
                "children": [{"model": "sensor", "properties": sensor}]}

    def fiducial_finder(self):
        return {"model": "fiducial", "pose": [0, 0, -0.1, 0],
                "properties": {"fov": self.uniform(60, 360), "range_max": self.uniform(2, 8)}}

    def other_sensors(self):
        sensors = [
            ("contact", {}),
            ("bumper", {"noblocks": 1, "size": [0.4, 0.4, 0.1], "bcount": 1, "bpose[0]": [0.2, 0, 0, 0],
                        "blength": 0.3}),
            ("blobfinder", {"image": [40, 30], "colors_count": 2, "colors": self.sample(COLORS, 2)}),
            ("imu", {"gyro_noise": self.uniform(0, 1), "acceleration_noise": self.uniform(0, 0.1)}),
            ("camera", {"resolution": [32, 24], "fov": [self.uniform(40, 100), 50],
                        "pantilt": [0, self.uniform(-30, 30)]}),
            ("radio", {"range": self.uniform(3, 12), "loss": 0.05, "range_loss": 0.2, "wall_loss": 8,
                       "range_and_bearing": 1}),
        ]
        return [{"model": model, "pose": [0, 0, -0.1, 0], "properties": properties}
                for model, properties in sensors if self.random() < 0.4]

    def door(self, name, half_width):
        return {"name": name, "model": "door", "pose": self.pose(half_width), "properties": {
            "size": [self.uniform(0.6, 2), 0.05, 2], "kind": self.choice(DOORS), "side": self.choice(("right", "left")),
            "swing": self.choice((-1, 1)) * self.uniform(45, 120), "ratio": self.uniform(0.5, 2),
            "seconds": self.uniform(0.3, 3), "reach": self.choice((0, 1.5)), "opening": self.choice((0, 1, 0.4))}}

    def lift(self, name, half_width):
        """A plate that carries what is on it."""
        heights = [self.uniform(0, 0.1), self.uniform(0.5, 3)]
        plate = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
        return {"name": name, "model": "lift", "pose": self.pose(half_width, heights[0]),
                "properties": {"size": [2, 2, 0.05], "floors": ["low", "high"], "heights": heights,
                               "speed": self.uniform(0.2, 1)},
                "children": [{"model": "block", "properties": {"points": 4, "z": [-0.05, 0]} |
                              {f"point[{i}]": point for i, point in enumerate(plate)}}]}

    def people(self, half_width, z=0):
        region = [-half_width, -half_width, half_width, half_width]
        goals = [[self.uniform(-half_width, half_width), self.uniform(-half_width, half_width)] for _ in range(4)]
        people = {"count": self.randint(1, 6), "region": region, "z": z, "goals": goals, "wait": [0, self.uniform(0, 3)],
                  "name_prefix": f"person_{z}_", "group": self.randint(1, 2),
                  "reaction": self.choice(("regular", "curious", "scared", "careless"))}
        if self.randint(1, 3) == 1:
            people["visits"] = {"per_hour": self.uniform(1000, 20000), "exits": goals[:2], "stops": self.randint(0, 2)}
        return people

    def building(self, half_width):
        """Two storeys in a random system of coordinates, with walls, doors of all kinds, a lift and people."""
        system = self.choice(("reference_image", "cartesian_meters", "wgs84"))
        # From x and y in m to the file, for each level.
        if system == "wgs84":  # where zone 32 of UTM begins to count
            degree = 111_319.5  # m
            to_file = [lambda x, y: [9 + x / degree, y / degree]] * 2
            parameters = {"generate_crs": [1, "EPSG:32632"], "suggested_offset_x": [3, 500_000],
                          "suggested_offset_y": [3, 0]}
        elif system == "cartesian_meters":
            offset = [self.uniform(-100, 100), self.uniform(-100, 100)]
            to_file = [lambda x, y: [x + offset[0], y + offset[1]]] * 2
            parameters = {"offset_x": [3, offset[0]], "offset_y": [3, offset[1]]}
        else:
            to_file = [self.drawing(0), self.drawing(self.uniform(-3, 3))]
            parameters = {}
        levels = {f"L{i + 1}": self.level(half_width, i, to_file[i]) for i in range(2)}
        x, y = to_file[0](self.uniform(2, half_width - 1), self.uniform(2, half_width - 1))
        lift = {"width": self.uniform(1.2, 2), "depth": self.uniform(1.2, 2), "x": x, "y": y,
                "yaw": self.uniform(-3, 3), "reference_floor_name": "L1", "initial_floor_name": self.choice(("L1", "L2")),
                "doors": {"door": {"motion_axis_orientation": 0, "width": 1, "x": 0, "y": -0.9}},
                "level_doors": {"L1": ["door"], "L2": ["door"]}}
        return {"name": "random", "coordinate_system": system, "reference_level_name": "L1", "parameters": parameters,
                "levels": levels, "lifts": {"lift": lift}}

    def drawing(self, turn):
        """Pixels, y down, for a storey that is drawn turned by that many radians."""
        scale = self.uniform(5, 50)  # pixels for each m
        cos, sin = math.cos(turn), math.sin(turn)
        return lambda x, y: [scale * (cos * x - sin * y), -scale * (sin * x + cos * y)]

    def level(self, half_width, number, to_file):
        corners = [(-half_width, -half_width), (half_width, -half_width), (half_width, half_width),
                   (-half_width, half_width)]
        points = list(corners)
        walls = [[i, (i + 1) % 4] for i in range(4)]
        doors = []

        def segment(length):
            x, y, angle = self.uniform(-half_width, half_width - 2), self.uniform(-half_width, half_width - 2), self.uniform(0, 3)
            points.extend([(x, y), (x + length * math.cos(angle), y + length * math.sin(angle))])
            return [len(points) - 2, len(points) - 1]

        for _ in range(self.randint(1, 4)):
            walls.append(segment(self.uniform(0.5, 2)))
        for i in range(self.randint(1, 3)):
            doors.append(segment(self.uniform(0.7, 1.8)) + [{
                "name": [1, f"site_door_{number}_{i}"], "type": [1, self.choice(DOORS)],
                "motion_degrees": [3, self.uniform(45, 120)], "motion_direction": [2, self.choice((-1, 1))],
                "right_left_ratio": [3, self.uniform(0.5, 2)], "plugin": [1, "normal"]}])
        vertices = [[*to_file(x, y), 0, ""] for x, y in points]
        vertices[-1][3] = f"goal_{number}"
        return {"elevation": STOREY * number, "vertices": vertices, "walls": walls, "doors": doors,
                "measurements": [[0, 1, {"distance": [3, 2 * half_width]}]],
                "fiducials": [[*to_file(x, y), f"corner_{i}"] for i, (x, y) in enumerate(corners[:3])],
                "floors": [{"vertices": [0, 1, 2, 3]}]}

    def robot(self, name, half_width):
        properties = {
            "size": [self.uniform(0.2, 0.6), self.uniform(0.2, 0.6), self.uniform(0.15, 0.8)],
            "drive": self.choice(("diff", "omni", "car")),
            "localization": self.choice(("gps", "odom")),
            "fiducial_return": self.randint(0, 3),
        }
        if self.random() < 0.3:
            properties |= {"kjoules": self.uniform(0.1, 1), "watts": self.uniform(1, 50), "mass": self.uniform(1, 20)}
        sensors = [self.scanner(), self.fiducial_finder(), *self.other_sensors()]
        controller = self.choice(CONTROLLERS)
        if self.random() < 0.2:
            names = ("speed", "steering") if properties["drive"] == "car" else ("vx", "wz")
            command = {"at": 0} | {each: self.uniform(-1, 1) for each in names}
            if any(sensor["model"] == "radio" for sensor in sensors):
                command["send"] = f"here is {name}"
            controller = {"name": "script",
                          "parameters": {"repeat": True, "period": self.uniform(0.2, 1), "commands": [command]}}
        return {"name": name, "model": "position", "pose": self.pose(half_width), "properties": properties,
                "children": sensors, "controller": controller}


def operate(generator, scenario, building):
    """Has the first robot operate doors and lifts."""
    doors = [model["name"] for model in scenario["models"] if model["model"] == "door"]
    lifts = {"plate": ("low", "high", "")}
    if building:
        doors += [door[2]["name"][1] for level in building["levels"].values() for door in level["doors"]]
        lifts["lift"] = ("L1", "L2", "")
    commands = [{"at": at, "doors": {generator.choice(doors): generator.choice(("open", "close"))},
                 "lifts": {name: generator.choice(floors) for name, floors in lifts.items()}}
                for at in (0, 1, 2, 3.5)]
    scenario["robots"][0]["controller"] = {"name": "script",
                                           "parameters": {"repeat": True, "period": 5, "commands": commands}}


def random_scenario(seed, includes):
    """A scenario, and the building that it is in, or none. `includes`: the folder of the project's world files, from
    that of the scenario."""
    generator = Generator(seed)
    half_width = generator.uniform(3, 8)
    inside = half_width - 0.5
    walls = [{"model": "model", "pose": [side * x, side * y, 0, heading],
              "properties": {"size": [2 * half_width, 0.1, 1]}}
             for x, y, heading in ((0, half_width, 0), (half_width, 0, 90)) for side in (-1, 1)]
    region = [-inside, -inside, inside, inside]
    scenario = {
        "name": f"random {seed}",
        "include": [f"{includes}/{name}" for name in INCLUDES],
        "seed": seed,
        "properties": {"interval_sim": generator.choice((20, 50, 100))},
        "models": [generator.body(inside) for _ in range(generator.randint(4, 15))],
        "robots": [generator.robot(f"r{i}", inside) for i in range(generator.randint(2, 6))],
        "spawn": [{"model": model, "count": generator.randint(1, 3), "region": region, "heading": "random",
                   "name_prefix": model} | ({} if controller is None else {"controller": controller})
                  for model, controller in (("scout", "wander"), ("cart", "wander"), ("carton", None))],
        "people": [generator.people(inside)],
    }
    scenario["models"] += [generator.door(f"door_{i}", inside) for i in range(generator.randint(1, 3))]
    scenario["models"].append(generator.lift("plate", inside))
    building = generator.building(half_width) if seed % 2 == 1 else None
    if building:
        scenario["world"] = f"random_{seed}.building.yaml"
        scenario["people"].append(generator.people(inside, STOREY))
    else:
        scenario["models"] += walls
    operate(generator, scenario, building)
    return scenario, building


def write_random_scenarios(folder, first, count):
    """The files of the seeds from `first` on, one after another."""
    includes = os.path.relpath(WORLDS / "include", folder)
    for seed in range(first, first + count):
        scenario, building = random_scenario(seed, includes)
        file = pathlib.Path(folder) / f"random_{seed}.json"
        file.write_text(json.dumps(scenario, indent=1))
        if building:
            (file.parent / scenario["world"]).write_text(json.dumps(building, indent=1))  # which is YAML, too
        yield file


if __name__ == "__main__":
    print(*write_random_scenarios(pathlib.Path(sys.argv[1]), *map(int, sys.argv[2:])), sep="\n")
