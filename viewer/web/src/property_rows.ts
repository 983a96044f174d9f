// The properties of an entity, a model, a part or the file, as groups of fields: all that its type has, those that the
// file gives first.
import {make, refill} from './dom';
import {attempt, installFailures, keepFailures} from './failures';
import type {EditorHelp, HelpRow} from './file_client';
import {showController, type ControllerTarget} from './controller_form';
import {fieldOf, helpText, type FileUnits} from './property_fields';

export interface ShownProperty {
  name: string;
  value: string;  // as in the file
  own: boolean;  // given here, not by a macro
  from?: string;  // the place where it is given
  warning?: string;  // about its value
}

export interface PropertyTarget {
  types: string[];  // of the help that applies, for instance ['*', 'position']
  locked: boolean;
  of: string;  // whose properties they are
  units: FileUnits;
  controller?: ControllerTarget;  // in place of the field of `ctrl`
  // Gives the reason of a refusal, else ''. null: remove it.
  set(name: string, value: string | null): Promise<string>;
  changed(): void | Promise<void>;  // after a change, to show what the file has then
}

// The groups of the properties that all models have; the properties of a type are a group of its own.
const GROUPS: Array<[string, string[]]> = [
  ['Place', ['name', 'pose', 'size']],
  ['Look', ['color', 'color_rgba', 'gui_nose']],
  ['Body', ['obstacle_return', 'gripper_return', 'bitmap', 'map_yaml', 'noblocks', 'boundary', 'origin', 'stack_children']],
  ['Sensing', ['ranger_return', 'fiducial_return', 'fiducial_key']],
  ['Energy', [
    'joules', 'joules_capacity', 'kjoules', 'kjoules_capacity', 'watts', 'mass', 'give_watts', 'take_watts',
  ]],
];
const FIRST = ['ctrl', 'drive'];  // of a robot
const TITLES: Record<string, string> = {position: 'Robot', world: 'World', scenario: 'Scenario'};

const AFTER_PRESS = 50;  // ms, between looks whether a press has ended

const opened = new Map<string, boolean>();  // groups that the user has opened or closed
const postponed = new WeakMap<HTMLElement, number>();  // timers of forms that are pressed

function rowOf(name: string, known: HelpRow[]): HelpRow | undefined {
  return known.find(row => row.name === name.replace(/\[\d+\]$/, ''));
}

function line(property: ShownProperty, row: HelpRow | undefined, isGiven: boolean, help: EditorHelp, target: PropertyTarget): HTMLElement {
  const box = make('div', `property${property.own ? '' : isGiven ? ' inherited' : ' absent'}`);
  box.dataset.name = property.name;
  const label = make('span', 'property-name', property.name);
  label.title = [helpText(row), property.from ? `given at ${property.from}` : ''].filter(Boolean).join('\n');
  let event: Event | undefined;
  box.addEventListener('change', each => { event = each; }, {capture: true});
  const set = (value: string): void => {
    if (value === '' && !property.own) return;
    void attempt(target.of, event, () => target.set(property.name, value === '' ? null : value));
  };
  const field = fieldOf({
    row, name: property.name, value: property.value, locked: target.locked, units: target.units, colors: help.colors, set,
  });
  box.append(label, field);
  if (field.classList.contains('field-tuple') || field.classList.contains('field-rgba')) box.classList.add('wide');
  if (property.own && !target.locked) {
    const remove = make('button', 'plain', '✕');
    remove.title = `Remove ${property.name}`;
    remove.setAttribute('aria-label', remove.title);
    remove.onclick = () => void target.set(property.name, null);
    box.append(remove);
  }
  if (property.warning) {
    const warning = make('div', 'property-warning', property.warning);
    warning.setAttribute('role', 'alert');
    box.append(warning);
  }
  return box;
}

function groupsOf(shown: ShownProperty[], known: HelpRow[]): Array<{title: string; names: string[]}> {
  const own = known.filter(row => row.type !== '*');
  const groups = GROUPS.map(([title, names]) => ({
    title, names: names.filter(name => known.some(row => row.type === '*' && row.name === name && !own.some(o => o.name === name))),
  }));
  if (own.length > 0) {
    groups.splice(groups[0].names.length > 0 ? 1 : 0, 0,
                  {title: TITLES[own[0].type] ?? own[0].type, names: [...new Set([...FIRST, ...own.map(row => row.name)])].filter(
                    name => own.some(row => row.name === name))});
  }
  const placed = new Set(groups.flatMap(({names}) => names));
  const others = shown.map(({name}) => name).filter(name => !placed.has(name));
  // Indexed ones are beside their kind: bpose[0] in place of bpose.
  for (const name of others.filter(each => each.includes('['))) {
    const kind = groups.find(({names}) => names.includes(name.replace(/\[\d+\]$/, '')));
    if (kind) kind.names.push(name);
  }
  const rest = others.filter(name => !groups.some(({names}) => names.includes(name)));
  if (rest.length > 0) groups.push({title: 'Other', names: rest});
  return groups.filter(({names}) => names.length > 0);
}

// After a change the form is rebuilt. One that the file has refused stays as it is typed.
function renewing(parent: HTMLElement, target: PropertyTarget): PropertyTarget {
  const shown = async (change: Promise<string>): Promise<string> => {
    const problem = await change;
    if (problem === '') delete parent.dataset.signature;
    void target.changed();
    return problem;
  };
  const {controller} = target;
  return {
    ...target,
    set: (name, value) => shown(target.set(name, value)),
    ...(controller ? {controller: {
      ...controller,
      choose: (name: string | null) => shown(controller.choose(name)),
      set: (parameter: string, value: unknown) => shown(controller.set(parameter, value)),
    }} : {}),
  };
}

export function showProperties(parent: HTMLElement, shown: ShownProperty[], help: EditorHelp, given: PropertyTarget): void {
  // A press inside the form ends on the element on which it began; then the form is rebuilt.
  clearTimeout(postponed.get(parent));
  if (parent.matches(':active')) {
    postponed.set(parent, window.setTimeout(() => showProperties(parent, shown, help, given), AFTER_PRESS));
    return;
  }
  const target = renewing(parent, given);
  // What a user types is not replaced by what the file had before, and an unchanged form stays as it is.
  const active = document.activeElement;
  const isInside = active instanceof HTMLElement && parent.contains(active);
  if (isInside && active instanceof HTMLInputElement && (active.dataset.shown ?? active.value) !== active.value) return;
  const signature = JSON.stringify([shown, target.types, target.locked, target.units, target.controller?.shown, help.properties.length]);
  if (parent.dataset.signature === signature && parent.dataset.of === target.of) return;
  if (parent.dataset.of === undefined) {
    installFailures(parent, () => parent.dataset.of ?? '', () => {
      delete parent.dataset.signature;
      void target.changed();
    });
  }
  Object.assign(parent.dataset, {signature, of: target.of});
  const focused = isInside ? [active.dataset.property, active.dataset.element, active.dataset.parameter] : null;
  // The selection of a number field has no other access.
  const isSelected = isInside && active instanceof HTMLInputElement && document.getSelection()?.toString() === active.value;

  const known = help.properties.filter(row => target.types.includes(row.type));
  const boxes = groupsOf(shown, known).map(({title, names}, i) => {
    const box = document.createElement('details');
    box.className = 'property-group';
    const present = names.filter(name => shown.some(property => property.name === name));
    const key = `${target.types.join()} ${title}`;
    const hasOwn = present.some(name => shown.some(property => property.name === name && property.own));
    const hasController = Boolean(target.controller) && names.includes('ctrl');
    box.open = opened.get(key) ?? (i === 0 || hasOwn || hasController);
    const summary = make('summary', '', title);
    summary.onclick = () => opened.set(key, !box.open);  // at once: the event `toggle` comes later
    if (present.length > 0) summary.append(make('span', 'faint', String(present.length)));
    box.append(summary);
    const drive = shown.find(({name}) => name === 'drive')?.value ?? '';
    for (const name of names) {
      if (name === 'ctrl' && target.controller) {
        box.append(showController(target.controller, help));
        const warning = shown.find(each => each.name === 'ctrl')?.warning;
        if (warning) {
          const text = make('div', 'property-warning', warning);
          text.setAttribute('role', 'alert');
          box.append(text);
        }
        continue;
      }
      const property = shown.find(each => each.name === name);
      if (!property && (target.locked || (name === 'wheelbase' && !drive.includes('car')))) continue;
      if (!property && shown.some(each => each.name.startsWith(`${name}[`))) continue;
      box.append(line(property ?? {name, value: '', own: false}, rowOf(name, known), Boolean(property), help, target));
    }
    return box;
  });
  refill(parent, boxes.filter(box => box.childElementCount > 1));
  keepFailures(parent, target.of);
  if (!focused) return;
  const again = [...parent.querySelectorAll<HTMLElement>('[data-property], [data-parameter]')].find(
    each => [each.dataset.property, each.dataset.element, each.dataset.parameter].every((value, i) => value === focused[i]));
  again?.focus();
  if (isSelected && again instanceof HTMLInputElement) again.select();
}
