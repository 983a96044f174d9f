// Events: their texts, colours and kinds, and the list of them, the newest first: an event that repeats is one row,
// kinds are hidden and shown, and a click goes to the state of the event.
//
// Rows are gathered as events arrive and only while the list is seen; the list renders at most a hundred rows at first,
// because a long run has thousands.
import {EventType} from '../generated/rows';
import {color} from './colors';
import {byId, make, setText} from './dom';
import type {RunEvent} from './protocol';
import type {Run} from './run';
import {clockText, durationText} from './times';

const MOST_ROWS = 100;  // shown at first, and more each time that more are asked for
const SAME_AFTER = 10;  // s: a robot that stalls again at the same body so soon has not got away

export function eventText({type, robot, other, object, detail}: RunEvent): string {
  switch (type) {
    case EventType.StallBegan: return `${robot} stalls at ${other || 'the ground'}`;
    case EventType.StallEnded: return `${robot} moves again`;
    case EventType.Joined: return `${robot} has an agent`;
    case EventType.Left: return `${robot} has lost its agent`;
    case EventType.ProposalRejected: return `${robot}: proposal rejected: ${detail}`;
    case EventType.Blocked: return `${robot}: ${detail} blocked by ${other || 'the ground'}`;
    case EventType.Gripped: return `${robot}: ${detail} holds ${object || 'an object'}`;
    case EventType.Released: return `${robot}: ${detail} has released ${object || 'an object'}`;
    case EventType.Landed: return `${object || 'an object'} rests on ${other || 'the ground'}`;
    case EventType.Unstable: return `${object || 'an object'} rests unstably on ${other || 'the ground'}`;
    case EventType.OutOfEnergy: return `${robot} is out of energy`;
    case EventType.DoorOpened: return `${object} is open`;
    case EventType.DoorClosed: return `${object} is closed`;
    case EventType.DoorBlocked:
    case EventType.LiftBlocked: return `${object} is blocked`;
    case EventType.LiftLeft: return `${object} leaves ${detail}`;
    case EventType.LiftArrived: return `${object} is at ${detail}`;
    case EventType.LiftOverloaded: return `${object} carries too much to leave ${detail}`;
    case EventType.LaneSwitched: return `lane ${detail}`;
    case EventType.ZoneSwitched: return `zone ${detail}`;
    case EventType.GoodsArrived: return `goods of ${detail} have arrived`;
    case EventType.GoodsRefused: return `there is no room for goods of ${detail}`;
    case EventType.GoodsLoaded: return `${robot} has goods of ${detail}`;
    case EventType.Delivered: return `${robot} has delivered goods of ${detail}`;
    case EventType.PersonBoarded: return `${object} gets on ${other} at ${detail}`;
    case EventType.PersonAlighted: return `${object} gets off ${other} at ${detail}`;
    case EventType.PersonArrived: return `${object} has reached ${detail}`;
    case EventType.WaitBegan: return `${robot} has waited for 10 s${other ? ` for ${other}` : ''}${detail ? ` (${detail})` : ''}`;
    case EventType.WaitEnded: return `${robot} goes on ${detail}`;
    case EventType.DeadlockBroken: return `${robot} goes on; ${detail} had waited for each other`;
    case EventType.Replanned: return `${robot || 'A robot'} is sent another way${other ? ` because of ${other}` : ''}: ${detail}`;
    case EventType.NoWay: return `${robot} has had no way to its goal for 10 s: ${detail}`;
    case EventType.Said: return `${robot} says: ${detail}`;
    case EventType.Reported: return robot ? `${robot}: ${detail}` : detail;
  }
}

interface Kind {
  name: string;
  types: EventType[];
}

const KINDS: Kind[] = [
  {name: 'Contacts', types: [EventType.StallBegan, EventType.StallEnded, EventType.Blocked]},
  {name: 'Objects', types: [EventType.Gripped, EventType.Released, EventType.Landed, EventType.Unstable]},
  {name: 'Doors', types: [EventType.DoorOpened, EventType.DoorClosed, EventType.DoorBlocked]},
  {name: 'Lifts', types: [EventType.LiftLeft, EventType.LiftArrived, EventType.LiftBlocked, EventType.LiftOverloaded]},
  {name: 'People', types: [EventType.PersonBoarded, EventType.PersonAlighted, EventType.PersonArrived]},
  {
    name: 'Traffic',
    types: [EventType.WaitBegan, EventType.WaitEnded, EventType.DeadlockBroken, EventType.Replanned, EventType.NoWay],
  },
  {name: 'Rules', types: [EventType.LaneSwitched, EventType.ZoneSwitched]},
  {name: 'Goods', types: [EventType.GoodsArrived, EventType.GoodsRefused, EventType.GoodsLoaded, EventType.Delivered]},
  {name: 'Messages', types: [EventType.Said, EventType.Reported]},
  {name: 'Energy', types: [EventType.OutOfEnergy]},
  {name: 'Agents', types: [EventType.Joined, EventType.Left, EventType.ProposalRejected]},
];

function kindOf(event: RunEvent): Kind {
  return KINDS.find(kind => kind.types.includes(event.type)) ?? KINDS[0];
}

const WARNINGS = [EventType.Blocked, EventType.StallBegan, EventType.Unstable, EventType.OutOfEnergy,
  EventType.DoorBlocked, EventType.LiftBlocked, EventType.WaitBegan, EventType.NoWay];
const FAULTS = [EventType.Left, EventType.ProposalRejected];

// 2: a fault, 1: a warning, 0: neither.
export function eventGravity({type}: RunEvent): number {
  return FAULTS.includes(type) ? 2 : WARNINGS.includes(type) ? 1 : 0;
}

// Of its mark on the timeline.
export function eventColor(event: RunEvent): string {
  if (FAULTS.includes(event.type)) return color('--lost');
  if (WARNINGS.includes(event.type)) return color('--stalled');
  return event.type === EventType.Gripped ? color('--holding') : color('--moving');
}

// Rows of the list: events that belong together.
interface Item {
  events: RunEvent[];  // those that began it, the first first
  end: RunEvent | null;  // of the last
}

export class EventList {
  private readonly list = byId('event-list');
  private readonly chips = make('div', 'event-kinds');
  private readonly hidden = new Set<Kind>();
  private readonly buttons = new Map<Kind, HTMLButtonElement>();
  private readonly onlySelected = make('button', 'chip', 'Selected only') as HTMLButtonElement;
  private readonly open = new Set<RunEvent>();  // the first events of items whose repetitions are shown
  private items: Item[] = [];
  private counts = new Map<Kind, number>();
  private run: Run | null = null;
  private source: RunEvent[] | null = null;
  private seen: RunEvent | null = null;
  private selected = '';
  private rows = MOST_ROWS;
  private shown = '';

  constructor(private readonly onEvent: (event: RunEvent) => void) {
    this.chips.setAttribute('role', 'group');
    this.chips.setAttribute('aria-label', 'Events that are shown');
    for (const kind of KINDS) {
      const button = make('button', 'chip on', kind.name) as HTMLButtonElement;
      button.hidden = true;  // before the first event
      button.setAttribute('aria-pressed', 'true');
      button.onclick = () => {
        if (!this.hidden.delete(kind)) this.hidden.add(kind);
        this.set(button, !this.hidden.has(kind));
      };
      this.buttons.set(kind, button);
      this.chips.append(button);
    }
    this.onlySelected.onclick = () => this.set(this.onlySelected, !this.onlySelected.classList.contains('on'));
    this.onlySelected.setAttribute('aria-pressed', 'false');
    this.chips.append(this.onlySelected);
    this.list.before(this.chips);
  }

  count(run: Run): void {
    setText(byId('event-count'), run.events.length > 0 ? String(run.events.length) : '');
  }

  // While the list is seen. `selected`: the name of the selected robot or object; '': none.
  show(run: Run, selected: string): void {
    this.run = run;
    this.selected = selected;
    this.addNew(run.events);
    this.onlySelected.disabled = selected === '';
    for (const [kind, button] of this.buttons) {
      const count = this.counts.get(kind) ?? 0;
      setText(button, `${kind.name} ${count}`);
      button.hidden = count === 0;
    }
    this.render();
  }

  private set(button: HTMLButtonElement, on: boolean): void {
    button.classList.toggle('on', on);
    button.setAttribute('aria-pressed', String(on));
    this.rows = MOST_ROWS;
    this.render();
  }

  private addNew(events: RunEvent[]): void {
    const last = events[events.length - 1] ?? null;
    if (events === this.source && last === this.seen) return;
    let from = events === this.source && this.seen ? events.lastIndexOf(this.seen) + 1 : 0;
    if (from === 0) {
      this.items = [];
      this.counts = new Map();
    }
    for (; from < events.length; ++from) this.add(events[from]);
    this.source = events;
    this.seen = last;
  }

  private add(event: RunEvent): void {
    const kind = kindOf(event);
    this.counts.set(kind, (this.counts.get(kind) ?? 0) + 1);
    const interval = this.run?.world.interval ?? 0;
    const before = this.findStall(event.robot);
    if (event.type === EventType.StallEnded && before && !before.end) {
      before.end = event;
      return;
    }
    if (event.type === EventType.StallBegan && before) {
      const [first] = before.events;
      const since = event.tick - (before.end ?? before.events[before.events.length - 1]).tick;
      if (first.other === event.other && since >= 0 && since * interval <= SAME_AFTER) {
        before.events.push(event);
        before.end = null;
        return;
      }
    }
    this.items.push({events: [event], end: null});
  }

  // The newest stall of the robot, if it is among the newest items.
  private findStall(robot: string): Item | null {
    for (let i = this.items.length - 1; i >= Math.max(0, this.items.length - 200); --i) {
      const [first] = this.items[i].events;
      if (first.robot === robot && first.type === EventType.StallBegan) return this.items[i];
    }
    return null;
  }

  private textOf({events, end}: Item): string {
    const [first] = events;
    if (first.type !== EventType.StallBegan || events.length > 1 || !end || !this.run) return eventText(first);
    return `${eventText(first)} for ${durationText((end.tick - first.tick) * this.run.world.interval)}`;
  }

  private wanted(item: Item): boolean {
    const [event] = item.events;
    if (this.hidden.has(kindOf(event))) return false;
    const only = this.onlySelected.classList.contains('on') && this.selected !== '';
    return !only || [event.robot, event.other, event.object].some(name => name === this.selected || name.startsWith(`${this.selected}.`));
  }

  private render(): void {
    const run = this.run;
    if (!run) return;
    const last = this.items[this.items.length - 1];
    const key = [
      this.items.length, last?.events.length, last?.end?.tick, this.seen?.position, this.source?.length, this.rows, this.open.size,
      [...this.hidden].map(kind => kind.name).join(), this.onlySelected.className, this.selected, run.past ? run.position : ''].join(' ');
    if (key === this.shown) return;
    this.shown = key;
    const items: Item[] = [];
    let more = 0;
    for (let i = this.items.length - 1; i >= 0; --i) {
      if (!this.wanted(this.items[i])) continue;
      if (items.length < this.rows) items.push(this.items[i]);
      else ++more;
    }
    const elements = items.flatMap(item => this.rowsOf(run, item));
    if (items.length === 0) elements.push(make('p', 'empty faint', 'No events yet.'));
    if (more > 0) {
      const button = make('button', 'more', `${more} more`) as HTMLButtonElement;
      button.onclick = () => {
        this.rows += 5 * MOST_ROWS;
        this.render();
      };
      elements.push(button);
    }
    // The focus stays on its row.
    const focused = this.list.contains(document.activeElement) ? (document.activeElement as HTMLElement).dataset.key : undefined;
    this.list.replaceChildren(...elements);
    if (focused !== undefined) this.list.querySelector<HTMLElement>(`[data-key="${focused}"]`)?.focus();
  }

  private rowsOf(run: Run, item: Item): HTMLElement[] {
    const [first] = item.events;
    const row = this.row(run, first, this.textOf(item));
    if (item.events.length === 1) return [row];
    const isOpen = this.open.has(first);
    const times = make('button', 'event-times', `× ${item.events.length}`);
    times.title = isOpen ? 'Hide the repetitions' : 'Show the repetitions';
    times.setAttribute('aria-expanded', String(isOpen));
    times.onclick = () => {
      if (!this.open.delete(first)) this.open.add(first);
      this.render();
    };
    const line = make('div', 'event-line');
    line.append(row, times);
    if (!isOpen) return [line];
    return [line, ...item.events.slice(1).map(event => {
      const repeated = this.row(run, event, eventText(event));
      repeated.classList.add('repeated');
      return repeated;
    })];
  }

  private row(run: Run, event: RunEvent, text: string): HTMLElement {
    const isWarning = WARNINGS.includes(event.type);
    const row = make('button', `event${isWarning ? ' warning' : FAULTS.includes(event.type) ? ' fault' : ''}`);
    row.dataset.key = `${event.position} ${event.type} ${event.robot}`;
    row.title = 'Go to this moment';
    row.classList.toggle('now', run.past && event.position === run.position);
    row.append(
      make('span', 'event-time', clockText(event.tick * run.world.interval)), make('span', 'event-text', text));
    row.onclick = () => this.onEvent(event);
    return row;
  }
}
