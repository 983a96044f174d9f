// Run: the newest state of the run, as the updates of the gateway add up.
//
// One object per world, changed in place by updates; rows keep their indices for the life of the world. A new world (an
// edit, another run) makes a new Run, which inherits events and timeline only if the run is the same. The page computes
// no motion: every pose shown comes from the gateway, or lies between two of them (motion.ts).
import {EventType, StateTables} from '../generated/rows';
import type {Matrix4} from 'three';
import {
  JointType, type Joint, type LaneRule, type Light, type Pose, type Reading, type RobotGoal, type RobotReadings, type RunEvent, type RunStatus, type TimeSpan, type Traffic, type Update,
  type World,
} from './protocol';

export const VEHICLE_CONTROLLER = 'vda5050';
const MOST_EVENTS = 10_000;  // as the gateway keeps

export class Run extends StateTables {
  events: RunEvent[] = [];
  status: RunStatus | null = null;
  readings = new Map<number, RobotReadings>();  // by robot
  goals: RobotGoal[] = [];  // in force
  traffic: Traffic = {ways: [], waits: [], closed: []};  // if it is shown
  laneRules: LaneRule[] = [];
  tick = 0;
  hash = '';
  edition = 0;
  position = 0;  // on the timeline, from first to last
  first = 0;
  last = 0;
  past = false;
  paused = false;
  over = false;
  hasState = false;
  lostAgents = new Set<string>();  // of robots, by name
  spans: TimeSpan[] = [];  // of the timeline, ascending

  private readonly vehicles: Set<string>;  // of VDA 5050, by name

  constructor(public readonly world: World, before: Run | null) {
    super();
    this.vehicles = new Set(world.robots.filter(({controller}) => controller.name === VEHICLE_CONTROLLER).map(({name}) => name));
    if (before?.world.run !== world.run) return;
    this.spans = before.spans;
    this.events = before.events;
    this.lostAgents = before.lostAgents;
  }

  get seconds(): number {
    return this.tick * this.world.interval;
  }

  apply(update: Update): void {
    this.applyRows(update);
    if (update.allEvents) {
      this.events = [];
      this.lostAgents.clear();
    }
    for (const event of update.events) {
      if (event.type === EventType.Left) this.lostAgents.add(event.robot);
      if (event.type === EventType.Joined) this.lostAgents.delete(event.robot);
      event.ofVehicle = this.vehicles.has(event.robot);
      this.events.push(event);
    }
    if (this.events.length > MOST_EVENTS) this.events.splice(0, this.events.length - MOST_EVENTS);
    if (update.readings) this.readings = new Map(update.readings.map(readings => [readings.robot, this.withKept(readings)]));
    this.goals = update.goals;
    this.traffic = update.traffic;
    this.laneRules = update.laneRules;
    this.tick = update.tick;
    this.hash = update.hash;
    this.edition = update.edition;
    this.position = update.position;
    this.first = update.first;
    this.last = update.lastPosition;
    this.past = update.past;
    this.paused = update.paused;
    this.over = update.last;
    this.hasState = true;
  }

  isSwitchedOn(light: Light): boolean {
    return light.row >= 0 ? this.lights[light.row]?.switchedOn ?? light.switchedOn : light.switchedOn;
  }

  // Blinking follows simulated time.
  isLit(light: Light): boolean {
    const time = this.tick * Math.round(this.world.interval * 1e9);
    return this.isSwitchedOn(light) && time % light.blinkPeriod < light.blinkOn;
  }

  // Readings that the gateway has not sent again (camera images, which are large) are those of the previous update.
  private withKept(received: RobotReadings): RobotReadings {
    const before = this.readings.get(received.robot)?.readings ?? [];
    const readings = received.readings.map((reading, i): Reading => {
      return reading.kept && before[i]?.sensor === reading.sensor ? before[i] : reading;
    });
    return {...received, readings};
  }

  // The objects that the robot's grippers hold, as indices.
  held(robot: number): number[] {
    const result: number[] = [];
    this.objects.forEach((object, i) => {
      if (object.holder >= 0 && this.world.grippers[object.holder]?.robot === robot) result.push(i);
    });
    return result;
  }
}

// A robot, an object or a person of the world.
export interface Entity {
  kind: 'robot' | 'object' | 'person';
  index: number;
}

export function sameEntity(a: Entity | null, b: Entity | null): boolean {
  return a === b || (a !== null && b !== null && a.kind === b.kind && a.index === b.index);
}

export function rootOf(world: World, entity: Entity): number {
  if (entity.kind === 'robot') return world.robots[entity.index].root;
  return entity.kind === 'object' ? world.objects[entity.index] : world.people[entity.index].root;
}

// True if the model is `root` or below it.
export function isInTree(world: World, model: number, root: number): boolean {
  let at = model;
  while (at >= 0 && at !== root) at = world.models[at].parent;
  return at === root;
}

export function nameOf(world: World, entity: Entity): string {
  return world.models[rootOf(world, entity)].name;
}

export function findEntity(world: World, name: string): Entity | null {
  const robot = world.robots.findIndex(r => r.present && r.name === name);
  if (robot >= 0) return {kind: 'robot', index: robot};
  const object = world.objects.findIndex(o => !world.models[o].removed && world.models[o].name === name);
  if (object >= 0) return {kind: 'object', index: object};
  const person = world.people.findIndex(({root}) => !world.models[root].removed && world.models[root].name === name);
  return person >= 0 ? {kind: 'person', index: person} : null;
}

// A person that is not in the world at present is this far below it, as in troupe/world_state.h.
const AWAY_Z = -500_000;

export function isAway(pose: {z: number}): boolean {
  return pose.z < 0.5 * AWAY_Z;
}

export function poseOf(run: Run, entity: Entity): Pose | null {
  const rows = {robot: run.robots, object: run.objects, person: run.people}[entity.kind];
  const row = rows[entity.index];
  return row ? row.pose : null;
}

// Poses as in troupe/pose.h: compose(X_AB, X_BC) is X_AC.

export const IDENTITY: Pose = {x: 0, y: 0, z: 0, heading: 0};

export function compose(a: Pose, b: Pose): Pose {
  const c = Math.cos(a.heading);
  const s = Math.sin(a.heading);
  return {
    x: a.x + c * b.x - s * b.y,
    y: a.y + s * b.x + c * b.y,
    z: a.z + b.z,
    heading: a.heading + b.heading,
  };
}

// The motion of the joint's model at a position, in the model's frame.
export function jointMotion(joint: Joint, position: number): Pose {
  if (joint.type === JointType.Revolute) return {...IDENTITY, heading: position};
  const {axis, axisZ} = joint;
  return {x: position * axis.x, y: position * axis.y, z: position * axisZ, heading: 0};
}

export function toMatrix(pose: Pose, matrix: Matrix4): Matrix4 {
  const c = Math.cos(pose.heading);
  const s = Math.sin(pose.heading);
  return matrix.set(c, -s, 0, pose.x, s, c, 0, pose.y, 0, 0, 1, pose.z, 0, 0, 0, 1);
}

export function degrees(radians: number): number {
  return (radians * 180) / Math.PI;
}
