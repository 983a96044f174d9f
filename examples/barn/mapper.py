"""A planner that knows no map: it draws one from its scans, searches its way in that, and follows it.

The map is a grid of cells of 7.5 cm around the course. Each end of a ray is an obstacle; cells within half the width of the
robot of one are closed, and those a little farther away cost more. A way is searched (A*, Hart, Nilsson and Raphael 1968) when
there is none yet, and again as soon as the scans show an obstacle on it. Its arithmetic is that of Python's floats and lists.
"""

import heapq
import math

import numpy

CELL = 0.075                     # m
LEFT, BELOW, COLUMNS, ROWS = -6.5, 1.0, 114, 178  # m, m, cells: the course with a margin
CLOSED = 0.27                    # m, from an obstacle to the middle of the robot: half its width and a margin
NEAR = 0.62                      # m, up to which cells cost more
SEEN = 6.0                       # m: farther ends of rays are left to later scans
AHEAD = 0.5                      # m, along the way: the point that it steers to
TOP, TURN = 1.3, 1.8             # m/s, rad/s
MARGIN = 0.025                   # m, around the robot
CLEAR, SHUT = 10, 1000           # costs of a cell


def _kernel():
    """(cells to the side, cells up, cost) of the cells around an obstacle."""
    reach = int(NEAR / CELL) + 1
    cells = []
    for dx in range(-reach, reach + 1):
        for dy in range(-reach, reach + 1):
            distance = CELL * math.hypot(dx, dy)
            if distance < CLOSED:
                cells.append((dx, dy, SHUT))
            elif distance < NEAR:
                cells.append((dx, dy, CLEAR + round(60 * ((NEAR - distance) / (NEAR - CLOSED)) ** 2)))
    return cells


KERNEL = _kernel()
STEPS = [(1, 10), (-1, 10), (COLUMNS, 10), (-COLUMNS, 10),
         (COLUMNS + 1, 14), (COLUMNS - 1, 14), (-COLUMNS + 1, 14), (-COLUMNS - 1, 14)]


class Mapper:
    """One robot's map and way. `bearings`: rad, of the rays; `goal`: x and y in m."""

    def __init__(self, bearings, goal):
        self.bearings = bearings
        self.costs = [CLEAR] * (COLUMNS * ROWS)
        for column in range(COLUMNS):
            self.costs[column] = self.costs[(ROWS - 1) * COLUMNS + column] = SHUT
        for row in range(ROWS):
            self.costs[row * COLUMNS] = self.costs[row * COLUMNS + COLUMNS - 1] = SHUT
        self.obstacles = set()
        self.goal = self.cell(*goal)
        self.way = []             # cells from the robot on
        self.searches = 0

    @staticmethod
    def cell(x, y):
        column = min(max(int((x - LEFT) / CELL), 1), COLUMNS - 2)
        return min(max(int((y - BELOW) / CELL), 1), ROWS - 2) * COLUMNS + column

    @staticmethod
    def center(cell):
        return LEFT + (cell % COLUMNS + 0.5) * CELL, BELOW + (cell // COLUMNS + 0.5) * CELL

    def draw(self, ranges, pose):
        """Adds the ends of the rays to the map."""
        hit = ranges < SEEN
        angles = self.bearings[hit] + pose[3]
        scanner = pose[0] - 0.065 * math.cos(pose[3]), pose[1] - 0.065 * math.sin(pose[3])
        x = scanner[0] + ranges[hit] * numpy.cos(angles)
        y = scanner[1] + ranges[hit] * numpy.sin(angles)
        columns = numpy.floor((x - LEFT) / CELL).astype(int)
        rows = numpy.floor((y - BELOW) / CELL).astype(int)
        inside = (columns >= 0) & (columns < COLUMNS) & (rows >= 0) & (rows < ROWS)
        for cell in numpy.unique(rows[inside] * COLUMNS + columns[inside]).tolist():
            if cell in self.obstacles:
                continue
            self.obstacles.add(cell)
            row, column = divmod(cell, COLUMNS)
            for dx, dy, cost in KERNEL:
                if 0 <= column + dx < COLUMNS and 0 <= row + dy < ROWS:
                    at = cell + dy * COLUMNS + dx
                    if cost > self.costs[at]:
                        self.costs[at] = cost

    def search(self, start):
        """The cheapest way of cells, or none. Closed cells around the start may be left."""
        self.searches += 1
        goal_row, goal_column = divmod(self.goal, COLUMNS)
        lengths = {start: 0}
        before = {}
        heap = [(0, start)]
        done = set()
        while heap:
            cell = heapq.heappop(heap)[1]
            if cell == self.goal:
                way = [cell]
                while cell != start:
                    cell = before[cell]
                    way.append(cell)
                return way[::-1]
            if cell in done:
                continue
            done.add(cell)
            length, closed = lengths[cell], self.costs[cell] >= SHUT
            for step, far in STEPS:
                to = cell + step
                if not 0 <= to < COLUMNS * ROWS or to in done:
                    continue
                cost = self.costs[to]
                if cost >= SHUT and not (closed and self.inside(to)):
                    continue
                new = length + far * cost
                if new < lengths.get(to, 1 << 60):
                    lengths[to] = new
                    before[to] = cell
                    row, column = divmod(to, COLUMNS)
                    dx, dy = abs(column - goal_column), abs(row - goal_row)
                    heapq.heappush(heap, (new + CLEAR * (10 * max(dx, dy) + 4 * min(dx, dy)), to))
        return []

    @staticmethod
    def inside(cell):
        return 0 < cell % COLUMNS < COLUMNS - 1 and 0 < cell // COLUMNS < ROWS - 1

    def motion(self, ranges, pose):
        """The twist (m/s, rad/s) for a scan and the pose x, y, z, heading at which it was made."""
        self.draw(ranges, pose)
        here = self.cell(pose[0], pose[1])
        while len(self.way) > 1 and self.far(self.way[0], pose) >= self.far(self.way[1], pose):
            self.way.pop(0)
        shut = any(self.costs[cell] >= SHUT for cell in self.way[2:])
        if not self.way or shut or self.far(self.way[0], pose) > 0.3:
            self.way = self.search(here)
        if not self.way:
            return 0.0, 1.0       # it looks around
        target = next((cell for cell in self.way if self.far(cell, pose) >= AHEAD), self.way[-1])
        x, y = self.center(target)
        angle = math.atan2(y - pose[1], x - pose[0]) - pose[3]
        angle = (angle + math.pi) % (2 * math.pi) - math.pi
        # Slower near obstacles, and where the way turns.
        cost = max(self.costs[cell] for cell in self.way[:8])
        speed = TOP * max(0.25, 1.0 - max(cost - CLEAR, 0) / 60) if cost < SHUT else 0.2
        if abs(angle) > 0.7:
            speed = 0.0
        speed, turn = speed * max(0.2, math.cos(angle)) ** 2, max(-TURN, min(TURN, 2.6 * angle))
        x, y = self.points(ranges)
        for trial in ((speed, turn), (0.4 * speed, turn), (0.15, 0.5 * turn), (0.0, turn), (0.12, 0.0), (-0.15, 0.0)):
            if self.clear(x, y, *trial):
                return trial
        return -0.1, -0.5 * turn

    def points(self, ranges):
        """The ends of near rays in the frame of the robot."""
        near = ranges < 1.5
        return ranges[near] * numpy.cos(self.bearings[near]) - 0.065, ranges[near] * numpy.sin(self.bearings[near])

    @staticmethod
    def clear(x, y, speed, turn):
        """The robot, a little larger, meets no point within the next moments."""
        for later in (0.15, 0.3, 0.45):
            heading = turn * later
            c, s = math.cos(heading), math.sin(heading)
            dx, dy = x - speed * later * math.cos(heading / 2), y - speed * later * math.sin(heading / 2)
            along, across = c * dx + s * dy, c * dy - s * dx
            if ((numpy.abs(along) < 0.254 + MARGIN) & (numpy.abs(across) < 0.215 + MARGIN)).any():
                return False
        return True

    def far(self, cell, pose):
        x, y = self.center(cell)
        return math.hypot(x - pose[0], y - pose[1])
