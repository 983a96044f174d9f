// Editing by mouse, touch or keys: moves entities to other poses, adds models of the world file, deletes and renames
// the selected entity, and sends robots to points. The run decides; it refuses a pose in a wall, and says why.
//
// What is dragged is shown as a ghost until the run has answered, and the entity itself stays where it is: the picture
// always shows states of the run. Undo and redo are further requests with the opposite effect, kept by name, because
// ids change with editions; a file in editing has a history of its own (setFile).
import {BUILT_IN_CONTROLLERS} from '../generated/rows';
import type {Connection} from './connection';
import {byId, make, setOn, toast} from './dom';
import {Popup} from './toolbar';
import {Measuring} from './drawing';
import type {Pose} from './protocol';
import {findEntity, nameOf, poseOf, type Entity, type Run} from './run';
import type {WorldScene} from './scene';
import {RubberBand} from './selection';

type Tool = 'none' | 'move' | 'add' | 'send' | 'measure';

// Another entity that is dragged with the one below the pointer.
interface Companion {
  entity: Entity;
  name: string;
  start: Pose;
}

interface Drag {
  entity: Entity;
  name: string;
  start: Pose;
  others: Companion[];
  offset: {x: number; y: number};  // from the pointer to the entity
  pose: Pose;
  turning: boolean;
  byKeys: boolean;
}

// On the window, px.
interface Place {
  x: number;
  y: number;
}

const CLICK_DISTANCE = 5;  // px: a pointer that moves less has clicked
const GOAL_TICKS = 1_000_000;  // for which a goal is in force
const TURN = Math.PI / 12;  // of a model before it is put down, by a key
const NUDGE = 0.1;  // m, by an arrow key; with Shift a tenth of that
const AIM = 40;  // px, of the place of a tool by an arrow key; with Shift a tenth of that

const ARROWS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
};

const HINTS: Record<Tool, string> = {
  none: '',
  move: 'Drag a robot or an object; with Shift: turn it. Or arrows, [ and ], Enter for the selected one.',
  add: 'Click where it is to be put, with Shift to put several; [ and ] turn it. Or arrows, Enter.',
  send: 'Click where the robot is to go. Or arrows, Enter.',
  measure: 'Click two points to measure their distance. Or arrows, Enter.',
};

export interface EditingHost {
  run(): Run | null;
  selected(): Entity | null;
  select(entity: Entity | null): void;
  selectNamed(name: string): void;  // as soon as the world has it
  driveTo(point: [number, number]): void;  // the selected robot
}

export interface NamedPose {
  name: string;
  pose: Pose;
}

// The edits of a file, in place of edits of a run.
export interface FileEdits {
  undo(): Promise<void>;
  redo(): Promise<void>;
  rename(before: string, after: string): Promise<void>;
  deleteSelected(): Promise<void>;
  // The name of the entry that makes what is called `name`: a door, of its leaf.
  ownerOf(name: string): string;
  selection(): readonly string[];
  selectOnly(name: string): void;  // '': nothing
  toggle(name: string): void;
  selectInside(rect: DOMRect): void;
  // Poses beside what is near, of an entity and of a new model.
  beside(name: string, pose: Pose): Pose;
  besideNew(model: string, pose: Pose): Pose;
  move(poses: NamedPose[]): Promise<boolean>;
  // The file has been edited by a request for the run.
  changed(): void;
}

export class Editing {
  private file: FileEdits | null = null;
  private tool: Tool = 'none';
  private adding = {name: '', type: '', heading: 0};
  private controller = '';  // of robots that are added; empty: as their model says
  private drag: Drag | null = null;
  private pressed: Place | null = null;
  private aim: Place | null = null;  // of a tool
  private readonly menu = byId('add-menu');
  private readonly popup = new Popup(byId('add'), this.menu);
  private readonly hint = byId('hint');
  private readonly band = new RubberBand();
  private readonly history: EditHistory;
  private readonly measuring: Measuring;

  constructor(
      private readonly scene: WorldScene, private readonly connection: Connection, private readonly host: EditingHost) {
    this.measuring = new Measuring(scene);
    this.history = new EditHistory((canUndo, canRedo) => {
      byId<HTMLButtonElement>('undo').disabled = !canUndo;
      byId<HTMLButtonElement>('redo').disabled = !canRedo;
    });
    const canvas = scene.canvas;
    // Before the controls of the camera, which would turn it.
    canvas.addEventListener('pointerdown', event => this.onDown(event), {capture: true});
    window.addEventListener('pointermove', event => this.onMove(event));
    window.addEventListener('pointerup', event => this.onUp(event));
    byId('move').onclick = () => this.toggle('move');
    byId('measure').onclick = () => this.toggle('measure');
    byId('send').onclick = () => this.toggle('send');
    byId('add').onclick = () => void this.toggleMenu();
    byId('delete').onclick = () => void this.deleteSelected();
    byId('undo').onclick = () => void this.undo();
    byId('redo').onclick = () => void this.redo();
    byId('panel-name').ondblclick = () => void this.renameSelected();
  }

  setViewOnly(viewOnly: boolean): void {
    if (viewOnly && this.tool !== 'measure') this.cancel();
  }

  toggle(tool: Tool): void {
    const next = this.tool === tool ? 'none' : tool;
    this.cancel();
    if (next === 'send' && this.host.selected()?.kind !== 'robot') {
      toast('Select a robot to send');
      return;
    }
    this.tool = next;
    for (const id of ['move', 'measure', 'send'] as const) setOn(id, next === id);
    this.hint.hidden = next === 'none';
    this.hint.textContent = HINTS[next];
    this.scene.canvas.classList.toggle('aiming', next !== 'none' && next !== 'move');
    if (next !== 'none') byId('scene').focus({preventScroll: true});
  }

  cancel(): void {
    this.tool = 'none';
    this.drag = this.aim = null;
    this.popup.set(false);
    this.hint.hidden = true;
    this.measuring.clear();
    this.hideDrag();
    this.scene.setControlsEnabled(true);
    this.scene.canvas.classList.remove('aiming');
    for (const id of ['move', 'measure', 'send']) setOn(id, false);
  }

  // True if the key belongs to the editing.
  press(event: KeyboardEvent): boolean {
    if (this.tool !== 'none' && !event.ctrlKey && !event.metaKey && this.pressInTool(event)) return true;
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || (key !== 'z' && key !== 'y')) return false;
    void (key === 'y' || event.shiftKey ? this.redo() : this.undo());
    return true;
  }

  // The place of a tool by arrows, its angle by brackets, and Enter in place of a click.
  private pressInTool(event: KeyboardEvent): boolean {
    const [x, y] = ARROWS[event.key] ?? [0, 0];
    const turn = event.key === '[' ? TURN : event.key === ']' ? -TURN : 0;
    const isArrow = x !== 0 || y !== 0;
    if (!isArrow && turn === 0 && event.key !== 'Enter') return false;
    const fine = event.shiftKey ? 0.1 : 1;
    if (this.tool === 'move') {
      if (event.key === 'Enter') {
        if (this.drag?.byKeys) this.drop(this.drag);
      } else {
        this.nudge(fine * NUDGE * x, fine * NUDGE * y, turn);
      }
      return true;
    }
    const box = this.scene.canvas.getBoundingClientRect();
    const selected = this.host.selected();
    const at = this.aim ?? (selected && this.tool === 'send' ? this.scene.placeOf(selected) : null)
      ?? {x: box.left + box.width / 2, y: box.top + box.height / 2};
    this.aim = {
      x: Math.max(box.left, Math.min(box.right - 1, at.x + fine * AIM * x)),
      y: Math.max(box.top, Math.min(box.bottom - 1, at.y - fine * AIM * y)),
    };
    this.adding.heading += turn;
    this.pointAt(this.aim);
    if (event.key === 'Enter') this.click(this.aim, event.shiftKey);
    return true;
  }

  // Moves the selected entity before it is put down by Enter.
  private nudge(x: number, y: number, turn: number): void {
    const run = this.host.run();
    const entity = this.host.selected();
    const start = run && entity ? poseOf(run, entity) : null;
    if (!run || !entity || !start) return toast('Select the robot or the object to move', true);
    if (!this.drag?.byKeys) {
      const name = nameOf(run.world, entity);
      this.drag = {
        entity, name, start, others: this.companionsOf(run, name), offset: {x: 0, y: 0}, pose: start, turning: false, byKeys: true,
      };
    }
    const {pose} = this.drag;
    this.drag.pose = {...pose, x: pose.x + x, y: pose.y + y, heading: pose.heading + turn};
    this.showDrag(this.drag);
  }

  // The other selected entities, if this one is among them.
  private companionsOf(run: Run, name: string): Companion[] {
    const names = this.file?.selection() ?? [];
    if (!names.includes(name)) return [];
    return names.filter(each => each !== name).flatMap(each => {
      const entity = findEntity(run.world, each);
      const start = entity ? poseOf(run, entity) : null;
      return entity && start ? [{entity, name: each, start}] : [];
    });
  }

  // Where the companions of a drag would be: they move with the entity, and turn about it.
  private companionPoses({start, pose, others}: Drag): NamedPose[] {
    const turn = pose.heading - start.heading;
    const [c, s] = [Math.cos(turn), Math.sin(turn)];
    return others.map(({name, start: own}) => {
      const [x, y] = [own.x - start.x, own.y - start.y];
      return {name, pose: {...own, x: pose.x + c * x - s * y, y: pose.y + s * x + c * y, heading: own.heading + turn}};
    });
  }

  private showDrag(drag: Drag): void {
    const radiusOf = (entity: Entity): number => this.scene.bodies?.radiusOf(entity) ?? 0.3;
    this.scene.showGhost(drag.pose, radiusOf(drag.entity));
    this.scene.showGhostRings(this.companionPoses(drag).map(({pose}, i) => ({pose, radius: radiusOf(drag.others[i].entity)})));
  }

  private hideDrag(): void {
    this.scene.showGhost(null, 0);
    this.scene.showGhostRings([]);
  }

  // The names of what is dragged.
  get dragged(): string[] {
    return this.drag ? [this.drag.name, ...this.drag.others.map(({name}) => name)] : [];
  }

  // What is at a place of the window; a part of an entry of a file is that entry.
  private pick(run: Run, x: number, y: number): Entity | null {
    const entity = this.scene.pick(x, y);
    if (!entity || !this.file) return entity;
    return findEntity(run.world, this.file.ownerOf(nameOf(run.world, entity))) ?? entity;
  }

  forget(): void {
    this.history.clear();
  }

  // From now on the edits are those of a file, which has its own history and renames by itself.
  setFile(file: FileEdits): void {
    this.file = file;
    this.history.off = true;
  }

  startAdding(name: string, type: string): void {
    if (this.tool === 'add') this.cancel();
    this.toggle('add');
    this.adding = {name, type, heading: 0};
  }

  private undo(): Promise<void> {
    return this.file ? this.file.undo() : this.history.undo();
  }
  private redo(): Promise<void> {
    return this.file ? this.file.redo() : this.history.redo();
  }

  async deleteSelected(): Promise<void> {
    if (this.file) return this.file.deleteSelected();
    const run = this.host.run();
    const entity = this.host.selected();
    const pose = run && entity ? poseOf(run, entity) : null;
    if (!run || !entity || !pose) return;
    const name = nameOf(run.world, entity);
    if (!await this.remove(name)) return;
    toast(`${name} is deleted`);
    this.host.select(null);
    this.history.add({
      text: `the deletion of ${name}`, undo: () => this.restore(name, name, pose), redo: () => this.remove(name),
    });
  }

  // A robot's controller starts again under the new name: renaming is a deletion and a restoration, because names are
  // keys of the protocol.
  async renameSelected(): Promise<void> {
    const run = this.host.run();
    const entity = this.host.selected();
    if (!run || !entity) return;
    const before = nameOf(run.world, entity);
    const note = this.file ? '' : " A robot's controller starts anew.";
    const after = window.prompt(`New name of ${before}.${note}`, before)?.trim();
    if (!after || after === before) return;
    if (this.file) return this.file.rename(before, after);
    if (!await this.rename(before, after)) return;
    this.history.add({
      text: `the new name of ${before}`, undo: () => this.rename(after, before), redo: () => this.rename(before, after),
    });
  }

  async setPose(name: string, pose: Pose): Promise<boolean> {
    return this.edit('set_pose', {name, pose: numbers(pose)});
  }

  private remove(name: string): Promise<boolean> {
    return this.edit('delete', {name});
  }
  private restore(source: string, name: string, pose: Pose): Promise<boolean> {
    return this.edit('restore', {source, name, pose: numbers(pose)});
  }

  private async rename(before: string, after: string): Promise<boolean> {
    const run = this.host.run();
    const entity = run ? this.entityCalled(run, before) : null;
    const pose = run && entity ? poseOf(run, entity) : null;
    if (!pose) {
      toast(`the world has no ${before} any more`, true);
      return false;
    }
    if (!await this.remove(before)) return false;
    if (await this.restore(before, after, pose)) return true;
    await this.restore(before, before, pose);
    return false;
  }

  private entityCalled(run: Run, name: string): Entity | null {
    const selected = this.host.selected();
    if (selected && nameOf(run.world, selected) === name) return selected;
    const robot = run.world.robots.findIndex(r => r.present && r.name === name);
    if (robot >= 0) return {kind: 'robot', index: robot};
    const object = run.world.objects.findIndex(o => !run.world.models[o].removed && run.world.models[o].name === name);
    return object >= 0 ? {kind: 'object', index: object} : null;
  }

  private async edit(command: string, more: object): Promise<boolean> {
    const reply = await this.connection.request(command, more);
    if (!reply.done) toast(reply.problem, true);
    this.file?.changed();
    return reply.done;
  }

  private onDown(event: PointerEvent): void {
    if (event.button !== 0) return;
    this.pressed = {x: event.clientX, y: event.clientY};
    const run = this.host.run();
    const entity = this.tool === 'move' && run ? this.pick(run, event.clientX, event.clientY) : null;
    if (this.file && event.shiftKey && !entity && (this.tool === 'none' || this.tool === 'move')) {
      event.stopImmediatePropagation();
      this.scene.setControlsEnabled(false);
      this.band.begin(event);
      return;
    }
    if (this.tool !== 'move' || !run) return;
    const start = entity ? poseOf(run, entity) : null;
    if (!entity || !start) return;
    const at = this.scene.pointAt(event.clientX, event.clientY, start.z);
    if (!at) return;
    event.stopImmediatePropagation();
    this.scene.setControlsEnabled(false);
    const name = nameOf(run.world, entity);
    const others = this.companionsOf(run, name);
    if (others.length === 0 && !event.shiftKey) this.host.select(entity);
    this.drag = {
      entity, name, start, others, offset: {x: start.x - at.x, y: start.y - at.y}, pose: start,
      turning: event.shiftKey, byKeys: false,
    };
  }

  private onMove(event: PointerEvent): void {
    if (event.target === this.scene.canvas) this.aim = {x: event.clientX, y: event.clientY};
    if (this.band.isOpen) return this.band.move(event);
    if (this.aim) this.pointAt(this.aim);
    if (!this.drag || this.drag.byKeys) return;
    const {start, offset} = this.drag;
    const at = this.scene.pointAt(event.clientX, event.clientY, start.z);
    if (!at) return;
    this.drag.pose = this.drag.turning
      ? {...start, heading: Math.atan2(at.y - start.y, at.x - start.x)}
      : {...start, x: at.x + offset.x, y: at.y + offset.y};
    if (this.file && !this.drag.turning) this.drag.pose = this.file.beside(this.drag.name, this.drag.pose);
    this.showDrag(this.drag);
  }

  // Shows what a click at a place of the window would do.
  private pointAt(place: Place): void {
    if (this.tool === 'add' || this.tool === 'send') this.preview(place);
    if (this.tool === 'measure') this.measuring.move(place.x, place.y);
  }

  private click({x, y}: Place, repeat: boolean): void {
    if (this.tool === 'add') void this.spawnAt(x, y, repeat);
    else if (this.tool === 'send') void this.sendTo(x, y);
    else if (this.tool === 'measure') this.measuring.click(x, y);
    else {
      const run = this.host.run();
      const entity = run ? this.pick(run, x, y) : null;
      this.host.select(entity);
      this.file?.selectOnly(run && entity ? nameOf(run.world, entity) : '');
    }
  }

  // Of a click with Shift, or of a rectangle that has been dragged.
  private endBand(event: PointerEvent, pressed: Place | null): void {
    const rect = this.band.end(event);
    this.scene.setControlsEnabled(true);
    const run = this.host.run();
    if (!run || !this.file) return;
    if (pressed && Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > CLICK_DISTANCE) return this.file.selectInside(rect);
    const entity = this.pick(run, event.clientX, event.clientY);
    if (entity) this.file.toggle(nameOf(run.world, entity));
  }

  private onUp(event: PointerEvent): void {
    const pressed = this.pressed;
    this.pressed = null;
    if (this.band.isOpen) return this.endBand(event, pressed);
    if (this.drag && !this.drag.byKeys) return this.drop(this.drag, event.shiftKey);
    if (!pressed || Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > CLICK_DISTANCE) return;
    if (event.target !== this.scene.canvas) return;
    this.click({x: event.clientX, y: event.clientY}, event.shiftKey);
  }

  // `toggles`: what has not moved is selected with others, or no more.
  private drop(drag: Drag, toggles = false): void {
    this.drag = null;
    this.scene.setControlsEnabled(true);
    const {name, start, pose} = drag;
    if (pose === start) {
      this.hideDrag();
      if (toggles && drag.turning && this.file) this.file.toggle(name);
      return;
    }
    if (drag.others.length === 0) this.host.select(drag.entity);
    const companions = this.companionPoses(drag);
    if (this.file && companions.length > 0) {
      void this.file.move([{name, pose}, ...companions]).then(() => this.hideDrag());
      return;
    }
    void this.setPose(name, pose).then(done => {
      this.hideDrag();
      if (!done) return;
      this.history.add({
        text: `the move of ${name}`, undo: () => this.setPose(name, start), redo: () => this.setPose(name, pose),
      });
    });
  }

  private async toggleMenu(): Promise<void> {
    if (this.popup.isOpen) return this.popup.set(false);
    const reply = await this.connection.request('spawnables');
    if (!reply.done) {
      toast(reply.problem, true);
      return;
    }
    const models = reply.entities ?? [];
    const rows = models.map(({name, type}) => {
      const row = make('button', 'menu-row', name);
      row.append(make('span', 'menu-type', type === 'position' ? 'robot' : type));
      row.onclick = () => {
        this.toggle('add');
        this.adding = {name, type, heading: 0};
      };
      return row;
    });
    const choice = models.some(({type}) => type === 'position') ? [this.controllerChoice()] : [];
    this.menu.replaceChildren(...choice, ...rows);
    if (models.length === 0) this.menu.append(make('div', 'more', 'the world file defines no models'));
    this.popup.set(true);
    (rows[0] ?? this.menu).focus();
  }

  // The controller of robots that are added.
  private controllerChoice(): HTMLElement {
    const label = make('label', 'menu-choice', 'Controller of robots');
    const select = make('select', '') as HTMLSelectElement;
    select.append(new Option('as the model says', ''), ...BUILT_IN_CONTROLLERS.map(name => new Option(name, name)));
    select.value = this.controller;
    select.onchange = () => { this.controller = select.value; };
    label.append(select);
    return label;
  }

  // The place of the model that the next click adds: its body, if one of its type is in the world. Or of the next goal.
  private preview(place: Place): void {
    const at = this.scene.floorAt(place.x, place.y);
    if (!at) return;
    const isSent = this.tool === 'send';
    const plain = {x: at.x, y: at.y, z: at.z, heading: isSent ? 0 : this.adding.heading};
    const pose = isSent || !this.file ? plain : this.file.besideNew(this.adding.name, plain);
    this.scene.showGhost(pose, 0.3, isSent ? '' : this.adding.name);
  }

  // `repeat`: the tool remains.
  private async spawnAt(clientX: number, clientY: number, repeat: boolean): Promise<void> {
    const at = this.scene.floorAt(clientX, clientY);
    const {name: source, type, heading} = this.adding;
    if (!repeat) this.cancel();
    if (!at) return;
    const plain = {x: at.x, y: at.y, z: at.z, heading};
    const pose = this.file ? this.file.besideNew(source, plain) : plain;
    const controller = type === 'position' && this.controller ? {controller: this.controller} : {};
    const reply = await this.connection.request('spawn', {source, pose: numbers(pose), ...controller});
    this.file?.changed();
    const name = reply.entities?.[0]?.name ?? source;
    toast(reply.done ? `${name} is added` : reply.problem, !reply.done);
    if (!reply.done) return;
    this.host.selectNamed(name);
    this.history.add({
      text: `the addition of ${name}`, undo: () => this.remove(name), redo: () => this.restore(name, name, pose),
    });
  }

  private async sendTo(clientX: number, clientY: number): Promise<void> {
    const run = this.host.run();
    const entity = this.host.selected();
    const at = this.scene.floorAt(clientX, clientY);
    this.cancel();
    if (!run || entity?.kind !== 'robot' || !at) return;
    const name = nameOf(run.world, entity);
    const goal = {waypoints: [[at.x, at.y]], heights: this.scene.levels.areStacked ? [] : [at.z]};
    const reply = await this.connection.request('command_robot', {name, ticks: GOAL_TICKS, goal});
    if (reply.done) return toast(`${name} is sent to the point`);
    if (!reply.problem.includes('accepts no goals')) return toast(reply.problem, true);
    this.host.driveTo([at.x, at.y]);
    toast(`${name} is driven to the point: its controller accepts no goals`);
  }
}

function numbers(pose: Pose): number[] {
  return [pose.x, pose.y, pose.z, pose.heading];
}

// EditHistory: undo and redo of the edits that were made on this page. The run decides on each again: an undo is refused
// like any edit, for instance when another body is at the place by now.

export interface Edit {
  text: string;  // "the move of r0"
  undo(): Promise<boolean>;  // false: refused; the reason was shown
  redo(): Promise<boolean>;
}

const MOST = 100;

export class EditHistory {
  private done: Edit[] = [];
  private undone: Edit[] = [];
  private busy = false;
  off = false;  // a file in editing has its own history

  constructor(private readonly onChange: (canUndo: boolean, canRedo: boolean) => void) {}

  add(edit: Edit): void {
    if (this.off) return;
    this.done.push(edit);
    if (this.done.length > MOST) this.done.shift();
    this.undone = [];
    this.changed();
  }

  undo(): Promise<void> {
    return this.apply(this.done, this.undone, edit => edit.undo(), 'undone');
  }
  redo(): Promise<void> {
    return this.apply(this.undone, this.done, edit => edit.redo(), 'redone');
  }

  // After a reset there is nothing to undo.
  clear(): void {
    this.done = [];
    this.undone = [];
    this.changed();
  }

  private async apply(
      from: Edit[], to: Edit[], make: (edit: Edit) => Promise<boolean>, verb: string): Promise<void> {
    const edit = from[from.length - 1];
    if (!edit || this.busy) return;
    this.busy = true;
    try {
      if (await make(edit)) {
        from.pop();
        to.push(edit);
        toast(`${edit.text} is ${verb}`);
      }
    } finally {
      this.busy = false;
      this.changed();
    }
  }

  private changed(): void {
    this.onChange(this.done.length > 0, this.undone.length > 0);
  }
}
