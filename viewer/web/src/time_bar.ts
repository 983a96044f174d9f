// The time bar: the state of the run, and the buttons that control its time.
import type {Connection} from './connection';
import {byId, fixed, setText, toast} from './dom';
import type {Run} from './run';

function clock(seconds: number): string {
  const whole = Math.floor(seconds / 60);
  return whole > 0 ? `${whole} min ${fixed(seconds - 60 * whole, 1)} s` : `${fixed(seconds, 1)} s`;
}

export class TimeBar {
  private run: Run | null = null;
  private readonly play = byId<HTMLButtonElement>('play');
  private readonly stepOne = byId<HTMLButtonElement>('step');
  private readonly stepTen = byId<HTMLButtonElement>('step-ten');
  private readonly reset = byId<HTMLButtonElement>('reset');
  private viewOnly = false;

  constructor(private readonly connection: Connection) {
    this.play.onclick = () => this.toggle();
    this.stepOne.onclick = () => this.step(1);
    this.stepTen.onclick = () => this.step(10);
    this.reset.onclick = () => void this.send('reset');
  }

  setViewOnly(viewOnly: boolean): void {
    this.viewOnly = viewOnly;
  }

  toggle(): void {
    if (!this.play.disabled) void this.send(this.run?.paused ? 'play' : 'pause');
  }

  step(ticks: number): void {
    if (!this.stepOne.disabled) void this.send('step', {ticks});
  }

  show(run: Run | null): void {
    this.run = run;
    const usable = run !== null && run.hasState && !run.over && !this.viewOnly;
    this.play.disabled = this.reset.disabled = !usable;
    this.stepOne.disabled = this.stepTen.disabled = !usable || !run.paused;
    this.play.classList.toggle('paused', run?.paused ?? false);
    this.play.title = run?.paused ? 'Play (space)' : 'Pause (space)';
    if (!run?.hasState) return;
    const status = run.status;
    setText(byId('time'), clock(run.seconds));
    setText(byId('tick'), status && status.targetTicks > 0 ? `tick ${run.tick} of ${status.targetTicks}` : `tick ${run.tick}`);
    const progress = byId('progress');
    progress.hidden = !status || status.targetTicks === 0;
    if (status && status.targetTicks > 0) {
      byId('progress-bar').style.width = `${fixed(100 * Math.min(1, run.tick / status.targetTicks), 2)}%`;
    }
    setText(byId('factor'), run.over ? 'the run is over' : run.paused ? 'paused'
      : status ? `${fixed(status.realTimeFactor, status.realTimeFactor < 10 ? 1 : 0)} × real time` : '');
    const waiting = byId('waiting');
    const names = status?.waitingFor ?? [];
    waiting.hidden = names.length === 0 || run.over;
    if (names.length > 0 && status) {
      const more = status.waitingCount - Math.min(4, names.length);
      setText(waiting, `waiting for ${names.slice(0, 4).join(', ')}${more > 0 ? ` and ${more} more` : ''} (${fixed(status.waitingSeconds, 1)} s)`);
    }
  }

  private async send(command: string, more: object = {}): Promise<void> {
    const reply = await this.connection.request(command, more);
    if (!reply.done) toast(reply.problem, true);
  }
}
