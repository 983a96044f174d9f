#!/usr/bin/python3
"""Writes a warehouse for vehicles of VDA 5050: a world, a scenario, a layout in LIF, and jobs for fleet_control.py.

usage: make_warehouse.py FOLDER [--vehicles N] [--jobs N] [--seed S] [--doors] [--people N] [--name NAME]

Aisles with racks at both sides lead north and south in turn, between a road to the east and one to the west. Each vehicle has a
charger beside a road. Half of the racks have a pallet; each job brings one to an empty rack. With --doors a wall with a sliding door
on each road divides the hall; the vehicles open them. People of --people cross the roads.
"""
import argparse
import json
import pathlib
import random

STEP = 3.0       # m between nodes
ROWS = 4         # nodes of an aisle between the roads are 1 to ROWS - 1
MAP = "warehouse"
DOORWAY = 1.8    # m

WORLD = """# Written by examples/fleet_control/make_warehouse.py: {vehicles} vehicles of VDA 5050 (docs/vda5050.md).
name "{name}"
define wall model ( color "gray60" )
define rack model ( size [1 1.2 0.25] color "slate gray" gui_nose 0 )
define pallet model ( size [0.4 0.5 0.3] color "peru" gui_nose 0 gripper_return 1 )
define charger model ( size [1.2 1.2 0.02] color "light green" obstacle_return 0 joules -1 give_watts 2000 )
define cart position
(
  size [0.8 0.6 0.3]
  drive "diff"
  velocity_bounds [ -1 1 0 0 0 0 -60 60 ]
  acceleration_bounds [ -0.8 0.8 0 0 0 0 -120 120 ]
  kjoules 500  watts 20  mass 60  take_watts 2000
)
"""


class Warehouse:
    def __init__(self, vehicles, seed, with_doors=False):
        self.columns = max(4, (vehicles + 3) // 4 * 2)  # an even number: as many aisles lead north as south
        self.nodes, self.edges, self.stations, self.homes = {}, [], {}, []
        for x in range(self.columns):
            for y in range(ROWS + 1):
                self.nodes[f"n{x}_{y}"] = x * STEP, y * STEP
                if y:
                    ends = f"n{x}_{y - 1}", f"n{x}_{y}"
                    self.edges.append(ends if x % 2 else ends[::-1])
            if x:
                self.edges.append((f"n{x - 1}_0", f"n{x}_0"))
                self.edges.append((f"n{x}_{ROWS}", f"n{x - 1}_{ROWS}"))
        for x in range(1, self.columns):
            for y in range(1, ROWS):
                if with_doors and x == self.columns // 2:
                    continue  # the wall is there
                # Between two aisles; from the one at its west.
                self.stations[f"rack_{x}_{y}"] = f"n{x - 1}_{y}", ((x - 0.5) * STEP, y * STEP)
        for i in range(vehicles):
            x, is_north = i // 2, i % 2
            name, y = f"home_{i + 1}", ROWS + 1 if is_north else -1
            self.nodes[name] = x * STEP, y * STEP
            road = f"n{x}_{ROWS if is_north else 0}"
            self.edges += [(name, road), (road, name)]
            self.homes.append(name)
        self.draw = random.Random(seed)
        racks = sorted(self.stations)
        self.full = sorted(self.draw.sample(racks, len(racks) // 2))

    def jobs(self, count):
        full = list(self.full)
        empty = [rack for rack in sorted(self.stations) if rack not in full]
        for _ in range(count):
            start, end = full.pop(self.draw.randrange(len(full))), empty.pop(self.draw.randrange(len(empty)))
            full.append(end)
            empty.append(start)
            yield {"from": start, "to": end}

    def world(self, name, with_doors):
        text = WORLD.format(name=name, vehicles=len(self.homes))
        low, high = -1.5 * STEP, (ROWS + 1.5) * STEP
        west, east = -0.6 * STEP, (self.columns - 0.4) * STEP
        for name, x, y, width, depth in (("south", (west + east) / 2, low, east - west, 0.1), ("north", (west + east) / 2, high, east - west, 0.1),
                                         ("west", west, (low + high) / 2, 0.1, high - low - 0.2),
                                         ("east", east, (low + high) / 2, 0.1, high - low - 0.2)):
            text += self.wall(name, x, y, width, depth)
        if with_doors:
            text += self.doors()
        for rack, (_, (x, y)) in self.stations.items():
            text += f'rack( name "{rack}" pose [{x:g} {y:g} 0 0] )\n'
        for i, rack in enumerate(self.full, 1):
            x, y = self.stations[rack][1]
            text += f'pallet( name "pallet_{i}" pose [{x:g} {y:g} 0.25 0] )\n'
        for i, home in enumerate(self.homes, 1):
            x, y = self.nodes[home]
            text += f'charger( name "charger_{i}" pose [{x:g} {y:g} 0 0] )\n'
            text += f'cart( name "cart_{i}" pose [{x:g} {y:g} 0 {90 if y < 0 else -90}] color "steel blue" )\n'
        return text

    def doors(self):
        """The wall in the middle of the hall, with a doorway where each road passes."""
        x, ends = self.middle, (-1.5 * STEP, (ROWS + 1.5) * STEP)
        roads = 0.0, ROWS * STEP
        text, y = "", ends[0]
        for name, road in zip(("south", "north"), roads):
            text += self.wall(f"fire_wall_{name}", x, (y + 0.05 + road - DOORWAY / 2) / 2, 0.1, road - DOORWAY / 2 - y - 0.05)
            text += (f'door( name "{name}_door" pose [{x:g} {road:g} 0 90] size [{DOORWAY:g} 0.05 2.2] kind "double_sliding" seconds 2 '
                     'color "gold" )\n')
            y = road + DOORWAY / 2
        return text + self.wall("fire_wall_middle", x, (y + ends[1] - 0.05) / 2, 0.1, ends[1] - 0.05 - y)

    @property
    def middle(self):
        return (self.columns // 2 - 0.5) * STEP

    @staticmethod
    def wall(name, x, y, width, depth):
        return f'wall( name "{name}" pose [{x:g} {y:g} 0 0] size [{width:g} {depth:g} 1] )\n'

    def scenario(self, name, people):
        content = {"name": name, "world": f"{name}.world", "seed": 1,
                   "robots": [{"name": f"cart_{i}", "controller": {"name": "vda5050", "parameters": {"map": MAP}}}
                              for i in range(1, len(self.homes) + 1)]}
        if people:
            # Ways across both roads, between racks.
            crossings = [(self.columns // 4 + 0.5) * STEP, (3 * self.columns // 4 + 0.5) * STEP]
            content["people"] = [
                {"count": people // 2 + (people % 2) * (i == 0), "name_prefix": f"picker{i + 1}_", "region": [x - 1, 1, x + 1, 2],
                 "goals": [[x, -4], [x, 1.5], [x, ROWS * STEP - 1.5], [x, ROWS * STEP + 4]], "wait": [20, 90], "radius": 0.2}
                for i, x in enumerate(crossings)]
        return content

    def layout(self):
        charging = [{"actionType": "startCharging", "required": False, "blockingType": "HARD"}]
        return {
            "metaInformation": {"projectIdentification": "warehouse", "creator": "Troupe", "exportTimestamp": "2026-01-01T00:00:00Z",
                                "lifVersion": "1.0.0"},
            "layouts": [{
                "layoutId": MAP, "layoutVersion": "1", "layoutLevelId": MAP,
                "nodes": [{"nodeId": name, "mapId": MAP, "nodePosition": {"x": x, "y": y}, "vehicleTypeNodeProperties": [
                    {"vehicleTypeId": "cart"} | ({"actions": charging} if name in self.homes else {})]}
                          for name, (x, y) in self.nodes.items()],
                "edges": [{"edgeId": f"{start}-{end}", "startNodeId": start, "endNodeId": end,
                           "vehicleTypeEdgeProperties": [{"vehicleTypeId": "cart"}]} for start, end in self.edges],
                "stations": [{"stationId": rack, "interactionNodeIds": [node], "stationPosition": {"x": x, "y": y}}
                             for rack, (node, (x, y)) in self.stations.items()]}]}


def text_of(layout):
    """Of a LIF, a line for each node, edge and station."""
    one = layout["layouts"][0]
    lists = {key: [json.dumps(each) for each in one[key]] for key in ("nodes", "edges", "stations")}
    head = json.dumps({key: value for key, value in one.items() if key not in lists})[1:-1]
    parts = ",\n ".join(f'"{key}": [\n  ' + ",\n  ".join(each) + "]" for key, each in lists.items())
    return f'{{"metaInformation": {json.dumps(layout["metaInformation"])},\n "layouts": [{{{head},\n {parts}}}]}}\n'


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--vehicles", type=int, default=12)
    parser.add_argument("--jobs", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--doors", action="store_true", help="a wall with doors divides the hall")
    parser.add_argument("--people", type=int, default=0, help="people who cross the roads")
    parser.add_argument("--name", default="warehouse", help="of the files (default: warehouse)")
    arguments = parser.parse_args()
    if not 1 <= arguments.vehicles <= 200:
        parser.error("expected 1 to 200 vehicles")
    warehouse = Warehouse(arguments.vehicles, arguments.seed, arguments.doors)
    arguments.folder.mkdir(parents=True, exist_ok=True)
    place, name = arguments.folder, arguments.name
    (place / f"{name}.world").write_text(warehouse.world(name, arguments.doors))
    (place / f"{name}.json").write_text(json.dumps(warehouse.scenario(name, arguments.people), indent=2) + "\n")
    (place / f"{name}.lif.json").write_text(text_of(warehouse.layout()))
    (place / f"{name}.jobs").write_text("".join(json.dumps(job) + "\n" for job in warehouse.jobs(arguments.jobs)))


if __name__ == "__main__":
    main()
