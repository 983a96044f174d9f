// FileEditor: the page of `troupe edit`: the entities of the file, its models, properties, problems and text. The
// gateway holds the file; each edit is a request, and the world that follows comes as that of a run.
//
// The page keeps no copy of the file: after each edit it asks for the document again and shows that. So a refused edit
// leaves nothing to be undone, and two pages that edit one file show the same.
import {BitmapDrawing} from './bitmap_drawing';
import type {Connection} from './connection';
import {byId, labelOf, make, setText, toast} from './dom';
import {Drawing, roomBetween, SpawnRegions, wallBetween, type DrawTool, type Point} from './drawing';
import type {Editing} from './editing';
import {FileClient, placeText, type EditorHelp, type EntityReport, type FileDocument, type PaletteRow} from './file_client';
import {FilePanel} from './file_panel';
import {ModelEditor} from './model_editor';
import {drawPicture} from './model_picture';
import {PlaceGrid} from './place_grid';
import {PlanImport} from './plan_import';
import type {WorldScene} from './scene';
import {TextPane} from './text_pane';
import {WaypointDrawing} from './waypoint_drawing';

export interface FileEditorHost {
  // An entity of the scene, if it is one. `center`: the picture turns to it.
  selectName(name: string, center: boolean): void;
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
  private readonly regions: SpawnRegions;
  private readonly panel: FilePanel;
  private readonly plan: PlanImport;
  private readonly waypoints: WaypointDrawing;
  readonly text: TextPane;
  private help: EditorHelp = {properties: [], controllers: [], stage_controllers: {}, colors: {}};
  private palette: PaletteRow[] = [];
  private selected = '';
  private copied = '';  // to be pasted
  private pointer: {x: number; y: number} | null = null;  // over the picture, px
  private paletteVersion = -1;
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
    this.regions = new SpawnRegions(scene, this.client, {
      // Robots first: those are spawned most.
      models: () => [...this.palette].sort((a, b) => Number(b.type === 'position') - Number(a.type === 'position'))
        .map(row => row.name),
      changed: () => void this.refresh(),
    });
    this.panel = new FilePanel(this.client, {
      help: () => this.help,
      refresh: () => this.refresh(),
      renamed: name => this.select(name),
      drawWaypoints: (from, done) => {
        this.editing.cancel();
        this.drawing.set('none');
        this.waypoints.begin(from, done);
      },
    }, viewOnly);
    this.waypoints = new WaypointDrawing(scene);
    this.plan = new PlanImport(this.client, name => {
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
    });
    new PlaceGrid(scene, () => this.bitmaps.open);
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
    void this.refresh();
  }

  select(name: string): void {
    if (name === this.selected) return;
    this.selected = name;
    void this.showPanel();
    this.showEntities();
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
      if (key === 'd' && this.selected) {
        void this.duplicate();
        return true;
      }
      if (key === 'c' && this.selected && window.getSelection()?.isCollapsed !== false) {
        this.copied = this.selected;
        toast(`${this.copied} is copied: Ctrl-V puts a copy at the pointer`);
        return true;
      }
      if (key === 'v' && this.copied) {
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
    for (const tool of ['wall', 'room', 'region'] as const) bind(`file-${tool}`, () => this.draw(tool));
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
        'file-save', 'file-wall', 'file-room', 'file-bitmap', 'file-plan', 'file-region', 'file-model', 'file-test',
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
    this.palette = reply.models;
    this.showPalette();
  }

  private showDocument(shown: FileDocument): void {
    document.body.classList.toggle('testing', shown.testing);
    document.title = `${shown.modified ? '• ' : ''}${shown.file.split('/').pop()} · Troupe`;
    const state = byId('file-state');
    state.hidden = false;
    setText(state, shown.testing ? `test${shown.tested ? ` of ${shown.tested}` : ''}` : shown.error ? 'error' : shown.modified ? 'not saved' : 'saved');
    state.className = `badge ${shown.error ? 'lost' : shown.testing ? 'holding' : shown.modified ? 'stalled' : 'moving'}`;
    setText(labelOf('file-test'), shown.testing ? 'End test' : 'Test');
    byId('file-region').hidden = shown.kind !== 'scenario' || this.viewOnly;
    byId('file-bitmap').hidden = shown.kind === 'scenario' || this.viewOnly;
    byId('file-plan').hidden = shown.kind !== 'world' || this.viewOnly;
    byId('file-model').hidden = shown.kind === 'scenario' || this.viewOnly;
    for (const [id, label] of [['undo', shown.undo], ['redo', shown.redo]] as const) {
      const button = byId<HTMLButtonElement>(id);
      button.disabled = !label;
      button.title = label ? `${id === 'undo' ? 'Undo' : 'Redo'} ${label}` : '';
    }
    this.regions.show(shown.testing ? [] : shown.regions, this.viewOnly);
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
        const row = make('button', `entity${entity.here ? '' : ' elsewhere'}${entity.name === this.selected ? ' selected' : ''}`);
        row.append(make('span', '', entity.name), make('span', 'faint', entity.model));
        row.title = placeText(entity.where);
        row.onclick = () => {
          this.select(entity.name);
          this.host.selectName(entity.name, true);
        };
        return row;
      }));
  }

  // The models of the file first, then those of libraries, then the plain types.
  private showPalette(): void {
    const groups = new Map<string, PaletteRow[]>();
    const titleOf = (row: PaletteRow): string => row.library ?? (row.where.file ? '' : 'plain');
    for (const row of this.palette) {
      const title = titleOf(row);
      groups.set(title, [...groups.get(title) ?? [], row]);
    }
    const order = (title: string): number => (title === '' ? 0 : title === 'plain' ? 2 : 1);
    const sorted = [...groups].sort(([a], [b]) => order(a) - order(b));
    byId('palette').replaceChildren(...sorted.flatMap(([title, rows]) => {
      const lines = rows.map(row => this.paletteLine(row));
      if (title === '') return lines;
      const head = make('h3', 'palette-title', title.replace(/_/g, ' '));
      head.title = title === 'plain' ? 'A box to begin with' : `Of the library ${rows[0].where.file}, which is included when one is put down`;
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
    byId('file-duplicate').hidden = byId('file-rename').hidden = byId('file-delete').hidden = report.refusal !== '' || this.viewOnly || report.shelf;
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
    this.selected = after;
    await this.refresh();
    this.host.selectName(after, false);
  }

  private async renameSelected(): Promise<void> {
    const after = window.prompt(`New name of ${this.selected}.`, this.selected)?.trim();
    if (after && after !== this.selected) await this.rename(this.selected, after);
  }

  // A copy beside the selected entity, which is selected then: it is moved, or duplicated again.
  private async duplicate(): Promise<void> {
    const report = await this.client.ask('entity', {name: this.selected}) as unknown as EntityReport & {done: boolean};
    if (!report.done) return;
    const [x, y, z, heading] = report.pose;
    await this.copy(report.name, [x + BESIDE, y - BESIDE, z, heading]);
  }

  private async paste(): Promise<void> {
    const report = await this.client.ask('entity', {name: this.copied}) as unknown as EntityReport & {done: boolean; problem: string};
    if (!report.done) return toast(`${this.copied} is not in the file any more`, true);
    const [x, y, z, heading] = report.pose;
    const at = this.pointer && this.scene.floorAt(this.pointer.x, this.pointer.y);
    await this.copy(report.name, at ? [at.x, at.y, z, heading] : [x + BESIDE, y - BESIDE, z, heading]);
  }

  private async copy(name: string, pose: number[]): Promise<void> {
    const reply = await this.client.edit('copy', {name, pose});
    if (reply.done) toast(`${reply.name} is a copy of ${name}`);
    await this.refresh();
  }

  async deleteSelected(): Promise<void> {
    if (!this.selected) return;
    const reply = await this.client.edit('delete', {name: this.selected});
    if (!reply.done) return;
    toast(`${this.selected} is deleted`);
    this.selected = '';
    await this.refresh();
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
    if (tool === 'region') {
      this.drawing.set('none');
      return this.regions.add(from, to);
    }
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
