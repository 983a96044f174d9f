// Failures: texts that the file has refused. They stay in their fields with the reason, also when the form is built again,
// until the field is corrected or Escape returns to what the file has.
import {make} from './dom';

const kept = new Map<string, {text: string; problem: string}>();

function keyOf(of: string, {dataset}: HTMLElement): string {
  return JSON.stringify([of, dataset.property, dataset.element, dataset.parameter, dataset.path]);
}

function isTextField(element: EventTarget | null): element is HTMLInputElement {
  return element instanceof HTMLInputElement && !['checkbox', 'color'].includes(element.type);
}

function mark(input: HTMLInputElement, problem: string): void {
  const line = input.closest('.property') ?? input.parentElement;
  input.classList.toggle('wrong', problem !== '');
  input.setAttribute('aria-invalid', String(problem !== ''));
  line?.querySelector('.property-problem')?.remove();
  if (problem === '') return;
  const note = make('div', 'property-warning property-problem', `${problem}. Escape: as in the file`);
  note.setAttribute('role', 'alert');
  line?.append(note);
}

// Makes the change that an event of the form has asked for. `of`: what the form is of; `change`: gives the reason of a
// refusal, else ''.
export async function attempt(of: string, event: Event | undefined, change: () => Promise<string>): Promise<string> {
  const input = event?.target ?? null;
  const problem = await change();
  if (!isTextField(input)) return problem;
  const key = keyOf(of, input);
  if (problem === '') kept.delete(key);
  else kept.set(key, {text: input.value, problem});
  mark(input, problem);
  return problem;
}

// After a form has been built.
export function keepFailures(form: HTMLElement, of: string): void {
  if (kept.size === 0) return;
  for (const input of form.querySelectorAll('input')) {
    const failure = isTextField(input) ? kept.get(keyOf(of, input)) : undefined;
    if (!failure) continue;
    input.value = input.dataset.shown = failure.text;
    mark(input, failure.problem);
  }
}

// Gives up the refused text of a field. `show`: builds the form again.
export function installFailures(form: HTMLElement, of: () => string, show: () => void): void {
  form.addEventListener('keydown', event => {
    if (event.key !== 'Escape' || !isTextField(event.target) || !kept.delete(keyOf(of(), event.target))) return;
    event.stopPropagation();
    event.preventDefault();
    event.target.blur();
    show();
  }, {capture: true});
}
