// The speed of the selected robot over the last seconds of simulated time.
import {fixed} from './dom';
import type {Run} from './run';

const SECONDS = 20;  // of simulated time
const MOST = 1200;  // samples

export class SpeedPlot {
  private samples: Array<[number, number]> = [];  // s, m/s
  private key = '';

  constructor(private readonly canvas: HTMLCanvasElement) {}

  // At each update.
  add(run: Run, robot: number): void {
    const key = `${run.world.name} ${robot}`;
    const last = this.samples[this.samples.length - 1];
    if (key !== this.key || (last && run.seconds < last[0])) this.samples = [];
    this.key = key;
    const row = run.robots[robot];
    if (!row || (last && this.samples.length > 0 && run.seconds === last[0])) return;
    this.samples.push([run.seconds, Math.hypot(row.twist.vx, row.twist.vy)]);
    const first = this.samples.findIndex(([time]) => time >= run.seconds - SECONDS);
    if (first > 0 || this.samples.length > MOST) this.samples.splice(0, Math.max(first, this.samples.length - MOST));
  }

  draw(): void {
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    if (width === 0 || this.samples.length === 0) return;
    const ratio = Math.min(window.devicePixelRatio, 2);
    if (this.canvas.width !== Math.round(width * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const style = getComputedStyle(document.documentElement);
    const context = this.canvas.getContext('2d')!;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const top = Math.max(0.1, ...this.samples.map(([, speed]) => speed));
    const end = this.samples[this.samples.length - 1][0];
    context.strokeStyle = style.getPropertyValue('--line');
    context.strokeRect(0.5, 0.5, width - 1, height - 1);
    context.beginPath();
    this.samples.forEach(([time, speed], i) => {
      const x = width * (1 - (end - time) / SECONDS);
      const y = height - 3 - (height - 6) * (speed / top);
      if (i === 0) context.moveTo(x, y);
      else context.lineTo(x, y);
    });
    context.strokeStyle = style.getPropertyValue('--rays');
    context.lineWidth = 1.5;
    context.stroke();
    context.fillStyle = style.getPropertyValue('--faint');
    context.font = '10px system-ui, sans-serif';
    context.fillText(`${fixed(top, 2)} m/s, last ${SECONDS} s`, 5, 12);
  }
}
