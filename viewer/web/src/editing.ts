// Editing by mouse: drags entities to other poses, adds models of the world file, deletes the selected entity. The run
// decides; it refuses a pose in a wall, and says why.
import type {Connection} from './connection';
import {byId, make, toast} from './dom';
import type {Pose} from './protocol';
import {nameOf, poseOf, type Entity, type Run} from './run';
import type {WorldScene} from './scene';

interface Drag {
  entity: Entity;
  name: string;
  start: Pose;
  offset: {x: number; y: number};  // from the pointer to the entity
  pose: Pose;
  turning: boolean;
}

const CLICK_DISTANCE = 5;  // px: a pointer that moves less has clicked

export interface EditingHost {
  run(): Run | null;
  selected(): Entity | null;
  select(entity: Entity | null): void;
}

export class Editing {
  private moving = false;  // the tool for dragging is on
  private adding = '';  // the model that the next click adds
  private drag: Drag | null = null;
  private pressed: {x: number; y: number} | null = null;
  private readonly menu = byId('add-menu');
  private readonly hint = byId('hint');

  constructor(
      private readonly scene: WorldScene, private readonly connection: Connection, private readonly host: EditingHost) {
    const canvas = scene.canvas;
    // Before the controls of the camera, which would turn it.
    canvas.addEventListener('pointerdown', event => this.onDown(event), {capture: true});
    window.addEventListener('pointermove', event => this.onMove(event));
    window.addEventListener('pointerup', event => this.onUp(event));
    byId('move').onclick = () => this.setMoving(!this.moving);
    byId('add').onclick = () => void this.toggleMenu();
    byId('delete').onclick = () => void this.deleteSelected();
  }

  setViewOnly(viewOnly: boolean): void {
    for (const id of ['move', 'add', 'delete']) byId(id).hidden = viewOnly;
    if (viewOnly) this.cancel();
  }

  setMoving(moving: boolean): void {
    this.moving = moving;
    byId('move').classList.toggle('on', moving);
    this.showHint(moving ? 'Drag a robot or an object; with Shift: turn it. Escape ends this.' : '');
  }

  cancel(): void {
    this.drag = null;
    this.adding = '';
    this.menu.hidden = true;
    this.scene.showGhost(null, 0);
    this.scene.setControlsEnabled(true);
    this.setMoving(false);
  }

  async deleteSelected(): Promise<void> {
    const run = this.host.run();
    const entity = this.host.selected();
    if (!run || !entity) return;
    const name = nameOf(run.world, entity);
    const reply = await this.connection.request('delete', {name});
    toast(reply.done ? `${name} is deleted` : reply.problem, !reply.done);
    if (reply.done) this.host.select(null);
  }

  async setPose(name: string, pose: Pose): Promise<boolean> {
    const reply = await this.connection.request('set_pose', {name, pose: [pose.x, pose.y, pose.z, pose.heading]});
    if (!reply.done) toast(reply.problem, true);
    return reply.done;
  }

  private showHint(text: string): void {
    this.hint.hidden = text === '';
    this.hint.textContent = text;
  }

  private onDown(event: PointerEvent): void {
    if (event.button !== 0) return;
    this.pressed = {x: event.clientX, y: event.clientY};
    const run = this.host.run();
    if (!this.moving || !run) return;
    const entity = this.scene.pick(event.clientX, event.clientY);
    const start = entity ? poseOf(run, entity) : null;
    if (!entity || !start) return;
    const at = this.scene.pointAt(event.clientX, event.clientY, start.z);
    if (!at) return;
    event.stopImmediatePropagation();
    this.scene.setControlsEnabled(false);
    this.host.select(entity);
    this.drag = {
      entity, name: nameOf(run.world, entity), start, offset: {x: start.x - at.x, y: start.y - at.y}, pose: start,
      turning: event.shiftKey,
    };
  }

  private onMove(event: PointerEvent): void {
    if (!this.drag) return;
    const {start, offset} = this.drag;
    const at = this.scene.pointAt(event.clientX, event.clientY, start.z);
    if (!at) return;
    this.drag.pose = this.drag.turning
      ? {...start, heading: Math.atan2(at.y - start.y, at.x - start.x)}
      : {...start, x: at.x + offset.x, y: at.y + offset.y};
    this.scene.showGhost(this.drag.pose, this.scene.bodies?.radiusOf(this.drag.entity) ?? 0.3);
  }

  private onUp(event: PointerEvent): void {
    const pressed = this.pressed;
    this.pressed = null;
    const drag = this.drag;
    if (drag) {
      this.drag = null;
      this.scene.setControlsEnabled(true);
      if (drag.pose === drag.start) {
        this.scene.showGhost(null, 0);
        return;
      }
      void this.setPose(drag.name, drag.pose).then(() => this.scene.showGhost(null, 0));
      return;
    }
    if (!pressed || Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > CLICK_DISTANCE) return;
    if (event.target !== this.scene.canvas) return;
    if (this.adding) void this.spawnAt(event.clientX, event.clientY);
    else this.host.select(this.scene.pick(event.clientX, event.clientY));
  }

  private async toggleMenu(): Promise<void> {
    if (!this.menu.hidden) {
      this.menu.hidden = true;
      return;
    }
    const reply = await this.connection.request('spawnables');
    if (!reply.done) {
      toast(reply.problem, true);
      return;
    }
    const models = reply.entities ?? [];
    this.menu.replaceChildren(...models.map(({name, type}) => {
      const row = make('button', 'menu-row', name);
      row.append(make('span', 'menu-type', type));
      row.onclick = () => {
        this.menu.hidden = true;
        this.adding = name;
        this.showHint(`Click where ${name} is to be put. Escape ends this.`);
      };
      return row;
    }));
    if (models.length === 0) this.menu.append(make('div', 'more', 'the world file defines no models'));
    this.menu.hidden = false;
  }

  private async spawnAt(clientX: number, clientY: number): Promise<void> {
    const at = this.scene.pointAt(clientX, clientY, 0);
    const source = this.adding;
    this.cancel();
    if (!at) return;
    const reply = await this.connection.request('spawn', {source, pose: [at.x, at.y, 0, 0]});
    toast(reply.done ? `${reply.entities?.[0]?.name ?? source} is added` : reply.problem, !reply.done);
  }
}
