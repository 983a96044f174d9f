"""Worlds by chance: rooms, mazes, warehouses and forests. The same arguments give the same world, on every machine.

Each function returns a troupe.World without robots, whose middle is at (0, 0). A function of the seed makes a
VectorSimulation of different worlds:

    troupe.VectorSimulation(lambda seed: forest(seed).robots(4, (-5, -5, 5, 5)), 16)
"""

from __future__ import annotations

import random
from typing import List, Set, Tuple

from .world import World

__all__ = ["forest", "maze", "rooms", "warehouse"]

_Cell = Tuple[int, int]


def rooms(seed: int = 0, *, columns: int = 4, rows: int = 3, room: Tuple[float, float] = (4.0, 4.0), door: float = 1.2,
          extra: float = 0.3, height: float = 1.0) -> World:
    """Rooms side by side, each reached from every other one: doorways by a spanning tree, and `extra` of the other walls."""
    _check(columns=columns, rows=rows, door=door, height=height)
    if door >= min(room):
        raise ValueError(f"door: found {door}, expected less than a room's sides {room}")
    chance = random.Random(seed)
    open_walls = _spanning_tree(chance, columns, rows)
    for wall in _inner_walls(columns, rows):
        if wall not in open_walls and chance.random() < extra:
            open_walls.add(wall)
    width, depth = room
    world = World(name="rooms", seed=seed)
    left, low = -columns * width / 2, -rows * depth / 2
    world.wall((left, low), (-left, low), (-left, -low), (left, -low), closed=True, height=height)
    for a, b in _inner_walls(columns, rows):
        x, y = left + b[0] * width, low + b[1] * depth
        start, end = ((x, y), (x, y + depth)) if a[1] == b[1] else ((x, y), (x + width, y))
        if (a, b) not in open_walls:
            world.wall(start, end, height=height)
            continue
        length = depth if a[1] == b[1] else width
        # The doorway is anywhere in the wall, with a post of 0.1 m at least at each side.
        at = chance.uniform(0.1, length - door - 0.1)
        along = ((end[0] - start[0]) / length, (end[1] - start[1]) / length)
        world.wall(start, (start[0] + at * along[0], start[1] + at * along[1]), height=height)
        at += door
        world.wall((start[0] + at * along[0], start[1] + at * along[1]), end, height=height)
    return world


def maze(seed: int = 0, *, columns: int = 10, rows: int = 10, cell: float = 1.5, thickness: float = 0.1,
         height: float = 1.0) -> World:
    """A maze with one way between any two cells, each a square of `cell` metres."""
    _check(columns=columns, rows=rows, cell=cell, thickness=thickness, height=height)
    chance = random.Random(seed)
    open_walls = _spanning_tree(chance, columns, rows)
    world = World(name="maze", seed=seed)
    left, low = -columns * cell / 2, -rows * cell / 2
    world.wall((left, low), (-left, low), (-left, -low), (left, -low), closed=True, thickness=thickness, height=height)
    closed = {wall for wall in _inner_walls(columns, rows) if wall not in open_walls}
    # Walls in a line are one body.
    for i in range(1, columns):
        for first, last in _runs([((i - 1, j), (i, j)) in closed for j in range(rows)]):
            x = left + i * cell
            world.wall((x, low + first * cell), (x, low + last * cell), thickness=thickness, height=height)
    for j in range(1, rows):
        for first, last in _runs([((i, j - 1), (i, j)) in closed for i in range(columns)]):
            y = low + j * cell
            world.wall((left + first * cell, y), (left + last * cell, y), thickness=thickness, height=height)
    return world


def warehouse(seed: int = 0, *, aisles: int = 5, length: float = 12.0, aisle: float = 2.0, shelf: float = 1.0,
              filled: float = 0.8, height: float = 2.0) -> World:
    """Rows of shelves with aisles between them. A shelf stands on legs: low robots drive under it. `filled` of their
    sections, 2 m long, hold goods down to the floor, which close the way."""
    _check(aisles=aisles, length=length, aisle=aisle, shelf=shelf, height=height)
    chance = random.Random(seed)
    world = World(name="warehouse", seed=seed)
    half_width = (aisles * aisle + (aisles + 1) * shelf) / 2 + aisle
    half_depth = length / 2 + aisle
    world.wall((-half_width, -half_depth), (half_width, -half_depth), (half_width, half_depth), (-half_width, half_depth),
               closed=True, height=height)
    sections = max(1, round(length / 2))
    size = length / sections
    leg = 0.08
    for row in range(aisles + 1):
        x = -half_width + aisle + shelf / 2 + row * (aisle + shelf)
        for section in range(sections):
            y = -length / 2 + (section + 0.5) * size
            world.box((x, y, 0.5, 0.0), (shelf, size, height - 0.5), color="DarkOrange", name="shelf")
            for side_x in (-1, 1):
                for side_y in (-1, 1):
                    world.box((x + side_x * (shelf - leg) / 2, y + side_y * (size - leg) / 2, 0.0, 0.0), (leg, leg, 0.5),
                              color="DarkOrange", name="leg")
            if chance.random() < filled:
                world.box((x, y, 0.0, 0.0), (shelf - 0.2, size - 0.2, 0.45), color="tan", name="goods")
    return world


def forest(seed: int = 0, *, size: Tuple[float, float] = (20.0, 20.0), trees: int = 60,
           radius: Tuple[float, float] = (0.1, 0.4), gap: float = 0.8, height: float = 2.0) -> World:
    """Trees at places by chance, at least `gap` metres from each other and from the middle, within walls."""
    _check(trees=trees, gap=gap, height=height, width=size[0], depth=size[1], radius=radius[0])
    chance = random.Random(seed)
    world = World(name="forest", seed=seed)
    x, y = size[0] / 2, size[1] / 2
    world.wall((-x, -y), (x, -y), (x, y), (-x, y), closed=True, height=height)
    placed: List[Tuple[float, float, float]] = [(0.0, 0.0, 0.0)]
    for _ in range(int(trees)):
        for _ in range(1000):
            r = chance.uniform(*radius)
            at = (chance.uniform(-x + r + gap, x - r - gap), chance.uniform(-y + r + gap, y - r - gap))
            if all((at[0] - other[0]) ** 2 + (at[1] - other[1]) ** 2 >= (r + other[2] + gap) ** 2 for other in placed):
                break
        else:
            raise ValueError(f"trees: found room for {len(placed) - 1} of {trees}")
        placed.append((*at, r))
        world.block([(at[0] + r * c, at[1] + r * s) for c, s in _OCTAGON], z=(0.0, height), color="sienna", name="tree")
    return world


# Of radius 1. Numbers, because cosines differ in their last bits between machines.
_DIAGONAL = 0.7071067811865476
_OCTAGON = [(1.0, 0.0), (_DIAGONAL, _DIAGONAL), (0.0, 1.0), (-_DIAGONAL, _DIAGONAL), (-1.0, 0.0),
            (-_DIAGONAL, -_DIAGONAL), (0.0, -1.0), (_DIAGONAL, -_DIAGONAL)]


def _check(**positive: float) -> None:
    for name, value in positive.items():
        if not value > 0:
            raise ValueError(f"{name}: found {value}, expected more than 0")


def _inner_walls(columns: int, rows: int) -> List[Tuple[_Cell, _Cell]]:
    """Between cells (column, row), each with the lower cell first."""
    walls = [((i - 1, j), (i, j)) for j in range(rows) for i in range(1, columns)]
    return walls + [((i, j - 1), (i, j)) for j in range(1, rows) for i in range(columns)]


def _spanning_tree(chance: random.Random, columns: int, rows: int) -> Set[Tuple[_Cell, _Cell]]:
    """The walls that a search in depth by chance opens."""
    opened: Set[Tuple[_Cell, _Cell]] = set()
    visited = {(0, 0)}
    path = [(0, 0)]
    while path:
        i, j = path[-1]
        beside = [(i + di, j + dj) for di, dj in ((1, 0), (0, 1), (-1, 0), (0, -1))
                  if 0 <= i + di < columns and 0 <= j + dj < rows and (i + di, j + dj) not in visited]
        if not beside:
            path.pop()
            continue
        chosen = beside[chance.randrange(len(beside))]
        visited.add(chosen)
        opened.add((min((i, j), chosen), max((i, j), chosen)))
        path.append(chosen)
    return opened


def _runs(flags: List[bool]) -> List[Tuple[int, int]]:
    """The first place of each run of True, and that after its last."""
    found: List[Tuple[int, int]] = []
    for place, flag in enumerate(flags):
        if not flag:
            continue
        if found and found[-1][1] == place:
            found[-1] = (found[-1][0], place + 1)
        else:
            found.append((place, place + 1))
    return found
