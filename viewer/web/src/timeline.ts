// The timeline: its axis, and past states of a live run and the states of a recording: by dragging, and playing
// forwards and backwards at any speed. A state is asked for by its position; the gateway answers with an update of the
// past.
//
// One request at a time is under way, and the newest wish replaces the one before it: dragging over thousands of
// positions costs as many states as the gateway can compute, and the thumb never lags behind a queue.
import {color} from './colors';
import type {Connection} from './connection';
import {byId, setText, toast} from './dom';
import type {EventItems} from './event_items';
import type {TimeSpan} from './protocol';
import type {Run} from './run';
import {drawMarks, gatherMarks, markAt, middleOf, textOfMark, type Mark} from './timeline_marks';
import {clockText, labelStep, secondsAt, spansOf, stepDigits} from './times';

const THUMB = 14;  // px, wide, as in time.css
const FASTEST = 200;  // times real time, in place of "max"

export class Timeline {
  private run: Run | null = null;
  private recording = false;
  private online = true;
  private past = false;  // shows, or waits for, a past state
  private wanted: number | null = null;  // the newest position that was asked for and not shown yet
  private sent: number | null = null;  // that the gateway has not answered yet
  private playing = 0;  // states a second; negative: backwards; 0: it stands
  private position = 0;  // with the fractions of a state
  private readonly slider = byId<HTMLInputElement>('timeline');
  private readonly axis = byId<HTMLCanvasElement>('timeline-events');
  private readonly tip = byId('timeline-tip');
  private marks: Mark[] = [];
  private drawn = '';

  // `speed`: times real time, 0: as fast as possible. `changed`: it begins or ends to show the past.
  constructor(
      private readonly connection: Connection, private readonly items: EventItems, private readonly speed: () => number,
      private readonly changed: () => void) {
    this.slider.oninput = () => {
      this.playing = 0;
      this.seek(Number(this.slider.value));
    };
    byId('live').onclick = () => this.returnToLive();
    byId('back').onclick = () => this.play(this.playing < 0 ? 0 : -1);
    byId('step-back').onclick = () => this.step(-1);
    byId('continue').onclick = () => void this.continueHere();
    this.slider.onpointermove = event => this.pointAt(event.offsetX);
    this.slider.onpointerleave = () => this.pointAt(null);
    // A run that stands has no news that would redraw the axis.
    new ResizeObserver(() => {
      if (this.run) this.draw(this.run);
    }).observe(this.axis);
  }

  get inPast(): boolean {
    return this.past;
  }
  get isPlaying(): boolean {
    return this.playing !== 0;
  }

  setRecording(recording: boolean): void {
    if (recording && !this.recording) this.past = true;
    this.recording = recording;
  }

  // The connection was lost: nothing is answered any more.
  reset(): void {
    this.sent = this.wanted = null;
    this.past = this.recording;
  }

  // False: no program answers.
  setOnline(online: boolean): void {
    this.online = online;
    this.slider.disabled = !online;
    for (const id of ['back', 'step-back']) byId<HTMLButtonElement>(id).disabled = !online;
  }

  seek(position: number): void {
    if (!this.run) return;
    const began = !this.past;
    this.past = true;
    this.position = Math.max(this.run.first, Math.min(this.run.last, position));
    this.wanted = Math.round(this.position);
    this.send();
    if (began) this.changed();
  }

  seekTick(tick: number): void {
    this.past = true;
    this.connection.send({type: 'seek', tick});
    this.changed();
  }

  toggle(): void {
    this.play(this.playing > 0 ? 0 : 1);
  }

  // Plays from the begin.
  replay(): void {
    if (!this.run) return;
    this.seek(this.run.first);
    this.playing = 0;
    this.play(1, this.run.first);
  }

  step(states: number): void {
    this.playing = 0;
    this.seek((this.run?.position ?? 0) + states);
  }

  returnToLive(): void {
    if (this.recording || !this.past) return;
    this.past = false;
    this.playing = 0;
    this.sent = this.wanted = null;
    this.connection.send({type: 'live'});
    this.changed();
  }

  // Sets the run back, by its recording.
  private async continueHere(): Promise<void> {
    if (!this.run?.past) return;
    const reply = await this.connection.request('rewind', {tick: this.run.tick});
    if (reply.done) this.returnToLive();
    else toast(reply.problem, true);
  }

  // With each state, more often than the page shows texts: the next one is asked for at once.
  received(run: Run): void {
    this.run = run;
    if (!run.past) return;
    if (this.playing === 0 && this.wanted === null) this.position = run.position;
    this.sent = null;
    if (this.wanted === run.position) this.wanted = null;
    this.send();
  }

  show(run: Run): void {
    // The axis does not move under a thumb that is dragged.
    if (document.activeElement !== this.slider || this.playing !== 0 || !this.past) {
      this.slider.min = String(run.first);
      this.slider.max = String(Math.max(run.last, run.first + 1));
    }
    this.slider.value = String(this.past ? Math.round(this.position) : run.last);
    byId<HTMLButtonElement>('live').disabled = this.recording || !this.online;
    byId<HTMLButtonElement>('continue').disabled = this.recording || !run.past || !this.online;
    byId('live').classList.toggle('on', !this.past);
    byId<HTMLButtonElement>('back').disabled = byId<HTMLButtonElement>('step-back').disabled = !this.past;
    byId('back').classList.toggle('on', this.playing < 0);
    this.slider.setAttribute('aria-valuetext', clockText(secondsAt(run, Number(this.slider.value))));
    this.draw(run);
  }

  private play(direction: number, from = this.run?.position ?? 0): void {
    if (!this.run || !this.past) return;
    const factor = this.speed() || FASTEST;
    const began = this.playing === 0;
    this.playing = (direction * factor) / this.run.world.interval;
    this.changed();
    if (!began || direction === 0) return;
    this.position = from;
    let last = performance.now();
    const frame = (now: number): void => {
      const run = this.run;
      if (this.playing === 0 || !this.past || !run) return;
      const next = this.position + (this.playing * (now - last)) / 1000;
      last = now;
      this.seek(next);
      if (next >= run.last || next <= run.first) {
        this.playing = 0;
        this.changed();
        return;
      }
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  // One at a time: the gateway is asked for the newest position as soon as it has answered.
  private send(): void {
    if (this.sent !== null || this.wanted === null || this.wanted === this.run?.position && this.run.past) return;
    this.sent = this.wanted;
    if (!this.connection.send({type: 'seek', position: this.wanted})) this.sent = null;
  }

  private draw(run: Run): void {
    const {clientWidth: width, clientHeight: height} = this.axis;
    const theme = document.documentElement.dataset.theme;
    const [begin, end] = [Number(this.slider.min), Number(this.slider.max)];
    const key = [begin, end, run.last, this.items.version, run.spans.length, width, theme].join(' ');
    if (key === this.drawn || width === 0) return;
    this.drawn = key;
    const ratio = Math.min(window.devicePixelRatio, 2);
    this.axis.width = Math.round(width * ratio);
    this.axis.height = Math.round(height * ratio);
    const context = this.axis.getContext('2d')!;
    context.scale(ratio, ratio);
    // As the thumb of the slider moves.
    const x = (position: number): number =>
      THUMB / 2 + ((width - THUMB) * (position - begin)) / (end - begin);
    const spans = spansOf(run).flatMap(([first, last, tick]): TimeSpan[] => {
      const from = Math.max(first, begin);
      return from <= Math.min(last, end) ? [[from, Math.min(last, end), tick + from - first]] : [];
    });
    const middle = height / 2;
    context.fillStyle = color('--field');
    for (const [first, last] of spans) context.fillRect(x(first), middle - 2, Math.max(1, x(last) - x(first)), 4);
    this.drawLabels(context, run, spans, x, width, height);
    this.marks = gatherMarks(this.items, begin, end, run.last, x);
    drawMarks(context, this.marks, middle - 4);
  }

  // Shows what the mark under the pointer stands for.
  private pointAt(x: number | null): void {
    const mark = x === null ? undefined : markAt(this.marks, x);
    this.tip.hidden = !mark || !this.run;
    if (!mark || !this.run) return;
    setText(this.tip, textOfMark(mark, this.run));
    const half = this.tip.offsetWidth / 2;
    this.tip.style.left = `${Math.max(half, Math.min(this.axis.clientWidth - half, middleOf(mark)))}px`;
  }

  // Each span has its own times. Where one ends and another begins that does not follow it, there is a gap or a jump.
  private drawLabels(
      context: CanvasRenderingContext2D, run: Run, spans: TimeSpan[], x: (position: number) => number, width: number,
      height: number): void {
    const {interval} = run.world;
    const [begin, end] = [Number(this.slider.min), Number(this.slider.max)];
    const step = labelStep((end - begin) * interval, Math.max(1, Math.floor(width / 64)));
    context.font = '12px system-ui, sans-serif';
    context.textBaseline = 'bottom';
    let free = 0;
    spans.forEach(([first, last, tick], i) => {
      if (i > 0) {
        context.fillStyle = color('--accent');
        context.fillRect(x(first) - 1, height / 2 - 6, 2, 12);
      }
      context.fillStyle = color('--faint');
      const shift = first - tick;  // from ticks to positions
      for (let time = Math.ceil((tick * interval) / step - 1e-9) * step; time <= (last - shift) * interval + 1e-9; time += step) {
        const at = x(time / interval + shift);
        context.fillRect(Math.round(at) - 0.5, height / 2 + 2, 1, 4);
        const text = clockText(time, stepDigits(step));
        const wide = context.measureText(text).width;
        const left = Math.max(0, Math.min(width - wide, at - wide / 2));
        if (left < free) continue;
        context.fillText(text, left, height + 1);
        free = left + wide + 10;
      }
    });
  }
}
