// Forms of what robots are told to do step by step: the steps and places of `fetch`, the commands of `script`. Angles are
// degrees here and radians in the file.
import {make} from './dom';
import {numberField} from './property_fields';
import type {Waypoints} from './waypoint_drawing';

type Json = unknown;
type Row = Record<string, Json>;

export interface TaskForm {
  locked: boolean;
  // The whole list.
  set(rows: Json): void;
  // Lets the user click a point in the picture.
  pick?: (done: (waypoints: Waypoints) => void) => void;
  places: string[];  // their names, for steps
}

const DEGREE = Math.PI / 180;

const rounded = (value: number, digits: number): number => Number(value.toFixed(digits));
export const inDegrees = (radians: number): number => rounded(radians / DEGREE, 3);
export const inRadians = (degrees: number): number => rounded(degrees * DEGREE, 6);

interface Unit {
  unit: string;
  shown(value: number): number;
  stored(value: number): number;
}

function unitOf(unit: string): Unit {
  const isAngle = unit.startsWith('°');
  return {unit, shown: isAngle ? inDegrees : value => value, stored: isAngle ? inRadians : value => value};
}

function number(label: string, unit: string, value: Json, form: TaskForm, set: (value: number | null) => void): HTMLElement {
  const {shown, stored} = unitOf(unit);
  const box = make('label', 'task-field');
  const input = document.createElement('input');
  input.disabled = form.locked;
  input.setAttribute('aria-label', label);
  input.dataset.task = label;
  input.value = input.dataset.shown = typeof value === 'number' ? String(shown(value)) : '';
  box.append(make('span', 'field-name', label), numberField(input, unit, {}, text => set(text === '' ? null : stored(Number(text)))));
  return box;
}

function choice(label: string, options: Array<[string, string]>, value: string, form: TaskForm, set: (value: string) => void): HTMLSelectElement {
  const select = document.createElement('select');
  select.disabled = form.locked;
  select.setAttribute('aria-label', label);
  select.dataset.task = label;
  select.append(...options.map(([name, text]) => new Option(text, name)));
  select.value = value;
  select.onchange = () => set(select.value);
  return select;
}

function textField(label: string, value: string, form: TaskForm, set: (text: string) => void): HTMLInputElement {
  const input = document.createElement('input');
  input.disabled = form.locked;
  input.value = input.dataset.shown = value;
  input.placeholder = label;
  input.setAttribute('aria-label', label);
  input.dataset.task = label;
  input.onchange = () => {
    input.dataset.shown = input.value;
    set(input.value.trim());
  };
  return input;
}

function button(text: string, title: string, action: () => void): HTMLElement {
  const made = make('button', 'plain', text);
  made.title = made.ariaLabel = title;
  made.onclick = action;
  return made;
}

// The rows of a list, each with its fields; rows move up and are deleted.
function list(rows: Json[], form: TaskForm, what: string, fields: (row: Json, set: (next: Json) => void) => HTMLElement[], first: Json): HTMLElement {
  const box = make('div', 'tasks');
  const changed = (change: (next: Json[]) => void): void => {
    const next = [...rows];
    change(next);
    form.set(next);
  };
  rows.forEach((row, i) => {
    const line = make('div', 'task');
    line.append(make('span', 'faint task-number', String(i + 1)), ...fields(row, next => changed(all => { all[i] = next; })));
    if (!form.locked) {
      line.append(
        ...(i > 0 ? [button('↑', `Move ${what} ${i + 1} up`, () => changed(all => { [all[i - 1], all[i]] = [all[i], all[i - 1]]; }))] : []),
        button('✕', `Delete ${what} ${i + 1}`, () => changed(all => { all.splice(i, 1); })));
    }
    box.append(line);
  });
  if (!form.locked) {
    const add = make('button', 'small', `Add ${what}`);
    add.dataset.add = what;
    add.onclick = () => changed(all => { all.push(first); });
    box.append(add);
  }
  return box;
}

const PLACE = [['x', 'm'], ['y', 'm'], ['heading', '°'], ['lift', '%']] as const;

function placeFields(at: number[], form: TaskForm, set: (at: number[]) => void): HTMLElement[] {
  const fields = PLACE.map(([name, unit], i) => number(name, unit, at[i] ?? 0, form, value => {
    const next = PLACE.map((_, j) => at[j] ?? 0);
    next[i] = value ?? 0;
    set(next);
  }));
  if (form.pick && !form.locked) {
    fields.push(button('✎', 'Click the place in the picture', () => form.pick?.(([point]) => set([point[0], point[1], at[2] ?? 0, at[3] ?? 0]))));
  }
  return fields;
}

const STEPS: Array<[string, string, Json]> = [
  ['take', 'take', ''], ['put', 'put down', ''], ['go_to', 'go to', [0, 0]], ['turn_to', 'turn to', 0], ['drive', 'drive', 0.5],
  ['push', 'push', 0.5], ['gripper', 'gripper', 'open'], ['lift', 'lift', 50], ['wait', 'wait', 1], ['wait_until', 'wait until', 10],
];
const STEP_UNITS: Record<string, string> = {turn_to: '°', drive: 'm', push: 'm', lift: '%', wait: 's', wait_until: 's'};

function stepFields(step: Json, form: TaskForm, set: (next: Json) => void): HTMLElement[] {
  const [kind = 'wait', value] = Object.entries((step ?? {}) as Row)[0] ?? [];
  const initial = (name: string): Json => {
    const [, , given] = STEPS.find(([each]) => each === name)!;
    return given === '' ? form.places[0] ?? [1, 0, 0, 0] : given;
  };
  const kinds = STEPS.map(([name, text]): [string, string] => [name, text]);
  const first = choice('step', kinds, kind, form, name => set({[name]: initial(name)}));
  const change = (next: Json): void => set({[kind]: next});
  if (kind === 'take' || kind === 'put') {
    const isPoint = Array.isArray(value);
    const where = choice('place', [...form.places.map((name): [string, string] => [name, name]), ['', 'a point']], isPoint ? '' : String(value), form,
                         name => change(name === '' ? [1, 0, 0, 0] : name));
    return [first, where, ...(isPoint ? placeFields(value as number[], form, change) : [])];
  }
  if (kind === 'go_to') {
    const [x, y] = value as number[];
    const pick = form.pick && !form.locked ? [button('✎', 'Click the point in the picture', () => form.pick?.(([point]) => change(point)))] : [];
    return [first, number('x', 'm', x, form, next => change([next ?? 0, y])), number('y', 'm', y, form, next => change([x, next ?? 0])), ...pick];
  }
  if (kind === 'gripper') return [first, choice('fingers', [['open', 'open'], ['close', 'close']], String(value), form, change)];
  return [first, number(kind.replace('_', ' '), STEP_UNITS[kind] ?? '', value, form, next => change(next ?? 0))];
}

const COMMAND = [['at', 's'], ['vx', 'm/s'], ['vy', 'm/s'], ['wz', '°/s'], ['speed', 'm/s'], ['steering', '°'], ['lift', '%']] as const;
const ALWAYS = ['at', 'vx', 'wz'];  // others only where they are given
const MORE = ['gripper', 'lift', 'say', 'vy', 'speed', 'steering'];

function commandFields(row: Json, form: TaskForm, set: (next: Json) => void): HTMLElement[] {
  const command = (row ?? {}) as Row;
  const change = (key: string, value: Json): void => {
    const next = {...command, [key]: value};
    if (value === null || value === '') delete next[key];
    set(next);
  };
  const isCar = 'speed' in command || 'steering' in command;
  const shown = COMMAND.filter(([name]) => name in command || (ALWAYS.includes(name) && !(isCar && name !== 'at')));
  const fields = shown.map(([name, unit]) => typeof command[name] === 'string'
    ? textField(name, String(command[name]), form, text => change(name, text))
    : number(name, unit, command[name], form, value => change(name, name === 'at' ? value ?? 0 : value)));
  if ('gripper' in command) {
    fields.push(choice('fingers', [['', 'as before'], ['open', 'open'], ['close', 'close']], String(command.gripper), form, value => change('gripper', value)));
  }
  if ('say' in command) fields.push(textField('say', String(command.say), form, text => change('say', text)));
  const others = Object.fromEntries(Object.entries(command).filter(([key]) => !COMMAND.some(([name]) => name === key) && !['gripper', 'say'].includes(key)));
  if (Object.keys(others).length > 0) {
    fields.push(textField('more', JSON.stringify(others), form, text => {
      try {
        const rest = JSON.parse(text === '' ? '{}' : text) as Row;
        set({...Object.fromEntries(Object.entries(command).filter(([key]) => !(key in others))), ...rest});
      } catch {
        // The text stays as it is typed.
      }
    }));
  }
  if (!form.locked) {
    const rest = MORE.filter(name => !(name in command));
    const initial: Row = {gripper: 'close', lift: 50, say: 'hello', vy: 0, speed: 0.3, steering: 0};
    fields.push(choice('also', [['', '+'], ...rest.map((name): [string, string] => [name, name])], '', form, name => name && change(name, initial[name])));
  }
  return fields;
}

// The form of a parameter; null: it has none.
export function taskForm(controller: string, parameter: string, value: Json, form: TaskForm): HTMLElement | null {
  const rows = Array.isArray(value) ? value : [];
  if (controller === 'fetch' && parameter === 'steps') {
    return list(rows, form, 'step', (row, set) => stepFields(row, form, set), {take: form.places[0] ?? [1, 0, 0, 0]});
  }
  if (controller === 'fetch' && parameter === 'places') {
    return list(rows, form, 'place', (row, set) => {
      const place = (row ?? {}) as {name?: string; at?: number[]};
      return [textField('name', place.name ?? '', form, name => set({...place, name})), ...placeFields(place.at ?? [], form, at => set({...place, at}))];
    }, {name: `place${rows.length + 1}`, at: [1, 0, 0, 0]});
  }
  if (controller === 'script' && parameter === 'commands') {
    const last = rows[rows.length - 1] as {at?: number} | undefined;
    return list(rows, form, 'command', (row, set) => commandFields(row, form, set), {at: rounded((last?.at ?? -1) + 1, 3), vx: 0.3});
  }
  return null;
}
