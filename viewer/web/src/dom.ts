// Helpers for elements of the page. Texts are set as text and never as HTML, because names come from world files and
// peers.

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element ${id}`);
  return element as T;
}

export function make(tag: string, className: string, text = ''): HTMLElement {
  const element = document.createElement(tag);
  element.className = className;
  element.textContent = text;
  return element;
}

// Writes only what has changed, so that the page is not laid out again 60 times a second.
export function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

// Leaves a list that has these options already as it is: it may be open.
export function setOptions(list: HTMLSelectElement, options: HTMLOptionElement[]): void {
  const texts = (all: Iterable<HTMLOptionElement>): string => [...all].map(({value, text}) => `${value} ${text}`).join();
  if (texts(list.options) !== texts(options)) list.replaceChildren(...options);
}

// Replaces the children of an element. A list for a choice that has the focus stays in the page, in the place of the new
// one with its label: an open list that leaves the page is closed.
export function refill(parent: HTMLElement, children: HTMLElement[]): void {
  const kept = document.activeElement;
  const fresh = kept instanceof HTMLSelectElement && parent.contains(kept)
    ? children.flatMap(child => [...child.querySelectorAll('select')]).find(each => each.ariaLabel === kept.ariaLabel && !each.disabled)
    : undefined;
  if (!fresh || !(kept instanceof HTMLSelectElement)) return parent.replaceChildren(...children);
  const way = (from: Element, to: Element | null): Element[] => {
    const nodes = [from];
    while (nodes[0].parentElement && nodes[0].parentElement !== to) nodes.unshift(nodes[0].parentElement);
    return nodes;
  };
  const [old, now] = [way(kept, parent), way(fresh, null)];
  if (old.length !== now.length || old.some((each, i) => each.tagName !== now[i].tagName)) return parent.replaceChildren(...children);
  old.forEach((each, i) => {
    const siblings = i === 0 ? children : [...now[i - 1].childNodes];
    for (const sibling of [...each.parentNode!.childNodes]) if (sibling !== each) sibling.remove();
    const at = siblings.indexOf(now[i] as HTMLElement);
    each.before(...siblings.slice(0, at));
    each.after(...siblings.slice(at + 1));
    for (const {name, value} of now[i].attributes) each.setAttribute(name, value);
  });
  const {value} = fresh;
  setOptions(kept, [...fresh.options].map(option => option.cloneNode(true) as HTMLOptionElement));
  if (kept.value !== value) kept.value = value;
  kept.onchange = event => {
    fresh.value = kept.value;
    fresh.onchange?.(event);
  };
}

export function fixed(value: number, digits: number): string {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text;
}

// Calls at most once in `period` ms, and once more after the last call.
export function throttled(period: () => number, call: () => void): () => void {
  let waiting = false;
  let last = 0;
  return () => {
    if (waiting) return;
    waiting = true;
    setTimeout(() => {
      waiting = false;
      last = performance.now();
      call();
    }, Math.max(0, last + period() - performance.now()));
  };
}

// Of a button that stays on until it is pressed again.
export function setOn(id: string, on: boolean): void {
  const button = byId(id);
  button.classList.toggle('on', on);
  button.setAttribute('aria-pressed', String(on));
}

// The text of a button beside its icon.
export function labelOf(id: string): HTMLElement {
  return byId(id).querySelector<HTMLElement>('.tool-label')!;
}

// A button whose action is not possible now stays where it is, and says why when it is pressed. `refusal`: why not; '': it
// is possible.
export function allow(target: string | HTMLElement, refusal: string): void {
  const button = typeof target === 'string' ? byId(target) : target;
  if (button.dataset.refusal === refusal) return;
  button.dataset.title ??= button.title;
  button.dataset.refusal = refusal;
  button.title = refusal || button.dataset.title;
  button.setAttribute('aria-disabled', String(refusal !== ''));
}

export function tellRefusals(): void {
  document.addEventListener('click', event => {
    const button = (event.target as Element).closest<HTMLElement>('[aria-disabled=true]');
    if (!button) return;
    event.stopImmediatePropagation();
    toast(button.dataset.refusal ?? '', true);
  }, {capture: true});
}

export function toast(text: string, isError = false): void {
  const element = make('div', isError ? 'toast error' : 'toast', text);
  if (isError) element.setAttribute('role', 'alert');
  byId('toasts').append(element);
  setTimeout(() => element.remove(), isError ? 7000 : 3000);
}
