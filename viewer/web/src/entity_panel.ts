// The panel of the selected robot or object.
import {agentText} from './agents';
import type {AgentInfo} from './connection';
import {byId, fixed, make, setText} from './dom';
import {drawPolarPlot} from './polar_plot';
import {degrees} from './pose';
import {OBJECT_MODES, scansOf, type Pose} from './protocol';
import {PowerRows} from './power_rows';
import {robotState} from './robot_list';
import {SensorViews} from './sensor_views';
import {SpeedPlot} from './speed_plot';
import {nameOf, poseOf, type Entity, type Run} from './run';

function normalizedDegrees(heading: number): number {
  return degrees(Math.atan2(Math.sin(heading), Math.cos(heading)));
}

export class EntityPanel {
  private readonly panel = byId('panel');
  private readonly facts = byId('panel-facts');
  private readonly joints = byId('panel-joints');
  private readonly plot = byId<HTMLCanvasElement>('panel-plot');
  private readonly speedCanvas = byId<HTMLCanvasElement>('panel-speed');
  private readonly speeds = new SpeedPlot(this.speedCanvas);
  private readonly power = new PowerRows(byId('panel-power'));
  private readonly sensors = new SensorViews(byId('panel-readings'));
  private readonly cells = new Map<string, HTMLElement>();

  // `agent`: of the robot, if it is known.
  show(run: Run, entity: Entity | null, agent: AgentInfo | null): void {
    const pose = entity ? poseOf(run, entity) : null;
    this.panel.hidden = !pose;
    if (!entity || !pose) return;
    setText(byId('panel-name'), nameOf(run.world, entity));
    if (entity.kind === 'robot') this.showRobot(run, entity.index, pose, agent);
    else this.showObject(run, entity.index, pose);
  }

  // At each update, also between two texts.
  note(run: Run, entity: Entity | null): void {
    if (entity?.kind !== 'robot') return;
    this.speeds.add(run, entity.index);
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
      ['controller', description.controller],
    ];
    if (agent) facts.push(['agent', agentText(agent)]);
    if (held.length > 0) {
      facts.push(['holds', held.map(i => nameOf(run.world, {kind: 'object', index: i})).join(', ')]);
    }
    this.showFacts(facts);
    this.showJoints(run, robot);
    this.power.show(run, robot);
    this.speedCanvas.hidden = false;
    this.speeds.draw();
    this.showScans(run, robot);
    this.sensors.show(run, robot);
  }

  private showScans(run: Run, robot: number): void {
    const readings = run.readings.get(robot)?.readings ?? [];
    const scans = readings.flatMap(scansOf);
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
    this.showFacts(facts);
    this.joints.replaceChildren();
    this.speedCanvas.hidden = true;
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
      const share = joint.max > joint.min ? ((state?.position ?? 0) - joint.min) / (joint.max - joint.min) : 0;
      if (Math.abs(bar.value - share) > 1e-4) bar.value = share;
      setText(value, joint.revolute ? `${fixed(degrees(state?.position ?? 0), 1)}°` : `${fixed(state?.position ?? 0, 3)} m`);
      row.classList.toggle('blocked', state?.blocked ?? false);
    });
  }
}
