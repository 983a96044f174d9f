// Events: their texts, colours and kinds, and the list of them, the newest first: an event that repeats is one row,
// kinds are hidden and shown, and a click goes to the state of the event.
//
// Rows are gathered as events arrive and only while the list is seen; the list renders at most a hundred rows at first,
// because a long run has thousands.
import {EventType} from '../generated/rows';
import {byId, make, setText} from './dom';
import {KINDS, kindOf, type EventItem, type EventItems, type EventKind} from './event_items';
import type {RunEvent} from './protocol';
import type {Run} from './run';
import {clockText, durationText} from './times';

const MOST_ROWS = 100;  // shown at first, and more each time that more are asked for

export function eventText({type, robot, other, object, detail, ofVehicle}: RunEvent): string {
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
    case EventType.PersonEntered: return `${object} has entered`;
    case EventType.PersonLeft: return `${object} has left`;
    case EventType.PersonArrived: return `${object} has reached ${detail}`;
    case EventType.WaitBegan: return `${robot} has waited for 10 s${other ? ` for ${other}` : ''}${detail ? ` (${detail})` : ''}`;
    case EventType.WaitEnded: return `${robot} goes on ${detail}`;
    case EventType.DeadlockBroken: return `${robot} goes on; ${detail} had waited for each other`;
    case EventType.Replanned: return `${robot || 'A robot'} is sent another way${other ? ` because of ${other}` : ''}: ${detail}`;
    case EventType.NoWay: return `${robot} has had no way to its goal for 10 s: ${detail}`;
    case EventType.Said: return ofVehicle ? `${robot}: ${detail}` : `${robot} says: ${detail}`;
    case EventType.Reported: return robot ? `${robot}: ${detail}` : detail;
  }
}

const WARNINGS = [EventType.Blocked, EventType.StallBegan, EventType.Unstable, EventType.OutOfEnergy,
  EventType.DoorBlocked, EventType.LiftBlocked, EventType.WaitBegan, EventType.NoWay];
const FAULTS = [EventType.Left, EventType.ProposalRejected];

// What a vehicle of VDA 5050 says of its order when something has gone wrong.
const TROUBLE = /^(error .*: |order .* rejected|action .* FAILED|mode MANUAL)/;

// 2: a fault, 1: a warning, 0: neither.
export function eventGravity({type, detail, ofVehicle}: RunEvent): number {
  if (type === EventType.Said && ofVehicle) return detail.split('; ').some(each => TROUBLE.test(each)) ? 1 : 0;
  return FAULTS.includes(type) ? 2 : WARNINGS.includes(type) ? 1 : 0;
}

export class EventList {
  private readonly list = byId('event-list');
  private readonly chips = make('div', 'event-kinds');
  private readonly buttons = new Map<EventKind, HTMLButtonElement>();
  private readonly onlySelected = make('button', 'chip', 'Selected only') as HTMLButtonElement;
  private readonly open = new Set<RunEvent>();  // the first events of items whose repetitions are shown
  private run: Run | null = null;
  private selected = '';
  private rows = MOST_ROWS;
  private shown = '';

  // `changed`: other kinds are shown.
  constructor(
      private readonly items: EventItems, private readonly onEvent: (event: RunEvent) => void, changed: () => void) {
    this.chips.setAttribute('role', 'group');
    this.chips.setAttribute('aria-label', 'Events that are shown');
    for (const kind of KINDS) {
      const button = make('button', 'chip on') as HTMLButtonElement;
      const mark = make('span', 'chip-mark');
      mark.style.background = `var(${kind.color})`;
      button.append(mark, make('span', '', kind.name));
      button.title = `${kind.name}: in the list, and on the timeline in this colour`;
      button.hidden = true;  // before the first event
      button.setAttribute('aria-pressed', 'true');
      button.onclick = () => {
        if (!items.hidden.delete(kind)) items.hidden.add(kind);
        this.set(button, !items.hidden.has(kind));
        changed();
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
    this.onlySelected.disabled = selected === '';
    for (const [kind, button] of this.buttons) {
      const count = this.items.counts.get(kind) ?? 0;
      setText(button.lastElementChild as HTMLElement, `${kind.name} ${count}`);
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

  private textOf({events, end}: EventItem): string {
    const [first] = events;
    if (first.type !== EventType.StallBegan || events.length > 1 || !end || !this.run) return eventText(first);
    return `${eventText(first)} for ${durationText((end.tick - first.tick) * this.run.world.interval)}`;
  }

  private wanted(item: EventItem): boolean {
    const [event] = item.events;
    if (this.items.hidden.has(kindOf(event))) return false;
    const only = this.onlySelected.classList.contains('on') && this.selected !== '';
    return !only || [event.robot, event.other, event.object].some(name => name === this.selected || name.startsWith(`${this.selected}.`));
  }

  private render(): void {
    const run = this.run;
    if (!run) return;
    const key = [
      this.items.version, this.rows, this.open.size, this.onlySelected.className, this.selected, run.past ? run.position : ''].join(' ');
    if (key === this.shown) return;
    this.shown = key;
    const items: EventItem[] = [];
    let more = 0;
    const {all} = this.items;
    for (let i = all.length - 1; i >= 0; --i) {
      if (!this.wanted(all[i])) continue;
      if (items.length < this.rows) items.push(all[i]);
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

  private rowsOf(run: Run, item: EventItem): HTMLElement[] {
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
    const row = make('button', `event${['', ' warning', ' fault'][eventGravity(event)]}`);
    row.dataset.key = `${event.position} ${event.type} ${event.robot}`;
    row.title = 'Go to this moment';
    row.classList.toggle('now', run.past && event.position === run.position);
    row.append(
      make('span', 'event-time', clockText(event.tick * run.world.interval)), make('span', 'event-text', text));
    row.onclick = () => this.onEvent(event);
    return row;
  }
}
