// Toolbar: the tools in groups. Groups that have no place are behind the button "More". Popup: a box that a button opens.
// Groups move as a whole, the last ones first, so that tools keep their neighbours at every width.
import {byId} from './dom';

// One is open at a time; Escape, and a press elsewhere, close it.
export class Popup {
  private static open: Popup | null = null;

  constructor(private readonly button: HTMLElement, private readonly box: HTMLElement) {}

  static install(): void {
    window.addEventListener('pointerdown', event => {
      const open = Popup.open;
      const at = event.target as Node;
      if (open && !open.box.contains(at) && !open.button.contains(at)) open.set(false);
    }, {capture: true});
  }
  // True if one was open.
  static closeAny(): boolean {
    const open = Popup.open;
    if (!open) return false;
    const hadFocus = open.box.contains(document.activeElement);
    open.set(false);
    if (hadFocus) open.button.focus();
    return true;
  }

  get isOpen(): boolean {
    return !this.box.hidden;
  }
  toggle(): void {
    this.set(!this.isOpen);
  }
  set(open: boolean): void {
    if (open && Popup.open !== this) Popup.open?.set(false);
    this.box.hidden = !open;
    this.button.setAttribute('aria-expanded', String(open));
    if (open) Popup.open = this;
    else if (Popup.open === this) Popup.open = null;
  }
}

const TITLE = 190;  // px that the names of the session and the world have at least
const SHORT_TITLE = 84;  // px, in a narrow window
const NARROW = 760;  // px
const SPACE = 24;  // px, beside and between them

export class Toolbar {
  private readonly top = byId('top');
  private readonly bar = byId('tools');
  private readonly more = byId('more');
  private readonly button = byId('more-open');
  private readonly groups: HTMLElement[];

  constructor() {
    this.groups = [...this.bar.querySelectorAll<HTMLElement>('.group')];
    const popup = new Popup(this.button, this.more);
    this.button.onclick = () => popup.toggle();
    this.more.addEventListener('click', event => {
      if ((event.target as Element).closest('button:not([aria-disabled=true])')) popup.set(false);
    });
    this.bar.addEventListener('keydown', event => this.press(event));
    new ResizeObserver(() => this.layOut()).observe(this.top);
  }

  // When tools are shown or hidden.
  layOut(): void {
    for (const group of this.groups) this.bar.insertBefore(group, this.button);
    this.button.hidden = true;
    const title = this.top.clientWidth < NARROW ? SHORT_TITLE : TITLE;
    const place = this.top.clientWidth - title - SPACE;
    const fits = (): boolean => this.bar.scrollWidth <= place;
    if (fits()) return;
    this.button.hidden = false;
    for (const group of [...this.groups].reverse()) {
      if (fits()) break;
      this.more.prepend(group);
    }
  }

  private press(event: KeyboardEvent): void {
    const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
    if (step === 0 || !(event.target as Element).matches(':focus-visible')) return;
    event.preventDefault();
    const buttons = [...this.bar.querySelectorAll('button')].filter(b => !b.disabled && b.offsetParent !== null);
    const at = buttons.indexOf(document.activeElement as HTMLButtonElement);
    buttons[(at + step + buttons.length) % buttons.length]?.focus();
  }
}
