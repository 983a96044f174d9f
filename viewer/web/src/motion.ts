// Motion: the poses at which bodies are drawn between two updates, so that a run of ten ticks a second does not jerk. A
// body moves from where it is drawn to its newest pose, in the time that passed between the last two updates.
//
// So the picture is up to one update late, and never ahead: extrapolated bodies would be seen inside walls. Numbers in
// panels are those of the newest state. Edits, jumps and the past are not smoothed.
import type {JointRow, ObjectRow, PersonRow, RobotRow} from '../generated/rows';
import {BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, LineBasicMaterial, LineSegments} from 'three';
import {robotColorOf} from './colors';
import type {Pose} from './protocol';
import {isAway, type Run} from './run';

const LONGEST = 250;  // ms; a slower run is shown as it is
const JUMP = 1.0;  // m: a longer way is an edit
const MOST_BODIES = 400;  // beyond that the drawing costs more than it shows

interface Shown {
  robots: Pose[];
  objects: Pose[];
  people: Pose[];
  joints: number[];
}

function between(a: Pose, b: Pose, t: number): Pose {
  if (Math.hypot(b.x - a.x, b.y - a.y) > JUMP) return b;
  const turn = Math.atan2(Math.sin(b.heading - a.heading), Math.cos(b.heading - a.heading));
  return {x: a.x + t * (b.x - a.x), y: a.y + t * (b.y - a.y), z: a.z + t * (b.z - a.z), heading: b.heading - (1 - t) * turn};
}

export class Motion {
  enabled = true;
  private run: Run | null = null;
  private from: Shown | null = null;
  private begin = 0;  // ms
  private duration = 0;
  private arrived = 0;
  private key = '';
  private tick = 0;
  private target: Shown | null = null;  // the newest state; null: it is shown as it is

  // The run has a new state.
  update(run: Run, now: number): void {
    const key = `${run.world.number} ${run.edition} ${run.past}`;
    const isSmall = run.world.robots.length + run.world.objects.length + run.world.people.length <= MOST_BODIES;
    const advances = this.enabled && this.target !== null && key === this.key && run.tick > this.tick;
    if (run.tick === this.tick && key === this.key) {
      this.run = run;
      return;
    }
    const passed = now - this.arrived;
    const from = advances && passed < LONGEST ? this.shown(now) : null;
    this.run = run;
    this.from = from;
    this.duration = from ? passed : 0;
    this.begin = this.arrived = now;
    this.key = key;
    this.tick = run.tick;
    // Now, because the next update changes the rows of the run.
    this.target = this.enabled && isSmall ? {
      robots: run.robots.map(row => row.pose), objects: run.objects.map(row => row.pose),
      joints: run.joints.map(row => row.position), people: run.people.map(row => row.pose),
    } : null;
  }

  // Bodies are on their way.
  moves(now: number): boolean {
    return this.from !== null && now < this.begin + this.duration;
  }

  // The run with the poses that are drawn now.
  view(run: Run, now: number): Run {
    if (!this.moves(now) || this.run !== run) {
      this.from = null;
      return run;
    }
    const {robots, objects, joints, people} = this.shown(now);
    const view = Object.create(run) as Run;
    view.robots = run.robots.map((row, i): RobotRow => ({...row, pose: robots[i]}));
    view.objects = run.objects.map((row, i): ObjectRow => ({...row, pose: objects[i]}));
    view.people = run.people.map((row, i): PersonRow => ({...row, pose: people[i]}));
    view.joints = run.joints.map((row, i): JointRow => ({...row, position: joints[i]}));
    return view;
  }

  private shown(now: number): Shown {
    const target = this.target ?? {robots: [], objects: [], joints: [], people: []};
    const from = this.from;
    if (!from || !this.moves(now)) return target;
    const t = (now - this.begin) / this.duration;
    const poses = (a: Pose[], b: Pose[]): Pose[] => b.map((pose, i) => (a[i] && isAway(a[i]) === isAway(pose) ? between(a[i], pose, t) : pose));
    return {
      robots: poses(from.robots, target.robots),
      objects: poses(from.objects, target.objects),
      people: poses(from.people, target.people),
      joints: target.joints.map((position, i) => (from.joints[i] ?? position) + t * (position - (from.joints[i] ?? position))),
    };
  }
}

// Trails: the ways that robots have come, as lines on the ground in the colours of the robots.

const POINTS = 120;  // of a trail
const STEP = 0.05;  // m, from one point to the next
const NEW_TRAIL = 2.0;  // m: a longer step is a new pose by an edit, and begins another trail
const HEIGHT = 0.015;  // m

interface Trail {
  points: Float32Array;  // x, y of a ring of points
  next: number;
  count: number;
}

export class Trails {
  visible = false;
  readonly lines: LineSegments;
  private readonly geometry = new BufferGeometry();
  private readonly material = new LineBasicMaterial({vertexColors: true, transparent: true, opacity: 0.8, depthWrite: false});
  private trails = new Map<number, Trail>();  // by robot
  private values = new Float32Array(0);
  private colors = new Float32Array(0);
  private readonly color = new Color();
  private tick = 0;

  constructor() {
    this.lines = new LineSegments(this.geometry, this.material);
    this.lines.frustumCulled = false;
  }

  clear(): void {
    this.trails.clear();
  }

  show(run: Run): void {
    if (run.tick < this.tick) this.clear();
    this.tick = run.tick;
    run.robots.forEach((row, robot) => this.extend(robot, row.pose.x, row.pose.y));
    this.lines.visible = this.visible;
    if (this.visible) this.fill();
  }

  private extend(robot: number, x: number, y: number): void {
    let trail = this.trails.get(robot);
    if (!trail) {
      trail = {points: new Float32Array(2 * POINTS), next: 0, count: 0};
      this.trails.set(robot, trail);
    }
    if (trail.count > 0) {
      const last = (trail.next + POINTS - 1) % POINTS;
      const distance = Math.hypot(x - trail.points[2 * last], y - trail.points[2 * last + 1]);
      if (distance < STEP) return;
      if (distance > NEW_TRAIL) trail.count = 0;
    }
    trail.points[2 * trail.next] = x;
    trail.points[2 * trail.next + 1] = y;
    trail.next = (trail.next + 1) % POINTS;
    trail.count = Math.min(POINTS, trail.count + 1);
  }

  private fill(): void {
    const needed = this.trails.size * (POINTS - 1) * 6;
    if (this.values.length < needed) {
      this.values = new Float32Array(needed);
      this.colors = new Float32Array(needed);
      this.geometry.dispose();
      this.geometry.setAttribute('color', new BufferAttribute(this.colors, 3).setUsage(DynamicDrawUsage));
      this.geometry.setAttribute('position', new BufferAttribute(this.values, 3).setUsage(DynamicDrawUsage));
    }
    let at = 0;
    for (const [robot, {points, next, count}] of this.trails) {
      const {r, g, b} = robotColorOf(robot, this.color);
      for (let i = count; i > 1; --i) {
        for (const back of [i, i - 1]) {
          const index = (next + POINTS - back) % POINTS;
          this.values.set([points[2 * index], points[2 * index + 1], HEIGHT], at);
          this.colors.set([r, g, b], at);
          at += 3;
        }
      }
    }
    this.geometry.setDrawRange(0, at / 3);
    for (const name of ['position', 'color']) {
      const attribute = this.geometry.getAttribute(name);
      if (attribute) attribute.needsUpdate = true;
    }
  }
}
