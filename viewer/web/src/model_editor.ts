// ModelEditor: draws a model of the file: its blocks, colour, parts and properties.
//
// Blocks are edited here and sent as a whole when they are applied; parts are changed by requests of their own, at
// once. Metres and radians in the frame of the model; the gateway converts to the file's units and fits blocks to the
// model's size.
import {byId, make, setText, toast} from './dom';
import {stageController} from './controller_form';
import type {EditorHelp, FileClient, ModelPart, ModelReport} from './file_client';
import {ModelViews, type Fan, type ViewsState} from './model_views';
import {placedParts} from './part_geometry';
import {ModelScene} from './model_scene';
import {PartList} from './part_list';
import {nearestColor, pickerOf} from './property_fields';
import {showProperties} from './property_rows';

const FLAGS: Array<[string, string, boolean]> = [
  ['model-collides', 'obstacle_return', true], ['model-movable', 'gripper_return', false],
];

export interface ModelEditorHost {
  help(): EditorHelp;
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
  private readonly parts: PartList;
  private scene: ModelScene | null = null;  // made when it is seen first
  private report: ModelReport | null = null;  // null: a new model
  private blocksChanged = false;
  private readonly box = byId('model-editor');
  private readonly name = byId<HTMLInputElement>('model-name');
  private readonly base = byId<HTMLInputElement>('model-base');
  private readonly color = byId<HTMLInputElement>('model-color');

  constructor(private readonly client: FileClient, private readonly host: ModelEditorHost) {
    this.views = new ModelViews(byId('model-top'), byId('model-side'), this.state, {
      blocksChanged: () => {
        this.blocksChanged = true;
        this.showBlocks();
        this.showBody();
      },
      partDrawn: outline => void this.parts.drawn(outline),
      partSelected: path => this.showParts(path),
      partShaped: (path, shape) => void this.change({part: path, action: 'shape', shape}),
    });
    this.parts = new PartList({
      help: () => this.host.help(),
      change: more => this.change(more),
      select: path => {
        this.views.parts.select(path);
        this.showParts(path);
        this.views.draw();
      },
      pick: picked => this.views.parts.setPick(picked),
      setDrawsPart: draws => this.views.setDrawsPart(draws),
    });
    this.color.oninput = () => this.showBody();
    byId('model-close').onclick = () => this.close();
    byId('model-apply').onclick = () => void this.apply();
    byId('model-test').onclick = () => void this.test();
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
    this.views.parts.setParts([]);
    this.name.value = '';
    this.base.value = 'model';
    this.color.value = 'gray60';
    for (const [id, , initial] of FLAGS) byId<HTMLInputElement>(id).checked = initial;
    this.open();
  }

  async openModel(name: string): Promise<void> {
    const reply = await this.client.edit('model', {name});
    if (!reply.done) return;
    this.views.parts.select(null);
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
    this.scene ??= new ModelScene(byId<HTMLCanvasElement>('model-body'));
    this.showLists();
    this.showBody();
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
    this.state.others = report.others;
    this.views.parts.setParts(placedParts(report.parts));
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
    setText(byId('model-error'), locked ? 'of an included file: edit it there' : '');
    this.showBlocks();
    this.showParts(this.views.parts.selectedPart()?.path ?? null);
    const type = this.report?.base_type ?? 'model';
    if (this.report) {
      const {properties, own} = this.report;
      const shown = Object.keys(properties).map(name => ({name, value: own[name] ?? properties[name], own: name in own}));
      const set = (property: string, value: string | null): Promise<string> =>
        this.change({part: [], action: 'set', property, value});
      const help = this.host.help();
      showProperties(byId('model-properties'), shown, help, {
        types: ['*', type], locked, of: this.report.name, units: this.report, set, changed: () => {},
        ...(type === 'position' ? {controller: stageController(
          (properties.ctrl ?? '').replace(/^"|"$/g, ''), this.report.name, 'ctrl' in own || !properties.ctrl, locked, help,
          value => set('ctrl', value))} : {}),
      });
    } else {
      byId('model-properties').replaceChildren();
    }
  }

  private bodyColor(): [number, number, number] {
    return this.host.help().colors[this.color.value.trim()] ?? [153, 153, 153];
  }

  private showBody(): void {
    const {blocks, others} = this.state;
    const parts = this.views.parts.parts.flatMap(({part}) => part.bodies ?? []);
    this.scene?.show([...blocks.map(({outline, z}) => ({outline, z})), ...parts, ...others], `rgb(${this.bodyColor().join(',')})`);
    const locked = this.report !== null && !this.report.here;
    byId('model-picker').replaceChildren(pickerOf({name: 'the colour of the model', locked}, this.bodyColor(), rgb => {
      this.color.value = nearestColor(rgb, this.host.help().colors);
      this.showBody();
    }));
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
          this.showBody();
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
        this.showBody();
        this.views.draw();
      };
      row.append(select, ' z ', height(0, 'Underside, m'), ' to ', height(1, 'Top, m'), ' m', remove);
      return row;
    }));
  }

  private showParts(selected: number[] | null): void {
    this.parts.show(this.report, this.views.parts.parts, selected);
  }

  // True if the file is changed so.
  // Gives the reason of a refusal, else ''. The text of a property that is refused stays in its field.
  private async change(more: {action: string; [member: string]: unknown}): Promise<string> {
    if (!this.report) return 'there is no model';
    if (this.blocksChanged && !await this.apply()) return 'the blocks are refused';
    const {done, problem} = await this.client.edit('change_part', {model: this.report.name, ...more});
    if (done || more.action !== 'set') await this.reload();
    return done ? '' : problem;
  }

  private async reload(): Promise<void> {
    this.host.changed();
    const reply = await this.client.edit('model', {name: this.name.value});
    if (!reply.done) return;
    this.show(reply as unknown as ModelReport);
    this.showLists();
    this.showBody();
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
