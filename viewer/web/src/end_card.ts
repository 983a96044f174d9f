// EndCard: the result of a run when it or its recording is over: distance, contacts and energy of each robot, and ways
// to go on. The past stays reachable behind it.
import {EventType} from '../generated/rows';
import {robotColor} from './colors';
import type {Connection, SessionInfo} from './connection';
import {fixed, make, setText, toast} from './dom';
import {energyText} from './entity_panel';
import type {RunEvent, TotalsReply} from './protocol';
import type {Run} from './run';
import {clockText} from './times';

export interface EndCardHost {
  info(): SessionInfo | null;
  select(robot: string): void;
  replay(): void;
}

interface RobotRow {
  name: string;
  distance: number;
  energy?: number;
}

// "table2 × 3, wall", the most frequent first.
function countsText(names: string[]): string {
  const counts = new Map<string, number>();
  for (const name of names) counts.set(name, (counts.get(name) ?? 0) + 1);
  return [...counts].sort((a, b) => b[1] - a[1]).slice(0, 4)
    .map(([name, count]) => (count > 1 ? `${name} × ${count}` : name)).join(', ') + (counts.size > 4 ? ' …' : '');
}

// A word of a shell.
function quoted(word: string): string {
  return /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replace(/'/g, `'\\''`)}'`;
}

export class EndCard {
  private readonly card = make('section', 'popup');
  private readonly title = make('h2', '');
  private readonly titleText = make('span', '');
  private readonly facts = make('p', 'faint');
  private readonly rows = make('div', 'scroll end-rows');
  private readonly actions = make('div', 'row');
  private readonly command = make('code', 'end-command');
  private run: Run | null = null;
  private shownFor = '';  // the run whose end was shown
  private asking = false;
  private online = true;

  constructor(private readonly connection: Connection, private readonly host: EndCardHost) {
    this.card.id = 'end-card';
    this.card.hidden = true;
    this.card.setAttribute('role', 'dialog');
    const close = make('button', 'plain', '×');
    close.title = close.ariaLabel = 'Close';
    close.onclick = () => this.set(false);
    this.title.append(this.titleText, close);
    this.command.hidden = true;
    this.card.append(this.title, this.facts, this.rows, this.actions, this.command);
    document.body.append(this.card);
  }

  get isOpen(): boolean {
    return !this.card.hidden;
  }

  // Opens at the end of a run or of a recording, and when the page returns to it; a state before hides it.
  show(run: Run): void {
    this.run = run;
    const isAtEnd = this.host.info()?.recording ? run.position === run.last && run.first < run.last : run.over && !run.past;
    if (!isAtEnd) {
      this.shownFor = '';
      this.card.hidden = true;
      return;
    }
    if (this.shownFor === run.world.run) return;
    this.shownFor = run.world.run;
    this.set(true);
  }

  // False: no program answers.
  setOnline(online: boolean): void {
    if (this.online === online) return;
    this.online = online;
    if (this.isOpen) this.offer();
  }

  set(open: boolean): void {
    this.card.hidden = !open;
    if (!open || !this.run) return;
    const text = this.host.info()?.recording ? 'The end of the recording' : 'The run is over';
    setText(this.titleText, text);
    this.card.setAttribute('aria-label', text);
    this.offer();
    void this.sum();
  }

  private button(text: string, title: string, action: () => void): HTMLButtonElement {
    const button = make('button', 'small', text) as HTMLButtonElement;
    button.title = title;
    button.onclick = action;
    return button;
  }

  private offer(): void {
    const info = this.host.info();
    const words = info?.command ?? [];
    const starts = info?.runs_again && this.online ? 'Starts it again' : 'The command that starts it again';
    const replay = this.button('Replay', 'Play the run again from its start, as it was', () => {
      this.set(false);
      this.host.replay();
    });
    replay.classList.add('strong');
    const buttons: HTMLElement[] = this.online ? [replay, this.button('Look back', 'Close this, and drag the timeline', () => this.set(false))]
      : [this.button('Look at the end', 'Close this: the last state stays', () => this.set(false))];
    if (words.length > 0 || (this.online && info?.runs_again)) {
      buttons.push(
        this.button('Run again', starts, () => void this.runAgain(words, null)),
        this.button('Another seed', `${starts} with another seed`, () => void this.runAgain(words, Math.floor(1 + 1e6 * Math.random()))));
    }
    if (info?.saves_recording && this.online) {
      buttons.push(this.button('Save the recording', 'A file for troupe view, troupe replay and troupe export', () => {
        const link = document.createElement('a');
        link.href = `/recording.mcap${location.search}`;
        link.download = `${info.session}.mcap`;
        link.click();
      }));
    }
    if (!this.online) buttons.unshift(make('p', 'end-gone faint', 'The program has ended: nothing before this can be shown.'));
    this.actions.replaceChildren(...buttons);
    this.command.hidden = true;
  }

  // `seed`: null: that of the run. The page connects to the new run by itself.
  private async runAgain(words: string[], seed: number | null): Promise<void> {
    const withSeed = seed === null ? words
      : [...words.filter((word, i) => !word.startsWith('--seed') && words[i - 1] !== '--seed'), '--seed', String(seed)];
    if (!this.online || !this.host.info()?.runs_again) return this.tell(withSeed);
    const reply = await this.connection.runAgain(seed);
    if (!reply.done) return words.length > 0 ? this.tell(withSeed) : toast(reply.problem, true);
    toast(seed === null ? 'The run starts again' : `The run starts again, with seed ${seed}`);
    this.set(false);
  }

  private tell(words: string[]): void {
    const text = words.map(quoted).join(' ');
    setText(this.command, text);
    this.command.hidden = false;
    navigator.clipboard?.writeText(text).then(
      () => toast('The command is copied: paste it into a terminal'), () => toast('Enter this command in a terminal'));
  }

  // The gateway sums up a part at a time.
  private async sum(): Promise<void> {
    if (this.asking) return;
    this.asking = true;
    for (;;) {
      const reply = await this.connection.totals();
      if (this.card.hidden || !this.run) break;
      if (reply.done) this.fill(this.run, reply);
      if (!reply.done || reply.complete) break;
    }
    this.asking = false;
  }

  private fill(run: Run, totals: TotalsReply): void {
    const seconds = (totals.last_tick ?? run.tick) * run.world.interval;
    const stalls = run.events.filter(event => event.type === EventType.StallBegan).length;
    const target = run.status?.target_ticks ?? 0;
    const end = target > 0 && run.tick < target ? `stopped before tick ${target}` : '';
    setText(this.facts, [
      `${clockText(seconds)} of simulated time`, `tick ${totals.last_tick ?? run.tick}`, `${stalls} ${stalls === 1 ? 'stall' : 'stalls'}`,
      end, totals.complete ? '' : 'summing up …',
    ].filter(text => text !== '').join(' · '));
    const robots = (totals.robots ?? []).map((robot): RobotRow => robot);
    this.rows.replaceChildren(...this.trafficRows(totals), ...robots.map(robot => this.row(run, robot)));
  }

  // Of robots on lanes.
  private trafficRows({traffic, waits}: TotalsReply): HTMLElement[] {
    const rows: HTMLElement[] = [];
    if (traffic && traffic.robots > 0) {
      const share = (part: number): string => `${fixed(100 * part, 0)} %`;
      rows.push(make('p', 'end-traffic', [
        `${traffic.robots} on lanes`, `${traffic.arrivals} arrivals (${fixed(traffic.arrivals_per_hour, 0)} an hour)`,
        `${share(traffic.utilisation)} of the time moving to goals`, `${share(traffic.waiting)} waiting`].join(' · ')));
    }
    for (const {kind, place, seconds, longest, waits: count} of waits ?? []) {
      rows.push(make('p', 'end-traffic faint',
        `Waits at ${kind} ${place}: ${fixed(seconds, 0)} s, ${count} × · the longest ${fixed(longest, 0)} s`));
    }
    return rows;
  }

  private row(run: Run, robot: RobotRow): HTMLElement {
    const index = run.world.robots.findIndex(r => r.present && r.name === robot.name);
    const of = (...types: EventType[]): RunEvent[] => run.events.filter(e => e.robot === robot.name && types.includes(e.type));
    const stalls = of(EventType.StallBegan);
    const gripped = of(EventType.Gripped);
    const said = of(EventType.Said);
    const facts = [
      robot.energy !== undefined ? `used ${energyText(robot.energy)}` : '',
      stalls.length > 0 ? `stalled at ${countsText(stalls.map(event => event.other || 'the ground'))}` : 'no contact',
      gripped.length > 0 ? `gripped ${countsText(gripped.map(event => event.object))}` : '',
      said.length > 0 ? `said “${said[said.length - 1].detail}”` : '',
    ];
    const row = make('button', 'end-robot');
    const dot = make('span', 'plot-line');
    dot.style.borderTopColor = robotColor(Math.max(0, index));
    row.append(
      dot, make('strong', 'end-name', robot.name), make('span', 'end-distance', `${fixed(robot.distance, robot.distance < 100 ? 1 : 0)} m`),
      make('span', 'end-facts faint', facts.filter(text => text !== '').join(' · ')));
    row.onclick = () => this.host.select(robot.name);
    return row;
  }
}
