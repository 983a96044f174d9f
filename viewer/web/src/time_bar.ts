// The time bar: the state of the run, and the buttons that control its time.
//
// The buttons mean the live run or the past, whichever is shown; in the past they move the timeline and send nothing to
// the run. The page never assumes that a request was executed: a button changes its look with the state that comes
// back.
import type {Connection} from './connection';
import {byId, fixed, setText, toast} from './dom';
import type {EventItems} from './event_items';
import type {Run} from './run';
import {Timeline} from './timeline';
import {clockText} from './times';

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
  private online = true;
  readonly timeline: Timeline;

  constructor(private readonly connection: Connection, items: EventItems, changed: () => void) {
    this.timeline = new Timeline(
      connection, items, () => (this.speed.value === 'max' ? 0 : Number(this.speed.value)), () => {
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

  // False: no program answers.
  setOnline(online: boolean): void {
    this.online = online;
    this.timeline.setOnline(online);
    this.show(this.run);
  }

  toggle(): void {
    if (!this.online) return;
    if (this.timeline.inPast) this.timeline.toggle();
    else if (this.run?.over) this.timeline.replay();
    else if (!this.play.disabled) void this.send(this.run?.paused ? 'play' : 'pause');
  }

  step(ticks: number): void {
    if (!this.online) return;
    if (this.timeline.inPast) this.timeline.step(ticks);
    else if (!this.stepOne.disabled) void this.send('step', {ticks});
  }

  show(run: Run | null): void {
    this.run = run;
    const past = this.timeline.inPast;
    const usable = this.online && run !== null && run.hasState && (past || (!run.over && !this.viewOnly));
    const over = run !== null && run.hasState && run.over && !past;
    const stands = over || (past ? !this.timeline.isPlaying : run?.paused ?? false);
    this.play.disabled = !this.online || (!usable && !over);
    this.speed.disabled = !usable;
    this.reset.disabled = !usable || past;
    this.stepOne.disabled = this.stepTen.disabled = !usable || !stands;
    this.play.classList.toggle('paused', stands);
    this.play.title = this.play.ariaLabel = over ? 'Play again from the start (space)' : stands ? 'Play (space)' : 'Pause (space)';
    if (!run?.hasState) return;
    this.timeline.show(run);
    const status = run.status;
    if (status && !past && document.activeElement !== this.speed) this.showSpeed(status.speed ?? 0);
    setText(byId('time'), clockText(run.seconds));
    setText(byId('tick'), status && status.target_ticks > 0 ? `tick ${run.tick} of ${status.target_ticks}` : `tick ${run.tick}`);
    setText(byId('factor'), !this.online ? 'ended' : past ? (run.past ? 'the past' : 'going back') : run.over ? 'the run is over' : run.paused ? 'paused'
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

  // A speed that the list lacks was set by the command line or another tool.
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
