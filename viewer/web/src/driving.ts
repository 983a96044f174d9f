// Driving: moves the selected robot by keys, a gamepad or the pad on the page, and commands its grippers. While it is
// on, the robot stands still unless it is driven; each command is valid for a short time only, so that a robot stops
// when the page is gone, and its controller continues. A robot whose controller accepts no goals is driven to a point
// in a straight line, and stands there until it is released.
//
// Each command waits for its reply before the next is sent: a slow run gets fewer commands, not a queue of old ones.
// Commands are counted in ticks, so their time is converted by the measured speed of the run.
import type {Connection} from './connection';
import {allow, byId, labelOf, make, setOn, setText, toast} from './dom';
import {DriveType} from './protocol';
import {nameOf, type Run} from './run';

const PERIOD = 100;  // ms from one command to the next
const VALID = 0.5;  // s of wall time that a command is valid for
const UNBOUNDED = 1e3;  // m/s and more: the world file states no bound
const TYPICAL_SPEED = 1.0;  // m/s, of a robot whose drive has no bounds
const TYPICAL_TURN = 1.5;  // rad/s, at most
const ARRIVED = 0.1;  // m from the point of a drive to a point
const AHEAD = 0.5;  // rad: a point in this direction is driven to, another one turned to
const SLOW_DOWN = 0.6;  // m before the point
const PATIENCE = 40;  // commands without a motion
const DEAD_ZONE = 0.12;  // of a gamepad's sticks

// Forward, left and turn, each from -1 to 1.
type Stick = [number, number, number];

const KEYS: Record<string, Stick> = {
  w: [1, 0, 0], ArrowUp: [1, 0, 0], s: [-1, 0, 0], ArrowDown: [-1, 0, 0], a: [0, 0, 1], ArrowLeft: [0, 0, 1],
  d: [0, 0, -1], ArrowRight: [0, 0, -1], q: [0, 1, 0], e: [0, -1, 0],
};

export interface DrivingHost {
  run(): Run | null;
  robot(): number;  // selected; -1: none
}

export class Driving {
  private on = false;
  private viewOnly = false;
  private readonly pressed = new Set<string>();
  private pad: [number, number] | null = null;  // forward and turn by the pad of the page
  private share = 0.5;  // of the robot's speed
  private point: [number, number] | null = null;  // to drive to
  private waited = 0;  // commands on the way to the point without a motion
  private readonly knob = byId('drive-knob');

  constructor(private readonly connection: Connection, private readonly host: DrivingHost) {
    byId('drive').onclick = () => this.set(!this.on);
    const pad = byId('drive-pad');
    pad.onpointerdown = event => {
      pad.setPointerCapture(event.pointerId);
      this.movePad(pad, event);
    };
    pad.onpointermove = event => {
      if (pad.hasPointerCapture(event.pointerId)) this.movePad(pad, event);
    };
    pad.onpointerup = pad.onpointercancel = () => this.movePad(pad, null);
    byId<HTMLInputElement>('drive-share').oninput = event => {
      this.share = Number((event.target as HTMLInputElement).value) / 100;
    };
    window.addEventListener('blur', () => this.pressed.clear());
    window.addEventListener('keyup', event => this.pressed.delete(keyOf(event)));
  }

  get isOn(): boolean {
    return this.on;
  }

  setViewOnly(viewOnly: boolean): void {
    this.viewOnly = viewOnly;
    if (viewOnly) this.set(false);
  }

  set(on: boolean): void {
    const now = on && !this.viewOnly && this.host.robot() >= 0;
    if (on && this.host.robot() < 0) toast('Select a robot to drive');
    setOn('drive', now);
    setText(labelOf('drive'), now ? 'Release' : 'Drive');
    this.point = null;
    byId('drive-box').hidden = !now;
    if (now === this.on) return;
    this.on = now;
    this.pressed.clear();
    if (now) void this.drive();
  }

  // Drives the selected robot to a point of the world.
  driveTo(point: [number, number]): void {
    this.set(true);
    this.waited = 0;
    if (this.on) this.point = point;
  }

  // True if the key drives.
  press(event: KeyboardEvent): boolean {
    const key = keyOf(event);
    if (!this.on || !(key in KEYS)) return false;
    this.pressed.add(key);
    this.point = null;
    return true;
  }

  private movePad(pad: HTMLElement, event: PointerEvent | null): void {
    this.pad = null;
    if (event) {
      this.point = null;
      const box = pad.getBoundingClientRect();
      const limit = (value: number): number => Math.max(-1, Math.min(1, value));
      this.pad = [
        limit(1 - (2 * (event.clientY - box.top)) / box.height), limit(1 - (2 * (event.clientX - box.left)) / box.width),
      ];
    }
    const [forward, turn] = this.pad ?? [0, 0];
    this.knob.style.transform = `translate(${-34 * turn}px, ${-34 * forward}px)`;
  }

  private stick(): Stick {
    const sum: Stick = [0, 0, 0];
    const add = (stick: Stick): void => stick.forEach((value, i) => { sum[i] += value; });
    for (const key of this.pressed) add(KEYS[key]);
    if (this.pad) add([this.pad[0], 0, this.pad[1]]);
    const gamepad = navigator.getGamepads?.().find(device => device?.connected);
    if (gamepad) {
      const axis = (i: number): number => (Math.abs(gamepad.axes[i] ?? 0) > DEAD_ZONE ? -gamepad.axes[i] : 0);
      add([axis(1), axis(0), axis(2)]);
    }
    return sum.map(value => Math.max(-1, Math.min(1, value))) as Stick;
  }

  // Towards the point, from where the robot is.
  private towardsPoint(run: Run, index: number): Stick {
    const {pose, twist} = run.robots[index];
    const [x, y] = [this.point![0] - pose.x, this.point![1] - pose.y];
    const distance = Math.hypot(x, y);
    this.waited = twist.vx === 0 && twist.vy === 0 && twist.wz === 0 ? this.waited + 1 : 0;
    if (distance < ARRIVED || this.waited > PATIENCE) {
      const {name} = run.world.robots[index];
      toast(distance < ARRIVED ? `${name} is at the point: "Release" lets its controller continue`
        : `${name} does not get to the point: something is in its way`, distance >= ARRIVED);
      this.point = null;
      return [0, 0, 0];
    }
    const turn = Math.atan2(y, x) - pose.heading;
    const error = Math.atan2(Math.sin(turn), Math.cos(turn));
    const forward = Math.abs(error) < AHEAD ? Math.min(1, distance / SLOW_DOWN) : 0;
    return [forward, 0, Math.max(-1, Math.min(1, 1.5 * error))];
  }

  // For so many ticks a command is valid.
  private ticks(run: Run): number {
    const factor = run.status && run.status.real_time_factor > 0 ? run.status.real_time_factor : 1;
    return Math.max(2, Math.min(100_000, Math.ceil((VALID * factor) / run.world.interval)));
  }

  private async drive(): Promise<void> {
    while (this.on) {
      const run = this.host.run();
      const index = this.host.robot();
      if (!run || index < 0 || run.over) return this.set(false);
      const robot = run.world.robots[index];
      const speed = this.share * (robot.maxSpeed < UNBOUNDED ? robot.maxSpeed : TYPICAL_SPEED);
      const turn = this.share * Math.min(robot.maxTurn, TYPICAL_TURN);
      const [forward, left, rotation] = this.point ? this.towardsPoint(run, index) : this.stick();
      const twist = [forward * speed, robot.drive.type === DriveType.Omni ? left * speed : 0, rotation * turn];
      const reply = await this.connection.request('command_robot', {name: robot.name, ticks: this.ticks(run), twist});
      if (!reply.done) {
        toast(reply.problem, true);
        return this.set(false);
      }
      await new Promise(resolve => setTimeout(resolve, PERIOD));
    }
  }
}

function keyOf(event: KeyboardEvent): string {
  return event.key.length === 1 ? event.key.toLowerCase() : event.key;
}

// The buttons of the selected robot's grippers.
export class GripperButtons {
  private readonly box = byId('panel-grippers');
  private buttons: HTMLElement[] = [];
  private shown = '';
  private viewOnly = false;

  constructor(private readonly connection: Connection) {}

  setViewOnly(viewOnly: boolean): void {
    this.viewOnly = viewOnly;
    this.shown = '';
  }

  show(run: Run, robot: number): void {
    const grippers = this.viewOnly ? [] : run.world.grippers.filter(gripper => gripper.robot === robot);
    const key = `${run.world.number} ${robot} ${grippers.length}`;
    if (key === this.shown) return;
    this.shown = key;
    const name = robot >= 0 ? nameOf(run.world, {kind: 'robot', index: robot}) : '';
    this.buttons = [];
    this.box.replaceChildren(...grippers.map((gripper, number) => {
      const row = make('div', 'gripper');
      const send = (order: object): void => void this.send(name, {gripper: number, ...order});
      const button = (text: string, order: object): void => {
        const element = make('button', 'small', text);
        element.onclick = () => send(order);
        row.append(element);
        this.buttons.push(element);
      };
      row.append(make('span', 'faint', gripper.name));
      button('Open', {opening: 100});
      button('Close', {opening: 0});
      if (gripper.lift >= 0) {
        button('Lower', {lift: 0});
        button('Lift', {lift: 100});
      }
      return row;
    }));
  }

  // Why they cannot be used now; empty: they can.
  refuse(refusal: string): void {
    for (const button of this.buttons) allow(button, refusal);
  }

  private async send(name: string, order: object): Promise<void> {
    const reply = await this.connection.request('command_robot', {name, ticks: 1, grippers: [order]});
    if (!reply.done) toast(reply.problem, true);
  }
}
