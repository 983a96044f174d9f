// The time bar: the state of the run, and the buttons that control its time.
import type {Connection} from './connection';
import {byId, fixed, setText, toast} from './dom';
import {eventColor} from './robot_list';
import type {Run} from './run';

function clock(seconds: number): string {
  const whole = Math.floor(seconds / 60);
  return whole > 0 ? `${whole} min ${fixed(seconds - 60 * whole, 1)} s` : `${fixed(seconds, 1)} s`;
}

function milliseconds(seconds: number): string {
  return fixed(1000 * seconds, seconds < 0.01 ? 2 : seconds < 0.1 ? 1 : 0);
}

export class TimeBar {
  private run: Run | null = null;
  private readonly play = byId<HTMLButtonElement>('play');
  private readonly stepOne = byId<HTMLButtonElement>('step');
  private readonly stepTen = byId<HTMLButtonElement>('step-ten');
  private readonly reset = byId<HTMLButtonElement>('reset');
  private readonly speed = byId<HTMLSelectElement>('speed');
  private viewOnly = false;
  readonly timeline: Timeline;

  constructor(private readonly connection: Connection, changed: () => void) {
    this.timeline = new Timeline(
      connection, () => (this.speed.value === 'max' ? 0 : Number(this.speed.value)), () => {
        this.show(this.run);
        changed();
      });
    this.play.onclick = () => this.toggle();
    this.stepOne.onclick = () => this.step(1);
    this.stepTen.onclick = () => this.step(10);
    this.reset.onclick = () => void this.send('reset');
    this.speed.onchange = () => void this.setSpeed(this.speed.value);
  }

  setViewOnly(viewOnly: boolean): void {
    this.viewOnly = viewOnly;
  }

  toggle(): void {
    if (this.timeline.inPast) this.timeline.toggle();
    else if (!this.play.disabled) void this.send(this.run?.paused ? 'play' : 'pause');
  }

  step(ticks: number): void {
    if (this.timeline.inPast) this.timeline.step(ticks);
    else if (!this.stepOne.disabled) void this.send('step', {ticks});
  }

  show(run: Run | null): void {
    this.run = run;
    const past = this.timeline.inPast;
    const usable = run !== null && run.hasState && (past || (!run.over && !this.viewOnly));
    const stands = past ? !this.timeline.isPlaying : run?.paused ?? false;
    this.play.disabled = this.speed.disabled = !usable;
    this.reset.disabled = !usable || past;
    this.stepOne.disabled = this.stepTen.disabled = !usable || !stands;
    this.play.classList.toggle('paused', stands);
    this.play.title = this.play.ariaLabel = stands ? 'Play (space)' : 'Pause (space)';
    if (!run?.hasState) return;
    this.timeline.show(run);
    const status = run.status;
    if (status && !past && document.activeElement !== this.speed) this.showSpeed(status.speed ?? 0);
    setText(byId('time'), clock(run.seconds));
    setText(byId('tick'), status && status.target_ticks > 0 ? `tick ${run.tick} of ${status.target_ticks}` : `tick ${run.tick}`);
    setText(byId('factor'), past ? (run.past ? 'the past' : 'going back') : run.over ? 'the run is over' : run.paused ? 'paused'
      : status ? `${fixed(status.real_time_factor, status.real_time_factor < 10 ? 1 : 0)} × real time` : '');
    const phases = Object.entries(status?.phases ?? {});
    const live = status !== null && !past && !run.over && !run.paused && phases.some(([, seconds]) => seconds > 0);
    setText(byId('phases'), live ? phases.map(([name, s]) => `${name} ${milliseconds(s)}`).join(' · ') + ' ms' : '');
    const waiting = byId('waiting');
    const names = status?.waiting_for ?? [];
    waiting.hidden = names.length === 0 || run.over || past;
    if (names.length > 0 && status) {
      const more = status.waiting_count - Math.min(4, names.length);
      setText(waiting, `waiting for ${names.slice(0, 4).join(', ')}${more > 0 ? ` and ${more} more` : ''} (${fixed(status.waiting_seconds, 1)} s)`);
    }
  }

  // Other values than those of the list are those of the command line.
  private showSpeed(speed: number): void {
    const value = speed === 0 ? 'max' : String(speed);
    if (this.speed.value === value) return;
    if (![...this.speed.options].some(option => option.value === value)) {
      this.speed.prepend(new Option(`${fixed(speed, 2)} ×`, value));
    }
    this.speed.value = value;
  }

  private async setSpeed(value: string): Promise<void> {
    this.speed.blur();
    if (this.timeline.inPast) return;
    await this.send('speed', {speed: value === 'max' ? value : Number(value)});
  }

  private async send(command: string, more: object = {}): Promise<void> {
    const reply = await this.connection.request(command, more);
    if (!reply.done) toast(reply.problem, true);
  }
}

// Timeline: shows past states of a live run, and the states of a recording: by dragging, and playing forwards and backwards
// at any speed. A state is asked for by its position; the gateway answers with an update of the past.

const FASTEST = 200;  // times real time, in place of "max"

export class Timeline {
  private run: Run | null = null;
  private recording = false;
  private past = false;  // shows, or waits for, a past state
  private wanted: number | null = null;  // the newest position that was asked for and not shown yet
  private sent: number | null = null;  // that the gateway has not answered yet
  private playing = 0;  // states a second; negative: backwards; 0: it stands
  private position = 0;  // with the fractions of a state
  private readonly slider = byId<HTMLInputElement>('timeline');
  private readonly marks = byId<HTMLCanvasElement>('timeline-events');
  private marked = '';

  // `speed`: times real time, 0: as fast as possible. `changed`: it begins or ends to show the past.
  constructor(
      private readonly connection: Connection, private readonly speed: () => number, private readonly changed: () => void) {
    this.slider.oninput = () => {
      this.playing = 0;
      this.seek(Number(this.slider.value));
    };
    byId('live').onclick = () => this.returnToLive();
    byId('back').onclick = () => this.play(this.playing < 0 ? 0 : -1);
    byId('step-back').onclick = () => this.step(-1);
    byId('continue').onclick = () => void this.continueHere();
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
    if (document.activeElement !== this.slider || this.playing !== 0 || !this.past) {
      this.slider.min = String(run.first);
      this.slider.max = String(Math.max(run.last, run.first + 1));
      this.slider.value = String(this.past ? Math.round(this.position) : run.last);
    }
    byId<HTMLButtonElement>('live').disabled = this.recording;
    byId<HTMLButtonElement>('continue').disabled = this.recording || !run.past;
    byId('live').classList.toggle('on', !this.past);
    byId<HTMLButtonElement>('back').disabled = byId<HTMLButtonElement>('step-back').disabled = !this.past;
    byId('back').classList.toggle('on', this.playing < 0);
    this.drawMarks(run);
  }

  private play(direction: number): void {
    if (!this.run || !this.past) return;
    const factor = this.speed() || FASTEST;
    const began = this.playing === 0;
    this.playing = (direction * factor) / this.run.world.interval;
    this.changed();
    if (!began || direction === 0) return;
    this.position = this.run.position;
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

  private drawMarks(run: Run): void {
    const key = `${run.first} ${run.last} ${run.events.length} ${this.marks.clientWidth}`;
    if (key === this.marked) return;
    this.marked = key;
    const {clientWidth: width, clientHeight: height} = this.marks;
    if (this.marks.width !== width) this.marks.width = width;
    if (this.marks.height !== height) this.marks.height = height;
    const context = this.marks.getContext('2d')!;
    context.clearRect(0, 0, width, height);
    for (const event of run.events) {
      if (event.position < run.first || event.position > run.last) continue;
      context.fillStyle = eventColor(event);
      context.fillRect((width * (event.position - run.first)) / Math.max(1, run.last - run.first) - 0.5, 0, 1.5, height);
    }
  }
}
