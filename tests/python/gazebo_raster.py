"""A raster of worlds of Gazebo that shares nothing with Troupe: it reads the XML by Python's parser, multiplies the poses as
matrices, and asks of each point of a grid whether it is in a box, a cylinder or a sphere of a static model.

    python3 gazebo_raster.py [--height M] FOLDER...       # all worlds below the folders: which load, and how they compare

`NAME` of model://NAME is sought in all folders below the given ones that have a model.sdf or a model.config.
"""

import argparse
import math
import os
import pathlib
import re
import sys
import xml.etree.ElementTree as xml

import numpy

CELL = 0.025  # m, of the raster
SLACK = 0.05  # m
REACH = 60.0  # m, to the sides of the origin: farther obstacles are not compared


class Unknown(Exception):
    """What this raster does not read, such as a mesh."""


def root(file):
    """Of an XML file, whose prefixes need no declaration here."""
    return xml.fromstring(re.sub(r"(</?|\s)(?!xmlns)\w+:(\w+)(?=[\s=/>])", r"\1\2", pathlib.Path(file).read_text(errors="replace")))


def matrix(element):
    """Of the `pose` of an element: x y z roll pitch yaw."""
    text = element.findtext("pose") or "0 0 0 0 0 0"
    attributes = element.find("pose").attrib if element.find("pose") is not None else {}
    if attributes.get("rotation_format", "euler_rpy") != "euler_rpy":
        raise Unknown("a quaternion")
    x, y, z, *angles = map(float, text.split())
    if attributes.get("degrees") == "true":
        angles = map(math.radians, angles)
    (a, b), (c, d), (e, f) = ((math.cos(angle), math.sin(angle)) for angle in angles)
    turn = (numpy.array([[e, -f, 0], [f, e, 0], [0, 0, 1]]) @ numpy.array([[c, 0, d], [0, 1, 0], [-d, 0, c]])
            @ numpy.array([[1, 0, 0], [0, a, -b], [0, b, a]]))
    pose = numpy.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, (x, y, z)
    return pose


def relative(element, frames):
    """The frame of the `pose` of an element."""
    pose = element.find("pose")
    name = pose.get("relative_to", pose.get("frame", "")) if pose is not None else ""
    if name and name not in frames:
        raise Unknown(f"the frame {name}")
    return frames[name] if name else numpy.eye(4)


def is_static(model):
    return model.findtext("static", "0").strip() in ("true", "1")


def model_solids(model, pose):
    """(pose, geometry) of the collisions of a static model at a pose."""
    if model.find("model") is not None or model.find("include") is not None:
        raise Unknown("a nested model")
    frames = {"__model__": numpy.eye(4)}
    for frame in model.findall("frame"):
        if frame.get("attached_to"):
            raise Unknown("a frame on another")
        frames[frame.get("name")] = relative(frame, frames) @ matrix(frame)
    for link in model.findall("link"):
        at = pose @ relative(link, frames) @ matrix(link)
        for collision in link.findall("collision"):
            geometry = collision.find("geometry")
            kind = next((child.tag for child in geometry), None)
            if kind in ("box", "cylinder", "sphere"):
                yield at @ matrix(collision), geometry
            elif kind not in ("plane", "empty", None):
                raise Unknown(kind)


def solids(file, left_out=(), models=None):
    """(solids, names of static models that are left out) of a world. `models`: files of models by their names."""
    world = root(file).find("world")
    states = {model.get("name"): model for state in world.findall("state") for model in state.findall("model")}
    frames = {"world": numpy.eye(4)}
    found, unknown = [], []
    for element in [*world.findall("model"), *world.findall("include")]:
        name = element.get("name") or element.findtext("name") or ""
        try:
            model = element
            if element.tag == "include":
                uri = element.findtext("uri", "").strip()
                if uri.lower().rstrip("/0123456789").endswith(("/sun", "/ground_plane", "/ground plane")):
                    continue
                model = root((models or {})[uri.rstrip("/").rsplit("/", 1)[-1]]).find("model")
                name = name or model.get("name")
            if not is_static(element if element.find("static") is not None else model) or name in left_out:
                continue
            placed = states.get(name, element if element.tag == "model" or element.find("pose") is not None else model)
            pose = relative(placed, frames) @ matrix(placed)
            found += model_solids(model, pose)
        except (Unknown, KeyError, AttributeError) as fault:
            unknown.append(f"{name}: {fault}")
    return found, unknown


def inside(points, pose, geometry):
    """Which of the points (n, 3) are in the solid."""
    x, y, z = (numpy.linalg.inv(pose)[:3] @ numpy.column_stack([points, numpy.ones(len(points))]).T)
    if (box := geometry.find("box")) is not None:
        half = [float(word) / 2 for word in box.findtext("size").split()]
        return (abs(x) <= half[0]) & (abs(y) <= half[1]) & (abs(z) <= half[2])
    if (cylinder := geometry.find("cylinder")) is not None:
        return (numpy.hypot(x, y) <= float(cylinder.findtext("radius"))) & (abs(z) <= float(cylinder.findtext("length")) / 2)
    return numpy.sqrt(x**2 + y**2 + z**2) <= float(geometry.find("sphere").findtext("radius"))


def radius(geometry):
    """m, of a ball around the solid."""
    if (box := geometry.find("box")) is not None:
        return math.hypot(*(float(word) / 2 for word in box.findtext("size").split()))
    if (cylinder := geometry.find("cylinder")) is not None:
        return math.hypot(float(cylinder.findtext("radius")), float(cylinder.findtext("length")) / 2)
    return float(geometry.find("sphere").findtext("radius"))


def draw(shapes, origin, rows, columns, height, cell=CELL):
    """(rows, columns): whether the centre of a cell is in a solid at the height. `origin`: of the lower left corner, m."""
    raster = numpy.zeros((rows, columns), bool)
    for pose, geometry in shapes:
        reach = radius(geometry) + cell
        low = [max(int((pose[i, 3] - reach - origin[i]) / cell), 0) for i in (0, 1)]
        high = [min(int((pose[i, 3] + reach - origin[i]) / cell) + 1, count) for i, count in ((0, columns), (1, rows))]
        if low[0] >= high[0] or low[1] >= high[1] or abs(pose[2, 3] - height) > reach:
            continue
        x = origin[0] + (numpy.arange(low[0], high[0]) + 0.5) * cell
        y = origin[1] + (numpy.arange(low[1], high[1]) + 0.5) * cell
        points = numpy.column_stack([*(grid.ravel() for grid in numpy.meshgrid(x, y)), numpy.full(len(x) * len(y), height)])
        raster[low[1]:high[1], low[0]:high[0]] |= inside(points, pose, geometry).reshape(len(y), len(x))
    return raster


def grown(cells, reach, cell=CELL):
    """Cells within `reach` m of the given ones."""
    steps = round(reach / cell)
    rows, columns = cells.shape
    wide = numpy.zeros((rows + 2 * steps, columns + 2 * steps), bool)
    for dy in range(-steps, steps + 1):
        for dx in range(-steps, steps + 1):
            if dx * dx + dy * dy <= steps * steps:
                wide[steps + dy:steps + dy + rows, steps + dx:steps + dx + columns] |= cells
    return wide[steps:-steps, steps:-steps]


def compare(simulation, shapes, height):
    """(cells of the raster, those that the map of Troupe lacks, those of the map that the raster lacks)."""
    occupancy = simulation.map(CELL, height)
    occupied = numpy.asarray(occupancy.occupied)
    raster = draw(shapes, occupancy.origin, *occupied.shape, height)
    return int(raster.sum()), int((raster & ~grown(occupied, SLACK)).sum()), int((occupied & ~grown(raster, SLACK)).sum())


def trial(file, height, models):
    """A line of the table: the file, whether it loads, and how it compares."""
    import troupe
    try:
        simulation = troupe.Simulation(str(file))
    except (troupe.Error, ValueError, OSError) as fault:
        return f"refused | {fault}"
    try:
        shapes, unknown = solids(file, models=models)
    except xml.ParseError as fault:
        return f"loads | not compared: {fault}"
    limits = simulation.map(0.5, height)
    rows, columns = numpy.asarray(limits.occupied).shape
    if max(rows, columns) * 0.5 > 2 * REACH:
        return f"loads | not compared: {columns * 0.5:.0f} m x {rows * 0.5:.0f} m"
    cells, missing, more = compare(simulation, shapes, height)
    if cells == 0:
        return f"loads | no simple static obstacle at this height, left out: {len(unknown)}"
    both = f", {more} cells more" if not unknown else f" (left out: {len(unknown)}, {unknown[0]})"
    return f"loads | {cells} cells, {missing} missing{both}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--height", type=float, default=0.2, help="m, of the lidar (0.2)")
    options = parser.parse_args()
    models, paths = {}, set()
    for folder in options.folders:
        for name in ("model.sdf", "model.config"):
            for file in sorted(pathlib.Path(folder).rglob(name)):
                models.setdefault(file.parent.name, file.parent / "model.sdf")
                paths.add(str(file.parent.parent))
    os.environ["GZ_SIM_RESOURCE_PATH"] = ":".join([os.environ.get("GZ_SIM_RESOURCE_PATH", ""), *sorted(paths)])
    for folder in options.folders:
        for file in sorted(pathlib.Path(folder).rglob("*")):
            if file.suffix not in (".sdf", ".world") or file.name.startswith("model") or not file.is_file():
                continue
            text = file.read_text(errors="replace")
            if "<world" not in text:
                continue
            print(f"{file} | {trial(file, options.height, models)}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
