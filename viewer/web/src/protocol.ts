// The messages of the gateway: viewer/gateway/page_messages.cc and page_viewer.cc write them. Numbers are
// little-endian; metres and radians, in the world frame unless the name says otherwise. The build makes the types of
// states, of the description of the world and of readings, and their readers (generated/rows.ts, by write_rows.cc); here
// is what the page derives from them.
//
// A message is trusted, because it comes from the server of the page: a truncated one throws a RangeError and ends its
// handling. The order of reads is the layout: each function reads what the function of the same content writes. A
// change of a part written by hand needs another kPageProtocol.
import {
  LAYOUT, readContent, readDescription, readStateRows, type Content, type EventType, type StateRows, type WorldDescription,
} from '../generated/rows';

export interface Pose {
  x: number;
  y: number;
  z: number;
  heading: number;
}

export interface Twist {
  vx: number;
  vy: number;
  wz: number;
}

export interface Block {
  bottom: number;
  top: number;
  outline: Float32Array;  // x, y, x, y ... counter-clockwise
}

// The occupied pixels of a dense bitmap.
export interface Area {
  box: [number, number, number, number];  // min x, min y, max x, max y
  pose: Pose;
  width: number;  // pixels
  height: number;
  bits: Uint8Array;  // row by row, the lowest bit first
}

export interface Shape {
  blocks: Block[];
  bottom: number;  // of the rectangles and the area
  top: number;
  rectangles: Float32Array;  // min x, min y, max x, max y of each
  loops: Float32Array[];  // around the union of the rectangles
  area: Area | null;
}

// Red, green, blue and alpha, 0 to 1.
export type Color = [number, number, number, number];

export type Joint = WorldDescription['joints'][number];
export type Level = WorldDescription['levels'][number];
type Model = WorldDescription['models'][number];

// As in troupe/world_description.h.
export const enum DriveType { Differential, Omni, Car }
export const enum JointType { Prismatic, Revolute }

export type Robot = WorldDescription['robots'][number] & {
  present: boolean;
  maxSpeed: number;  // m/s, at which a user can drive it
  maxTurn: number;  // rad/s
};

// A store of energy.
export type Store = Model['power'] & {model: number};

export type Light = Model['blinking'] & {
  model: number;
  row: number;  // of the lights of a state; -1: it is on no robot, and always switched as at load
};

export interface World extends Omit<WorldDescription, 'interval' | 'robots'> {
  number: number;
  run: string;  // of which it is a world
  host: string;
  interval: number;  // s
  robots: Robot[];
  stores: Store[];  // by their rows in states
  lights: Light[];
}

export const OBJECT_MODES = ['placed', 'resting', 'falling', 'held', 'mounted'];

// A goal of a user that is in force: x, y, x, y ...
export interface RobotGoal {
  robot: number;
  waypoints: Float32Array;
  way: Float32Array;  // to the last one, of a robot that is selected and searches its ways; else empty
}

export interface RunEvent {
  position: number;  // of its state on the timeline
  tick: number;
  type: EventType;
  robot: string;  // by their names in the world of the event; empty: none
  other: string;  // models
  object: string;
  detail: string;
  ofVehicle?: boolean;  // its robot is a vehicle of VDA 5050
}

// The fields of StatusMessage (transport/protocol/messages.h), as JSON.
export interface RunStatus {
  target_ticks: number;  // 0: no end
  real_time_factor: number;
  waiting_seconds: number;
  waiting_count: number;
  waiting_for: string[];  // the first ones
  speed?: number;  // that the run is paced to, multiple of real time; none: it is not paced
  phases: {wait: number; step: number; record: number; publish: number};  // s, of a tick of the service; 0: no tick was made
}

// A part of the timeline without a gap: its first and last position, and the tick at the first.
export type TimeSpan = [number, number, number];

// Of signals of robots (viewer/gateway/signals.h), at the states that have one.
export interface SeriesReply {
  done: boolean;
  problem: string;
  positions: number[];
  ticks: number[];
  values: Array<Array<number | null>>;  // by signal
  next: number | null;  // the position with which to go on
  tables?: SignalTable[];  // of a request without signals
}

// A kind of things, and the signals that each of them has (common/signals).
export interface SignalTable {
  name: string;  // "doors"
  singular: string;
  things: string[];
  signals: Array<{name: string, unit: string, documentation: string}>;
}

// What the robots have done since the first state (viewer/gateway/past_answers.h).
export interface TotalsReply {
  done: boolean;
  problem: string;
  complete: boolean;
  first_tick?: number;
  last_tick?: number;
  seconds?: number;
  robots?: Array<{name: string; distance: number; energy?: number}>;
  traffic?: {robots: number; arrivals: number; arrivals_per_hour: number; utilisation: number; waiting: number};
  waits?: Array<{kind: string; place: string; seconds: number; longest: number; waits: number}>;  // the most waiting first, by kind
}

// The verdicts of expectations over the past (viewer/gateway/expectation_rows.h).
export interface ExpectationRow {
  name: string;
  text: string;
  problem: string;  // why it is not judged; the others are missing then
  verdict?: 'true' | 'false' | 'undecided';
  at_end?: boolean;  // it holds if the run ends at the last judged state
  decided?: number | null;  // positions
  cause?: number | null;
  names?: string[];
  robustness?: [number | null, number | null];  // null: infinite
  spans?: Array<[number, number]>;  // from a position on: 0: not decided, 1: it holds so far, 2: violated
}
export interface ExpectationsReply {
  done: boolean;
  problem: string;
  complete: boolean;
  from: number;  // positions
  from_tick: number;
  to: number;
  problem_at: string;  // why later states are not judged
  rows: ExpectationRow[];
}

// The content of a reading of this kind.
export type ContentOf<Kind extends Content['kind']> = Extract<Content, {kind: Kind}>;
export type Scan = ContentOf<'ranger'>['geometry'][number] & {
  ranges: Float64Array;  // of all rays of the first plane, then of the next
};
export type BumperSegment = ContentOf<'bumper'>['segments'][number];
export type Reception = ContentOf<'radio'>['receptions'][number];

export interface Reading {
  sensor: string;
  tick: number;  // of the measurement
  content: Content;
  kept: boolean;  // not sent again: the content before still counts
}

export function scansOf(content: Content): Scan[] {
  if (content.kind !== 'ranger') return [];
  let first = 0;
  return content.geometry.map(scan => {
    const begin = first;
    first += Math.max(1, scan.elevations.length) * scan.fan.count;
    return {...scan, ranges: content.ranges.subarray(begin, first)};
  });
}

export interface RobotReadings {
  robot: number;
  tick: number;
  readings: Reading[];
}

// The next vertex of a robot's way on its lanes, counted through all graphs.
export interface Move {
  to: number;
  granted: boolean;  // the robot may go there: others keep off
}

export interface Wait {
  robot: number;
  since: number;  // tick
  thing: number;  // the model for which it waits; -1: not known
  lane: number | null;
}

export interface Traffic {
  ways: Array<{robot: number; moves: Move[]}>;
  waits: Wait[];
  closed: number[];  // lanes
}

// A lane that an operator has closed (a limit of 0) or slowed down (m/s), counted through all graphs.
export interface LaneRule {
  lane: number;
  speedLimit: number;
}

export interface Update extends StateRows {
  world: number;
  past: boolean;  // of a past state, or a recording
  paused: boolean;
  last: boolean;
  tick: number;
  hash: string;
  edition: number;
  position: number;  // on the timeline; the next are its ends
  first: number;
  lastPosition: number;
  events: RunEvent[];
  allEvents: boolean;  // the events replace all earlier ones
  goals: RobotGoal[];
  traffic: Traffic;  // empty unless the page asks for it
  laneRules: LaneRule[];
  readings: RobotReadings[] | null;  // null: the ones before still count
}

export class Reader {
  private at = 0;
  private readonly view: DataView;

  constructor(private readonly buffer: ArrayBuffer) {
    this.view = new DataView(buffer);
  }

  u8(): number {
    return this.view.getUint8(this.at++);
  }
  // Not a value of the message yet.
  peek(): number {
    return this.view.getUint8(this.at);
  }
  flag(): boolean {
    return this.u8() !== 0;
  }
  u32(): number {
    this.at += 4;
    return this.view.getUint32(this.at - 4, true);
  }
  i32(): number {
    this.at += 4;
    return this.view.getInt32(this.at - 4, true);
  }
  u64(): bigint {
    this.at += 8;
    return this.view.getBigUint64(this.at - 8, true);
  }
  i64(): bigint {
    this.at += 8;
    return this.view.getBigInt64(this.at - 8, true);
  }
  f32(): number {
    this.at += 4;
    return this.view.getFloat32(this.at - 4, true);
  }
  f64(): number {
    this.at += 8;
    return this.view.getFloat64(this.at - 8, true);
  }
  bytes(count: number): Uint8Array {
    this.at += count;
    return new Uint8Array(this.buffer.slice(this.at - count, this.at));
  }
  text(): string {
    return new TextDecoder().decode(this.bytes(this.u32()));
  }
  pose(): Pose {
    return {x: this.f64(), y: this.f64(), z: this.f64(), heading: this.f64()};
  }
  twist(): Twist {
    return {vx: this.f32(), vy: this.f32(), wz: this.f32()};
  }
  floats(count: number): Float32Array {
    return new Float32Array(this.bytes(4 * count).buffer);
  }
  doubles(count: number): Float64Array {
    return new Float64Array(this.bytes(8 * count).buffer);
  }
  list<T>(read: () => T): T[] {
    const count = this.u32();
    const result: T[] = [];
    for (let i = 0; i < count; ++i) result.push(read());
    return result;
  }
  color(): Color {
    return [this.f32(), this.f32(), this.f32(), this.f32()];
  }
  variant<T>(readers: Array<() => T>): T {
    const kind = this.u8();
    if (kind >= readers.length) throw new Error(`found a value of kind ${kind}, expected less than ${readers.length}`);
    return readers[kind]();
  }
  shape(): Shape {
    return readShape(this);
  }
}

function readShape(r: Reader): Shape {
  const blocks = r.list((): Block => {
    const bottom = r.f32();
    const top = r.f32();
    return {bottom, top, outline: r.floats(2 * r.u32())};
  });
  const bottom = r.f32();
  const top = r.f32();
  const rectangles = r.floats(4 * r.u32());
  const loops = r.list(() => r.floats(2 * r.u32()));
  let area: Area | null = null;
  if (r.flag()) {
    const box: Area['box'] = [r.f32(), r.f32(), r.f32(), r.f32()];
    const pose = r.pose();
    const width = r.u32();
    const height = r.u32();
    area = {box, pose, width, height, bits: r.bytes(Math.ceil((width * height) / 8))};
  }
  return {blocks, bottom, top, rectangles, loops, area};
}

function withSpeeds(robot: WorldDescription['robots'][number], models: Model[]): Robot {
  const {type, velocity, wheelbase} = robot.drive;
  const maxSpeed = velocity.x.max;
  const maxTurn = type === DriveType.Car ? maxSpeed / wheelbase : velocity.heading.max;
  return {...robot, present: !models[robot.root].removed, maxSpeed, maxTurn};
}

function readWorld(r: Reader): World {
  if (r.u32() !== LAYOUT) throw new Error('the viewer was updated: load the page again');
  const number = r.u32();
  const run = String(r.u64());
  const host = r.text();
  const world = readDescription(r);
  const {models} = world;
  const stores = r.list(() => r.u32());
  const rowOfLight = new Map(r.list(() => r.u32()).map((model, row) => [model, row]));
  return {
    ...world, number, run, host,
    interval: world.interval * 1e-9,
    robots: world.robots.map(robot => withSpeeds(robot, models)),
    stores: stores.map(model => ({model, ...models[model].power})),
    lights: models.flatMap(({blinking}, model) =>
      blinking.blinkPeriod > 0 ? [{model, row: rowOfLight.get(model) ?? -1, ...blinking}] : []),
  };
}

const KEPT = 255;  // in place of the kind of a reading

function readRobotReadings(r: Reader): RobotReadings {
  const robot = r.u32();
  const tick = Number(r.u64());
  const readings = r.list((): Reading => {
    const sensor = r.text();
    if (r.peek() !== KEPT) return {sensor, tick, content: readContent(r), kept: false};
    r.u8();
    return {sensor, tick, content: {kind: 'none'}, kept: true};
  });
  return {robot, tick, readings};
}

function readUpdate(r: Reader): Update {
  const world = r.u32();
  const flags = r.u8();
  return {
    world,
    paused: (flags & 1) !== 0,
    last: (flags & 2) !== 0,
    past: (flags & 16) !== 0,
    allEvents: (flags & 32) !== 0,
    tick: Number(r.u64()),
    hash: r.u64().toString(16).padStart(16, '0'),
    edition: r.u32(),
    position: Number(r.u64()),
    first: Number(r.u64()),
    lastPosition: Number(r.u64()),
    ...readStateRows(r),
    events: r.list((): RunEvent => ({
      position: Number(r.u64()), tick: Number(r.u64()), type: r.u8(), robot: r.text(), other: r.text(), object: r.text(),
      detail: r.text(),
    })),
    goals: r.list((): RobotGoal => ({robot: r.u32(), waypoints: r.floats(2 * r.u32()), way: r.floats(2 * r.u32())})),
    traffic: {
      ways: r.list(() => ({robot: r.u32(), moves: r.list((): Move => ({to: r.u32(), granted: r.flag()}))})),
      waits: r.list((): Wait => ({robot: r.u32(), since: Number(r.u64()), thing: r.i32(), lane: r.flag() ? r.u32() : null})),
      closed: r.list(() => r.u32()),
    },
    laneRules: r.list((): LaneRule => ({lane: r.u32(), speedLimit: r.f64()})),
    readings: (flags & 8) !== 0 ? r.list(() => readRobotReadings(r)) : null,
  };
}

export type Message = {kind: 'world'; world: World} | {kind: 'update'; update: Update};

export function decode(buffer: ArrayBuffer): Message {
  const reader = new Reader(buffer);
  const kind = reader.u8();
  if (kind === 1) return {kind: 'world', world: readWorld(reader)};
  if (kind === 2) return {kind: 'update', update: readUpdate(reader)};
  throw new Error(`found a message of kind ${kind}, expected 1 or 2`);
}
