// The panel of the selected robot, object or person: its facts, joints, agent and scans.
//
// It shows what the newest update has. `show` runs again and again, so that texts of elements change and the elements
// themselves stay, with the user's selection and focus.
import {agentText} from './agents';
import {color} from './colors';
import type {AgentInfo} from './connection';
import {byId, fixed, make, setText} from './dom';
import {JointType, OBJECT_MODES, scansOf, type Light, type Pose, type Reading, type RobotGoal} from './protocol';
import {robotState} from './thing_list';
import {compose, degrees, isAway, isInTree, nameOf, poseOf, type Entity, type Run} from './run';
import {bearing, flattestPlane, raysOf} from './sensor_marks';
import {SensorViews} from './sensor_views';

function normalizedDegrees(heading: number): number {
  return degrees(Math.atan2(Math.sin(heading), Math.cos(heading)));
}

export class EntityPanel {
  private readonly panel = byId('panel');
  private readonly head = byId('panel-head');
  private readonly empty = document.querySelectorAll<HTMLElement>('#dock .empty');
  private readonly facts = byId('panel-facts');
  private readonly joints = byId('panel-joints');
  private readonly plot = byId<HTMLCanvasElement>('panel-plot');
  private readonly power = new PowerRows(byId('panel-power'));
  private readonly sensors = new SensorViews(byId('panel-readings'));
  private readonly cells = new Map<string, HTMLElement>();

  // `agent`: of the robot, if it is known.
  show(run: Run, entity: Entity | null, agent: AgentInfo | null): void {
    const pose = entity ? poseOf(run, entity) : null;
    this.panel.hidden = this.head.hidden = !pose;
    for (const note of this.empty) note.hidden = pose !== null;
    if (!entity || !pose) return;
    setText(byId('panel-name'), nameOf(run.world, entity));
    if (entity.kind === 'robot') this.showRobot(run, entity.index, pose, agent);
    else if (entity.kind === 'object') this.showObject(run, entity.index, pose);
    else this.showPerson(run, entity.index, pose);
  }

  // At each update, also between two texts.
  note(run: Run, entity: Entity | null): void {
    if (entity?.kind !== 'robot') return;
    this.sensors.note(run, entity.index);
  }

  private showRobot(run: Run, robot: number, pose: Pose, agent: AgentInfo | null): void {
    const description = run.world.robots[robot];
    const row = run.robots[robot];
    const held = run.held(robot);
    const state = robotState(run, robot, held.length > 0);
    const badge = byId('panel-state');
    badge.className = `badge ${state}`;
    setText(badge, state === 'lost' ? 'no agent' : state);
    const facts: Array<[string, string]> = [
      ...this.poseFacts(pose),
      ['speed', `${fixed(row.twist.vx, 3)} m/s`],
      ...(row.twist.vy !== 0 ? [['sideways', `${fixed(row.twist.vy, 3)} m/s`] as [string, string]] : []),
      ['turning', `${fixed(degrees(row.twist.wz), 1)} °/s`],
      ['controller', description.controller.name],
    ];
    const goal = run.goals.find(each => each.robot === robot);
    if (goal) facts.push(['goal', goalText(goal, pose)]);
    if (agent) facts.push(['agent', agentText(agent)]);
    if (held.length > 0) {
      facts.push(['holds', held.map(i => nameOf(run.world, {kind: 'object', index: i})).join(', ')]);
    }
    this.showFacts(facts);
    this.showJoints(run, robot);
    this.power.show(run, robot);
    this.showScans(run, robot);
    this.sensors.show(run, robot);
  }

  private showScans(run: Run, robot: number): void {
    const readings = run.readings.get(robot)?.readings ?? [];
    const scans = readings.flatMap(({content}) => scansOf(content));
    byId('panel-sensors').hidden = scans.length === 0;
    if (scans.length === 0) return;
    let rays = 0;
    let nearest = Infinity;
    for (const {ranges} of scans) {
      rays += ranges.length;
      for (const range of ranges) nearest = Math.min(nearest, range);
    }
    setText(byId('panel-sensor-text'), `${rays} rays, nearest ${fixed(nearest, 2)} m`);
    drawPolarPlot(this.plot, readings);
  }

  private showObject(run: Run, object: number, pose: Pose): void {
    const row = run.objects[object];
    const mode = OBJECT_MODES[row.mode] ?? '?';
    const badge = byId('panel-state');
    badge.className = `badge ${mode === 'held' ? 'holding' : mode === 'falling' ? 'moving' : 'idle'}`;
    setText(badge, mode);
    const facts = this.poseFacts(pose);
    if (row.holder >= 0) {
      const gripper = run.world.grippers[row.holder];
      facts.push(['held by', `${run.world.robots[gripper.robot].name}, ${gripper.name}`]);
    }
    this.showFactsOnly(facts);
  }

  private showPerson(run: Run, person: number, pose: Pose): void {
    const row = run.people[person];
    if (isAway(pose)) {
      byId('panel-state').className = 'badge idle';
      setText(byId('panel-state'), 'away');
      this.showFactsOnly([['goals', `${row.goalsChosen}`]]);
      return;
    }
    const speed = Math.hypot(row.vx, row.vy);
    const badge = byId('panel-state');
    badge.className = `badge ${speed > 0.05 ? 'moving' : 'idle'}`;
    setText(badge, row.dwellTicks > 0 ? 'waiting' : speed > 0.05 ? 'walking' : 'standing');
    this.showFactsOnly([...this.poseFacts(pose), ['speed', `${fixed(speed, 3)} m/s`], ['goals', `${row.goalsChosen}`]]);
  }

  private showFactsOnly(facts: Array<[string, string]>): void {
    this.showFacts(facts);
    this.joints.replaceChildren();
    byId('panel-sensors').hidden = true;
    this.sensors.clear();
    this.power.clear();
  }

  private poseFacts(pose: Pose): Array<[string, string]> {
    return [
      ['x', `${fixed(pose.x, 3)} m`],
      ['y', `${fixed(pose.y, 3)} m`],
      ['z', `${fixed(pose.z, 3)} m`],
      ['heading', `${fixed(normalizedDegrees(pose.heading), 1)}°`],
    ];
  }

  private showFacts(facts: Array<[string, string]>): void {
    const names = facts.map(([name]) => name);
    if (names.join() !== [...this.cells.keys()].join()) {
      this.cells.clear();
      this.facts.replaceChildren();
      for (const name of names) {
        const cell = make('dd', '');
        this.facts.append(make('dt', '', name), cell);
        this.cells.set(name, cell);
      }
    }
    for (const [name, value] of facts) setText(this.cells.get(name)!, value);
  }

  private showJoints(run: Run, robot: number): void {
    const joints = run.world.joints.map((joint, i) => ({joint, i})).filter(({joint}) => joint.robot === robot);
    if (this.joints.childElementCount !== joints.length) {
      this.joints.replaceChildren(...joints.map(() => {
        const row = make('div', 'joint');
        row.append(make('span', 'joint-name'), make('meter', 'joint-bar'), make('span', 'joint-value'));
        return row;
      }));
    }
    joints.forEach(({joint, i}, n) => {
      const row = this.joints.children[n];
      const [name, bar, value] = [...row.children] as [HTMLElement, HTMLMeterElement, HTMLElement];
      const state = run.joints[i];
      setText(name, joint.name);
      bar.min = 0;
      bar.max = 1;
      const {min, max} = joint.position;
      const share = max > min ? ((state?.position ?? 0) - min) / (max - min) : 0;
      if (Math.abs(bar.value - share) > 1e-4) bar.value = share;
      setText(value, joint.type === JointType.Revolute ? `${fixed(degrees(state?.position ?? 0), 1)}°` : `${fixed(state?.position ?? 0, 3)} m`);
      row.classList.toggle('blocked', state?.blocked ?? false);
    });
  }
}

// The stores of energy and the lights of the selected robot, in its panel.

// The last point of a goal, and its distance along the way.
function goalText(goal: RobotGoal, pose: Pose): string {
  let length = 0;
  let [x, y] = [pose.x, pose.y];
  const way = goal.way.length > 0 ? goal.way : goal.waypoints.slice(-2);
  for (let i = 0; i + 1 < way.length; i += 2) {
    length += Math.hypot(way[i] - x, way[i + 1] - y);
    [x, y] = [way[i], way[i + 1]];
  }
  const [endX, endY] = goal.waypoints.slice(-2);
  return `${fixed(endX, 2)}, ${fixed(endY, 2)} m (${fixed(length, 1)} m)`;
}

// Without the robot's name; `own`: of the robot's root itself.
function partName(run: Run, robot: number, model: number, own: string): string {
  const {name, root} = run.world.robots[robot];
  return model === root ? own : run.world.models[model].name.replace(`${name}.`, '');
}

export function energyText(joules: number): string {
  return joules >= 1000 ? `${fixed(joules / 1000, 2)} kJ` : `${fixed(joules, 1)} J`;
}

function lightText(run: Run, light: Light): string {
  if (!run.isSwitchedOn(light)) return 'switched off';
  const blinks = light.blinkOn > 0 && light.blinkOn < light.blinkPeriod;
  return `${run.isLit(light) ? 'on' : 'dark'}${blinks ? ', blinks' : ''}`;
}

export class PowerRows {
  private key = '';
  private stores: number[] = [];  // indices
  private lights: Light[] = [];

  constructor(private readonly parent: HTMLElement) {}

  show(run: Run, robot: number): void {
    const key = `${run.world.number} ${robot}`;
    if (key !== this.key) this.rebuild(run, robot);
    this.key = key;
    this.stores.forEach((store, i) => this.showStore(run, store, this.parent.children[i]));
    this.lights.forEach((light, i) => {
      const row = this.parent.children[this.stores.length + i];
      const [, dot, value] = [...row.children] as HTMLElement[];
      const color = run.world.models[light.model].color.slice(0, 3).map(c => Math.round(255 * c)).join(' ');
      const background = run.isLit(light) ? `rgb(${color})` : '';
      if (dot.style.backgroundColor !== background) dot.style.backgroundColor = background;
      setText(value, lightText(run, light));
    });
  }

  clear(): void {
    this.key = '';
    this.parent.replaceChildren();
  }

  private rebuild(run: Run, robot: number): void {
    const {root} = run.world.robots[robot];
    const isOf = (model: number): boolean => !run.world.models[model].removed && isInTree(run.world, model, root);
    this.stores = run.world.stores.flatMap(({model}, i) => (isOf(model) ? [i] : []));
    this.lights = run.world.lights.filter(({model}) => isOf(model));
    this.parent.replaceChildren();
    for (const store of this.stores) {
      const row = make('div', 'store');
      const name = partName(run, robot, run.world.stores[store].model, 'energy');
      row.append(make('span', 'joint-name', name), make('meter', 'joint-bar'), make('span', 'joint-value'));
      row.append(make('span', 'store-charge faint'));
      this.parent.append(row);
    }
    for (const {model} of this.lights) {
      const row = make('div', 'light');
      row.append(make('span', 'joint-name', partName(run, robot, model, 'light')), make('span', 'light-dot'), make('span', ''));
      this.parent.append(row);
    }
  }

  private showStore(run: Run, index: number, row: Element): void {
    const {capacity, endless} = run.world.stores[index];
    const {joules, chargeWatts} = run.stores[index] ?? {joules: 0, chargeWatts: 0};
    const [, bar, value, charge] = [...row.children] as [HTMLElement, HTMLMeterElement, HTMLElement, HTMLElement];
    const share = endless ? 1 : capacity > 0 ? joules / capacity : 0;
    bar.low = 0.2;
    if (Math.abs(bar.value - share) > 1e-4) bar.value = share;
    setText(value, endless ? 'endless' : energyText(joules));
    const charging = chargeWatts > 0 ? `charging with ${fixed(chargeWatts, 1)} W` : '';
    const of = endless ? '' : `of ${energyText(capacity)}`;
    setText(charge, [of, charging].filter(text => text !== '').join(', '));
  }
}

// The ranges of a robot's rangers around it, ahead upwards.

export function drawPolarPlot(canvas: HTMLCanvasElement, readings: Reading[]): void {
  const ratio = Math.min(window.devicePixelRatio, 2);
  const size = canvas.clientWidth;
  if (size === 0) return;
  if (canvas.width !== Math.round(size * ratio)) canvas.width = canvas.height = Math.round(size * ratio);
  const context = canvas.getContext('2d')!;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, size, size);
  const scans = readings.flatMap(({content}) => scansOf(content));
  const reach = Math.max(0.1, ...scans.map(scan => scan.limits.max + Math.hypot(scan.pose.x, scan.pose.y)));
  const center = size / 2;
  const scale = (center - 12) / reach;
  const at = (x: number, y: number): [number, number] => [center - y * scale, center - x * scale];

  context.strokeStyle = color('--line');
  context.fillStyle = color('--faint');
  context.font = '12px system-ui, sans-serif';
  context.lineWidth = 1;
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find(s => reach / s <= 5) ?? 100;
  for (let r = step; r <= reach * 1.001; r += step) {
    context.beginPath();
    context.arc(center, center, r * scale, 0, 2 * Math.PI);
    context.stroke();
    context.fillText(`${Number(r.toFixed(2))} m`, center + 3, center - r * scale + 11);
  }
  context.beginPath();
  context.moveTo(center, 4);
  context.lineTo(center, size - 4);
  context.moveTo(4, center);
  context.lineTo(size - 4, center);
  context.stroke();

  const line = color('--rays');
  for (const scan of scans) {
    const outline: Array<[number, number]> = [at(scan.pose.x, scan.pose.y)];
    const hits: Array<[number, number]> = [];
    const count = raysOf(scan);
    const plane = flattestPlane(scan);
    const level = Math.cos(scan.elevations[plane] ?? 0);
    scan.ranges.subarray(plane * count, (plane + 1) * count).forEach((range, i) => {
      const spread = count > 1 ? [0] : [-0.04, 0, 0.04];
      for (const side of spread) {
        const p = compose(
          {...scan.pose, heading: scan.pose.heading + bearing(scan, i) + side}, {x: range * level, y: 0, z: 0, heading: 0});
        outline.push(at(p.x, p.y));
        if (side === 0 && range < scan.limits.max) hits.push(at(p.x, p.y));
      }
    });
    context.beginPath();
    outline.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    context.closePath();
    context.globalAlpha = 0.16;
    context.fillStyle = line;
    context.fill();
    context.globalAlpha = 0.9;
    for (const [x, y] of hits) context.fillRect(x - 1, y - 1, 2, 2);
    context.globalAlpha = 1;
  }
  context.fillStyle = color('--text');
  context.beginPath();
  context.moveTo(...at(9 / scale, 0));
  context.lineTo(...at(-6 / scale, 5 / scale));
  context.lineTo(...at(-6 / scale, -5 / scale));
  context.fill();
}
