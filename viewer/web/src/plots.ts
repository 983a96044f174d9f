// Plots: signals of robots, doors, people and all other things of a run over simulated time, signals of one unit in one
// chart. The gateway says which signals there are, and computes the values from the states of the past
// (viewer/gateway/signals.h), so that they are there at once, also after a seek and in recordings; only the times in
// which agents answer are those that the page has seen. A click goes to a moment; all values are saved as CSV.
//
// Samples lie on a grid of positions whose step is a power of two: when the shown time changes, most samples stay
// valid, and a curve does not flicker by sampling other states. The exported file has every tick.
import {robotColor} from './colors';
import {chart, type Curve} from './chart';
import type {Connection} from './connection';
import {make, setText, toast} from './dom';
import {saveText} from './graphics';
import {JointType, type SeriesReply, type SignalTable, type World} from './protocol';
import type {Run} from './run';
import {clockText, secondsAt, spansOf} from './times';

export interface Signal {
  thing: string;  // a robot, a door, a joint ...
  name: string;  // as in viewer/gateway/signals.h, or ANSWER
}

const ANSWER = 'answer';  // the time in which the agent of the robot answers

interface Scale {
  unit: string;
  scale: number;  // from the unit of the gateway, which files have
}

const DEGREES = 180 / Math.PI;

// What the page shows in the unit of a field.
function scaleOf(unit: string): Scale {
  return unit.startsWith('rad') ? {unit: unit.replace('rad', '°'), scale: DEGREES} : {unit, scale: 1};
}

const WINDOWS: Array<[string, number]> = [['10 s', 10], ['1 min', 60], ['10 min', 600], ['all', Infinity]];
const MOST_SAMPLES = 1000;  // of a curve: more are thinned out
const MOST_SIGNALS = 12;
const DASHES = [[], [6, 3], [2, 2], [8, 2, 2, 2]];

// The values at the states of one range of positions, each `every`-th.
interface Samples {
  key: string;
  every: number;
  from: number;  // that was asked for
  next: number;  // the first position that was not
  ticks: number[];
  positions: number[];
  values: Array<Array<number | null>>;  // by signal
}

export class Plots {
  private signals: Signal[] = [];  // that the user has chosen; none: the speed of the selected robot
  private run: Run | null = null;
  private selected = -1;
  private samples: Samples | null = null;
  private asking = false;
  private readonly answers = new Map<string, Array<[number, number]>>();  // position and ms, by robot
  private readonly choice = make('select', 'plot-choice') as HTMLSelectElement;
  private readonly range = make('select', 'plot-window') as HTMLSelectElement;
  private readonly export = make('button', 'small', 'CSV') as HTMLButtonElement;
  private readonly charts = make('div', 'plot-charts');
  private choices = '';
  private readonly thing = make('select', 'plot-thing') as HTMLSelectElement;  // of the choice; '': the selected robot
  private tables: SignalTable[] = [];  // of the world of `tablesOf`
  private tablesOf = '';

  // `answer`: the newest time in which the agent of a robot has answered, s; null: it is not known.
  constructor(
      private readonly parent: HTMLElement, private readonly connection: Connection,
      private readonly seek: (position: number) => void, private readonly answer: (robot: string) => number | null,
      private readonly fileName: () => string) {
    this.thing.setAttribute('aria-label', 'The thing whose signals can be added to the plots');
    this.thing.onchange = () => this.show(this.run, this.selected);
    this.choice.setAttribute('aria-label', 'Add a signal of it to the plots');
    this.choice.onchange = () => this.add(this.choice.value);
    this.range.setAttribute('aria-label', 'Time that the plots show');
    this.range.append(...WINDOWS.map(([text, seconds]) => new Option(text, String(seconds))));
    this.range.value = '60';
    this.range.onchange = () => this.show(this.run, this.selected);
    this.export.title = 'Save the values in the shown time as CSV, at each tick';
    this.export.onclick = () => void this.save();
    const head = make('div', 'plot-head');
    head.append(make('h2', '', 'Plots'), this.thing, this.choice, this.range, this.export);
    this.parent.append(head, this.charts);
  }

  // The signals that are shown now.
  get shown(): Signal[] {
    if (this.signals.length > 0 || !this.run || this.selected < 0) return this.signals;
    return [{thing: this.run.world.robots[this.selected].name, name: 'speed'}];
  }

  // `selected`: a robot; -1: none.
  show(run: Run | null, selected: number): void {
    this.run = run;
    this.selected = selected;
    this.parent.hidden = !run?.hasState || (selected < 0 && this.signals.length === 0 && this.tables.length < 2);
    if (!run?.hasState) return;
    void this.describe(run);
    this.noteAnswers(run);
    if (this.parent.offsetParent === null) return;
    this.offer(run);
    void this.fetch(run);
    this.draw(run);
  }

  // A signal of the chosen thing, or of a part of it: "gripper.lift position".
  add(text: string): void {
    this.choice.value = '';
    const chosen = this.chosen();
    if (!this.run || chosen === '' || text === '') return;
    const space = text.startsWith('range/') ? -1 : text.lastIndexOf(' ');
    const part = text.slice(0, Math.max(space, 0));
    const name = text.slice(space + 1);
    const thing = part === '' ? chosen : `${chosen}.${part}`;
    const signals = this.shown.filter(signal => signal.thing !== thing || signal.name !== name);
    if (signals.length >= MOST_SIGNALS) return toast(`The plots show at most ${MOST_SIGNALS} signals`, true);
    this.signals = [...signals, {thing, name}];
    this.show(this.run, this.selected);
  }

  private remove(signal: Signal): void {
    this.signals = this.shown.filter(other => other !== signal && (other.thing !== signal.thing || other.name !== signal.name));
    this.show(this.run, this.selected);
  }

  // The signals that there are, from the gateway, once for each world.
  private async describe(run: Run): Promise<void> {
    const key = `${run.world.run} ${run.world.number}`;
    if (this.asking || key === this.tablesOf) return;
    this.tablesOf = key;
    const reply = await this.connection.series([], 0, 0, 1);
    if (!reply.done || !reply.tables) {
      this.tablesOf = '';
      return;
    }
    this.tables = reply.tables.filter(({things}) => things.length > 0);
    this.choices = '';
    this.thing.replaceChildren(new Option('selected robot', ''), ...this.tables.filter(({name}) => name !== 'robots').map(table => {
      const group = make('optgroup', '') as HTMLOptGroupElement;
      group.label = table.name;
      group.append(...table.things.map(thing => new Option(thing, thing)));
      return group;
    }));
    if (this.run) this.show(this.run, this.selected);
  }

  private chosen(): string {
    return this.thing.value || (this.run?.world.robots[this.selected]?.name ?? '');
  }

  private scaleOf(world: World, {thing, name}: Signal): Scale {
    if (name === ANSWER) return {unit: 'ms', scale: 1};
    if (name.startsWith('range/')) return {unit: 'm', scale: 1};
    const table = this.tables.find(({things, signals}) => things.includes(thing) && signals.some(signal => signal.name === name));
    const unit = table?.signals.find(signal => signal.name === name)?.unit ?? '';
    const [shift, turn] = unit.split(' or ');
    if (turn === undefined) return scaleOf(unit);
    const joint = world.joints.find(j => thing === `${world.robots[j.robot].name}.${j.name}`);
    return scaleOf(joint?.type === JointType.Revolute ? turn : shift);
  }

  private offer(run: Run): void {
    const chosen = this.chosen();
    const key = `${run.world.number} ${chosen} ${this.thing.value}`;
    if (key === this.choices) return;
    this.choices = key;
    const options: HTMLOptionElement[] = [];
    const offer = (text: string, thing: string, name: string, documentation: string): void => {
      const {unit} = this.scaleOf(run.world, {thing, name});
      const option = new Option(unit ? `${text} (${unit})` : text, text);
      option.title = documentation;
      options.push(option);
    };
    for (const table of this.tables) {
      for (const thing of table.things) {
        const part = thing === chosen ? '' : thing.startsWith(`${chosen}.`) ? thing.slice(chosen.length + 1) : null;
        if (part === null) continue;
        for (const {name, documentation} of table.signals) offer(part === '' ? name : `${part} ${name}`, thing, name, documentation);
      }
    }
    const robot = this.thing.value === '' ? run.world.robots[this.selected] : undefined;
    for (const sensor of robot?.sensors ?? []) {
      if (sensor.parameters.type === 'ranger') offer(`range/${sensor.name}`, chosen, `range/${sensor.name}`, 'the nearest range');
    }
    if (robot) offer(ANSWER, chosen, ANSWER, 'the time in which its agent answers');
    this.choice.disabled = options.length === 0;
    this.choice.replaceChildren(new Option('Add …', ''), ...options);
  }

  // The ends of the shown time, as positions: it ends with the live state, and has a past one in it.
  private window(run: Run): [number, number] {
    const seconds = Number(this.range.value);
    if (!Number.isFinite(seconds)) return [run.first, run.last];
    const states = Math.max(2, Math.round(seconds / run.world.interval));
    const last = run.past ? Math.min(run.last, Math.max(run.position + Math.round(states / 4), run.first + states)) : run.last;
    return [Math.max(run.first, last - states), last];
  }

  private gatewaySignals(): Array<[string, string]> {
    return this.shown.filter(({name}) => name !== ANSWER).map(({thing, name}) => [thing, name]);
  }

  // Asks for the values that are missing, a part at a time.
  private async fetch(run: Run): Promise<void> {
    if (this.asking) return;
    const signals = this.gatewaySignals();
    const [from, to] = this.window(run);
    const every = 2 ** Math.max(0, Math.ceil(Math.log2((to - from + 1) / MOST_SAMPLES)));
    const key = `${run.world.run} ${every} ${JSON.stringify(signals)}`;
    const first = Math.floor(from / every) * every;
    const known = this.samples;
    if (!known || known.key !== key || first < known.from || first > known.next) {
      this.samples = {key, every, from: first, next: first, ticks: [], positions: [], values: signals.map(() => [])};
    }
    const samples = this.samples!;
    if (signals.length === 0 || samples.next > to) return;
    this.asking = true;
    const reply = await this.connection.series(signals, samples.next, to, every);
    this.asking = false;
    if (!reply.done || this.samples !== samples) return;
    this.append(samples, reply, to);
    if (this.run) this.show(this.run, this.selected);
  }

  private append(samples: Samples, reply: SeriesReply, to: number): void {
    samples.positions.push(...reply.positions);
    samples.ticks.push(...reply.ticks);
    reply.values.forEach((values, i) => samples.values[i].push(...values));
    samples.next = reply.next ?? (Math.floor(to / samples.every) + 1) * samples.every;
    const old = samples.positions.length - 4 * MOST_SAMPLES;
    if (old <= 0) return;
    samples.from = samples.positions[old];
    for (const list of [samples.positions, samples.ticks, ...samples.values]) list.splice(0, old);
  }

  private noteAnswers(run: Run): void {
    if (run.past) return;
    for (const {thing, name} of this.shown) {
      if (name !== ANSWER) continue;
      const seconds = this.answer(thing);
      const known = this.answers.get(thing) ?? [];
      this.answers.set(thing, known);
      if (seconds !== null && run.position > (known[known.length - 1]?.[0] ?? -1)) known.push([run.position, 1000 * seconds]);
      if (known.length > 10 * MOST_SAMPLES) known.splice(0, MOST_SAMPLES);
    }
  }

  private curvesOf(run: Run): Map<string, Curve[]> {
    const curves = new Map<string, Curve[]>();  // by unit
    const samples = this.samples;
    const used = new Map<string, number>();  // signals of a robot so far
    let column = 0;
    for (const signal of this.shown) {
      const {unit, scale} = this.scaleOf(run.world, signal);
      const robot = run.world.robots.findIndex(r => r.present && (r.name === signal.thing || signal.thing.startsWith(`${r.name}.`)));
      const color = robotColor(robot >= 0 ? robot : this.shown.indexOf(signal));
      const count = used.get(signal.thing) ?? 0;
      used.set(signal.thing, count + 1);
      const points: Array<[number, number | null]> = signal.name === ANSWER ? this.answers.get(signal.thing) ?? []
        : samples?.positions.map((position, i): [number, number | null] => {
          const value = samples.values[column]?.[i] ?? null;
          return [position, value === null ? null : value * scale];
        }) ?? [];
      if (signal.name !== ANSWER) ++column;
      const list = curves.get(unit) ?? [];
      list.push({
        name: `${signal.thing} ${signal.name}`, color, dash: DASHES[count % DASHES.length], points,
        isTurn: signal.name === 'heading', remove: () => this.remove(signal),
      });
      curves.set(unit, list);
    }
    return curves;
  }

  private draw(run: Run): void {
    const curves = this.curvesOf(run);
    const [from, to] = this.window(run);
    while (this.charts.childElementCount > curves.size) this.charts.lastElementChild!.remove();
    while (this.charts.childElementCount < curves.size) this.charts.append(make('figure', 'plot'));
    const axis = {
      from, to: Math.max(to, from + 1), now: run.position, spans: spansOf(run), interval: run.world.interval,
      every: this.samples?.every ?? 1, seek: this.seek,
      timeOf: (position: number) => clockText(secondsAt(run, position), run.world.interval < 0.1 ? 2 : 1),
    };
    [...curves].forEach(([unit, list], i) => chart(this.charts.children[i] as HTMLElement, unit, list, axis));
  }

  // Each tick in the shown time, in the units of the simulation: m, rad, s.
  async csv(): Promise<string> {
    const run = this.run;
    if (!run) return '';
    const signals = this.gatewaySignals();
    const answers = this.shown.filter(({name}) => name === ANSWER);
    const [from, to] = this.window(run);
    const quoted = (text: string): string => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
    const head = [...signals.map(([thing, name]) => `${thing}.${name}`), ...answers.map(({thing}) => `${thing}.answer_ms`)];
    const lines = [['tick', 'time', ...head].map(quoted).join(',')];
    for (let next: number | null = from; next !== null;) {
      const reply: SeriesReply = await this.connection.series(signals, next, to, 1);
      if (!reply.done) throw new Error(reply.problem);
      reply.ticks.forEach((tick, i) => {
        const values = reply.values.map(column => column[i]);
        const seen = answers.map(({thing}) => this.answers.get(thing)?.find(([position]) => position === reply.positions[i])?.[1] ?? null);
        const time = Number((tick * run.world.interval).toFixed(9));
        lines.push([tick, time, ...[...values, ...seen].map(value => value ?? '')].join(','));
      });
      next = reply.next;
    }
    return `${lines.join('\n')}\n`;
  }

  private async save(): Promise<void> {
    this.export.disabled = true;
    setText(this.export, '…');
    try {
      saveText(await this.csv(), `${this.fileName()}.csv`);
      toast('The values are saved');
    } catch (error) {
      toast((error as Error).message, true);
    }
    this.export.disabled = false;
    setText(this.export, 'CSV');
  }
}
