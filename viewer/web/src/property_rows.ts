// Rows to change properties, with their help: of an entity, a model, a part, or the file itself.
import {make} from './dom';
import type {HelpRow} from './file_client';

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
