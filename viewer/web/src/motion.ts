// Motion: the poses at which bodies are drawn between two updates, so that a run of ten ticks a second does not jerk. A
// body moves from where it is drawn to its newest pose, in the time that passed between the last two updates.
import type {JointRow, ObjectRow, RobotRow} from '../generated/rows';
import type {Pose} from './protocol';
import type {Run} from './run';

const LONGEST = 250;  // ms; a slower run is shown as it is
const JUMP = 1.0;  // m: a longer way is an edit
const MOST_BODIES = 400;  // beyond that the drawing costs more than it shows

interface Shown {
  robots: Pose[];
  objects: Pose[];
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
    const isSmall = run.world.robots.length + run.world.objects.length <= MOST_BODIES;
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
      joints: run.joints.map(row => row.position),
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
    const {robots, objects, joints} = this.shown(now);
    const view = Object.create(run) as Run;
    view.robots = run.robots.map((row, i): RobotRow => ({...row, pose: robots[i]}));
    view.objects = run.objects.map((row, i): ObjectRow => ({...row, pose: objects[i]}));
    view.joints = run.joints.map((row, i): JointRow => ({...row, position: joints[i]}));
    return view;
  }

  private shown(now: number): Shown {
    const target = this.target ?? {robots: [], objects: [], joints: []};
    const from = this.from;
    if (!from || !this.moves(now)) return target;
    const t = (now - this.begin) / this.duration;
    const poses = (a: Pose[], b: Pose[]): Pose[] => b.map((pose, i) => (a[i] ? between(a[i], pose, t) : pose));
    return {
      robots: poses(from.robots, target.robots),
      objects: poses(from.objects, target.objects),
      joints: target.joints.map((position, i) => (from.joints[i] ?? position) + t * (position - (from.joints[i] ?? position))),
    };
  }
}
