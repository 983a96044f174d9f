// PartList: the parts of a model as a list, with their properties, and the tools that add parts and build grippers.
import {byId, make, refill, setOptions, toast} from './dom';
import type {EditorHelp, GripperRole, ModelPart, ModelReport} from './file_client';
import {isBelow, pathKey, type PartShape, type PlacedPart, type Size} from './part_geometry';
import {showProperties} from './property_rows';
import type {Point2} from './sheet';

interface NewPart {
  size?: Size;  // m
  properties?: Record<string, string>;
  sensor?: Record<string, string>;
  shape?: PartShape;
  drawnHeight?: number;  // m, of a part whose outline is drawn
}

// Parts that can be added, as they begin.
const PARTS: Record<string, NewPart> = {
  ranger: {size: [0.1, 0.1, 0.1], sensor: {fov: '180', samples: '181'}},
  camera: {properties: {resolution: '[64 48]'}},
  fiducial: {properties: {range_max: '5'}},
  blobfinder: {properties: {range: '5'}},
  bumper: {properties: {bcount: '1', 'bpose[0]': '[0.2 0 0 0]', blength: '0.3'}},
  contact: {},
  gripper: {drawnHeight: 0.2},
  actuator: {size: [0.1, 0.1, 0.5], shape: {axis: [0, 0, 1]}, properties: {max_speed: '0.1'}, drawnHeight: 0.1},
  model: {size: [0.1, 0.1, 0.1]},
  blinkenlight: {},
};

const ROLES: Array<[GripperRole, string]> = [
  ['left_finger', 'left finger'], ['right_finger', 'right finger'], ['left_pad', 'left pad'],
  ['right_pad', 'right pad'], ['lift', 'lift'],
];

const CARRIERS = ['gripper', 'actuator', 'model', 'position'];  // types of models that carry parts

export interface PartListHost {
  help(): EditorHelp;
  change(more: {action: string; [member: string]: unknown}): Promise<string>;  // the reason of a refusal, else ''
  select(path: number[] | null): void;
  pick(picked: ((path: number[]) => void) | null): void;
  setDrawsPart(draws: boolean): void;
}

function valuesOf(properties: Record<string, string>): Array<{name: string; value: string; own: boolean}> {
  return Object.entries(properties).map(([name, value]) => ({name, value, own: true}));
}

export class PartList {
  private report: ModelReport | null = null;
  private parts: PlacedPart[] = [];
  private selected = '';
  private chosen: Partial<Record<GripperRole, number[]>> = {};  // of the selected gripper, until both fingers are
  private readonly type = byId<HTMLSelectElement>('part-type');
  private readonly parent = byId<HTMLSelectElement>('part-parent');

  constructor(private readonly host: PartListHost) {
    this.type.replaceChildren(...Object.keys(PARTS).map(type => new Option(type, type)));
    byId('part-add').onclick = () => void this.addDefault();
    byId('part-draw').onclick = () => {
      toast('Drag from corner to corner of the new part in the view from above, or click the corners of its outline');
      this.host.setDrawsPart(true);
    };
  }

  show(report: ModelReport | null, parts: PlacedPart[], selected: number[] | null): void {
    const key = selected ? pathKey(selected) : '';
    if (key !== this.selected || report?.name !== this.report?.name) this.chosen = {};
    this.report = report;
    this.parts = parts;
    this.selected = key;
    const locked = !report?.here;
    for (const id of ['part-add', 'part-draw']) byId<HTMLButtonElement>(id).disabled = locked;
    this.showParents();
    refill(
      byId('model-parts'), report ? report.parts.map(part => this.row(part, [part.index]))
        : [make('div', 'faint', 'Apply the model first, then add sensors, joints and grippers.')]);
    const shown = byId('model-parts').querySelector<HTMLElement>('.part.selected');
    const isCut = shown !== null && shown.getBoundingClientRect().top < byId('part-tools').getBoundingClientRect().bottom;
    shown?.scrollIntoView({block: isCut ? 'start' : 'nearest'});
  }

  // The outline of a new part is drawn.
  async drawn(outline: Point2[]): Promise<void> {
    const type = this.type.value;
    const parent = this.parentPart();
    const {properties, sensor, size, drawnHeight = size?.[2] ?? 0.1} = PARTS[type];
    const bottom = parent ? parent.pose[2] : type === 'gripper' ? 0 : this.report?.size[2] ?? 0;
    const blocks = [{outline, z: [bottom, bottom + drawnHeight]}];
    const shape = {blocks, ...(type === 'actuator' ? this.jointOf(outline, parent) : {})};
    await this.add(type, {name: this.nameOf(type, outline, parent), properties, sensor, shape});
  }

  private async addDefault(): Promise<void> {
    const type = this.type.value;
    const {properties, sensor, size, shape} = PARTS[type];
    const whole = this.report?.size ?? [0.4, 0.4, 0.3];
    // In front of its robot: on top of it a gripper reaches nothing.
    const pose = type === 'gripper' && !this.parentPart() ? {pose: [whole[0] / 2 + 0.1, 0, 0, 0]} : {};
    await this.add(type, {properties, sensor, shape: {...(size ? {size} : {}), ...shape, ...pose}});
  }

  private async add(kind: string, more: object): Promise<void> {
    const parent = this.parentPart()?.path ?? [];
    const count = this.partsBelow(parent).length;
    if (await this.host.change({part: parent, action: 'add', kind, ...more}) !== '') return;
    const added = [...parent, count];
    if (this.parts.some(({path}) => pathKey(path) === pathKey(added))) this.host.select(added);
  }

  private partsBelow(path: number[]): ModelPart[] {
    let parts = this.report?.parts ?? [];
    for (const index of path) parts = parts[index]?.parts ?? [];
    return parts;
  }

  // A part in a gripper closes towards the gripper's middle line.
  private jointOf(outline: Point2[], parent: PlacedPart | null): PartShape {
    const gripper = parent && this.gripperOf(parent);
    if (!gripper) return {axis: [0, 0, 1], limits: [0, 0.5]};
    const [x, y, , heading] = gripper.pose;
    const across = outline.map(([a, b]) => -Math.sin(heading) * (a - x) + Math.cos(heading) * (b - y));
    const [least, most] = [Math.min(...across), Math.max(...across)];
    const side = least + most > 0 ? -1 : 1;
    const travel = Math.max(0.01, side < 0 ? least : -most);
    return {axis: [-side * Math.sin(heading), side * Math.cos(heading), 0], limits: [0, travel]};
  }

  private nameOf(type: string, outline: Point2[], parent: PlacedPart | null): string | undefined {
    const gripper = parent && this.gripperOf(parent);
    if (type !== 'actuator') return undefined;
    if (!gripper) return 'joint';
    const [x, y, , heading] = gripper.pose;
    const sum = outline.reduce((all, [a, b]) => all - Math.sin(heading) * (a - x) + Math.cos(heading) * (b - y), 0);
    return sum > 0 ? 'left' : 'right';
  }

  // The gripper that a part is in, or is itself.
  private gripperOf(part: PlacedPart): PlacedPart | null {
    if (part.part.model === 'gripper') return part;
    return this.parts.find(each => each.part.model === 'gripper' && isBelow(part.path, each.path)) ?? null;
  }

  private parentPart(): PlacedPart | null {
    return this.parts.find(({path}) => pathKey(path) === this.parent.value) ?? null;
  }

  // A selected gripper carries the next parts, until nothing is selected: its fingers are drawn one after the other.
  private showParents(): void {
    const carriers = this.parts.filter(({part}) => CARRIERS.includes(part.model ?? ''));
    const selected = carriers.find(({path}) => pathKey(path) === this.selected);
    const kept = this.selected === '' ? '' : this.parent.value;
    setOptions(this.parent, [
      new Option('the model', ''), ...carriers.map(({part, path}) => new Option(part.name || part.type, pathKey(path)))]);
    const value = selected?.part.model === 'gripper' ? this.selected : kept;
    if (this.parent.value !== value) this.parent.value = value;
    if (this.parent.selectedIndex < 0) this.parent.value = '';
  }

  private row(part: ModelPart, path: number[]): HTMLElement {
    const locked = !this.report?.here;
    const row = make('div', `part${pathKey(path) === this.selected ? ' selected' : ''}`);
    const title = make('h3', '');
    const given = (part.properties.name ?? '').replace(/"/g, '');
    const name = make('button', 'plain part-name', `${part.type} ${given}`);
    name.onclick = () => this.host.select(path);
    const remove = make('button', 'plain', '✕');
    remove.title = `Delete this ${part.type}`;
    remove.hidden = locked;
    remove.onclick = () => void this.host.change({part: path, action: 'remove'});
    title.append(name, remove);
    const properties = make('div', '');
    const types = part.type === 'sensor' ? ['sensor'] : ['*', part.model ?? part.type];
    showProperties(properties, valuesOf(part.properties), this.host.help(), {
      types, locked, of: path.join('.'), units: this.report ?? {metres: 1, radians: 1},
      set: async (property, value) => this.host.change({part: path, action: 'set', property, value}),
      changed: () => {},
    });
    row.append(title, ...(part.model === 'gripper' && !locked ? [this.roleRows(part, path)] : []), properties,
               ...(part.parts ?? []).map(inner => this.row(inner, [...path, inner.index])));
    return row;
  }

  // The parts that a gripper is made of, from lists or from the picture.
  private roleRows(part: ModelPart, path: number[]): HTMLElement {
    const box = make('div', 'roles');
    const isSelected = pathKey(path) === this.selected;
    for (const [role, label] of ROLES) {
      const now = (isSelected ? this.chosen[role] : undefined) ?? part.gripper?.[role];
      const candidates = this.candidates(role, path);
      const select = document.createElement('select');
      select.dataset.role = role;
      select.setAttribute('aria-label', `${label} of ${part.name}`);
      const none = role.endsWith('finger') ? 'own paddles' : role.endsWith('pad') ? 'the finger' : 'none';
      select.append(
        new Option(none, ''), ...candidates.map(each => new Option(each.part.name, pathKey(each.path))));
      select.value = now ? pathKey(now) : '';
      select.onchange = () => {
        const chosen = select.value ? select.value.split('.').map(Number) : null;
        void this.choose(path, part, role, chosen);
      };
      const pick = make('button', 'plain', 'pick');
      pick.title = `Choose the ${label} in the picture`;
      pick.dataset.pick = role;
      pick.onclick = () => {
        toast(`Click the ${label} in one of the views`);
        this.host.select(path);
        this.host.pick(picked => {
          if (candidates.some(each => pathKey(each.path) === pathKey(picked))) {
            void this.choose(path, part, role, picked);
          } else {
            const reason = role.endsWith('pad') ? 'it is not in the gripper' : 'it is no joint of the gripper';
            toast(`This part cannot be the ${label}: ${reason}`, true);
          }
        });
      };
      const line = make('label', 'role', `${label} `);
      line.append(select, pick);
      box.append(line);
    }
    return box;
  }

  private candidates(role: GripperRole, gripper: number[]): PlacedPart[] {
    if (role === 'lift') return this.parts.filter(({part}) => part.joint !== undefined);
    const inside = this.parts.filter(({path}) => isBelow(path, gripper));
    return role.endsWith('finger') ? inside.filter(({part}) => part.joint !== undefined) : inside;
  }

  // Both fingers are changed at once: a gripper with one finger does not load.
  private async choose(path: number[], part: ModelPart, role: GripperRole, chosen: number[] | null): Promise<void> {
    const other = role === 'left_finger' ? 'right_finger' : role === 'right_finger' ? 'left_finger' : null;
    if (!other) {
      await this.host.change({part: path, action: 'roles', roles: {[role]: chosen}});
      return;
    }
    if (chosen === null) {
      this.chosen = {};
      const used = (Object.keys(part.gripper ?? {}) as string[]).filter(name => name !== 'paddle' && name !== 'lift');
      if (used.length === 0) return;
      await this.host.change({part: path, action: 'roles', roles: Object.fromEntries(used.map(name => [name, null]))});
      return;
    }
    const second = part.gripper?.[other] ?? this.chosen[other];
    if (!second) {
      this.host.select(path);
      this.chosen = {[role]: chosen};
      toast(`Choose the ${other.replace('_', ' ')}, too`);
      return;
    }
    const roles = {[role]: chosen, [other]: second};
    if (await this.host.change({part: path, action: 'roles', roles}) === '') this.chosen = {};
  }
}
