#!/usr/bin/python3
"""The parts of the benchmark beside other simulators that need none of them: worlds of equal work, commands, table.

usage: check_peers.py --programs FOLDER
"""
import argparse
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "benchmarks"), str(ROOT / "scripts")]
from runner import peer_worlds, peers, report  # noqa: E402

ROBOTS = 30

parser = argparse.ArgumentParser()
parser.add_argument("--programs", required=True)
troupe = pathlib.Path(parser.parse_args().programs) / "troupe"


def numbers(text):
    return [float(number) for number in re.split(r"[ ,]+", text.strip())]


def check_worlds(folder):
    """Robots stand at the same places in the worlds of one work, apart from each other and between the walls."""
    own = peer_worlds.write_foot_bots(folder, ROBOTS)
    listed = subprocess.run([troupe, "check", own], stdout=subprocess.PIPE, text=True, check=True).stdout
    assert f"robots: {ROBOTS}\n" in listed and "warnings: 0" in listed, listed
    assert listed.count("controller wander, ranger:0 (24 sensors, 24 rays)") == ROBOTS, listed
    poses = {name: numbers(pose) for name, pose in re.findall(r'name "(r\d+)" pose \[ (.*?) \]', own.read_text())}
    assert len(poses) == ROBOTS, poses

    argos = xml.etree.ElementTree.parse(peer_worlds.write_argos(folder, ROBOTS, 50, "library.so")).getroot()
    assert argos.find("framework/experiment").get("length") == "5"
    bodies = {bot.get("id"): (numbers(bot.find("body").get("position")), numbers(bot.find("body").get("orientation")))
              for bot in argos.find("arena").iter("foot-bot")}
    assert bodies == {name: ([x, y, 0.0], [a, 0.0, 0.0]) for name, (x, y, _, a) in poses.items()}, bodies
    half = (ROBOTS * peer_worlds.FOOT_BOT_AREA) ** 0.5 / 2 - peer_worlds.FOOT_BOT
    places = [pose[:2] for pose in poses.values()]
    assert all(max(abs(x), abs(y)) < half for x, y in places), places
    assert all((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 > (2 * peer_worlds.FOOT_BOT) ** 2
               for i, a in enumerate(places) for b in places[:i])

    text = peer_worlds.write_mvsim(folder, ROBOTS).read_text()
    mvsim = xml.etree.ElementTree.fromstring(text.replace(":class", "_class"))  # a prefix that no name space explains
    assert len(mvsim.findall("vehicle")) == ROBOTS and len(mvsim.findall("block")) == 4
    assert all(vehicle.find("sensor/nrays").text == "12" for vehicle in mvsim.findall("vehicle"))


def check_stage(folder):
    """Stage and Troupe read one file, but for its end."""
    work = peers.StageWork("/bin/stage", folder)
    world = work.prepare(folder / "peers", 10)
    command, _ = work.command(world, 7)
    changed = [(a, b) for a, b in zip(world.read_text().splitlines(), command[-1].read_text().splitlines(), strict=True)
               if a != b]
    assert changed == [("quit_time 60", "quit_time 0.7")], changed


def check_table(folder):
    """A ratio compares two runs of a round, and a peer has no figure where it was left out."""
    def row(number, work, program, robots, time):
        return {"round": number, "work": work, "program": program, "robots": robots, "processor_us": time, "mib": 10.0}

    report.write(folder, "peers", [
        row(0, "12 rays", "troupe", 10, 1.0), row(0, "lidar", "mvsim", 10, 8.0), row(0, "24 rays", "troupe", 1000, 2.0),
        row(0, "24 rays", "argos", 1000, 16.0), row(1, "24 rays", "troupe", 1000, 4.0),
        row(1, "24 rays", "argos", 1000, 20.0), row(0, "24 rays", "troupe", 100_000, 3.0)])
    assert report.peers(folder) == [
        ("ARGoS 3, 24 proximity rays", "1,000", "3 us (2 to 4)", "18 us (16 to 20)", "6.5 (5 to 8)",
         "10 MiB (10 to 10)", "10 MiB (10 to 10)"),
        ("ARGoS 3, 24 proximity rays", "100,000", "3 us", "not measured", "", "10 MiB", ""),
        ("MVSim, lidar of 12 rays", "10", "1 us", "8 us", "8", "10 MiB", "10 MiB")], report.peers(folder)
    target = next(row for row in report.targets(folder) if "ARGoS 3" in row[0])
    assert target[2] == "**missed**" and target[3].startswith("0.163 (0.125 to 0.2)"), target


with tempfile.TemporaryDirectory() as name:
    check_worlds(pathlib.Path(name))
    check_stage(pathlib.Path(name))
    check_table(pathlib.Path(name))
print(f"{ROBOTS} robots are the same in the worlds of Troupe, ARGoS and MVSim")
