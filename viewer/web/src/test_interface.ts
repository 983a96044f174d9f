// window.troupe: the content of the page, for tests. Tests read what is shown, not what was received, and act by the
// same methods as users' events; there are no shortcuts into the run.
import {Vector3} from 'three';
import type {Connection, EditReply, Reply} from './connection';
import type {FileDocument} from './file_client';
import type {FileEditor} from './file_editor';
import {eventText} from './events';
import type {Plots} from './plots';
import {scansOf, type Pose, type RunStatus} from './protocol';
import {findEntity, type Run} from './run';
import type {WorldScene} from './scene';
import type {ShownZone} from './zone_marks';

export interface ShownRobot {
  name: string;
  pose: Pose;  // as received
  drawn: Pose | null;  // of the instance in the scene; null: it has no body
  stalled: boolean;
  twist: [number, number, number];
}

export interface TestInterface {
  connected(): boolean;
  state(): {tick: number; hash: string; paused: boolean; over: boolean; edition: number; past: boolean; first: number; last: number; speed: number; phases: RunStatus['phases'] | null} | null;
  robots(): ShownRobot[];
  // The ranges of each scan of the robot, by sensor, at the tick of the measurement.
  readings(robot: string): {tick: number; sensors: Record<string, number[][]>} | null;
  // The tick of the measurement and the decoded content as JSON, by sensor of the robot; bytes in hexadecimal digits.
  contents(robot: string): Record<string, {tick: number; content: unknown}> | null;
  // The goals in force: the robot, the last point, and the number of points of its way.
  goals(): Array<{robot: string; to: number[]; way: number}>;
  // The traffic that is drawn: the robots whose ways are, and the arrows.
  traffic(): {ways: string[]; waits: Array<{robot: string; thing: string; ring: boolean}>};
  // The zones that are drawn.
  zones(): ShownZone[];
  // The nodes of the selected vehicle's order that are drawn.
  vehicleMarks(): {base: string[]; horizon: string[]};
  // The names by index.
  names(): {models: string[]; robots: string[]};
  // Whether each light is lit, by the name of its model.
  lights(): Record<string, boolean>;
  // The levels of the building, from below, and the choice among them: stacked, beside, or a level.
  levels(): {names: string[]; choice: string};
  select(name: string): void;
  events(): Array<{tick: number; position: number; text: string}>;
  // Adds signals of the selected robot to the plots, and what their export has.
  plot(signals: string[]): void;
  csv(): Promise<string>;
  request(command: string, more?: object): Promise<Reply>;
  // The page shows the replies to all of its requests, and the world of the edited file as it is then.
  isIdle(): boolean;
  // The members of an editor: its file as shown, a request, and the places of points on the window.
  file(): FileDocument | null;
  edit(op: string, more?: object): Promise<EditReply>;
  // How far the ground reaches from the origin, m: to -x, -y, x, y.
  ground(): number[];
  // The text in the text pane; null: it is closed.
  text(): string | null;
  setText(text: string): void;
  modelPoint(view: 'top' | 'side', a: number, b: number): {x: number; y: number} | null;
  groundPoint(x: number, y: number): {x: number; y: number};
  // Where an entity is on the window.
  placeOf(name: string): {x: number; y: number} | null;
}

export interface TestHost {
  run(): Run | null;
  connected(): boolean;
  select(name: string): void;
  plots(): Plots;
  file(): FileEditor | null;
}

export function installTestInterface(host: TestHost, scene: WorldScene, connection: Connection): void {
  const troupe: TestInterface = {
    connected: () => host.connected(),
    state: () => {
      const run = host.run();
      if (!run?.hasState) return null;
      return {
        tick: run.tick, hash: run.hash, paused: run.paused, over: run.over, edition: run.edition, past: run.past,
        first: run.first, last: run.last, speed: run.status?.speed ?? 0,
        phases: run.status?.phases ?? null,
      };
    },
    robots: () => {
      const run = host.run();
      if (!run?.hasState) return [];
      return run.world.robots.flatMap((robot, i) => robot.present && run.robots[i] ? [{
        name: robot.name,
        pose: run.robots[i].pose,
        drawn: scene.bodies?.drawnPose({kind: 'robot', index: i}) ?? null,
        stalled: run.robots[i].stalled,
        twist: [run.robots[i].twist.vx, run.robots[i].twist.vy, run.robots[i].twist.wz] as [number, number, number],
      }] : []);
    },
    readings: name => {
      const run = host.run();
      const robot = run?.world.robots.findIndex(r => r.present && r.name === name) ?? -1;
      const readings = run?.readings.get(robot);
      if (!readings) return null;
      const sensors: Record<string, number[][]> = {};
      for (const reading of readings.readings) sensors[reading.sensor] = scansOf(reading.content).map(scan => [...scan.ranges]);
      return {tick: readings.tick, sensors};
    },
    contents: name => {
      const run = host.run();
      const robot = run?.world.robots.findIndex(r => r.present && r.name === name) ?? -1;
      const readings = run?.readings.get(robot)?.readings;
      if (!readings) return null;
      const plain = (_: string, value: unknown): unknown => {
        if (value instanceof Uint8Array) return Array.from(value, byte => byte.toString(16).padStart(2, '0')).join('');
        return value instanceof Float64Array ? [...value] : value;
      };
      return Object.fromEntries(
        readings.map(({sensor, tick, content}) => [sensor, {tick, content: JSON.parse(JSON.stringify(content, plain))}]));
    },
    goals: () => (host.run()?.goals ?? []).map(goal => ({
      robot: host.run()!.world.robots[goal.robot].name, to: [...goal.waypoints.slice(-2)], way: goal.way.length / 2,
    })),
    zones: () => scene.zones.shown,
    traffic: () => {
      const world = host.run()?.world;
      if (!world || !scene.traffic.visible) return {ways: [], waits: []};
      return {
        ways: scene.traffic.ways.map(robot => world.robots[robot].name),
        waits: scene.traffic.shownWaits.map(({robot, thing, ring}) => ({
          robot: world.robots[robot].name, thing: world.models[thing].name, ring,
        })),
      };
    },
    vehicleMarks: () => ({base: scene.vehicle.base, horizon: scene.vehicle.horizon}),
    names: () => {
      const world = host.run()?.world;
      return {models: world?.models.map(({name}) => name) ?? [], robots: world?.robots.map(({name}) => name) ?? []};
    },
    lights: () => {
      const run = host.run();
      return Object.fromEntries((run?.world.lights ?? []).map(light => [run!.world.models[light.model].name, run!.isLit(light)]));
    },
    levels: () => ({names: scene.levels.list.map(({name}) => name), choice: scene.levels.choice}),
    select: name => host.select(name),
    events: () => (host.run()?.events ?? []).map(event => ({tick: event.tick, position: event.position, text: eventText(event)})),
    plot: signals => signals.forEach(signal => host.plots().add(signal)),
    csv: () => host.plots().csv(),
    request: (command, more = {}) => connection.request(command, more),
    isIdle: () => connection.isIdle && (host.run()?.edition ?? 0) >= (host.file()?.document?.edition ?? 0),
    file: () => host.file()?.document ?? null,
    edit: (op, more = {}) => connection.edit(op, more),
    ground: () => scene.reach(),
    text: () => host.file()?.text.text ?? null,
    setText: text => host.file()?.text.set(text),
    modelPoint: (view, a, b) => host.file()?.modelPoint(view, a, b) ?? null,
    groundPoint: (x, y) => scene.project(new Vector3(x, y, 0)),
    placeOf: name => {
      const run = host.run();
      const entity = run ? findEntity(run.world, name) : null;
      return entity ? scene.placeOf(entity) : null;
    },
  };
  Object.assign(window, {troupe});
}
