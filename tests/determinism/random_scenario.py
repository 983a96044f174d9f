"""Scenarios of random bodies, robots, sensors and controllers: functions of a seed."""

import math
import random

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


def random_scenario(seed, includes):
    """`includes`: the folder of the project's world files, from that of the scenario."""
    generator = Generator(seed)
    half_width = generator.uniform(3, 8)
    walls = [{"model": "model", "pose": [side * x, side * y, 0, heading],
              "properties": {"size": [2 * half_width, 0.1, 1]}}
             for x, y, heading in ((0, half_width, 0), (half_width, 0, 90)) for side in (-1, 1)]
    region = [-half_width + 0.5, -half_width + 0.5, half_width - 0.5, half_width - 0.5]
    return {
        "name": f"random {seed}",
        "include": [f"{includes}/{name}" for name in INCLUDES],
        "seed": seed,
        "properties": {"interval_sim": generator.choice((20, 50, 100))},
        "models": walls + [generator.body(half_width - 0.5) for _ in range(generator.randint(4, 15))],
        "robots": [generator.robot(f"r{i}", half_width - 0.5) for i in range(generator.randint(2, 6))],
        "spawn": [{"model": model, "count": generator.randint(1, 3), "region": region, "heading": "random",
                   "name_prefix": model} | ({} if controller is None else {"controller": controller})
                  for model, controller in (("scout", "wander"), ("cart", "wander"), ("carton", None))],
    }
