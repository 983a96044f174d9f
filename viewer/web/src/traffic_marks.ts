// TrafficMarks: the traffic of robots on lanes. The next moves of each robot are its way in its colour: broad where they
// are granted, so that others keep off, thin beyond. An arrow leads from each robot that waits to what it waits for; the
// arrows of robots that wait for each other in a ring are red. Closed lanes are crossed out.
//
// All of it are three objects, whose vertices are filled anew with each update: a thousand robots cost a millisecond.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial
} from 'three';
import {robotColorOf} from './colors';
import type {Pose, Traffic, World} from './protocol';
import {compose, type Run} from './run';

const HEIGHT = 0.025;  // m, above the floor
const HALF_WIDTH = 0.12;  // m, of a granted way
const ARROW = 0.07;  // m, half the width of an arrow
const HEAD = 0.35;  // m
const ABOVE = 0.6;  // m, of arrows above the floor: over most robots

type Point = [number, number, number];

// Vertices with colours that grow as needed and are never given back.
class Vertices {
  count = 0;
  private places = new Float32Array(0);
  private colors = new Float32Array(0);

  constructor(readonly geometry: BufferGeometry) {}

  add(x: number, y: number, z: number, {r, g, b}: Color): void {
    const at = 3 * this.count++;
    if (at >= this.places.length) this.grow();
    this.places[at] = x;
    this.places[at + 1] = y;
    this.places[at + 2] = z;
    this.colors[at] = r;
    this.colors[at + 1] = g;
    this.colors[at + 2] = b;
  }

  show(): void {
    this.geometry.setDrawRange(0, this.count);
    for (const name of ['position', 'color']) {
      const attribute = this.geometry.getAttribute(name);
      if (attribute) attribute.needsUpdate = true;
    }
  }

  private grow(): void {
    const size = Math.max(3 * 256, 2 * this.places.length);
    const enlarged = (before: Float32Array): Float32Array => {
      const after = new Float32Array(size);
      after.set(before);
      return after;
    };
    this.places = enlarged(this.places);
    this.colors = enlarged(this.colors);
    this.geometry.dispose();
    this.geometry.setAttribute('position', new BufferAttribute(this.places, 3).setUsage(DynamicDrawUsage));
    this.geometry.setAttribute('color', new BufferAttribute(this.colors, 3).setUsage(DynamicDrawUsage));
  }
}

// The robots that wait for each other in a ring.
export function ringsOf(world: World, traffic: Traffic): Set<number> {
  const robotOf = new Map(world.robots.map((robot, i) => [robot.root, i]));
  const next = new Map<number, number>();
  for (const {robot, thing} of traffic.waits) {
    const other = robotOf.get(thing);
    if (other !== undefined) next.set(robot, other);
  }
  const rings = new Set<number>();
  const seen = new Map<number, number>();  // by robot: the start of the search that came there
  for (const start of next.keys()) {
    let at: number | undefined = start;
    while (at !== undefined && !seen.has(at)) {
      seen.set(at, start);
      at = next.get(at);
    }
    if (at === undefined || seen.get(at) !== start) continue;
    for (let member: number | undefined = at; member !== undefined && !rings.has(member); member = next.get(member)) rings.add(member);
  }
  return rings;
}

export class TrafficMarks {
  visible = false;
  readonly group = new Group();
  // What is drawn: the robots whose ways are, and the arrows.
  ways: number[] = [];
  shownWaits: Array<{robot: number; thing: number; ring: boolean}> = [];
  private readonly held: Vertices;
  private readonly planned: Vertices;
  private readonly arrows: Vertices;
  private readonly color = new Color();
  private readonly wait = new Color();
  private readonly ring = new Color();
  private world: World | null = null;
  private vertices: Point[] = [];  // of all graphs
  private lanes: Array<[number, number]> = [];  // their ends
  private robots = new Map<number, number>();  // by root; so are the next
  private objects = new Map<number, number>();
  private people = new Map<number, number>();

  constructor() {
    const material = {vertexColors: true, transparent: true, depthWrite: false};
    const held = new Mesh(new BufferGeometry(), new MeshBasicMaterial({...material, opacity: 0.45, side: DoubleSide}));
    const planned = new LineSegments(new BufferGeometry(), new LineBasicMaterial({...material, opacity: 0.7}));
    const arrows = new Mesh(new BufferGeometry(), new MeshBasicMaterial({...material, opacity: 0.95, side: DoubleSide, depthTest: false}));
    this.held = new Vertices(held.geometry);
    this.planned = new Vertices(planned.geometry);
    this.arrows = new Vertices(arrows.geometry);
    for (const part of [held, planned, arrows]) {
      part.frustumCulled = false;
      this.group.add(part);
    }
    arrows.renderOrder = 3;
    this.group.visible = false;
  }

  setColors(wait: Color, ring: Color): void {
    this.wait.copy(wait);
    this.ring.copy(ring);
  }

  show(run: Run): void {
    this.group.visible = this.visible;
    if (!this.visible) return;
    if (run.world !== this.world) this.setWorld(run.world);
    for (const part of [this.held, this.planned, this.arrows]) part.count = 0;
    this.ways = [];
    this.shownWaits = [];
    this.addWays(run);
    this.addClosedLanes(run.traffic);
    this.addWaits(run);
    for (const part of [this.held, this.planned, this.arrows]) part.show();
  }

  private setWorld(world: World): void {
    this.world = world;
    this.vertices = world.laneGraphs.flatMap(graph => graph.vertices.map(({position, z}): Point => [position.x, position.y, z + HEIGHT]));
    this.lanes = [];
    let first = 0;
    for (const graph of world.laneGraphs) {
      for (const {start, end} of graph.lanes) this.lanes.push([first + start, first + end]);
      first += graph.vertices.length;
    }
    this.robots = new Map(world.robots.map((robot, i) => [robot.root, i]));
    this.objects = new Map(world.objects.map((root, i) => [root, i]));
    this.people = new Map(world.people.map(({root}, i) => [root, i]));
  }

  private addWays(run: Run): void {
    for (const {robot, moves} of run.traffic.ways) {
      const pose = run.robots[robot]?.pose;
      if (!pose) continue;
      this.ways.push(robot);
      robotColorOf(robot, this.color);
      let from: Point = [pose.x, pose.y, pose.z + HEIGHT];
      for (const {to, granted} of moves) {
        const place = this.vertices[to];
        if (!place) break;
        if (granted) this.addRibbon(this.held, from, place, HALF_WIDTH, this.color);
        this.planned.add(...from, this.color);
        this.planned.add(...place, this.color);
        from = place;
      }
    }
  }

  private addClosedLanes(traffic: Traffic): void {
    for (const lane of traffic.closed) {
      const ends = this.lanes[lane]?.map(vertex => this.vertices[vertex]);
      if (!ends || !ends[0] || !ends[1]) continue;
      this.addRibbon(this.held, ends[0], ends[1], 0.5 * HALF_WIDTH, this.ring);
      const [x, y] = [(ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2];
      const z = (ends[0][2] + ends[1][2]) / 2 + HEIGHT;
      for (const side of [-1, 1]) {
        this.addRibbon(this.arrows, [x - 0.3, y - side * 0.3, z], [x + 0.3, y + side * 0.3, z], ARROW, this.ring);
      }
    }
  }

  private addWaits(run: Run): void {
    const rings = ringsOf(run.world, run.traffic);
    for (const {robot, thing} of run.traffic.waits) {
      const pose = run.robots[robot]?.pose;
      const target = thing >= 0 ? this.poseOfModel(run, thing) : null;
      if (!pose || !target) continue;
      const ring = rings.has(robot);
      this.shownWaits.push({robot, thing, ring});
      this.addArrow(
        [pose.x, pose.y, pose.z + ABOVE], [target.x, target.y, target.z + ABOVE], ring ? this.ring : this.wait);
    }
  }

  // Of a robot, an object or a person, or of a model that does not move, such as a door.
  private poseOfModel(run: Run, model: number): Pose | null {
    const robot = this.robots.get(model);
    if (robot !== undefined) return run.robots[robot]?.pose ?? null;
    const object = this.objects.get(model);
    if (object !== undefined) return run.objects[object]?.pose ?? null;
    const person = this.people.get(model);
    if (person !== undefined) return run.people[person]?.pose ?? null;
    let pose: Pose | null = null;
    for (let at = model; at >= 0; at = run.world.models[at].parent) {
      const {poseInParent} = run.world.models[at];
      pose = pose ? compose(poseInParent, pose) : poseInParent;
    }
    return pose;
  }

  // Flat, in the planes of its ends.
  private addRibbon(part: Vertices, from: Point, to: Point, half: number, color: Color): void {
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    const length = Math.hypot(dx, dy);
    if (length === 0) return;
    const [nx, ny] = [(-dy / length) * half, (dx / length) * half];
    const corner = ([x, y, z]: Point, side: number): void => part.add(x + side * nx, y + side * ny, z, color);
    corner(from, 1);
    corner(from, -1);
    corner(to, 1);
    corner(to, 1);
    corner(from, -1);
    corner(to, -1);
  }

  private addArrow(from: Point, to: Point, color: Color): void {
    const [dx, dy, dz] = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    const length = Math.hypot(dx, dy);
    if (length === 0) return;
    const head = Math.min(HEAD, length);
    const share = (length - head) / length;
    const neck: Point = [from[0] + share * dx, from[1] + share * dy, from[2] + share * dz];
    this.addRibbon(this.arrows, from, neck, ARROW, color);
    const [nx, ny] = [(-dy / length) * 2.6 * ARROW, (dx / length) * 2.6 * ARROW];
    this.arrows.add(neck[0] + nx, neck[1] + ny, neck[2], color);
    this.arrows.add(neck[0] - nx, neck[1] - ny, neck[2], color);
    this.arrows.add(...to, color);
  }
}
