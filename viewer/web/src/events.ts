// The list of events, the newest first.
import {byId, fixed, make} from './dom';
import {EventType} from '../generated/rows';
import type {RunEvent} from './protocol';
import type {Run} from './run';

const MOST_SHOWN = 100;

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
    case EventType.Said: return `${robot} says: ${detail}`;
  }
}

const WARNINGS = [
  EventType.Left, EventType.ProposalRejected, EventType.Blocked, EventType.StallBegan, EventType.Unstable, EventType.OutOfEnergy,
];

export function eventColor(event: RunEvent): string {
  const name = event.type === EventType.Left || event.type === EventType.ProposalRejected ? '--red'
    : WARNINGS.includes(event.type) ? '--amber' : '--green';
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export class EventList {
  private readonly list = byId('event-list');
  private newest: RunEvent | null = null;

  constructor(private readonly onEvent: (event: RunEvent) => void) {}

  show(run: Run): void {
    const last = run.events[run.events.length - 1] ?? null;
    if (last === this.newest) return;
    const known = this.newest ? run.events.lastIndexOf(this.newest) : -1;
    this.newest = last;
    if (known < 0) this.list.replaceChildren();
    for (const event of run.events.slice(known + 1).slice(-MOST_SHOWN)) this.list.prepend(this.row(run, event));
    while (this.list.childElementCount > MOST_SHOWN) this.list.lastElementChild!.remove();
    byId('event-count').textContent = String(run.events.length);
  }

  private row(run: Run, event: RunEvent): HTMLElement {
    const row = make('button', WARNINGS.includes(event.type) ? 'event warning' : 'event');
    row.append(
      make('span', 'event-time', `${fixed(event.tick * run.world.interval, 1)} s`),
      make('span', 'event-text', eventText(event)));
    row.onclick = () => this.onEvent(event);
    return row;
  }
}
