// Rows to change properties, with their help: of an entity, a model, a part, or the file itself.
import {make} from './dom';
import type {HelpRow, PictureBlock} from './file_client';

export interface ShownProperty {
  name: string;
  value: string;  // as in the file
  own: boolean;  // given here, not by a macro
  from?: string;  // the place where it is given
}

export interface PropertyTarget {
  types: string[];  // of the help that applies, for instance ['*', 'position']
  locked: boolean;
  of: string;  // whose properties they are
  set(name: string, value: string | null): Promise<void>;  // null: remove it
}

function helpText(row: HelpRow | undefined): string {
  if (!row) return '';
  const form = row.form ? ` [${row.form}]` : '';
  const unit = row.unit ? ` (${row.unit})` : '';
  const initial = row.initial ? `, default ${row.initial}` : '';
  return `${row.help}${form}${unit}${initial}`;
}

// The value in the form that the property has: a user need not type the quotes of a text.
export function asWritten(row: HelpRow | undefined, text: string): string {
  const trimmed = text.trim();
  const isText = row && (row.form === 'text' || row.form.includes('|'));
  if (isText && !trimmed.startsWith('"') && !trimmed.startsWith('[')) return `"${trimmed}"`;
  const isTuple = row && row.form.includes(' ') && !row.form.includes('|');
  return isTuple && trimmed !== '' && !trimmed.startsWith('[') ? `[${trimmed}]` : trimmed;
}

export function showProperties(parent: HTMLElement, shown: ShownProperty[], help: HelpRow[], target: PropertyTarget): void {
  // What a user types is not replaced by what the file had before, and an unchanged form stays as it is.
  const active = document.activeElement;
  if (active instanceof HTMLInputElement && parent.contains(active) && active.value !== active.dataset.shown) return;
  const signature = JSON.stringify([shown, target.types, target.locked, help.length]);
  if (parent.dataset.signature === signature && parent.dataset.of === target.of) return;
  Object.assign(parent.dataset, {signature, of: target.of});
  const known = help.filter(row => target.types.includes(row.type));
  const rowOf = (name: string): HelpRow | undefined => known.find(row => row.name === name.replace(/\[\d+\]$/, ''));
  const rows = shown.map(property => {
    const line = make('div', property.own ? 'property' : 'property inherited');
    const label = make('span', '', property.name);
    label.title = [helpText(rowOf(property.name)), property.from ? `given at ${property.from}` : ''].filter(Boolean).join('\n');
    const input = document.createElement('input');
    input.value = property.value;
    input.disabled = target.locked;
    input.dataset.property = property.name;
    input.setAttribute('aria-label', property.name);
    input.dataset.shown = property.value;
    input.onchange = () => {
      input.dataset.shown = input.value;
      void target.set(property.name, asWritten(rowOf(property.name), input.value));
    };
    line.append(label, input);
    if (property.own && !target.locked) {
      const remove = make('button', 'plain', '✕');
      remove.title = `Remove ${property.name}`;
      remove.onclick = () => void target.set(property.name, null);
      line.append(remove);
    }
    return line;
  });
  parent.replaceChildren(...rows);
  if (target.locked) return;
  const line = make('div', 'property');
  const select = document.createElement('select');
  select.setAttribute('aria-label', 'Property to add');
  const given = new Set(shown.map(property => property.name));
  select.append(new Option('add …', ''), ...known.filter(row => !given.has(row.name)).map(row => {
    const option = new Option(row.name, row.name);
    option.title = helpText(row);
    return option;
  }));
  const input = document.createElement('input');
  input.hidden = true;
  input.setAttribute('aria-label', 'Its value');
  select.onchange = () => {
    const row = rowOf(select.value);
    input.hidden = !row;
    input.value = input.dataset.shown = row?.initial ?? '';
    input.placeholder = row?.form ?? '';
    input.title = helpText(row);
    input.focus();
  };
  const add = (): void => {
    if (select.value && input.value.trim()) void target.set(select.value, asWritten(rowOf(select.value), input.value));
  };
  input.onkeydown = event => {
    if (event.key === 'Enter') add();
  };
  const button = make('button', 'plain', '+');
  button.title = 'Add the property';
  button.onclick = add;
  line.append(select, input, button);
  parent.append(line);
}

// A small picture of a model, drawn from behind and above: its blocks from the lowest and farthest on.

export function drawPicture(canvas: HTMLCanvasElement, blocks: PictureBlock[]): void {
  const context = canvas.getContext('2d');
  if (!context || blocks.length === 0) return;
  const project = (x: number, y: number, z: number): [number, number] => [0.87 * (x - y), 0.5 * (x + y) + 0.9 * z];
  let [minX, maxX, minY, maxY] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const {outline, z} of blocks) {
    for (const [x, y] of outline) {
      for (const height of z) {
        const [u, v] = project(x, y, height);
        minX = Math.min(minX, u);
        maxX = Math.max(maxX, u);
        minY = Math.min(minY, v);
        maxY = Math.max(maxY, v);
      }
    }
  }
  const scale = 0.88 * Math.min(canvas.width / Math.max(maxX - minX, 1e-3), canvas.height / Math.max(maxY - minY, 1e-3));
  const at = (x: number, y: number, z: number): [number, number] => {
    const [u, v] = project(x, y, z);
    return [
      canvas.width / 2 + scale * (u - (minX + maxX) / 2), canvas.height / 2 - scale * (v - (minY + maxY) / 2),
    ];
  };
  const far = (block: PictureBlock): number =>
    block.z[0] * 1000 - block.outline.reduce((sum, [x, y]) => sum + x + y, 0) / block.outline.length;
  for (const block of [...blocks].sort((a, b) => far(a) - far(b))) {
    const {outline, z, color = [0.6, 0.6, 0.6]} = block;
    const shade = (factor: number): string => `rgb(${color.map(c => Math.round(255 * Math.min(1, c * factor + 0.06))).join(',')})`;
    const face = (points: Array<[number, number]>, fill: string): void => {
      context.fillStyle = fill;
      context.beginPath();
      points.forEach(([u, v], i) => (i === 0 ? context.moveTo(u, v) : context.lineTo(u, v)));
      context.closePath();
      context.fill();
      context.strokeStyle = 'rgba(0,0,0,0.25)';
      context.lineWidth = 0.5;
      context.stroke();
    };
    const sides = outline.map((a, i) => [a, outline[(i + 1) % outline.length]] as const);
    sides.sort(([a, b], [c, d]) => (c[0] + c[1] + d[0] + d[1]) - (a[0] + a[1] + b[0] + b[1]));
    for (const [a, b] of sides) {
      face([at(a[0], a[1], z[0]), at(b[0], b[1], z[0]), at(b[0], b[1], z[1]), at(a[0], a[1], z[1])],
           shade(Math.abs(a[0] - b[0]) > Math.abs(a[1] - b[1]) ? 0.8 : 0.65));
    }
    face(outline.map(([x, y]) => at(x, y, z[1])), shade(1));
  }
}
