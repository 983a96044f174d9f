// ModelEditor: draws a model of the file: its blocks, colour, parts and properties.
import {byId, make, setText, toast} from './dom';
import type {FileClient, HelpRow, ModelPart, ModelReport} from './file_client';
import {ModelViews, type Fan, type ViewsState} from './model_views';
import {showProperties} from './property_rows';

// Parts that can be added, as they begin.
const PARTS: Record<string, {properties: Record<string, string>; sensor?: Record<string, string>}> = {
  ranger: {properties: {size: '[0.1 0.1 0.1]'}, sensor: {range: '[0 5]', fov: '180', samples: '181'}},
  camera: {properties: {resolution: '[64 48]'}},
  fiducial: {properties: {range_max: '5'}},
  blobfinder: {properties: {range: '5'}},
  bumper: {properties: {bcount: '1', 'bpose[0]': '[0.2 0 0 0]', blength: '0.3'}},
  contact: {properties: {}},
  gripper: {properties: {pose: '[0.3 0 0 0]'}},
  actuator: {properties: {size: '[0.1 0.1 0.5]', axis: '[0 0 1]', max_speed: '0.1'}},
  model: {properties: {size: '[0.1 0.1 0.1]'}},
  blinkenlight: {properties: {}},
};

const FLAGS: Array<[string, string, boolean]> = [
  ['model-collides', 'obstacle_return', true], ['model-movable', 'gripper_return', false],
];

export interface ModelEditorHost {
  help(): HelpRow[];
  models(): string[];
  changed(): void;  // the file
  test(model: string, probeHeight: number): Promise<void>;
}

function numbers(text: string | undefined): number[] {
  return (text?.match(/[-+.\d]+/g) ?? []).map(Number).filter(Number.isFinite);
}

export class ModelEditor {
  private readonly state: ViewsState = {
    blocks: [], selected: -1, fans: [], newHeights: [0, 0.5], others: [],
  };
  private readonly views: ModelViews;
  private report: ModelReport | null = null;  // null: a new model
  private blocksChanged = false;
  private readonly box = byId('model-editor');
  private readonly name = byId<HTMLInputElement>('model-name');
  private readonly base = byId<HTMLInputElement>('model-base');
  private readonly color = byId<HTMLInputElement>('model-color');

  constructor(private readonly client: FileClient, private readonly host: ModelEditorHost) {
    this.views = new ModelViews(byId('model-top'), byId('model-side'), this.state, () => {
      this.blocksChanged = true;
      this.showBlocks();
    });
    byId('model-close').onclick = () => this.close();
    byId('model-apply').onclick = () => void this.apply();
    byId('model-test').onclick = () => void this.test();
    byId('part-add').onclick = () => void this.addPart([], byId<HTMLSelectElement>('part-type').value);
    byId('part-type').replaceChildren(...Object.keys(PARTS).map(type => new Option(type, type)));
    // The page's keys are not for a text that is typed here.
    this.box.addEventListener('keydown', event => {
      if (event.key === 'Escape' && !this.views.cancel()) this.close();
      event.stopPropagation();
    });
  }

  get isOpen(): boolean {
    return !this.box.hidden;
  }

  openNew(): void {
    this.report = null;
    this.state.blocks = [];
    this.state.fans = [];
    this.state.others = [];
    this.state.selected = -1;
    this.name.value = '';
    this.base.value = 'model';
    this.color.value = 'gray60';
    for (const [id, , initial] of FLAGS) byId<HTMLInputElement>(id).checked = initial;
    this.open();
  }

  async openModel(name: string): Promise<void> {
    const reply = await this.client.edit('model', {name});
    if (!reply.done) return;
    this.show(reply as unknown as ModelReport);
    this.open();
  }

  clientPoint(view: 'top' | 'side', a: number, b: number): {x: number; y: number} {
    return this.views.clientPoint(view, a, b);
  }

  blocks(): ViewsState['blocks'] {
    return this.state.blocks;
  }

  private open(): void {
    this.box.hidden = false;
    this.blocksChanged = false;
    byId('model-bases').replaceChildren(...['model', 'position', ...this.host.models()].map(name => new Option(name, name)));
    this.showLists();
    this.views.fit();
    this.name.focus();
  }

  private close(): void {
    this.box.hidden = true;
  }

  private show(report: ModelReport): void {
    this.report = report;
    this.name.value = report.name;
    this.base.value = report.base;
    this.color.value = (report.properties.color ?? '').replace(/"/g, '');
    for (const [id, property, initial] of FLAGS) {
      byId<HTMLInputElement>(id).checked = Number(report.properties[property] ?? (initial ? 1 : 0)) !== 0;
    }
    this.state.blocks = report.blocks;
    this.state.selected = Math.min(this.state.selected, report.blocks.length - 1);
    this.state.others = report.picture.slice(report.blocks.length);
    this.state.fans = report.parts.flatMap(part => this.fansOf(part));
    this.blocksChanged = false;
  }

  private fansOf(part: ModelPart): Fan[] {
    if (part.type !== 'ranger' || !this.report) return [];
    const {metres, radians} = this.report;
    const [x = 0, y = 0, , heading = 0] = numbers(part.properties.pose);
    return (part.parts ?? []).filter(sensor => sensor.type === 'sensor').map(sensor => {
      const [sx = 0, sy = 0, , turn = 0] = numbers(sensor.properties.pose);
      const [, range = 5 / metres] = numbers(sensor.properties.range);
      const c = Math.cos(heading * radians);
      const s = Math.sin(heading * radians);
      return {
        x: (x + c * sx - s * sy) * metres, y: (y + s * sx + c * sy) * metres, heading: (heading + turn) * radians,
        fov: sensor.properties.fov ? Number(sensor.properties.fov) * radians : 0.1, range: range * metres,
      };
    });
  }

  private showLists(): void {
    const isNew = this.report === null;
    const locked = this.report !== null && !this.report.here;
    this.name.disabled = !isNew;
    this.base.disabled = !isNew;
    byId<HTMLButtonElement>('model-apply').disabled = locked;
    byId<HTMLButtonElement>('part-add').disabled = isNew || locked;
    setText(byId('model-error'), locked ? 'of an included file: edit it there' : '');
    this.showBlocks();
    byId('model-parts').replaceChildren(
      ...(isNew ? [make('div', 'faint', 'Apply the model first, then add sensors, joints and grippers.')]
                : this.report!.parts.map(part => this.partRow(part, [part.index]))));
    const type = this.report?.type ?? 'model';
    if (this.report) {
      const {properties, own} = this.report;
      const shown = Object.keys(properties).map(name => ({name, value: own[name] ?? properties[name], own: name in own}));
      showProperties(byId('model-properties'), shown, this.host.help(), {
        types: ['*', type], locked, of: this.report.name,
        set: (name, value) => this.change({part: [], action: 'set', property: name, value}),
      });
    } else {
      byId('model-properties').replaceChildren();
    }
  }

  private showBlocks(): void {
    byId('model-blocks').replaceChildren(...this.state.blocks.map((block, i) => {
      const row = make('div', i === this.state.selected ? 'block-row selected' : 'block-row');
      const select = make('button', 'plain', `${i + 1}: ${block.outline.length} corners`);
      select.onclick = () => {
        this.state.selected = i;
        this.showBlocks();
        this.views.draw();
      };
      const height = (which: 0 | 1, label: string): HTMLInputElement => {
        const input = document.createElement('input');
        input.type = 'number';
        input.step = '0.01';
        input.className = 'number';
        input.value = String(block.z[which]);
        input.setAttribute('aria-label', label);
        input.onchange = () => {
          block.z[which] = Number(input.value);
          this.blocksChanged = true;
          this.views.draw();
        };
        return input;
      };
      const remove = make('button', 'plain', '✕');
      remove.onclick = () => {
        this.state.blocks.splice(i, 1);
        this.state.selected = -1;
        this.blocksChanged = true;
        this.showBlocks();
        this.views.draw();
      };
      row.append(select, ' z ', height(0, 'Underside, m'), ' to ', height(1, 'Top, m'), ' m', remove);
      return row;
    }));
  }

  private partRow(part: ModelPart, path: number[]): HTMLElement {
    const locked = !this.report?.here;
    const row = make('div', 'part');
    const title = make('h3', '', part.type);
    const remove = make('button', 'plain', '✕');
    remove.title = `Delete this ${part.type}`;
    remove.hidden = locked;
    remove.onclick = () => void this.change({part: path, action: 'remove'});
    title.append(remove);
    const properties = make('div', '');
    const types = part.type === 'sensor' ? ['sensor'] : ['*', part.type];
    showProperties(properties, Object.entries(part.properties).map(([name, value]) => ({name, value, own: true})), this.host.help(), {
      types, locked, of: path.join('.'), set: (name, value) => this.change({part: path, action: 'set', property: name, value}),
    });
    row.append(title, properties, ...(part.parts ?? []).map(inner => this.partRow(inner, [...path, inner.index])));
    return row;
  }

  private async change(more: object): Promise<void> {
    if (!this.report) return;
    if (this.blocksChanged && !await this.apply()) return;
    const reply = await this.client.edit('change_part', {model: this.report.name, ...more});
    if (reply.done) await this.reload();
  }

  private addPart(part: number[], type: string): Promise<void> {
    const {properties, sensor} = PARTS[type];
    return this.change({part, action: 'add', kind: type, properties, sensor});
  }

  private async reload(): Promise<void> {
    this.host.changed();
    const reply = await this.client.edit('model', {name: this.name.value});
    if (!reply.done) return;
    this.show(reply as unknown as ModelReport);
    this.showLists();
    this.views.draw();
  }

  private async apply(): Promise<boolean> {
    const properties: Record<string, string> = {};
    const before = this.report?.properties ?? {};
    if (this.color.value.trim() && this.color.value !== (before.color ?? '').replace(/"/g, '')) {
      properties.color = `"${this.color.value.trim()}"`;
    }
    for (const [id, property, initial] of FLAGS) {
      const value = byId<HTMLInputElement>(id).checked ? 1 : 0;
      if (value !== Number(before[property] ?? (initial ? 1 : 0))) properties[property] = String(value);
    }
    const {blocks} = this.state;
    if (blocks.some(({z}) => z[1] <= z[0])) {
      toast('A block has no height', true);
      return false;
    }
    const reply = await this.client.edit('set_model', {
      name: this.name.value.trim(), properties,
      ...(this.report ? {} : {base: this.base.value.trim()}),
      ...(this.blocksChanged && blocks.length > 0 ? {blocks: blocks.map(({outline, z}) => ({outline, z}))} : {}),
    });
    if (!reply.done) return false;
    this.blocksChanged = false;
    await this.reload();
    return true;
  }

  private async test(): Promise<void> {
    if ((!this.report || this.blocksChanged) && !await this.apply()) return;
    await this.host.test(this.name.value, Number(byId<HTMLInputElement>('model-probe').value) || 0.3);
    this.close();
  }
}
