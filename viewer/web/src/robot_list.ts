// The list of robots with their states.
import {EventType} from '../generated/rows';
import {color, isDark, robotColor} from './colors';
import {byId, fixed, make, setText} from './dom';
import type {RunEvent} from './protocol';
import type {Run} from './run';

const MOST_SHOWN = 200;

export type RobotState = 'lost' | 'stalled' | 'holding' | 'moving' | 'idle';

export function robotState(run: Run, robot: number, holding: boolean): RobotState {
  const row = run.robots[robot];
  if (run.lostAgents.has(run.world.robots[robot].name)) return 'lost';
  if (!row) return 'idle';
  if (row.stalled) return 'stalled';
  if (holding) return 'holding';
  const {vx, vy, wz} = row.twist;
  return vx !== 0 || vy !== 0 || wz !== 0 ? 'moving' : 'idle';
}

interface Row {
  element: HTMLElement;
  dot: HTMLElement;
  state: HTMLElement;
}

export class RobotList {
  private readonly list = byId('robot-list');
  private readonly search = byId<HTMLInputElement>('robot-search');
  private rows = new Map<number, Row>();  // by robot
  private key = '';

  // `hint`: of a robot, for its row, when the pointer comes to it.
  constructor(private readonly onSelect: (robot: number) => void, private readonly hint: (robot: string) => string) {
    this.list.onkeydown = event => {
      const row = (event.target as Element).closest('.robot');
      const next = event.key === 'ArrowDown' ? row?.nextElementSibling : event.key === 'ArrowUp' ? row?.previousElementSibling : null;
      if (!(next instanceof HTMLButtonElement)) return;
      event.preventDefault();
      next.focus();
    };
  }

  show(run: Run, selected: number): void {
    const wanted = this.search.value.trim().toLowerCase();
    const robots: number[] = [];
    let count = 0;
    run.world.robots.forEach((robot, i) => {
      if (!robot.present) return;
      ++count;
      if (robot.name.toLowerCase().includes(wanted)) robots.push(i);
    });
    setText(byId('robot-count'), String(count));
    const key = `${run.world.number} ${wanted} ${isDark()}`;
    if (key !== this.key) this.rebuild(run, robots);
    this.key = key;
    const holders = new Set(run.objects.filter(o => o.holder >= 0).map(o => run.world.grippers[o.holder].robot));
    for (const [i, row] of this.rows) {
      const state = robotState(run, i, holders.has(i));
      const speed = run.robots[i] ? Math.hypot(run.robots[i].twist.vx, run.robots[i].twist.vy) : 0;
      if (row.dot.className !== `dot ${state}`) row.dot.className = `dot ${state}`;
      if (row.state.className !== `robot-state ${state}`) row.state.className = `robot-state ${state}`;
      setText(row.state, state === 'moving' ? `${fixed(speed, 2)} m/s` : state);
      row.element.classList.toggle('selected', i === selected);
    }
  }

  private rebuild(run: Run, robots: number[]): void {
    this.rows = new Map();
    this.list.replaceChildren();
    for (const i of robots.slice(0, MOST_SHOWN)) {
      const row: Row = {element: make('button', 'robot'), dot: make('span', 'dot'), state: make('span', 'robot-state')};
      const swatch = make('span', 'swatch');
      swatch.style.background = robotColor(i);
      row.element.append(row.dot, swatch, make('span', 'robot-name', run.world.robots[i].name), row.state);
      row.element.onpointermove = () => {
        row.element.title = this.hint(run.world.robots[i].name);
      };
      row.element.onclick = () => this.onSelect(i);
      this.rows.set(i, row);
      this.list.append(row.element);
    }
    if (robots.length > MOST_SHOWN) this.list.append(make('div', 'more', `and ${robots.length - MOST_SHOWN} more: search by name`));
  }
}

// The list of events, the newest first.

const MOST_EVENTS = 100;

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
  return color(name);
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
    for (const event of run.events.slice(known + 1).slice(-MOST_EVENTS)) this.list.prepend(this.row(run, event));
    while (this.list.childElementCount > MOST_EVENTS) this.list.lastElementChild!.remove();
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
