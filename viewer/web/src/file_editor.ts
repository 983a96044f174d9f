// FileEditor: the page of `troupe edit`: the entities of the file, its models, properties, problems and text. The
// gateway holds the file; each edit is a request, and the world that follows comes as that of a run.
//
// The page keeps no copy of the file: after each edit it asks for the document again and shows that. So a refused edit
// leaves nothing to be undone, and two pages that edit one file show the same.
import {Areas} from './areas';
import {BitmapDrawing} from './bitmap_drawing';
import type {Connection} from './connection';
import {byId, labelOf, make, setText, toast} from './dom';
import {Drawing, roomBetween, wallBetween, type DrawTool, type Point} from './drawing';
import type {Editing, NamedPose} from './editing';
import {FileClient, placeText, type EditorHelp, type EntityReport, type FileDocument, type PaletteRow} from './file_client';
import {FilePanel} from './file_panel';
import {ModelEditor} from './model_editor';
import {drawPicture} from './model_picture';
import {PlaceGrid} from './place_grid';
import {PlanImport} from './plan_import';
import type {Pose} from './protocol';
import type {Run} from './run';
import type {WorldScene} from './scene';
import {Selection} from './selection';
import {TextPane} from './text_pane';
import {WaypointDrawing} from './waypoint_drawing';

export interface FileEditorHost {
  // An entity of the scene, if it is one. `center`: the picture turns to it.
  selectName(name: string, center: boolean): void;
  // Those are selected with it.
  markNames(names: readonly string[]): void;
  run(): Run | null;
}

const WALL_COLOR = '"gray60"';
const BESIDE = 0.5;  // m, in x and against y, from an entity to its duplicate
const LEAST_REACH = 5;  // m from the origin that the ground of a file has at least

export class FileEditor {
  document: FileDocument | null = null;
  private readonly client: FileClient;
  private readonly drawing: Drawing;
  private readonly bitmaps: BitmapDrawing;
  private readonly models: ModelEditor;
  private readonly areas: Areas;
  private readonly grid: PlaceGrid;
  private readonly selection = new Selection();
  private readonly panel: FilePanel;
  private readonly plan: PlanImport;
  private readonly waypoints: WaypointDrawing;
  readonly text: TextPane;
  private help: EditorHelp = {properties: [], controllers: [], stage_controllers: {}, colors: {}};
  private palette: PaletteRow[] = [];
  private copied: readonly string[] = [];  // to be pasted
  private pointer: {x: number; y: number} | null = null;  // over the picture, px
  private paletteVersion = -1;
  private paletteText = '';
  private bitmapVersion = -1;
  private refreshing = false;
  private again = false;

  constructor(
      private readonly connection: Connection, private readonly scene: WorldScene, private readonly editing: Editing,
      private readonly host: FileEditorHost, private readonly viewOnly: boolean) {
    this.client = new FileClient(connection);
    this.drawing = new Drawing(scene, {drawn: (tool, from, to) => void this.drawn(tool, from, to)});
    this.bitmaps = new BitmapDrawing(scene, this.client, {changed: () => void this.refresh()});
    this.models = new ModelEditor(this.client, {
      help: () => this.help,
      models: () => this.palette.map(row => row.name),
      changed: () => void this.refresh(),
      test: (model, probeHeight) => this.test(model, probeHeight),
    });
    this.areas = new Areas(scene, this.client, {
      robots: () => this.palette.filter(({type, library, where}) => type === 'position' && !library && where.file).map(({name}) => name),
      added: (key, index) => {
        this.host.selectName('', false);
        this.selection.set([]);
        this.panel.open([key], [key, index]);
        void this.refresh();
      },
    });
    this.panel = new FilePanel(this.client, {
      help: () => this.help,
      refresh: () => this.refresh(),
      renamed: name => this.select(name),
      drawWaypoints: (from, done, single) => {
        this.editing.cancel();
        this.drawing.set('none');
        this.waypoints.begin(from, done, single);
      },
      // Robots first: those are named most.
      models: () => [...this.palette].filter(({library}) => !library)
        .sort((a, b) => Number(b.type === 'position') - Number(a.type === 'position')).map(({name}) => name),
      places: () => {
        const places = this.document?.members.places;
        return Array.isArray(places) ? (places as Array<{name?: string}>).map(({name}) => name ?? '') : [];
      },
    }, viewOnly);
    this.waypoints = new WaypointDrawing(scene);
    this.plan = new PlanImport(scene, this.client, name => {
      toast(`${name} has the walls of the plan`);
      void this.refresh().then(() => this.scene.home());
    });
    this.text = new TextPane(this.client, {
      file: () => this.document,
      help: () => this.help,
      palette: () => this.palette,
      selectedLine: () => this.document?.entities.find(each => each.name === this.selected && each.here)?.where.line ?? 0,
      refresh: () => this.refresh(),
    }, viewOnly);
    scene.leastReach = LEAST_REACH;
    document.body.classList.add('file');
    byId('file-grid').hidden = viewOnly;
    byId('file-tools').hidden = byId('file-entities').hidden = false;
    editing.setFile({
      undo: () => this.step('undo'),
      redo: () => this.step('redo'),
      rename: (before, after) => this.rename(before, after),
      deleteSelected: () => this.deleteSelected(),
      ownerOf: name => this.ownerOf(name),
      selection: () => this.selection.names,
      selectOnly: name => this.selectOnly(name),
      toggle: name => this.toggle(name),
      selectInside: rect => this.selectInside(rect),
      beside: (name, pose) => this.grid.besideOthers(name, pose),
      besideNew: (model, pose) => this.grid.besideOthersNew(this.palette.find(({name}) => name === model)?.picture ?? [], pose),
      move: poses => this.moveTogether(poses),
      changed: () => void this.refresh(),
    });
    this.grid = new PlaceGrid(scene, {
      run: () => this.host.run(),
      choosesPixels: () => this.bitmaps.open,
      drawn: () => this.drawing.begun,
      dragged: () => this.editing.dragged,
    });
    this.bind();
    void this.load();
  }

  async load(): Promise<void> {
    const reply = await this.client.ask('help');
    if (reply.done) this.help = reply as unknown as EditorHelp;
    await this.refresh();
  }

  // The gateway has another world.
  worldChanged(): void {
    this.host.markNames(this.selection.others);
    void this.refresh();
  }

  private get selected(): string {
    return this.selection.primary;
  }

  select(name: string): void {
    if (name === this.selected) return;
    this.selection.set([name]);
    this.showSelection();
  }

  private showSelection(): void {
    this.host.markNames(this.selection.others);
    void this.showPanel();
    this.showEntities();
  }

  // The selection as it is now, in the picture, too.
  private applySelection(): void {
    const names = [...this.selection.names];
    this.host.selectName(this.selected, false);
    this.selection.set(names);
    this.showSelection();
  }

  private selectOnly(name: string): void {
    if (name === this.selected && !this.selection.isSeveral) return;
    this.selection.set([name]);
    this.showSelection();
  }

  private toggle(name: string): void {
    this.selection.toggle(name);
    this.applySelection();
  }

  private selectInside(rect: DOMRect): void {
    const inside = (this.document?.entities ?? []).map(({name}) => name).filter(name => {
      const at = this.scene.placeOfName(name);
      return at && at.x >= rect.left && at.x <= rect.right && at.y >= rect.top && at.y <= rect.bottom;
    });
    this.selection.set([...this.selection.names, ...inside]);
    this.applySelection();
  }

  // A leaf of a door and a cabin of a lift are called as their entry, and more.
  private ownerOf(name: string): string {
    const entities = this.document?.entities ?? [];
    if (entities.some(each => each.name === name)) return name;
    const owner = name.slice(0, Math.max(0, name.lastIndexOf('.')));
    return entities.some(each => each.name === owner) ? owner : name;
  }

  // True if the key belongs to the editor.
  press(event: KeyboardEvent): boolean {
    if (this.waypoints.press(event)) return true;
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === 's') {
      void this.save();
      return true;
    }
    if ((event.ctrlKey || event.metaKey) && !this.viewOnly && !isTyping(event)) {
      const key = event.key.toLowerCase();
      if (key === 'a') {
        this.selection.set((this.document?.entities ?? []).filter(({here}) => here).map(({name}) => name));
        this.applySelection();
        return true;
      }
      if (key === 'd' && this.selected) {
        void this.duplicate();
        return true;
      }
      if (key === 'c' && this.selected && window.getSelection()?.isCollapsed !== false) {
        this.copied = [...this.selection.names];
        toast(`${this.copied.length === 1 ? this.selected : `${this.copied.length} models`} copied: Ctrl-V puts a copy at the pointer`);
        return true;
      }
      if (key === 'v' && this.copied.length > 0) {
        void this.paste();
        return true;
      }
    }
    if (event.key === 'Escape') {
      this.drawing.set('none');
      void this.bitmaps.set(false);
    }
    return false;
  }

  modelPoint(view: 'top' | 'side', a: number, b: number): {x: number; y: number} {
    return this.models.clientPoint(view, a, b);
  }

  private bind(): void {
    const bind = (id: string, action: () => void): void => {
      byId(id).onclick = action;
    };
    bind('file-save', () => void this.save());
    bind('file-text', () => void this.text.open());
    bind('file-plan', () => this.plan.choose());
    bind('file-model', () => this.models.openNew());
    bind('file-test', () => void (this.document?.testing ? this.endTest() : this.test('', 0)));
    for (const tool of ['wall', 'room', 'area'] as const) bind(`file-${tool}`, () => this.draw(tool));
    bind('file-bitmap', () => {
      this.editing.cancel();
      this.drawing.set('none');
      void this.bitmaps.set(!this.bitmaps.open);
    });
    this.scene.canvas.addEventListener('pointermove', event => {
      this.pointer = {x: event.clientX, y: event.clientY};
    });
    bind('file-duplicate', () => void this.duplicate());
    bind('file-rename', () => void this.renameSelected());
    bind('file-delete', () => void this.deleteSelected());
    byId('entity-search').oninput = () => this.showEntities();
    window.addEventListener('beforeunload', event => {
      if (this.document?.modified || this.text.isChanged) event.preventDefault();
    });
    if (this.viewOnly) {
      for (const id of [
        'file-save', 'file-wall', 'file-room', 'file-bitmap', 'file-plan', 'file-area', 'file-model', 'file-test',
      ]) {
        byId(id).hidden = true;
      }
    }
  }

  private draw(tool: DrawTool): void {
    this.editing.cancel();
    void this.bitmaps.set(false);
    this.drawing.set(this.drawing.tool === tool ? 'none' : tool);
  }

  // One after another, the last one always after the newest change.
  async refresh(): Promise<void> {
    this.again = true;
    if (this.refreshing) return;
    this.refreshing = true;
    while (this.again) {
      this.again = false;
      const reply = await this.client.ask('document');
      if (!reply.done) break;
      const before = this.document;
      const now = reply as unknown as FileDocument;
      if (this.paletteVersion !== now.version) await this.loadPalette(now.version);
      this.document = now;
      this.showDocument(now);
      if (before) this.selectAdded(before, now);
      if (now.version !== this.bitmapVersion) {
        this.bitmapVersion = now.version;
        await this.bitmaps.refresh();
        await this.text.follow();
      }
    }
    this.refreshing = false;
  }

  // What has just been put down is selected, to be given its properties.
  private selectAdded(before: FileDocument, now: FileDocument): void {
    const name = /^the addition of (.*)$/.exec(now.undo)?.[1];
    if (!name || before.undo === now.undo || before.entities.some(each => each.name === name)) return;
    this.select(name);
    this.host.selectName(name, false);
  }

  private async loadPalette(version: number): Promise<void> {
    const reply = await this.client.ask('palette');
    if (!reply.done) return;
    this.paletteVersion = version;
    const text = JSON.stringify(reply.models);
    if (text === this.paletteText) return;
    this.paletteText = text;
    this.palette = reply.models;
    this.keepPlace(byId('palette'), () => this.showPalette());
  }

  private showDocument(shown: FileDocument): void {
    document.body.classList.toggle('testing', shown.testing);
    document.title = `${shown.modified ? '• ' : ''}${shown.file.split('/').pop()} · Troupe`;
    const state = byId('file-state');
    state.hidden = false;
    setText(state, shown.testing ? `test${shown.tested ? ` of ${shown.tested}` : ''}` : shown.error ? 'error' : shown.modified ? 'not saved' : 'saved');
    state.className = `badge ${shown.error ? 'lost' : shown.testing ? 'holding' : shown.modified ? 'stalled' : 'moving'}`;
    setText(labelOf('file-test'), shown.testing ? 'End test' : 'Test');
    byId('file-area').hidden = shown.kind !== 'scenario' || this.viewOnly;
    byId('file-bitmap').hidden = shown.kind === 'scenario' || this.viewOnly;
    byId('file-plan').hidden = shown.kind !== 'world' || this.viewOnly;
    byId('file-model').hidden = shown.kind === 'scenario' || this.viewOnly;
    for (const [id, label] of [['undo', shown.undo], ['redo', shown.redo]] as const) {
      const button = byId<HTMLButtonElement>(id);
      button.disabled = !label;
      button.title = label ? `${id === 'undo' ? 'Undo' : 'Redo'} ${label}` : '';
    }
    this.areas.show(shown.testing ? {} : shown.members);
    this.showEntities();
    this.showProblems(shown);
    void this.showPanel();
  }

  private showProblems(shown: FileDocument): void {
    const problems = [shown.error, shown.failure ?? '', ...shown.warnings].filter(text => text !== '');
    byId('file-problems').hidden = problems.length === 0;
    setText(byId('problem-count'), String(problems.length));
    byId('problem-list').replaceChildren(
      ...problems.map((text, i) => make('div', i === 0 && shown.error ? 'problem error-text' : 'problem', text)));
    setText(byId('text-error'), shown.error);
  }

  private showEntities(): void {
    const search = byId<HTMLInputElement>('entity-search').value.toLowerCase();
    const entities = this.document?.entities ?? [];
    setText(byId('entity-count'), String(entities.length));
    byId('entity-list').replaceChildren(
      ...entities.filter(({name, model}) => `${name} ${model}`.toLowerCase().includes(search)).slice(0, 500).map(entity => {
        const row = make('button', `entity${entity.here ? '' : ' elsewhere'}${this.selection.has(entity.name) ? ' selected' : ''}`);
        row.append(make('span', '', entity.name), make('span', 'faint', entity.model));
        row.title = placeText(entity.where);
        row.onclick = event => {
          if (event.shiftKey || event.ctrlKey || event.metaKey) return this.toggle(entity.name);
          this.selection.set([]);
          this.select(entity.name);
          this.host.selectName(entity.name, true);
        };
        return row;
      }));
  }

  // The first row in view stays where it is: it may be below the pointer.
  private keepPlace(list: HTMLElement, change: () => void): void {
    const rows = (): HTMLElement[] => [...list.querySelectorAll<HTMLElement>('.palette-row')];
    const {top} = list.getBoundingClientRect();
    const first = rows().find(row => row.getBoundingClientRect().bottom > top);
    const before = first?.getBoundingClientRect().top ?? 0;
    change();
    const again = first && rows().find(row => row.dataset.model === first.dataset.model);
    if (again) list.scrollTop += again.getBoundingClientRect().top - before;
  }

  // The models of the file first, then those in files beside it, those of libraries, and the plain types.
  private showPalette(): void {
    const groups = new Map<string, PaletteRow[]>();
    const titleOf = (row: PaletteRow): string => row.library ?? (row.where.file ? '' : 'plain');
    for (const row of this.palette) {
      const title = titleOf(row);
      groups.set(title, [...groups.get(title) ?? [], row]);
    }
    const order = (title: string): number => ({'': 0, files: 1, plain: 3} as Record<string, number>)[title] ?? 2;
    const sorted = [...groups].sort(([a], [b]) => order(a) - order(b));
    byId('palette').replaceChildren(...sorted.flatMap(([title, rows]) => {
      const lines = rows.map(row => this.paletteLine(row));
      if (title === '') return lines;
      const head = make('h3', 'palette-title', title.replace(/_/g, ' '));
      head.title = title === 'plain' ? 'A box to begin with'
        : title === 'files' ? 'Models and robots of Gazebo and ROS beside the file, which names them'
        : `Of the library ${rows[0].where.file}, which is included when one is put down`;
      return [head, ...lines];
    }));
  }

  private paletteLine(row: PaletteRow): HTMLElement {
    const line = make('div', 'palette-line');
    const button = make('button', 'palette-row') as HTMLButtonElement;
    button.dataset.model = row.name;
    const canvas = document.createElement('canvas');
    canvas.width = 88;
    canvas.height = 68;
    drawPicture(canvas, row.picture ?? []);
    button.append(canvas, make('span', '', row.name.replace(/_/g, ' ')));
    if (row.type === 'position') button.append(make('span', 'badge idle', 'robot'));
    button.title = row.where.file ? `${row.name}: ${row.type}, ${placeText(row.where)}` : `the type ${row.type}`;
    button.disabled = this.viewOnly;
    button.onclick = () => {
      this.drawing.set('none');
      void this.bitmaps.set(false);
      this.editing.startAdding(row.name, row.type);
    };
    line.append(button);
    if (row.where.file && !row.library) {
      const edit = make('button', 'plain', '✎');
      edit.title = row.here ? `Edit the model ${row.name}` : `Look at the model ${row.name}`;
      edit.setAttribute('aria-label', edit.title);
      edit.onclick = () => void this.models.openModel(row.name);
      line.append(edit);
    }
    return line;
  }

  // The properties of the selected entity, or of the file.
  private async showPanel(): Promise<void> {
    const panel = byId('file-panel');
    panel.hidden = false;
    const entity = this.document?.entities.find(each => each.name === this.selected);
    byId('file-panel-buttons').hidden = !entity || this.viewOnly;
    if (!entity) {
      if (this.document) this.panel.showFile(this.document);
      return;
    }
    const reply = await this.client.ask('entity', {name: entity.name});
    if (!reply.done || this.selected !== entity.name) return;
    const report = reply as unknown as EntityReport;
    const model = this.palette.find(row => row.name === report.model && row.where.file !== '');
    const edit = byId('file-edit-model');
    edit.hidden = !model;
    edit.onclick = () => void this.models.openModel(report.model);
    const isLocked = this.viewOnly || report.shelf;
    const several = this.selection.isSeveral;
    byId('file-duplicate').hidden = isLocked || (!entity.here && !several);
    byId('file-rename').hidden = isLocked || !entity.here || several || report.refusal !== '';
    // A scenario can leave out what its world has.
    byId('file-delete').hidden = isLocked || (report.refusal !== '' && this.document?.kind !== 'scenario' && !several);
    byId('file-several').hidden = !several;
    setText(byId('file-several'), several ? `${this.selection.names.length} selected: they are moved, turned, copied and deleted together` : '');
    edit.hidden = !model || several;
    if (this.document) this.panel.showEntity(this.document, report);
  }

  private async step(op: 'undo' | 'redo'): Promise<void> {
    const reply = await this.client.edit(op);
    if (reply.done) toast(`${reply.label} is ${op === 'undo' ? 'undone' : 'redone'}`);
    await this.refresh();
  }

  private async rename(before: string, after: string): Promise<void> {
    const reply = await this.client.edit('rename', {name: before, to: after});
    if (!reply.done) return;
    this.selection.set([after]);
    await this.refresh();
    this.host.selectName(after, false);
  }

  private async renameSelected(): Promise<void> {
    const after = window.prompt(`New name of ${this.selected}.`, this.selected)?.trim();
    if (after && after !== this.selected) await this.rename(this.selected, after);
  }

  // Copies beside the selected entities, which are selected then: they are moved, or duplicated again.
  private async duplicate(): Promise<void> {
    await this.copy(this.selection.names, ([x, y, z, heading]) => [x + BESIDE, y - BESIDE, z, heading]);
  }

  // With the middle of what was copied at the pointer.
  private async paste(): Promise<void> {
    const at = this.pointer && this.scene.floorAt(this.pointer.x, this.pointer.y);
    await this.copy(this.copied, ([x, y, z, heading], middle) =>
      at ? [at.x + x - middle.x, at.y + y - middle.y, z, heading] : [x + BESIDE, y - BESIDE, z, heading]);
  }

  private async copy(names: readonly string[], to: (pose: number[], middle: Point) => number[]): Promise<void> {
    const reports = await Promise.all(names.map(name => this.client.ask('entity', {name})));
    const missing = reports.findIndex(({done}) => !done);
    if (missing >= 0) return toast(`${names[missing]} is not in the file any more`, true);
    const poses = reports.map(report => (report as unknown as EntityReport).pose);
    const mean = (values: number[]): number => values.reduce((sum, value) => sum + value, 0) / values.length;
    const middle = {x: mean(poses.map(([x]) => x)), y: mean(poses.map(([, y]) => y))};
    const reply = await this.client.edit('together', {
      edits: names.map((name, i) => ({op: 'copy', name, pose: to(poses[i], middle)})),
    });
    await this.refresh();
    if (!reply.done) return;
    toast(names.length === 1 ? `${reply.names[0]} is a copy of ${names[0]}` : `${names.length} models are copied`);
    this.selection.set(reply.names);
    this.applySelection();
  }

  async deleteSelected(): Promise<void> {
    const names = this.selection.names;
    if (names.length === 0) return;
    const reply = await this.client.edit('together', {edits: names.map(name => ({op: 'delete', name}))});
    if (!reply.done) return;
    toast(names.length === 1 ? `${names[0]} is deleted` : `${names.length} models are deleted`);
    this.selection.set([]);
    this.host.selectName('', false);
    await this.refresh();
  }

  private async moveTogether(poses: NamedPose[]): Promise<boolean> {
    const numbers = ({x, y, z, heading}: Pose): number[] => [x, y, z, heading];
    const reply = await this.client.edit('together', {edits: poses.map(({name, pose}) => ({op: 'set_pose', name, pose: numbers(pose)}))});
    await this.refresh();
    return reply.done;
  }

  private async save(): Promise<void> {
    if (this.text.isChanged && !await this.text.apply()) return;
    let reply = await this.client.edit('save');
    if (reply.conflict && window.confirm(`${reply.problem}.\n\nReplace it by the edited file?`)) {
      reply = await this.client.edit('save', {overwrite: true});
    } else if (reply.conflict && window.confirm('Read the file from the disk again? Undo returns to the edits.')) {
      reply = await this.client.edit('reload');
      if (reply.done) toast('The file is read again');
      return this.refresh();
    }
    if (reply.done) toast('The file is saved');
    await this.refresh();
  }

  private async drawn(tool: DrawTool, from: Point, to: Point): Promise<void> {
    if (tool === 'area') return this.areas.add(from, to);
    const {thickness, height, door} = this.drawing;
    const model = tool === 'wall' ? wallBetween(from, to, thickness, height) : roomBetween(from, to, thickness, height, door);
    const {x, y, z, heading} = model.pose;
    await this.client.edit('add_model', {
      name: tool, pose: [x, y, z, heading], blocks: model.blocks, properties: {color: WALL_COLOR},
    });
    await this.refresh();
  }

  private async test(model: string, probeHeight: number): Promise<void> {
    const reply = await this.client.edit('test', {model, probe_height: probeHeight});
    if (reply.done) {
      // Not by the button: it pauses as long as the page has not received the end of an earlier test.
      const started = await this.connection.request('play');
      if (!started.done) toast(started.problem, true);
    }
    this.scene.home();
    await this.refresh();
  }

  private async endTest(): Promise<void> {
    await this.client.edit('end_test');
    await this.refresh();
    this.scene.home();
  }
}

function isTyping({target}: KeyboardEvent): boolean {
  return target instanceof HTMLInputElement || target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement
    || (target instanceof HTMLElement && target.isContentEditable);
}
