"""The nodes, edges and stations of a layout in LIF, with the shortest routes and the parts that two vehicles cannot be on at once."""
import heapq
import json
import math


class BadLayout(Exception):
    """The file cannot be used, with the reason."""


class Layout:
    """Nodes and edges are parts, numbered from 0, nodes first.

    names      of the parts
    nodes      number of a node by its id
    positions  (x, y), m, of the nodes
    maps       mapId of the nodes
    edges      number of the edge by (number of the start, number of the end)
    stations   number of the first interaction node by the id of the station
    chargers   numbers of nodes at which vehicles can charge
    conflicts  of each part the parts on which no other vehicle may be, as bits of a whole number
    """
    def __init__(self, content, vehicle_type=None, clearance=1.0):
        self.names, self.positions, self.maps, self.nodes = [], [], [], {}
        self.edges, self.stations, self.chargers = {}, {}, set()
        links = []
        try:
            for layout in content["layouts"]:
                for node in layout["nodes"]:
                    self._add_node(node, vehicle_type)
                links += [edge for edge in layout["edges"] if self._is_for(edge.get("vehicleTypeEdgeProperties"), vehicle_type)]
            for edge in links:
                ends = self.nodes.get(edge["startNodeId"]), self.nodes.get(edge["endNodeId"])
                if None not in ends and ends not in self.edges:
                    self.edges[ends] = len(self.names)
                    self.names.append(edge["edgeId"])
            for layout in content["layouts"]:
                for station in layout.get("stations") or []:
                    known = [self.nodes[each] for each in station["interactionNodeIds"] if each in self.nodes]
                    if known:
                        self.stations[station["stationId"]] = known[0]
        except (KeyError, TypeError, ValueError) as problem:
            raise BadLayout(f"no layout in LIF: {problem!r}") from problem
        if not self.edges:
            raise BadLayout("found no edge that vehicles of this type may use")
        self.ends = {number: ends for ends, number in self.edges.items()}
        self.next = {number: [] for number in self.nodes.values()}
        for start, end in sorted(self.edges):
            self.next[start].append(end)
        self.conflicts = self._find_conflicts(clearance)

    @staticmethod
    def read(path, vehicle_type=None, clearance=1.0):
        """Of a file. Raises BadLayout or OSError."""
        with open(path, encoding="utf-8") as file:
            try:
                content = json.load(file)
            except ValueError as problem:
                raise BadLayout(f"{path}: no JSON: {problem}") from problem
        return Layout(content, vehicle_type, clearance)

    @staticmethod
    def _is_for(properties, vehicle_type):
        return vehicle_type is None or any(each["vehicleTypeId"] == vehicle_type for each in properties or [])

    def _add_node(self, node, vehicle_type):
        properties = node.get("vehicleTypeNodeProperties") or []
        if not self._is_for(properties, vehicle_type):
            return
        number = self.nodes[node["nodeId"]] = len(self.names)
        self.names.append(node["nodeId"])
        self.positions.append((float(node["nodePosition"]["x"]), float(node["nodePosition"]["y"])))
        self.maps.append(node.get("mapId", ""))
        if any(action["actionType"] == "startCharging" for each in properties for action in each.get("actions") or []):
            self.chargers.add(number)

    def _segment(self, part):
        start, end = self.ends.get(part, (part, part))
        return self.positions[start], self.positions[end], self.maps[start]

    def _find_conflicts(self, clearance):
        """Parts nearer than the clearance, m. They are looked for in cells of a grid."""
        cells, boxes = {}, []
        size = max(clearance, 1.0)
        for part in range(len(self.names)):
            (ax, ay), (bx, by), _ = self._segment(part)
            reach = clearance / 2
            box = [(x, y) for x in range(math.floor((min(ax, bx) - reach) / size), math.floor((max(ax, bx) + reach) / size) + 1)
                   for y in range(math.floor((min(ay, by) - reach) / size), math.floor((max(ay, by) + reach) / size) + 1)]
            boxes.append(box)
            for cell in box:
                cells.setdefault(cell, []).append(part)
        conflicts = []
        for part, box in enumerate(boxes):
            near = {other for cell in box for other in cells[cell]}
            bits = 1 << part
            for other in near:
                if distance(self._segment(part), self._segment(other)) < clearance:
                    bits |= 1 << other
            conflicts.append(bits)
        return conflicts

    def length(self, start, end):
        """Of the way between two nodes, m."""
        return math.dist(self.positions[start], self.positions[end])

    def route(self, start, end, forbidden=0):
        """The nodes of the shortest route, or None. `forbidden`: parts that it must not use, as bits; its start may be one of them."""
        best, before, queue = {start: 0.0}, {}, [(0.0, start)]
        while queue:
            so_far, node = heapq.heappop(queue)
            if node == end:
                route = [end]
                while route[-1] != start:
                    route.append(before[route[-1]])
                return route[::-1]
            if so_far > best[node]:
                continue
            for other in self.next[node]:
                if forbidden >> other & 1 or forbidden >> self.edges[node, other] & 1:
                    continue
                length = so_far + self.length(node, other)
                if length < best.get(other, math.inf):
                    best[other], before[other] = length, node
                    heapq.heappush(queue, (length, other))
        return None

    def nearest(self, x, y, map_id=None):
        """The node at a point, and its distance, m."""
        nodes = [each for each in self.nodes.values() if map_id is None or self.maps[each] in ("", map_id)] or list(self.nodes.values())
        node = min(nodes, key=lambda each: (math.dist(self.positions[each], (x, y)), each))
        return node, math.dist(self.positions[node], (x, y))

    def place(self, name):
        """The node of a station or of a node by its id, or None."""
        return self.stations.get(name, self.nodes.get(name))


def distance(one, other):
    """Between two segments (start, end, map), m."""
    (a, b, level), (c, d, other_level) = one, other
    if level != other_level:
        return math.inf
    if crosses(a, b, c, d):
        return 0.0
    return min(to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b))


def to_segment(point, start, end):
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = dx * dx + dy * dy
    along = 0.0 if length == 0 else min(1.0, max(0.0, ((point[0] - start[0]) * dx + (point[1] - start[1]) * dy) / length))
    return math.dist(point, (start[0] + along * dx, start[1] + along * dy))


def crosses(a, b, c, d):
    def side(p, q, r):
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
