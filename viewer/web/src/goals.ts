// GoalMarks: the goals of users that are in force, and the ways to them.
//
// A goal is a ring on the ground with a cross, in the colour of its robot. The way of the selected robot comes from the
// gateway, which searches it as the robot does; other robots have a straight line through their points, because a way for
// each of many robots would cost the gateway more than it shows.
import {BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments} from 'three';
import {robotColorOf} from './colors';
import type {RobotGoal} from './protocol';
import type {Run} from './run';

const HEIGHT = 0.02;  // m, above the robot's floor
const RADIUS = 0.2;  // m
const SIDES = 24;

export class GoalMarks {
  readonly lines = new LineSegments(
    new BufferGeometry(), new LineBasicMaterial({vertexColors: true, transparent: true, depthWrite: false}));
  private readonly color = new Color();

  constructor() {
    this.lines.frustumCulled = false;
    this.lines.visible = false;
  }

  show(run: Run): void {
    if (run.goals.length === 0 && !this.lines.visible) return;  // most runs
    const points: number[] = [];
    const colors: number[] = [];
    for (const goal of run.goals) {
      const pose = run.robots[goal.robot]?.pose;
      if (!pose) continue;
      const before = points.length;
      addGoal(points, goal, pose.x, pose.y, pose.z + HEIGHT);
      const {r, g, b} = robotColorOf(goal.robot, this.color);
      for (let i = before; i < points.length; i += 3) colors.push(r, g, b);
    }
    this.lines.visible = points.length > 0;
    this.lines.geometry.dispose();
    this.lines.geometry = new BufferGeometry();
    this.lines.geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    this.lines.geometry.setAttribute('color', new BufferAttribute(new Float32Array(colors), 3));
  }
}

function addGoal(points: number[], goal: RobotGoal, x: number, y: number, z: number): void {
  const line = (x0: number, y0: number, x1: number, y1: number): void => { points.push(x0, y0, z, x1, y1, z); };
  const way = goal.way.length > 0 ? goal.way : goal.waypoints;
  let [fromX, fromY] = [x, y];
  for (let i = 0; i + 1 < way.length; i += 2) {
    line(fromX, fromY, way[i], way[i + 1]);
    [fromX, fromY] = [way[i], way[i + 1]];
  }
  const [endX, endY] = goal.waypoints.slice(-2);
  for (let i = 0; i < SIDES; ++i) {
    const [a, b] = [i, i + 1].map(corner => (2 * Math.PI * corner) / SIDES);
    line(endX + RADIUS * Math.cos(a), endY + RADIUS * Math.sin(a), endX + RADIUS * Math.cos(b), endY + RADIUS * Math.sin(b));
  }
  line(endX - RADIUS, endY, endX + RADIUS, endY);
  line(endX, endY - RADIUS, endX, endY + RADIUS);
}
