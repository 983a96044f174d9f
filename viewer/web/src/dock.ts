// Dock: the column beside the picture, with its tabs. On a phone held upright it is a sheet whose height is dragged.
// Tabs follow the ARIA pattern: arrows move, one tab is in the order of the Tab key.
import {byId} from './dom';

const TABS = ['robots', 'state', 'sensors', 'events'] as const;
export type Tab = typeof TABS[number];

const SHARES = [0.4, 0.72];  // of the window, at which the sheet remains; below the first it is closed
const CLOSED = 64;  // px: the handle and the tabs

export function isTab(name: string): name is Tab {
  return (TABS as readonly string[]).includes(name);
}

export class Dock {
  tab: Tab = 'state';
  private readonly dock = byId('dock');
  private readonly handle = byId('sheet-handle');
  private dragged = false;

  // `changed`: another tab is shown.
  constructor(private readonly changed: () => void) {
    for (const tab of TABS) {
      const button = byId(`tab-${tab}`);
      button.onclick = () => {
        this.show(tab);
        if (this.dock.clientHeight <= CLOSED) this.setHeight(SHARES[0] * window.innerHeight);
      };
      button.onkeydown = event => this.press(event, tab);
    }
    this.handle.onpointerdown = event => {
      this.handle.setPointerCapture(event.pointerId);
      this.dragged = false;
    };
    this.handle.onpointermove = event => {
      if (!this.handle.hasPointerCapture(event.pointerId)) return;
      this.dragged = true;
      this.setHeight(byId('bottom').getBoundingClientRect().top - event.clientY + 10);
    };
    this.handle.onpointerup = () => {
      if (this.dragged) this.snap();
    };
    this.handle.onclick = () => {
      if (!this.dragged) this.setHeight(this.dock.clientHeight > CLOSED ? CLOSED : SHARES[0] * window.innerHeight);
      this.dragged = false;
    };
    this.show(this.tab);
  }

  show(tab: Tab): void {
    const changed = tab !== this.tab;
    this.tab = tab;
    this.dock.dataset.tab = tab;
    for (const name of TABS) {
      const button = byId(`tab-${name}`);
      button.setAttribute('aria-selected', String(name === tab));
      button.tabIndex = name === tab ? 0 : -1;
    }
    if (changed) this.changed();
  }

  // Of the keys that move the focus between tabs.
  private press(event: KeyboardEvent, tab: Tab): void {
    const shown = TABS.filter(name => byId(`tab-${name}`).offsetParent !== null);
    const at = shown.indexOf(tab);
    const next = event.key === 'ArrowRight' ? at + 1 : event.key === 'ArrowLeft' ? at - 1
      : event.key === 'Home' ? 0 : event.key === 'End' ? shown.length - 1 : null;
    if (next === null) return;
    event.preventDefault();
    const name = shown[(next + shown.length) % shown.length];
    this.show(name);
    byId(`tab-${name}`).focus();
  }

  private snap(): void {
    const height = this.dock.clientHeight;
    const stops = [CLOSED, ...SHARES.map(share => share * window.innerHeight)];
    this.setHeight(stops.reduce((best, stop) => (Math.abs(stop - height) < Math.abs(best - height) ? stop : best)));
  }

  private setHeight(height: number): void {
    const most = 0.8 * window.innerHeight;
    document.body.style.setProperty('--sheet', `${Math.round(Math.max(CLOSED, Math.min(most, height)))}px`);
  }
}
