"""Worlds made for measuring. Troupe and Stage read the same files."""
import functools
import json
import pathlib
import random
import re
import shutil
import struct
import zlib

SCENARIOS = pathlib.Path(__file__).resolve().parents[2] / "worlds/scenarios"

# Rooms of 10 m x 7.5 m, with doors of 1.5 m in all four walls.
ROOM = (100, 75)  # pixels of 0.1 m
DOOR = 15
WALL = 2


def is_wall(x, y):
    in_x, in_y = x % ROOM[0], y % ROOM[1]
    across = in_x < WALL and abs(in_y - ROOM[1] // 2) > DOOR // 2
    along = in_y < WALL and abs(in_x - ROOM[0] // 2) > DOOR // 2
    return across or along


@functools.cache
def is_near_wall(x, y):
    """Whether a wall is within 2 pixels of a pixel of the first room, which all rooms are like."""
    near = range(-2, 3)
    return any(is_wall(x + dx, y + dy) for dx in near for dy in near)


def write_png(path, width, height, row_of, depth):
    """A grey image; row_of(y) gives a row's bytes, y from the top."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    packer = zlib.compressobj(1)
    data = b"".join(packer.compress(b"\0" + row_of(y)) for y in range(height)) + packer.flush()
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, 0, 0, 0, 0)) +
                     chunk(b"IDAT", data) + chunk(b"IEND", b""))


def write_building(path, width, height):
    rows = {}

    def row(y):
        key = y % ROOM[1] if y < height - WALL else -1
        if key not in rows:
            walls = [key == -1 or is_wall(x, y) or x >= width - WALL for x in range(width)]
            rows[key] = bytes(0 if wall else 255 for wall in walls)
        return rows[key]

    write_png(path, width, height, row, 8)


STAGE_HEADER = """
resolution 0.02
speedup -1
paused 0
threads 1
quit_time {seconds}
"""

MODELS = """
define building model
(
  color "gray30" boundary 0 gui_nose 0 gui_grid 0 gui_outline 0
  obstacle_return 1 ranger_return 1 gripper_return 0 fiducial_return 0
)
define ir sensor ( samples 1 range [ 0 2 ] fov 30 )
define swarmbot position
(
  size [ 0.100 0.100 0.100 ]
  ranger
  (
    pose [ 0 0 -0.050 0 ]
%s
  )
  ctrl "expand_swarm"
)
""" % "\n".join(f"    ir( pose [ 0 0 0 {angle} ] )" for angle in range(0, 360, 30))


def write_swarm(folder, robots, width=140.0, height=60.0, seconds=60):
    """Robots with 12 infrared rays in a building of rooms; sizes in m."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    pixels = (round(width * 10), round(height * 10))
    write_building(folder / "building.png", *pixels)
    free = []
    step = 3  # pixels between places
    for y in range(step, pixels[1] - step, step):
        for x in range(step, pixels[0] - step, step):
            if not is_near_wall(x % ROOM[0], (pixels[1] - 1 - y) % ROOM[1]):
                free.append((x, y))
    if len(free) < robots:
        raise ValueError(f"{robots} robots do not fit into {width} m x {height} m")
    places = random.Random(1).sample(free, robots)
    lines = [STAGE_HEADER.format(seconds=seconds), MODELS,
             f'building( name "building" size [ {width} {height} 0.5 ] pose [ 0 0 0 0 ] bitmap "building.png" )']
    for i, (x, y) in enumerate(places):
        at = (x / 10 - width / 2 + 0.05, y / 10 - height / 2 + 0.05)
        lines.append(f'swarmbot( name "r{i}" pose [ {at[0]:.3f} {at[1]:.3f} 0 {i * 37 % 360} ] )')
    world = folder / "swarm.world"
    world.write_text("\n".join(lines) + "\n")
    return world


def write_yard(folder, robots, door=False):
    """Robots without motion, sensors and contacts, and a door apart from them."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    side = 1
    while side * side < robots:
        side += 1
    lines = ["define bot position ( size [ 0.4 0.4 0.3 ] )"]
    lines += [f'bot( name "r{i}" pose [ {i % side} {i // side} 0 0 ] )' for i in range(robots)]
    if door:
        lines.append('door ( name "gate" pose [ -5 -5 0 0 ] kind "hinged" opening 0 )')
    world = folder / "yard.world"
    world.write_text("\n".join(lines) + "\n")
    return world


def write_lab_test(folder, count):
    """A test of the laboratory with ten expectations, for so many seeds."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    robots = ["body_at_cabinet", "laser_at_bench", "mast_at_table", "gripper_at_table", "load_at_table", "carrier"]
    test = folder / f"lab{count}.test.json"
    test.write_text(json.dumps({
        "scenario": str(SCENARIOS / "lab.json"), "vary": {"seed": {"range": [1, count, 1]}},
        "expect": [f"always speed({robot}) < 5 m/s" for robot in robots] + [
            "always distance(carrier, laser_at_bench) > 0.1 m", "eventually speed(carrier) > 0.1 m/s",
            "always z(carrier) < 1 m",
            "forall o in objects: always fall_speed(o) < 9 m/s"]}))
    return test


def write_site_map(folder, width=50_000, height=35_000):
    """A map of 0.02 m cells, with walls every 20 m and much empty space."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    bits = bytearray(b"\xff" * ((width + 7) // 8))
    for x in range(0, width, 1000):
        for i in range(8):
            bits[(x + i) // 8] &= ~(0x80 >> ((x + i) % 8))
    room = bytes(bits)
    wall = bytes(len(bits))
    door = b"\xff" * len(bits)
    write_png(folder / "site.png", width, height,
              lambda y: wall if y % 1000 < 8 else door if 400 < y % 1000 < 500 else room, 1)
    world = folder / "site.world"
    world.write_text('define site model ( obstacle_return 1 )\n'
                     f'site( name "site" size [ {width * 0.02:.2f} {height * 0.02:.2f} 1 ] bitmap "site.png" )\n'
                     'position( name "r0" pose [ 5 5 0 0 ] size [ 0.4 0.4 0.3 ] )\n')
    return world


def copy_for_stage(worlds, folder, name, seconds):
    """Stage's own worlds, with one that ends by itself and waits for no start; the path of that one."""
    if not folder.exists():
        shutil.copytree(worlds, folder)
    text = (folder / name).read_text()
    text = re.sub(r"^\s*(paused|threads|quit_time)\s.*$", "", text, flags=re.MULTILINE)
    path = (folder / name).with_name(f"{pathlib.Path(name).stem}_{seconds}.world")
    path.write_text(text + f"\npaused 0\nthreads 1\nquit_time {seconds}\n")
    return path
