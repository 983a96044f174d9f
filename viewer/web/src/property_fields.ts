// Fields for the values of properties, by the forms of the table in worldfile/edit: numbers with units, tuples element by
// element, choices, flags, colours. Each shows the value as the file has it, and reports its change as text of a file.
// What a field reports is text of a file and not a number, because the file is edited as text: 0.10 stays 0.10 until a
// user changes it.
import {make} from './dom';
import type {HelpRow} from './file_client';

export interface FileUnits {
  metres: number;  // per unit of length
  radians: number;  // per unit of angle
}

export interface FieldSetting {
  row?: HelpRow;  // none: a property that is not known
  name: string;
  value: string;  // as in the file; empty: not given
  locked: boolean;
  units: FileUnits;
  colors: Record<string, [number, number, number]>;
  set(value: string): void;  // as in a file
}

const WITHOUT_EFFECT = ['zmin', 'zmax'];  // elements that the file has, and nothing heeds
const LAST_UNIT = ['heading', 'amin', 'amax', 'angle', 'proportional'];  // elements with the last one of two units

function inFile(unit: string, {metres, radians}: FileUnits): string {
  const length = metres === 0.01 ? 'cm' : metres === 0.001 ? 'mm' : 'm';
  return unit.replace(/^m(?=$|\/)/, length).replace(/^deg(?=$|\/)/, radians === 1 ? 'rad' : '°').replace(/([ms])2/g, '$1²').replace(/^(proportion|0 to 1)$/, '');
}

export function helpText(row: HelpRow | undefined): string {
  if (!row) return '';
  const unit = row.unit ? ` (${row.unit})` : '';
  const initial = row.initial ? `, default ${row.initial}` : '';
  return `${row.help}${unit}${initial}`;
}

const isNumber = (text: string): boolean => /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(text.trim());

// The elements of "[a b c]", or of a single value.
function elementsOf(value: string): string[] {
  return value.trim().replace(/^\[|\]$/g, '').trim().split(/[\s,]+/).filter(Boolean);
}

function unquoted(value: string): string {
  const trimmed = value.trim();
  return /^"[^"]*"$/.test(trimmed) ? trimmed.slice(1, -1) : trimmed;
}

function inputOf(setting: FieldSetting, label: string, shown: string): HTMLInputElement {
  const input = document.createElement('input');
  input.value = shown;
  input.disabled = setting.locked;
  input.dataset.property = setting.name;
  input.dataset.shown = shown;
  input.setAttribute('aria-label', label);
  return input;
}

// A number in its unit. `least` and `most`: a value beyond them has a visible warning, and is not refused here.
export function numberField(
    input: HTMLInputElement, unit: string, range: {least?: number; most?: number}, set: (text: string) => void): HTMLElement {
  const box = make('span', 'field-number');
  input.type = 'number';
  input.step = 'any';
  const note = make('span', 'field-warning');
  note.setAttribute('role', 'alert');
  const check = (): void => {
    const value = Number(input.value);
    const {least = -Infinity, most = Infinity} = range;
    const wrong = input.value !== '' && (value < least || value > most);
    const text = least === -Infinity ? `expected at most ${most}` : most === Infinity ? `expected at least ${least}`
      : `expected ${least} to ${Math.round(most * 1e4) / 1e4}`;
    note.textContent = wrong ? `${text}${unit ? ` ${unit}` : ''}` : '';
    input.classList.toggle('wrong', wrong);
    input.setAttribute('aria-invalid', String(wrong));
  };
  input.oninput = check;
  check();
  input.onchange = () => {
    if (input.validity.badInput) return;
    input.dataset.shown = input.value;
    set(input.value.trim());
  };
  box.append(input);
  if (unit) box.append(make('span', 'field-unit', unit));
  box.append(note);
  return box;
}

function rangeOf(row: HelpRow): {least?: number; most?: number} {
  return row.unit === '0 to 1' ? {least: 0, most: 1} : {};
}

function tupleField(setting: FieldSetting, row: HelpRow, names: string[]): HTMLElement | null {
  const given = elementsOf(setting.value);
  if (setting.value !== '' && (given.length !== names.length || !given.every(isNumber))) return null;
  const initial = elementsOf(row.initial);
  const units = row.unit.split(', ');
  const box = make('span', names.length === 3 ? 'field-tuple three' : 'field-tuple');
  names.forEach((name, i) => {
    if (WITHOUT_EFFECT.includes(name)) return;
    const unit = inFile(LAST_UNIT.includes(name) ? units[units.length - 1] : units[0], setting.units);
    const input = inputOf(setting, `${setting.name} ${name}`, given[i] ?? '');
    input.dataset.element = name;
    input.placeholder = initial[i] ?? '';
    input.title = name;
    const label = make('label', 'field-element');
    label.append(make('span', 'field-name', name), numberField(input, unit, rangeOf(row), text => {
      const elements = names.map((_, j) => given[j] ?? initial[j] ?? '0');
      elements[i] = text === '' ? initial[i] ?? '0' : text;
      setting.set(`[${elements.join(' ')}]`);
    }));
    box.append(label);
  });
  return box;
}

function choiceField(setting: FieldSetting, row: HelpRow): HTMLElement {
  const select = document.createElement('select');
  const choices = row.form.split('|');
  const value = unquoted(setting.value);
  if (value !== '' && !choices.includes(value)) select.append(new Option(value, value));
  select.append(...choices.map(choice => new Option(choice, choice)));
  select.value = value || unquoted(row.initial) || choices[0];
  select.disabled = setting.locked;
  select.dataset.property = setting.name;
  select.setAttribute('aria-label', setting.name);
  select.onchange = () => setting.set(`"${select.value}"`);
  return select;
}

function flagField(setting: FieldSetting, row: HelpRow): HTMLElement {
  const input = inputOf(setting, setting.name, setting.value);
  input.type = 'checkbox';
  delete input.dataset.shown;  // its value is not what is shown
  input.checked = Number(setting.value || row.initial || 0) !== 0;
  input.onchange = () => setting.set(input.checked ? '1' : '0');
  return input;
}

const hex = (rgb: number[]): string => `#${rgb.map(c => Math.round(c).toString(16).padStart(2, '0')).join('')}`;

function rgbOf(text: string): number[] {
  return [1, 3, 5].map(i => parseInt(text.slice(i, i + 2), 16));
}

// The name of the colour that is nearest to an eye; numbered shades and aliases count less.
export function nearestColor(rgb: number[], colors: FieldSetting['colors']): string {
  let best = '';
  let least = Infinity;
  for (const [name, [r, g, b]] of Object.entries(colors)) {
    const distance = 2 * (r - rgb[0]) ** 2 + 4 * (g - rgb[1]) ** 2 + 3 * (b - rgb[2]) ** 2 + (/\d|Grey|grey/.test(name) ? 0.5 : 0)
      + (/\s/.test(name) ? 0.7 : 0);
    if (distance < least) [best, least] = [name, distance];
  }
  return best;
}

// A name with the picker of the browser, which chooses the nearest name.
function colorField(setting: FieldSetting, row: HelpRow): HTMLElement {
  const box = make('span', 'field-color');
  const name = unquoted(setting.value);
  const input = inputOf(setting, setting.name, name);
  input.placeholder = unquoted(row.initial);
  input.onchange = () => {
    input.dataset.shown = input.value;
    setting.set(`"${input.value.trim().replace(/"/g, '')}"`);
  };
  box.append(pickerOf(setting, setting.colors[name] ?? setting.colors[unquoted(row.initial)] ?? [255, 0, 0], rgb => {
    setting.set(`"${nearestColor(rgb, setting.colors)}"`);
  }), input);
  return box;
}

export function pickerOf(
    {name, locked}: {name: string; locked: boolean}, rgb: number[], picked: (rgb: number[]) => void): HTMLInputElement {
  const picker = document.createElement('input');
  picker.type = 'color';
  picker.value = hex(rgb);
  picker.disabled = locked;
  picker.dataset.picker = name;
  picker.title = 'Choose a colour';
  picker.setAttribute('aria-label', `Choose ${name}`);
  picker.onchange = () => picked(rgbOf(picker.value));
  return picker;
}

function rgbaField(setting: FieldSetting, row: HelpRow): HTMLElement | null {
  const tuple = tupleField(setting, row, row.form.split(' '));
  if (!tuple) return null;
  const given = elementsOf(setting.value).map(Number);
  const round = (value: number): string => String(Math.round((value / 255) * 1000) / 1000);
  const box = make('span', 'field-rgba');
  box.append(pickerOf(setting, given.length === 4 ? given.slice(0, 3).map(c => 255 * Math.min(1, Math.max(0, c))) : [255, 0, 0], rgb => {
    setting.set(`[${rgb.map(round).join(' ')} ${given[3] ?? 1}]`);
  }), tuple);
  return box;
}

function textField(setting: FieldSetting, isText: boolean): HTMLElement {
  const input = inputOf(setting, setting.name, isText ? unquoted(setting.value) : setting.value);
  input.placeholder = isText ? unquoted(setting.row?.initial ?? '') : setting.row?.initial ?? '';
  input.onchange = () => {
    input.dataset.shown = input.value;
    const text = input.value.trim();
    setting.set(isText && !text.startsWith('"') && !text.startsWith('[') ? `"${text}"` : text);
  };
  return input;
}

// The field of a property. A value that does not have its form is a plain text, as the file has it.
export function fieldOf(setting: FieldSetting): HTMLElement {
  const {row, value} = setting;
  const plain = (): HTMLElement => textField(setting, false);
  if (!row) return plain();
  if (row.form === 'flag' && (value === '' || isNumber(value))) return flagField(setting, row);
  if (row.form === 'number' && (value === '' || isNumber(value))) {
    const input = inputOf(setting, setting.name, value);
    input.placeholder = row.initial;
    return numberField(input, inFile(row.unit, setting.units), rangeOf(row), text => setting.set(text));
  }
  if (row.form.includes('|')) return choiceField(setting, row);
  if (row.form === 'color') return colorField(setting, row);
  if (row.form === 'text' || row.form === 'controller') return textField(setting, true);
  if (row.form === 'r g b a') return rgbaField(setting, row) ?? plain();
  if (row.form.includes(' ')) return tupleField(setting, row, row.form.split(' ')) ?? plain();
  return plain();
}
