// Forms of the values of a scenario, made from its schema: objects as fields, arrays as lists of entries. A value that no
// field fits is its JSON, in one line.
//
// A form holds no state: each change is one edit of the file, at the path of the value. An entry's fields are made when it
// is opened, because lists have hundreds.
import {make} from './dom';
import {attempt} from './failures';
import {numberField} from './property_fields';

export interface Schema {
  type?: string | string[];
  enum?: string[];
  description?: string;
  properties?: Record<string, Schema>;
  additionalProperties?: boolean | Schema;
  items?: Schema;
  required?: string[];
  minimum?: number;
  maximum?: number;
  $ref?: string;
  definitions?: Record<string, Schema>;
}

export type Path = Array<string | number>;

export interface FormHost {
  schema: Schema;  // with the definitions
  locked: boolean;
  // Names to choose from, for a member of this definition; none: it is a text.
  choices(definition: string): string[];
  // The reason of a refusal, else ''.
  set(path: Path, value: unknown): Promise<string>;
  controllerForm(path: Path, value: unknown): HTMLElement | null;
}

const POSES: Record<number, string[]> = {3: ['x', 'y', 'heading'], 4: ['x', 'y', 'z', 'heading']};
const REGION = ['x min', 'y min', 'x max', 'y max'];

const opened = new Map<string, boolean>();  // by paths

export function openGroup(path: Path): void {
  opened.set(path.join('\n'), true);
}

function definitionOf({$ref}: Schema): string {
  return $ref?.split('/').pop() ?? '';
}

export function resolved(schema: Schema, root: Schema): Schema {
  return schema.$ref ? {...root.definitions?.[definitionOf(schema)], $ref: schema.$ref} : schema;
}

function typesOf({type}: Schema): string[] {
  return Array.isArray(type) ? type : type ? [type] : [];
}

function textOf(value: unknown): string {
  return value === undefined ? '' : typeof value === 'string' ? value : JSON.stringify(value);
}

function inputOf(path: Path, value: string, locked: boolean): HTMLInputElement {
  const input = document.createElement('input');
  input.value = input.dataset.shown = value;
  input.disabled = locked;
  input.dataset.path = path.join('.');
  input.setAttribute('aria-label', path.filter(step => typeof step === 'string').slice(-2).join(' '));
  return input;
}

function tuple(path: Path, names: string[], value: unknown[], host: FormHost): HTMLElement {
  const box = make('span', 'field-tuple');
  names.forEach((name, i) => {
    const input = inputOf([...path, i], String(value[i] ?? 0), host.locked);
    input.setAttribute('aria-label', `${path[path.length - 1]} ${name}`);
    const label = make('label', 'field-element');
    let event: Event | undefined;
    input.addEventListener('change', each => { event = each; }, {capture: true});
    label.append(make('span', 'field-name', name), numberField(input, name === 'heading' ? '°' : 'm', {}, text => {
      const next = names.map((_, j) => Number(value[j] ?? 0));
      next[i] = Number(text);
      void attempt('scenario', event, () => host.set(path, next));
    }));
    box.append(label);
  });
  return box;
}

// A plain value: a flag, a choice, a number or a text.
function plainField(path: Path, schema: Schema, value: unknown, host: FormHost): HTMLElement {
  const types = typesOf(schema);
  const choices = schema.enum ?? host.choices(definitionOf(schema));
  if (types.length === 1 && types[0] === 'boolean') {
    const input = inputOf(path, '', host.locked);
    input.type = 'checkbox';
    delete input.dataset.shown;
    input.checked = value === true;
    input.onchange = () => void host.set(path, input.checked);
    return input;
  }
  if (choices.length > 0 && (value === undefined || typeof value === 'string')) {
    const select = document.createElement('select');
    select.disabled = host.locked;
    select.dataset.path = path.join('.');
    select.setAttribute('aria-label', String(path[path.length - 1]));
    const now = textOf(value);
    const all = now === '' ? ['', ...choices] : choices.includes(now) ? choices : [now, ...choices];
    select.append(...all.map(each => new Option(each.replace(/_/g, ' '), each)));
    select.value = now;
    select.onchange = () => void host.set(path, select.value === '' ? null : select.value);
    return select;
  }
  const input = inputOf(path, textOf(value), host.locked);
  input.placeholder = schema.description ?? '';
  input.title = schema.description ?? '';
  const isNumber = types.length === 1 && (types[0] === 'number' || types[0] === 'integer');
  if (isNumber && (value === undefined || typeof value === 'number')) {
    input.placeholder = '';
    let event: Event | undefined;
    input.addEventListener('change', each => { event = each; }, {capture: true});
    return numberField(input, unitOf(String(path[path.length - 1]), schema), {least: schema.minimum, most: schema.maximum}, text => {
      void attempt('scenario', event, () => host.set(path, text === '' ? null : Number(text)));
    });
  }
  input.onchange = event => {
    input.dataset.shown = input.value;
    const text = input.value.trim();
    let next: unknown = text === '' ? null : text;
    if (text !== '' && !(types.length === 1 && types[0] === 'string')) {
      try {
        next = JSON.parse(text);
      } catch {
        next = text;
      }
    }
    void attempt('scenario', event, () => host.set(path, next));
  };
  return input;
}

function unitOf(key: string, {description = ''}: Schema): string {
  if (/speed/.test(key)) return 'm/s';
  if (/heading/.test(key)) return '°';
  if (/seconds/.test(description)) return 's';
  return key === 'z' || key === 'spacing' || key === 'radius' || key === 'height' ? 'm' : '';
}

function field(path: Path, given: Schema, value: unknown, host: FormHost): HTMLElement {
  const schema = resolved(given, host.schema);
  const definition = definitionOf(given);
  const isNumbers = Array.isArray(value) && value.every(each => typeof each === 'number');
  if (definition === 'pose' && isNumbers && POSES[value.length]) return tuple(path, POSES[value.length], value, host);
  if (definition === 'region' && isNumbers && value.length === 4) return tuple(path, REGION, value, host);
  if (definition === 'controller') {
    const form = host.controllerForm(path, value);
    if (form) return form;
  }
  return plainField(path, schema, value, host);
}

// The fields of an object: what its schema has, and what it has itself.
export function objectFields(path: Path, given: Schema, value: Record<string, unknown>, host: FormHost): HTMLElement[] {
  const schema = resolved(given, host.schema);
  const known = schema.properties ?? {};
  const keys = [...Object.keys(known), ...Object.keys(value).filter(key => !(key in known))];
  return keys.flatMap(key => {
    const isGiven = key in value;
    const member = known[key] ?? (typeof schema.additionalProperties === 'object' ? schema.additionalProperties : {});
    const inner = resolved(member, host.schema);
    const isList = typesOf(inner).length === 1 && typesOf(inner)[0] === 'array' && typesOf(resolved(inner.items ?? {}, host.schema)).join() === 'object';
    const isObject = typesOf(inner).length === 1 && typesOf(inner)[0] === 'object';
    if (isList || (isObject && isGiven)) {
      return isList && !isGiven && host.locked ? [] : [isList ? listForm([...path, key], member, (value[key] ?? []) as unknown[], 0, host)
        : group([...path, key], key, '', () => objectFields([...path, key], member, value[key] as Record<string, unknown>, host))];
    }
    if (!isGiven && (host.locked || isObject)) return [];
    const line = make('div', `property${isGiven ? '' : ' absent'}`);
    line.dataset.name = key;
    const label = make('span', 'property-name', key.replace(/_/g, ' '));
    label.title = inner.description ?? '';
    const shown = field([...path, key], member, value[key], host);
    line.append(label, shown);
    if (shown.matches('.field-tuple, .controller')) line.classList.add('wide');
    if (isGiven && !host.locked && !(schema.required ?? []).includes(key)) {
      const remove = make('button', 'plain', '✕');
      remove.title = `Remove ${key}`;
      remove.setAttribute('aria-label', remove.title);
      remove.onclick = () => void host.set([...path, key], null);
      line.append(remove);
    }
    return [line];
  });
}

// A part of a form that is opened by a click on its title.
function group(path: Path, title: string, note: string, content: () => HTMLElement[], remove?: () => void): HTMLElement {
  const box = document.createElement('details');
  box.className = 'value-group';
  box.dataset.group = path.join('.');
  const key = path.join('\n');
  const summary = make('summary', '', title);
  if (note) summary.append(make('span', 'faint', note));
  if (remove) {
    const button = make('button', 'plain', '✕');
    button.title = `Delete ${title}`;
    button.setAttribute('aria-label', button.title);
    button.onclick = event => {
      event.preventDefault();
      remove();
    };
    summary.append(button);
  }
  box.append(summary);
  const fill = (): void => {
    if (box.childElementCount === 1) box.append(...content());
  };
  box.open = opened.get(key) ?? false;
  if (box.open) fill();
  box.ontoggle = () => {
    opened.set(key, box.open);
    if (box.open) fill();
  };
  return box;
}

function titleOf(value: unknown, index: number): [string, string] {
  if (typeof value !== 'object' || value === null) return [textOf(value), ''];
  const {name, count, model, kind, from, to, at, match, that} = value as Record<string, unknown>;
  const note = [count !== undefined ? `${count} ×` : '', model, kind, from && to ? `${from} → ${to}` : '', match ? JSON.stringify(match) : '']
    .filter(Boolean).map(textOf).join(' ');
  const first = textOf(name ?? that) || (at !== undefined ? `at ${textOf(at)} s` : '') || note || String(index + 1);
  return [first, first === note ? '' : note];
}

// The least that an entry of a list has.
function beginning(given: Schema, host: FormHost): unknown {
  const schema = resolved(given, host.schema);
  const definition = definitionOf(given);
  const choices = schema.enum ?? host.choices(definition);
  if (choices.length > 0) return choices[0];
  if (definition === 'pose') return [0, 0, 0];
  if (definition === 'region') return [-1, -1, 1, 1];
  if (schema.properties) return Object.fromEntries((schema.required ?? []).map(key => [key, beginning(schema.properties![key], host)]));
  const type = typesOf(schema)[0];
  return type === 'number' || type === 'integer' ? Math.max(1, schema.minimum ?? 1) : type === 'object' ? {} : type === 'array' ? [] : '';
}

// `more`: entries that are not shown.
export function listForm(path: Path, given: Schema, values: unknown[], more: number, host: FormHost): HTMLElement {
  const key = String(path[path.length - 1]);
  const schema = resolved(given, host.schema);
  const items = schema.items ?? {};
  const length = values.length + more;
  return group(path, key.replace(/_/g, ' '), length > 0 ? String(length) : '', () => {
    const isObject = Boolean(resolved(items, host.schema).properties);
    const entries = values.map((value, i): HTMLElement => {
      const at = [...path, i];
      const remove = host.locked ? undefined : () => void host.set(at, null);
      if (isObject && typeof value === 'object' && value !== null) {
        const [title, note] = titleOf(value, i);
        return group(at, title, note, () => objectFields(at, items, value as Record<string, unknown>, host), remove);
      }
      const line = make('div', 'property');
      line.append(make('span', 'property-name', String(i + 1)), field(at, items, value, host));
      if (remove) {
        const button = make('button', 'plain', '✕');
        button.title = button.ariaLabel = `Remove ${key} ${i + 1}`;
        button.onclick = remove;
        line.append(button);
      }
      return line;
    });
    if (more > 0) entries.push(make('div', 'more', `and ${more} more, in the text`));
    if (!host.locked) {
      const add = make('button', 'small', 'Add');
      add.title = `Add an entry to ${key}`;
      add.dataset.add = path.join('.');
      add.onclick = () => {
        const first = beginning(items, host);
        const names = new Set(values.map(value => (value as {name?: string} | null)?.name));
        if (typeof first === 'object' && first !== null && (first as {name?: string}).name === '') {
          let number = 1;
          while (names.has(`${key.replace(/s$/, '')}${number}`)) ++number;
          (first as {name?: string}).name = `${key.replace(/s$/, '')}${number}`;
        }
        openGroup([...path, length]);
        void host.set([...path, length], first);
      };
      entries.push(add);
    }
    return entries;
  });
}
