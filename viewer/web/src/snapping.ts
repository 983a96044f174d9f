// Snapping of what is drawn and dragged in a file: walls to right angles and to the middles of other walls, models with
// their sides to the sides of others.
//
// Lengths are metres in the world; shapes are those of the world that is shown, so that a snap never depends on the text.
import type {Pose, World} from './protocol';
import {compose, isInTree, poseOf, rootOf, type Entity, type Run} from './run';

export interface Point {
  x: number;
  y: number;
}

// A side of a block, or the middle of a wall.
export interface Segment {
  a: Point;
  b: Point;
}

const MOST_THICK = 0.4;  // m, of a box that is a wall
const LEAST_SIDE = 0.15;  // m: shorter sides are those of legs
const RIGHT = Math.tan((6 * Math.PI) / 180);  // a direction so near to a right angle becomes one
const MOST_SEGMENTS = 4000;

function transformed(pose: Pose, outline: ArrayLike<number>): Point[] {
  const [c, s] = [Math.cos(pose.heading), Math.sin(pose.heading)];
  return Array.from({length: outline.length / 2}, (_, i) => ({
    x: pose.x + c * outline[2 * i] - s * outline[2 * i + 1], y: pose.y + s * outline[2 * i] + c * outline[2 * i + 1],
  }));
}

// The outlines of the blocks of a model and its parts, each from corner to corner, in the frame of the model.
export function outlinesOf(world: World, root: number): Point[][] {
  const poses = new Map<number, Pose>([[root, {x: 0, y: 0, z: 0, heading: 0}]]);
  return world.models.flatMap((model, i) => {
    if (!isInTree(world, i, root)) return [];
    const parent = poses.get(model.parent);
    if (i !== root) poses.set(i, parent ? compose(parent, model.poseInParent) : model.poseInParent);
    const {blocks} = world.shapes[model.shape];
    return blocks.map(({outline}) => transformed(poses.get(i)!, outline));
  });
}

function placed(pose: Pose, points: Point[]): Point[] {
  return transformed(pose, points.flatMap(({x, y}) => [x, y]));
}

function sidesOf(corners: Point[]): Segment[] {
  return corners.map((a, i) => ({a, b: corners[(i + 1) % corners.length]}));
}

const lengthOf = ({a, b}: Segment): number => Math.hypot(b.x - a.x, b.y - a.y);

// The middle of a box that is a wall: its ends are half its thickness from those of the wall, where another one meets it.
function middleOf(corners: Point[]): Segment | null {
  if (corners.length !== 4) return null;
  const sides = sidesOf(corners);
  const long = lengthOf(sides[0]) >= lengthOf(sides[1]) ? 0 : 1;
  const [length, thickness] = [lengthOf(sides[long]), lengthOf(sides[1 - long])];
  if (thickness > MOST_THICK || length < 2 * thickness) return null;
  const between = ({a, b}: Segment): Point => ({x: (a.x + b.x) / 2, y: (a.y + b.y) / 2});
  const [from, to] = [between(sides[long === 0 ? 3 : 0]), between(sides[long === 0 ? 1 : 2])];
  const inset = thickness / 2 / length;
  const at = (share: number): Point => ({x: from.x + share * (to.x - from.x), y: from.y + share * (to.y - from.y)});
  return {a: at(inset), b: at(1 - inset)};
}

export class Surroundings {
  private readonly sides: Segment[] = [];
  private readonly middles: Segment[] = [];

  // `without`: the names of models that are dragged.
  constructor(run: Run, without: readonly string[] = []) {
    const {world} = run;
    world.objects.forEach((_, index) => {
      const entity: Entity = {kind: 'object', index};
      const root = rootOf(world, entity);
      const pose = poseOf(run, entity);
      if (!pose || world.models[root].removed || without.includes(world.models[root].name)) return;
      for (const corners of outlinesOf(world, root).map(outline => placed(pose, outline))) {
        if (this.sides.length > MOST_SEGMENTS) return;
        this.sides.push(...sidesOf(corners).filter(side => lengthOf(side) >= LEAST_SIDE));
        const middle = middleOf(corners);
        if (middle) this.middles.push(middle);
      }
    });
  }

  // The point of a wall that is drawn from `from`, near to `point`, which is on the grid. `within`: m. `right`: only right
  // angles.
  wallEnd(free: Point, point: Point, from: Point | null, within: number, right: boolean): Point {
    const end = this.middles.flatMap(({a, b}) => [a, b]).map(each => ({each, away: Math.hypot(each.x - free.x, each.y - free.y)}))
      .filter(({away}) => away < within).sort((a, b) => a.away - b.away)[0];
    if (end && !right) return end.each;
    const way = from ? {x: free.x - from.x, y: free.y - from.y} : null;
    const level = from && way && (right ? Math.abs(way.y) <= Math.abs(way.x) : Math.abs(way.y) < RIGHT * Math.abs(way.x));
    const upright = from && way && (right ? Math.abs(way.y) > Math.abs(way.x) : Math.abs(way.x) < RIGHT * Math.abs(way.y));
    const chosen = level ? {x: point.x, y: from.y} : upright ? {x: from.x, y: point.y} : point;
    // On the middle of another wall, but only along the direction that is kept.
    for (const {a, b} of this.middles) {
      const [dx, dy] = [b.x - a.x, b.y - a.y];
      const square = dx * dx + dy * dy;
      const base = level || upright ? chosen : free;
      let share = ((base.x - a.x) * dx + (base.y - a.y) * dy) / square;
      if (level && Math.abs(dy) > 1e-9) share = (from.y - a.y) / dy;
      else if (upright && Math.abs(dx) > 1e-9) share = (from.x - a.x) / dx;
      if (share < 0 || share > 1) continue;
      const on = {x: a.x + share * dx, y: a.y + share * dy};
      if ((level && Math.abs(on.y - from.y) > 1e-6) || (upright && Math.abs(on.x - from.x) > 1e-6)) continue;
      if (Math.hypot(on.x - free.x, on.y - free.y) < within) return on;
    }
    return chosen;
  }

  // The pose of a body near to `pose` at which a side of another touches it, or two in different directions.
  // `outlines`: in its frame; `within`: m.
  touching(pose: Pose, outlines: Point[][], within: number): Pose {
    let now = pose;
    let first: Point | null = null;  // direction of the side that is touched
    for (let round = 0; round < 2; ++round) {
      const points = outlines.flatMap(outline => placed(now, outline));
      let best: {shift: Point; along: Point; size: number} | null = null;
      for (const {a, b} of this.sides) {
        const length = Math.hypot(b.x - a.x, b.y - a.y);
        const along = {x: (b.x - a.x) / length, y: (b.y - a.y) / length};
        if (first && Math.abs(along.x * first.y - along.y * first.x) < 0.5) continue;
        const shares = points.map(({x, y}) => (x - a.x) * along.x + (y - a.y) * along.y);
        if (Math.max(...shares) < 0 || Math.min(...shares) > length) continue;
        // Outwards: outlines are counter-clockwise.
        const normal = {x: along.y, y: -along.x};
        const gap = Math.min(...points.map(({x, y}) => (x - a.x) * normal.x + (y - a.y) * normal.y));
        if (Math.abs(gap) > within || (best && Math.abs(gap) >= best.size)) continue;
        best = {shift: {x: -gap * normal.x, y: -gap * normal.y}, along, size: Math.abs(gap)};
      }
      if (!best) break;
      now = {...now, x: now.x + best.shift.x, y: now.y + best.shift.y};
      first = best.along;
    }
    return now;
  }
}
