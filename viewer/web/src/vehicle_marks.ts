// VehicleMarks: the way of the selected vehicle of VDA 5050. Its base is a broad line in its colour, as it may drive there;
// its horizon, which it may not, a thin dashed one. Nodes are rings.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial
} from 'three';
import {robotColorOf} from './colors';
import type {Run} from './run';
import type {VehicleNode, VehicleState} from './vehicles';

const HEIGHT = 0.03;  // m, above the floor
const HALF_WIDTH = 0.08;  // m, of the base
const RADIUS = 0.2;  // m, of a node
const SIDES = 16;
const DASH = 0.25;  // m

type Point = [number, number, number];

export class VehicleMarks {
  readonly group = new Group();
  // What is drawn, for tests.
  base: string[] = [];
  horizon: string[] = [];
  private readonly broad = new Mesh(
    new BufferGeometry(), new MeshBasicMaterial({transparent: true, opacity: 0.6, depthWrite: false, side: DoubleSide}));
  private readonly thin = new LineSegments(new BufferGeometry(), new LineBasicMaterial({transparent: true, depthWrite: false}));
  private readonly color = new Color();
  private robot = -1;
  private state: VehicleState | null = null;

  constructor() {
    for (const part of [this.broad, this.thin]) {
      part.frustumCulled = false;
      this.group.add(part);
    }
    this.group.visible = false;
  }

  // null: none. Whether that is another one than before.
  set(robot: number, state: VehicleState | null): boolean {
    const isOther = robot !== this.robot || state !== this.state;
    this.robot = robot;
    this.state = state;
    return isOther;
  }

  show(run: Run): void {
    const {robot, state} = this;
    const pose = state ? run.robots[robot]?.pose : undefined;
    this.base = [];
    this.horizon = [];
    this.group.visible = pose !== undefined && state!.nodes.length > 0;
    if (!this.group.visible) return;
    const triangles: number[] = [];
    const lines: number[] = [];
    let from: Point = [pose!.x, pose!.y, pose!.z + HEIGHT];
    for (const node of state!.nodes) {
      const to = placeOf(run, node, from[2]);
      if (!to) break;
      (node.released ? this.base : this.horizon).push(node.id);
      const way: Point[] = [from, ...node.line.map(({x, y}): Point => [x, y, to[2]]), to];
      // The part of a curve that lies behind the vehicle is left out.
      if (from[0] === pose!.x && from[1] === pose!.y && node.line.length > 0) way.splice(1, nearest(way, from) - 1);
      for (let i = 0; i + 1 < way.length; ++i) {
        if (node.released) addRibbon(triangles, way[i], way[i + 1]);
        else addDashes(lines, way[i], way[i + 1]);
      }
      addRing(lines, to);
      from = to;
    }
    robotColorOf(robot, this.color);
    this.broad.material.color.copy(this.color);
    this.thin.material.color.copy(this.color);
    for (const [part, values] of [[this.broad, triangles], [this.thin, lines]] as Array<[Mesh | LineSegments, number[]]>) {
      part.geometry.dispose();
      part.geometry = new BufferGeometry();
      part.geometry.setAttribute('position', new BufferAttribute(new Float32Array(values), 3));
    }
  }
}

// The index of the point of a way that is nearest to its first one, from the second on.
function nearest(way: Point[], [x, y]: Point): number {
  let best = 1;
  const distance = (i: number): number => Math.hypot(way[i][0] - x, way[i][1] - y);
  for (let i = 2; i < way.length; ++i) if (distance(i) < distance(best)) best = i;
  return best;
}

// Of the state, or of the vertex of the lanes of that name; at the floor of its map, if that is a level.
function placeOf(run: Run, {id, place, map}: VehicleNode, z: number): Point | null {
  const level = run.world.levels.find(({name}) => name === map);
  if (place) return [place.x, place.y, level ? level.z + HEIGHT : z];
  for (const graph of run.world.laneGraphs) {
    const vertex = graph.vertices.find(({name}) => name === id);
    if (vertex) return [vertex.position.x, vertex.position.y, vertex.z + HEIGHT];
  }
  return null;
}

function addRibbon(values: number[], from: Point, to: Point): void {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  if (length === 0) return;
  const [nx, ny] = [(-dy / length) * HALF_WIDTH, (dx / length) * HALF_WIDTH];
  const corner = ([x, y, z]: Point, side: number): void => { values.push(x + side * nx, y + side * ny, z); };
  for (const [point, side] of [[from, 1], [from, -1], [to, 1], [to, 1], [from, -1], [to, -1]] as Array<[Point, number]>) corner(point, side);
}

function addDashes(values: number[], from: Point, to: Point): void {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  const at = (share: number): Point => [0, 1, 2].map(i => from[i] + share * (to[i] - from[i])) as Point;
  for (let way = 0; way < length; way += 2 * DASH) values.push(...at(way / length), ...at(Math.min(1, (way + DASH) / length)));
}

function addRing(values: number[], [x, y, z]: Point): void {
  for (let i = 0; i < SIDES; ++i) {
    for (const corner of [i, i + 1]) {
      const angle = (2 * Math.PI * corner) / SIDES;
      values.push(x + RADIUS * Math.cos(angle), y + RADIUS * Math.sin(angle), z);
    }
  }
}
