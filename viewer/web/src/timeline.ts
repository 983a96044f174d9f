// Timeline: shows past states of a live run, and the states of a recording: by dragging, and playing forwards and backwards
// at any speed. A state is asked for by its position; the gateway answers with an update of the past.
import type {Connection} from './connection';
import {byId, toast} from './dom';
import {eventColor} from './events';
import type {Run} from './run';

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
    byId('live').hidden = this.recording;
    byId('continue').hidden = this.recording || !run.past;
    byId('live').classList.toggle('on', !this.past);
    byId('back').hidden = byId('step-back').hidden = !this.past;
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
