// The expectations of the run's scenario: one row each under the timeline, with the verdict over time on the axis of
// the timeline. The gateway judges the past, a part at a time (viewer/gateway/expectation_rows.h).
//
// The page asks until a reply is complete and then again when the run has advanced, at most twice a second: judging
// competes with seeking for the gateway's thread.
import type {Connection, SessionInfo} from './connection';
import {byId, fixed, make, setText} from './dom';
import type {ExpectationRow, ExpectationsReply} from './protocol';
import type {Run} from './run';
import {clockText, secondsAt} from './times';

const PERIOD = 500;  // ms, at least between two questions about a run that continues
const MARKS = ['open', 'holds', 'violated'] as const;
const COLORS = {open: 'var(--open)', holds: 'var(--moving)', violated: 'var(--lost)'};

type State = (typeof MARKS)[number];

interface Shown {
  state: State;
  text: string;
}

interface Elements {
  row: HTMLButtonElement;
  name: HTMLElement;
  band: HTMLElement;
  verdict: HTMLElement;
}

export class Expectations {
  private readonly box = byId('expectations');
  private readonly toggle = byId<HTMLButtonElement>('expectations-toggle');
  private readonly list = byId('expectations-list');
  private readonly axis = byId('timeline-box');
  private readonly now = make('div', 'expect-now');
  private elements: Elements[] = [];
  private reply: ExpectationsReply | null = null;
  private of = '';  // the run that the reply is about
  private asking = false;  // and for some time after the answer
  private askedTo = -1;  // the newest position when it was asked

  // `changed`: there is news to show.
  constructor(
      private readonly connection: Connection, private readonly seek: (position: number) => void, private readonly changed: () => void) {
    const phone = matchMedia('(max-width: 760px), (max-height: 480px)').matches;
    this.open((localStorage.getItem('expectations') ?? (phone ? 'closed' : 'open')) === 'open');
    this.toggle.onclick = () => {
      this.open(this.list.hidden);
      localStorage.setItem('expectations', this.list.hidden ? 'closed' : 'open');
      this.changed();
    };
    new ResizeObserver(() => document.body.style.setProperty('--expectations', `${this.box.offsetHeight}px`)).observe(this.box);
  }

  show(run: Run, info: SessionInfo | null): void {
    this.box.hidden = (info?.expectations ?? 0) === 0;
    if (this.box.hidden || !info) return;
    if (this.of !== run.world.run) {
      this.of = run.world.run;
      this.reply = null;
      this.askedTo = -1;
    }
    void this.ask(run);
    this.render(run, info);
  }

  private open(open: boolean): void {
    this.list.hidden = !open;
    this.toggle.setAttribute('aria-expanded', String(open));
  }

  // Nothing is new in a run that stands.
  private async ask(run: Run): Promise<void> {
    if (this.asking || this.askedTo === run.last) return;
    this.asking = true;
    const of = this.of;
    const to = run.last;
    for (;;) {
      const reply = await this.connection.expectations();
      if (this.of !== of) break;
      if (!reply.done) break;
      this.reply = reply;
      this.askedTo = reply.complete ? to : -1;
      this.changed();
      if (reply.complete) break;
    }
    setTimeout(() => {
      this.asking = false;
      this.changed();  // a run that was paused meanwhile has no other news
    }, PERIOD);
  }

  private render(run: Run, info: SessionInfo): void {
    const reply = this.reply;
    if (!reply) return setText(this.toggle, `${info.expectations} expectations`);
    const shown = reply.rows.map(row => this.stateOf(run, info, reply, row));
    const count = (state: State): number => shown.filter(each => each.state === state).length;
    const [holds, violated] = [count('holds'), count('violated')];
    const problem = reply.rows.filter(row => row.problem !== '').length;
    const parts = [
      `${reply.rows.length} ${reply.rows.length === 1 ? 'expectation' : 'expectations'}`, violated > 0 ? `${violated} violated` : '',
      holds > 0 ? `${holds} ${holds === 1 ? 'holds' : 'hold'}` : '', problem > 0 ? `${problem} not judged` : '',
      reply.from_tick > 0 ? `judged from ${clockText(reply.from_tick * run.world.interval)} on` : '', reply.problem_at,
    ];
    setText(this.toggle, parts.filter(part => part !== '').join(' · '));
    this.toggle.classList.toggle('violated', violated > 0);
    if (this.list.hidden) return;
    this.layOut();
    if (this.elements.length !== reply.rows.length) this.make(reply.rows.length);
    reply.rows.forEach((row, i) => this.fill(this.elements[i], run, reply, row, shown[i]));
    const at = run.past || info.recording ? run.position : run.last;
    this.now.style.left = `calc(var(--axis-left) + 7px + (var(--axis-width) - 14px) * ${this.share(run, at).toFixed(5)})`;
  }

  // The rows have the axis of the timeline.
  private layOut(): void {
    const axis = this.axis.getBoundingClientRect();
    const left = axis.left - this.list.getBoundingClientRect().left;
    this.list.style.setProperty('--axis-left', `${left}px`);
    this.list.style.setProperty('--axis-width', `${axis.width}px`);
  }

  private make(count: number): void {
    this.elements = Array.from({length: count}, () => {
      const row = make('button', 'expect-row') as HTMLButtonElement;
      const elements = {row, name: make('span', 'expect-name'), band: make('span', 'expect-band'), verdict: make('span', 'expect-verdict')};
      row.append(elements.name, elements.band, elements.verdict);
      return elements;
    });
    this.list.replaceChildren(...this.elements.map(each => each.row), this.now);
  }

  private fill(elements: Elements, run: Run, reply: ExpectationsReply, row: ExpectationRow, shown: Shown): void {
    const {row: button, name, band, verdict} = elements;
    setText(name, row.name);
    setText(verdict, shown.text);
    button.dataset.state = row.problem ? 'problem' : shown.state;
    const target = row.problem ? null : row.cause ?? row.decided ?? null;
    const goes = target === null ? '' : `. Go to ${clockText(secondsAt(run, target))}`;
    const margin = marginText(row);
    const title = `${row.text}${row.problem ? `\n${row.problem}` : ''}${margin ? `\n${margin}` : ''}${row.names?.length ? `\ndecided by ${row.names.join(', ')}` : ''}`;
    if (button.title !== title) button.title = title;
    const label = `${row.name}: ${shown.text}${goes}`;
    if (button.ariaLabel !== label) button.ariaLabel = label;
    button.dataset.refusal = 'It has not been decided yet.';
    button.setAttribute('aria-disabled', String(target === null));
    button.onclick = target === null ? null : () => this.seek(target);
    const background = this.gradient(run, reply, row);
    if (band.dataset.background !== background) band.style.background = band.dataset.background = background;
  }

  private share(run: Run, position: number): number {
    const end = Math.max(run.last, run.first + 1);
    return Math.max(0, Math.min(1, (position - run.first) / (end - run.first)));
  }

  private gradient(run: Run, reply: ExpectationsReply, row: ExpectationRow): string {
    if (!row.spans || row.spans.length === 0) return 'none';
    const percent = (position: number): string => `${(100 * this.share(run, position)).toFixed(2)}%`;
    const stops: string[] = [`transparent ${percent(row.spans[0][0])}`];
    row.spans.forEach(([from, mark], i) => {
      const to = i + 1 < row.spans!.length ? row.spans![i + 1][0] : reply.to + 1;
      stops.push(`${COLORS[MARKS[mark]]} ${percent(from)} ${percent(to)}`);
    });
    stops.push(`transparent ${percent(reply.to + 1)}`);
    return `linear-gradient(to right, ${stops.join(', ')})`;
  }

  // The verdict at the shown state.
  private stateOf(run: Run, info: SessionInfo, reply: ExpectationsReply, row: ExpectationRow): Shown {
    if (row.problem || !row.spans) return {state: 'open', text: 'not judged'};
    const position = run.past || info.recording ? run.position : reply.to;
    if (typeof row.decided === 'number' && position >= row.decided) {
      return row.verdict === 'true' ? {state: 'holds', text: 'holds'}
        : {state: 'violated', text: `violated ${clockText(secondsAt(run, row.decided))}`};
    }
    const isEnd = reply.complete && position >= reply.to && (info.recording || run.over);
    if (isEnd) return row.at_end ? {state: 'holds', text: 'holds'} : {state: 'violated', text: 'violated at the end'};
    let mark = 0;
    for (const [from, at] of row.spans) if (from <= position) mark = at;
    return mark === 1 ? {state: 'holds', text: 'holds so far'} : {state: 'open', text: 'not decided'};
  }
}

// How far the run is from the other verdict.
function marginText({robustness}: ExpectationRow): string {
  const [least, greatest] = robustness ?? [null, null];
  const margin = least ?? greatest;
  return margin === null ? '' : `margin ${fixed(margin, 3)}`;
}
