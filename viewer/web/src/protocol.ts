// The messages of the gateway: viewer/gateway/page_messages.cc and page_viewer.cc write them. Numbers are
// little-endian; metres and radians, in the world frame unless the name says otherwise. The build makes the rows of the
// state and their readers (generated/rows.ts, by write_rows.cc).
//
// A message is trusted, because it comes from the server of the page: a truncated one throws a RangeError and ends its
// handling. The order of reads is the layout: each function reads what the function of the same content writes. A
// change of the layout needs another PROTOCOL on both sides.
import {readStateRows, type EventType, type StateRows} from '../generated/rows';

export const PROTOCOL = 7;

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

export interface Model {
  name: string;
  type: string;
  parent: number;  // -1: none
  pose: Pose;  // in the parent
  shape: number;
  color: [number, number, number, number];
  removed: boolean;
}

export interface Sensor {
  name: string;
  type: string;
}

export interface Robot {
  name: string;
  root: number;  // model
  present: boolean;
  controller: string;
  sensors: Sensor[];
  omni: boolean;  // can move sideways
  maxSpeed: number;  // m/s
  maxTurn: number;  // rad/s
}

export interface Joint {
  name: string;
  robot: number;
  model: number;
  revolute: boolean;
  axis: [number, number, number];
  min: number;
  max: number;
}

export interface Gripper {
  name: string;
  robot: number;
  lift: number;  // joint; -1: none
}

// A store of energy.
export interface Store {
  model: number;
  capacity: number;  // J
  endless: boolean;
}

export interface Light {
  model: number;
  row: number;  // of the lights of a state; -1: it is on no robot, and always switched as at load
  period: number;  // ns; in each it is on first
  on: number;  // ns
  switchedOn: boolean;  // at load
}

export interface Door {
  model: number;
  leaves: number[];  // objects
  operated: boolean;
}

export interface Lift {
  model: number;
  cabin: number;  // object
  floors: string[];
  heights: number[];  // m
}

export interface Level {
  name: string;
  z: number;  // m, of its floor
}

export interface World {
  number: number;
  run: string;  // of which it is a world
  name: string;
  host: string;
  interval: number;  // s
  shapes: Shape[];
  models: Model[];
  robots: Robot[];
  joints: Joint[];
  grippers: Gripper[];
  objects: number[];  // models
  stores: Store[];
  lights: Light[];
  doors: Door[];
  lifts: Lift[];
  people: number[];  // models
  levels: Level[];  // of a building, ascending
}

export const OBJECT_MODES = ['placed', 'resting', 'falling', 'held', 'mounted'];

export interface RunEvent {
  position: number;  // of its state on the timeline
  tick: number;
  type: EventType;
  robot: string;  // by their names in the world of the event; empty: none
  other: string;  // models
  object: string;
  detail: string;
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

// What the robots have done since the first state (viewer/gateway/past_reader.h).
export interface TotalsReply {
  done: boolean;
  problem: string;
  complete: boolean;
  first_tick?: number;
  last_tick?: number;
  seconds?: number;
  robots?: Array<{name: string; distance: number; energy?: number}>;
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

export interface Scan {
  pose: Pose;  // in the robot
  fov: number;
  min: number;
  max: number;
  elevations: Float64Array;  // by plane; empty: one horizontal plane
  ranges: Float64Array;  // of all rays of the first plane, then of the next
}

export interface Beam {
  from: [number, number];  // in the gripper's model
  to: [number, number];
  z: number;
  brokenBy: number;  // object; -1: none
}

export interface Fiducial {
  id: number;
  model: number;
  range: number;
  bearing: number;  // in the finder
  pose: Pose;  // of the model, in the world
}

export interface BumperSegment {
  pose: Pose;  // of its middle in the robot, x pointing away from the robot
  length: number;
  pressedBy: number;  // model; -1: none
}

export interface Contact {
  part: number;  // models
  other: number;
  x: number;
  y: number;
  bottom: number;
  top: number;
}

export interface Blob {
  color: [number, number, number];
  left: number;  // pixels
  top: number;
  right: number;
  bottom: number;
  range: number;
}

// Poses: of the sensor in the robot.
export interface CameraContent {
  kind: 'camera';
  pose: Pose;
  width: number;  // pixels
  height: number;
  focalX: number;  // pixels
  focalY: number;
  centerX: number;
  centerY: number;
  min: number;
  max: number;
  colors: Uint8Array;  // red, green and blue of each pixel, rows from the top
}

export interface BlobsContent {
  kind: 'blobs';
  pose: Pose;
  width: number;  // pixels
  height: number;
  fov: number;
  range: number;
  blobs: Blob[];
}

export interface Reception {
  from: number;  // robot
  toAll: boolean;
  size: number;  // bytes
  bytes: Uint8Array;  // the first ones
  rssi: number;  // dBm
  tick: number;  // in which it was sent
  place: {range: number; bearing: number; elevation: number} | null;  // of the sender's antenna, if it is measured
}

// The content of each kind of sensor. `none`: the page does not show it; `kept`: the reading before still counts.
export type Content =
  | {kind: 'none'}
  | {kind: 'kept'}
  | {kind: 'ranger'; scans: Scan[]}
  | {kind: 'beams'; gripperModel: number; beams: Beam[]}
  | {kind: 'fiducials'; pose: Pose; min: number; max: number; fov: number; fiducials: Fiducial[]}
  | {kind: 'bumper'; height: number; segments: BumperSegment[]}
  | {kind: 'contacts'; contacts: Contact[]}
  | BlobsContent
  | CameraContent
  | {kind: 'radio'; pose: Pose; range: number; receptions: Reception[]}
  | {kind: 'imu'; pose: Pose; heading: number; turn: number; force: [number, number, number]};

export type ContentOf<Kind extends Content['kind']> = Extract<Content, {kind: Kind}>;

export interface Reading {
  sensor: string;
  tick: number;  // of the measurement
  content: Content;
}

export function scansOf(reading: Reading): Scan[] {
  return reading.content.kind === 'ranger' ? reading.content.scans : [];
}

export interface RobotReadings {
  robot: number;
  tick: number;
  readings: Reading[];
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
  allEvents: boolean;  // the events replace those of before
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

function readWorld(r: Reader): World {
  const protocol = r.u32();
  if (protocol !== PROTOCOL) throw new Error('the viewer was updated: load the page again');
  return {
    number: r.u32(),
    run: String(r.u64()),
    name: r.text(),
    host: r.text(),
    interval: r.f64(),
    shapes: r.list(() => readShape(r)),
    models: r.list((): Model => ({
      name: r.text(), type: r.text(), parent: r.i32(), pose: r.pose(), shape: r.u32(),
      color: [r.f32(), r.f32(), r.f32(), r.f32()], removed: r.flag(),
    })),
    robots: r.list((): Robot => ({
      name: r.text(), root: r.u32(), present: r.flag(), controller: r.text(),
      sensors: r.list((): Sensor => ({name: r.text(), type: r.text()})),
      omni: r.flag(), maxSpeed: r.f32(), maxTurn: r.f32(),
    })),
    joints: r.list((): Joint => ({
      name: r.text(), robot: r.u32(), model: r.u32(), revolute: r.flag(),
      axis: [r.f32(), r.f32(), r.f32()], min: r.f64(), max: r.f64(),
    })),
    grippers: r.list((): Gripper => ({name: r.text(), robot: r.u32(), lift: r.i32()})),
    objects: r.list(() => r.u32()),
    stores: r.list((): Store => ({model: r.u32(), capacity: r.f64(), endless: r.flag()})),
    lights: r.list((): Light => ({
      model: r.u32(), row: r.i32(), period: Number(r.u64()), on: Number(r.u64()), switchedOn: r.flag(),
    })),
    doors: r.list((): Door => ({model: r.u32(), leaves: r.list(() => r.u32()), operated: r.flag()})),
    lifts: r.list((): Lift => ({
      model: r.u32(), cabin: r.u32(), floors: r.list(() => r.text()), heights: r.list(() => r.f64()),
    })),
    people: r.list(() => r.u32()),
    levels: r.list((): Level => ({name: r.text(), z: r.f64()})),
  };
}

// The readers of contents by the number of the kind in a message.
const CONTENT_READERS: Record<number, (r: Reader) => Content> = {
  0: () => ({kind: 'none'}),
  1: r => ({
    kind: 'ranger',
    scans: r.list((): Scan => ({
      pose: r.pose(), fov: r.f64(), min: r.f64(), max: r.f64(), elevations: r.doubles(r.u32()), ranges: r.doubles(r.u32()),
    })),
  }),
  2: r => ({
    kind: 'beams', gripperModel: r.u32(),
    beams: r.list((): Beam => ({from: [r.f64(), r.f64()], to: [r.f64(), r.f64()], z: r.f64(), brokenBy: r.i32()})),
  }),
  3: r => ({
    kind: 'fiducials', pose: r.pose(), min: r.f64(), max: r.f64(), fov: r.f64(),
    fiducials: r.list((): Fiducial => ({id: r.i32(), model: r.u32(), range: r.f64(), bearing: r.f64(), pose: r.pose()})),
  }),
  4: r => ({
    kind: 'bumper', height: r.f64(),
    segments: r.list((): BumperSegment => ({pose: r.pose(), length: r.f64(), pressedBy: r.i32()})),
  }),
  5: r => ({
    kind: 'contacts',
    contacts: r.list((): Contact => ({
      part: r.u32(), other: r.u32(), x: r.f64(), y: r.f64(), bottom: r.f64(), top: r.f64(),
    })),
  }),
  6: r => ({
    kind: 'blobs', pose: r.pose(), width: r.u32(), height: r.u32(), fov: r.f64(), range: r.f64(),
    blobs: r.list((): Blob => ({
      color: [r.f64(), r.f64(), r.f64()], left: r.u32(), top: r.u32(), right: r.u32(), bottom: r.u32(), range: r.f64(),
    })),
  }),
  7: r => ({
    kind: 'camera', pose: r.pose(), width: r.u32(), height: r.u32(), focalX: r.f64(), focalY: r.f64(), centerX: r.f64(),
    centerY: r.f64(), min: r.f64(), max: r.f64(), colors: r.bytes(r.u32()),
  }),
  8: r => ({
    kind: 'radio', pose: r.pose(), range: r.f64(),
    receptions: r.list((): Reception => ({
      from: r.u32(), toAll: r.flag(), size: r.u32(), bytes: r.bytes(r.u32()), rssi: r.f64(), tick: Number(r.u64()),
      place: r.flag() ? {range: r.f64(), bearing: r.f64(), elevation: r.f64()} : null,
    })),
  }),
  9: r => ({
    kind: 'imu', pose: r.pose(), heading: r.f64(), turn: r.f64(), force: [r.f64(), r.f64(), r.f64()],
  }),
  255: () => ({kind: 'kept'}),
};

function readRobotReadings(r: Reader): RobotReadings {
  const robot = r.u32();
  const tick = Number(r.u64());
  const readings = r.list((): Reading => {
    const sensor = r.text();
    const kind = r.u8();
    const read = CONTENT_READERS[kind];
    if (!read) throw new Error(`found a reading of kind ${kind}, expected 0 to 9 or 255`);
    return {sensor, tick, content: read(r)};
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
