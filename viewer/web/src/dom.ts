// Small helpers for elements of the page.

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

// Writes only what has changed, so that the page is not laid out anew 60 times a second.
export function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
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

export function toast(text: string, isError = false): void {
  const element = make('div', isError ? 'toast error' : 'toast', text);
  byId('toasts').append(element);
  setTimeout(() => element.remove(), isError ? 7000 : 3000);
}
