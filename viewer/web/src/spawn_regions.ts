// The regions of a scenario's spawn rules: drawn on the ground, and a list to change them.
import {BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments} from 'three';
import type {Point} from './drawing';
import {byId, make} from './dom';
import type {FileClient, SpawnRule} from './file_client';
import type {WorldScene} from './scene';

export interface SpawnRegionsHost {
  models(): string[];
  changed(): void;
}

function cornersOf(region: SpawnRule['region']): Point[] {
  if (region.length === 4 && typeof region[0] === 'number') {
    const [x0, y0, x1, y1] = region as number[];
    return [{x: x0, y: y0}, {x: x1, y: y0}, {x: x1, y: y1}, {x: x0, y: y1}];
  }
  return (region as number[][]).map(([x, y]) => ({x, y}));
}

export class SpawnRegions {
  private shown = '';  // signature of the list
  private readonly lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({color: 0x2b9a5c}));

  constructor(
      private readonly scene: WorldScene, private readonly client: FileClient, private readonly host: SpawnRegionsHost) {
    this.lines.frustumCulled = false;
    scene.add(this.lines);
  }

  async add(from: Point, to: Point): Promise<void> {
    const round = (value: number): number => Math.round(value * 100) / 100;
    const model = this.host.models()[0] ?? 'position';
    const region = [Math.min(from.x, to.x), Math.min(from.y, to.y), Math.max(from.x, to.x), Math.max(from.y, to.y)].map(round);
    await this.client.edit('set_region', {rule: {model, count: 1, region}});
    this.host.changed();
  }

  show(rules: SpawnRule[], locked: boolean): void {
    const points: number[] = [];
    for (const rule of rules) {
      const corners = cornersOf(rule.region);
      corners.forEach((corner, i) => {
        const next = corners[(i + 1) % corners.length];
        points.push(corner.x, corner.y, 0.02, next.x, next.y, 0.02);
      });
    }
    this.lines.geometry.dispose();
    this.lines.geometry = new BufferGeometry();
    this.lines.geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    this.scene.invalidate();
    // A list that is open, or a number that is being typed, must stay where it is.
    const signature = JSON.stringify([rules, locked, this.host.models()]);
    if (signature === this.shown) return;
    this.shown = signature;
    byId('region-list').replaceChildren(
      ...(rules.length > 0 ? [make('h2', 'second', 'Spawn regions')] : []), ...rules.map((rule, i) => this.row(rule, i, locked)));
  }

  private row(rule: SpawnRule, index: number, locked: boolean): HTMLElement {
    const row = make('div', 'block-row');
    const change = (members: object): void => {
      void this.client.edit('set_region', {index, rule: members}).then(() => this.host.changed());
    };
    const count = document.createElement('input');
    count.type = 'number';
    count.className = 'number';
    count.min = '1';
    count.value = String(rule.count);
    count.disabled = locked;
    count.setAttribute('aria-label', 'Number of models');
    count.onchange = () => change({count: Number(count.value)});
    const model = document.createElement('select');
    model.disabled = locked;
    model.setAttribute('aria-label', 'Model');
    const names = this.host.models();
    model.append(...(names.includes(rule.model) ? names : [rule.model, ...names]).map(name => new Option(name, name, false, name === rule.model)));
    model.onchange = () => change({model: model.value});
    row.append(count, model);
    if (!locked) {
      const remove = make('button', 'plain', '✕');
      remove.title = 'Delete the spawn rule';
      remove.onclick = () => void this.client.edit('set_region', {index, rule: null}).then(() => this.host.changed());
      row.append(remove);
    }
    return row;
  }
}
