// Trails: the ways that robots have come, as lines on the ground.
import {BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, LineBasicMaterial, LineSegments} from 'three';
import type {Run} from './run';

const POINTS = 120;  // of a trail
const STEP = 0.05;  // m, from one point to the next
const JUMP = 2.0;  // m: a longer step is a new pose by an edit, and begins another trail
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
  private readonly material = new LineBasicMaterial({transparent: true, opacity: 0.55, depthWrite: false});
  private trails = new Map<number, Trail>();  // by robot
  private values = new Float32Array(0);
  private tick = 0;

  constructor() {
    this.lines = new LineSegments(this.geometry, this.material);
    this.lines.frustumCulled = false;
  }

  setColor(color: Color): void {
    this.material.color = color;
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
      if (distance > JUMP) trail.count = 0;
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
      this.geometry.dispose();
      this.geometry.setAttribute('position', new BufferAttribute(this.values, 3).setUsage(DynamicDrawUsage));
    }
    let at = 0;
    for (const {points, next, count} of this.trails.values()) {
      for (let i = count; i > 1; --i) {
        for (const back of [i, i - 1]) {
          const index = (next + POINTS - back) % POINTS;
          this.values[at++] = points[2 * index];
          this.values[at++] = points[2 * index + 1];
          this.values[at++] = HEIGHT;
        }
      }
    }
    this.geometry.setDrawRange(0, at / 3);
    const attribute = this.geometry.getAttribute('position');
    if (attribute) attribute.needsUpdate = true;
  }
}
