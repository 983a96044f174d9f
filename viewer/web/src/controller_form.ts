// The controller of a robot: chosen from a list, with its parameters. A Stage file has it as a text, `ctrl "wander
// speed=0.5"`, a scenario as an object; both are one ControllerTarget here.
// A form writes nothing by itself: each change becomes one edit of the file by its target, so that it can be undone as
// one.
import {make, toast} from './dom';
import type {ControllerHelp, EditorHelp, ParameterHelp} from './file_client';
import {attempt} from './failures';
import {numberField} from './property_fields';
import {inDegrees, inRadians, taskForm} from './task_forms';
import type {Waypoints} from './waypoint_drawing';

export interface ControllerTarget {
  shown: {name: string; parameters: Record<string, unknown>; own: boolean};  // name: as the file has it; '': none
  locked: boolean;
  isStage: boolean;
  of: string;  // whose controller it is
  // Both give the reason of a refusal, else ''.
  choose(name: string | null): Promise<string>;  // null: none
  set(parameter: string, value: unknown): Promise<string>;  // null: the default
  // In the picture, from the robot on; none: it has no place there. `single`: one point.
  draw?: (done: (waypoints: Waypoints) => void, single?: boolean) => void;
}

const NEEDS_TEXTS = ['script', 'fetch'];  // parameters with texts in them, which a `ctrl` cannot have

const WAYPOINTS = 'waypoints';  // of all controllers that have them: [[x, y], ...], m in the world

// The arguments of a `ctrl` text, each with the parameter that it is.
interface Argument {
  key: string;
  value: string;
  named: boolean;
}

function argumentsOf(words: string[], positions: string[]): Argument[] {
  let next = 0;
  return words.map(word => {
    const equal = word.indexOf('=');
    return equal >= 0 ? {key: word.slice(0, equal), value: word.slice(equal + 1), named: true}
      : {key: positions[next++] ?? '', value: word, named: false};
  });
}

function parsed(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    return /^[-+]?\.?\d/.test(text) && Number.isFinite(Number(text)) ? Number(text) : text;
  }
}

// `text`: of `ctrl`, without its quotes. `change`: of `ctrl`, with its quotes; null: it is removed.
export function stageController(
    text: string, of: string, own: boolean, locked: boolean, help: EditorHelp, change: (value: string | null) => Promise<string>,
    draw?: ControllerTarget['draw']): ControllerTarget {
  const [name = '', ...words] = text.trim().split(/\s+/).filter(Boolean);
  const positions = help.stage_controllers[name]?.arguments ?? [];
  const given = argumentsOf(words, positions);
  const write = (next: Argument[], controller = name): Promise<string> => {
    let place = 0;
    const written = next.map(({key, value, named}) => {
      const isNext = !named && (key === '' || positions[place] === key);
      if (isNext) ++place;
      return isNext ? value : `${key}=${value}`;
    });
    return change(`"${[controller, ...written].join(' ')}"`);
  };
  return {
    shown: {name, parameters: Object.fromEntries(given.filter(({key}) => key).map(({key, value}) => [key, parsed(value)])), own},
    locked, of, isStage: true, draw,
    choose: async chosen => {
      if (chosen === null) return change(null);
      const needed = help.controllers.find(each => each.name === chosen)?.parameters.filter(each => each.needed) ?? [];
      return write(needed.map(({name: key, initial}) => ({key, value: JSON.stringify(initial), named: true})), chosen);
    },
    set: async (key, value) => {
      const written = JSON.stringify(value);
      if (written.includes('"')) {
        const problem = 'A text cannot be a parameter in a world file: name the controller in a scenario';
        toast(problem, true);
        return problem;
      }
      if (value === null) return write(given.filter(each => each.key !== key));
      if (!given.some(each => each.key === key)) return write([...given, {key, value: written, named: true}]);
      return write(given.map(each => (each.key === key ? {...each, value: written} : each)));
    },
  };
}

// The range of an angle in degrees.
function rangeInDegrees({least, most}: ParameterHelp): {least?: number; most?: number} {
  const shown = (limit: number | undefined): {value?: number} => (limit === undefined ? {} : {value: Math.round(inDegrees(limit))});
  return {least: shown(least).value, most: shown(most).value};
}

function valueField(row: ParameterHelp, value: unknown, locked: boolean, change: (value: unknown, event?: Event) => void): HTMLElement {
  const input = document.createElement('input');
  input.disabled = locked;
  input.dataset.parameter = row.name;
  input.setAttribute('aria-label', row.name);
  if (row.form === 'flag') {
    input.type = 'checkbox';
    input.checked = (value ?? row.initial) === true;
    input.onchange = () => change(input.checked);
    return input;
  }
  let event: Event | undefined;
  input.addEventListener('change', each => { event = each; }, {capture: true});
  const set = (next: unknown): void => change(next, event);
  if (row.form === 'number' && row.unit.startsWith('rad') && (value === undefined || typeof value === 'number')) {
    input.value = input.dataset.shown = value === undefined ? '' : String(inDegrees(value));
    input.placeholder = typeof row.initial === 'number' && !row.needed ? String(inDegrees(row.initial)) : '';
    return numberField(input, row.unit.replace('rad', '°'), rangeInDegrees(row), text => set(text === '' ? null : inRadians(Number(text))));
  }
  input.value = input.dataset.shown = value === undefined ? '' : typeof value === 'string' ? value : JSON.stringify(value);
  input.placeholder = row.initial === null || row.needed ? '' : JSON.stringify(row.initial);
  if (row.form === 'number' && (value === undefined || typeof value === 'number')) {
    return numberField(input, row.unit, row, text => set(text === '' ? null : Number(text)));
  }
  input.onchange = () => {
    input.dataset.shown = input.value;
    const text = input.value.trim();
    if (text === '') return set(null);
    set(parsed(text));
  };
  return input;
}

export function showController(target: ControllerTarget, help: EditorHelp): HTMLElement {
  const {name, parameters, own} = target.shown;
  const box = make('div', 'controller');
  const known: ControllerHelp | undefined = help.controllers.find(
    each => each.name === (target.isStage ? help.stage_controllers[name]?.name ?? name : name));
  const select = document.createElement('select');
  select.setAttribute('aria-label', 'controller');
  select.dataset.property = 'controller';
  select.disabled = target.locked;
  select.append(new Option('none: stands still', ''));
  for (const each of help.controllers) {
    if (each.name === 'idle' && name !== 'idle') continue;
    const isRefused = target.isStage && NEEDS_TEXTS.includes(each.name);
    const option = new Option(isRefused ? `${each.name} (in scenarios only)` : each.name, each.name);
    option.disabled = isRefused;
    option.title = each.help;
    select.append(option);
  }
  if (name !== '' && !help.controllers.some(each => each.name === name)) select.append(new Option(name, name));
  select.value = name;
  select.onchange = event => void attempt(target.of, event, () => target.choose(select.value === '' ? null : select.value));
  const line = make('div', own || name === '' ? 'property' : 'property inherited');
  line.append(make('span', 'property-name', 'controller'), select);
  box.append(line);
  if (known) box.append(make('div', 'controller-help faint', known.help));
  const rows: ParameterHelp[] = known?.parameters ?? [];
  const others = Object.keys(parameters).filter(key => !rows.some(row => row.name === key));
  const free = others.map((key): ParameterHelp => ({name: key, form: 'json', unit: '', initial: null, help: 'of this controller', needed: false}));
  for (const row of [...rows, ...free]) {
    const isGiven = row.name in parameters;
    if (target.locked && !isGiven) continue;
    const parameter = make('div', `property parameter${isGiven ? (own ? '' : ' inherited') : ' absent'}`);
    const label = make('span', 'property-name', row.name);
    const isAngle = row.unit.startsWith('rad') && typeof row.initial === 'number';
    const initial = isAngle ? String(inDegrees(row.initial as number)) : JSON.stringify(row.initial);
    label.title = `${row.help}${row.unit ? ` (${row.unit.replace(/^rad/, '°')})` : ''}${row.initial === null ? '' : `, default ${initial}`}`;
    const places = Array.isArray(parameters.places) ? (parameters.places as Array<{name?: string}>).map(each => each?.name ?? '') : [];
    const tasks = taskForm(known?.name ?? '', row.name, parameters[row.name], {
      locked: target.locked, places, set: value => void target.set(row.name, value),
      pick: target.draw && (done => target.draw?.(done, true)),
    });
    if (tasks) {
      parameter.classList.add('wide');
      parameter.append(label, tasks);
      box.append(parameter);
      continue;
    }
    parameter.append(label, valueField(row, parameters[row.name], target.locked,
                                       (value, event) => void attempt(target.of, event, () => target.set(row.name, value))));
    if (row.name === WAYPOINTS && target.draw && !target.locked) {
      const draw = make('button', 'plain', '✎');
      draw.title = 'Draw the waypoints in the picture';
      draw.setAttribute('aria-label', draw.title);
      draw.onclick = () => target.draw?.(waypoints => void target.set(WAYPOINTS, waypoints));
      parameter.append(draw);
    } else if (isGiven && own && !target.locked && !row.needed) {
      const remove = make('button', 'plain', '✕');
      remove.title = `The default of ${row.name}`;
      remove.setAttribute('aria-label', remove.title);
      remove.onclick = () => void target.set(row.name, null);
      parameter.append(remove);
    }
    box.append(parameter);
  }
  return box;
}
