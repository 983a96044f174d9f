// chart: curves over the positions of the timeline, with axes, a legend, the shown moment, and the values at the
// pointer.
//
// The horizontal axis is the position and not the time, as that of the timeline: so a rewind, after which ticks begin
// again, does not fold a curve back, and a click always means one state. Labels show simulated time.
import {color} from './colors';
import {fixed, make, setText} from './dom';
import type {TimeSpan} from './protocol';
import {clockText, labelStep, stepDigits} from './times';

export interface Curve {
  name: string;
  color: string;
  dash: number[];
  points: Array<[number, number | null]>;  // position, value; null: none
  isTurn: boolean;  // an angle, which jumps by a whole turn
  remove: () => void;
}

export interface Axis {
  from: number;  // positions
  to: number;
  now: number;  // the shown one
  every: number;  // between two points
  spans: TimeSpan[];
  interval: number;  // s, of a tick
  seek: (position: number) => void;
  timeOf: (position: number) => string;
}

const HEIGHT = 116;  // px
const LEFT = 44;
const BOTTOM = 18;
const TOP = 8;
const RIGHT = 8;

// Distances of labels: 1, 2 or 5 times a power of ten.
function valueStep(range: number): number {
  const power = 10 ** Math.floor(Math.log10(range / 3));
  return [1, 2, 5, 10].map(factor => factor * power).find(step => range / step <= 4) ?? 10 * power;
}

function valueText(value: number, step: number): string {
  return fixed(value, Math.max(0, Math.min(6, -Math.floor(Math.log10(step) + 1e-9))));
}

function limits(curves: Curve[], {from, to}: Axis): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  for (const {points} of curves) {
    for (const [position, value] of points) {
      if (value === null || position < from || position > to) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  if (low > high) return [0, 1];
  const margin = Math.max(0.06 * (high - low), 1e-3 * Math.max(Math.abs(low), Math.abs(high)), 1e-6);
  return [low === 0 ? 0 : low - margin, high + margin];
}

interface Parts {
  canvas: HTMLCanvasElement;
  legend: HTMLElement;
  pointer: number | null;  // px from the left
  again: () => void;
}

const parts = new WeakMap<HTMLElement, Parts>();

function partsOf(figure: HTMLElement): Parts {
  const known = parts.get(figure);
  if (known) return known;
  const made: Parts = {
    canvas: make('canvas', 'plot-canvas') as HTMLCanvasElement, legend: make('figcaption', 'plot-legend'), pointer: null,
    again: () => undefined,
  };
  made.canvas.setAttribute('role', 'img');
  made.canvas.onpointermove = event => {
    made.pointer = event.offsetX;
    made.again();
  };
  made.canvas.onpointerleave = () => {
    made.pointer = null;
    made.again();
  };
  figure.append(made.legend, made.canvas);
  parts.set(figure, made);
  return made;
}

// Shows the curves in the figure, all of one unit.
export function chart(figure: HTMLElement, unit: string, curves: Curve[], axis: Axis): void {
  const made = partsOf(figure);
  made.again = () => draw(made, unit, curves, axis);
  made.canvas.onclick = event => axis.seek(Math.round(positionAt(event.offsetX, made.canvas.clientWidth, axis)));
  made.again();
}

function positionAt(x: number, width: number, {from, to}: Axis): number {
  return Math.max(from, Math.min(to, from + ((x - LEFT) / (width - LEFT - RIGHT)) * (to - from)));
}

// The point nearest to a position, if it is near.
function valueAt(curve: Curve, position: number, every: number): number | null {
  let best: [number, number | null] | null = null;
  for (const point of curve.points) if (!best || Math.abs(point[0] - position) < Math.abs(best[0] - position)) best = point;
  return best && Math.abs(best[0] - position) <= Math.max(every, 20) ? best[1] : null;
}

function showLegend(made: Parts, unit: string, curves: Curve[], axis: Axis, at: number): void {
  const {legend} = made;
  while (legend.childElementCount > curves.length) legend.lastElementChild!.remove();
  while (legend.childElementCount < curves.length) {
    const row = make('div', 'plot-name');
    const close = make('button', 'plain', '×');
    row.append(make('span', 'plot-line'), make('span', 'plot-text'), make('span', 'plot-value'), close);
    legend.append(row);
  }
  curves.forEach((curve, i) => {
    const [line, name, value, close] = [...legend.children[i].children] as HTMLElement[];
    line.style.borderTopColor = curve.color;
    line.style.borderTopStyle = curve.dash.length === 0 ? 'solid' : curve.dash[0] > 3 ? 'dashed' : 'dotted';
    setText(name, curve.name);
    const found = valueAt(curve, at, axis.every);
    setText(value, found === null ? '–' : `${fixed(found, 2)}${unit ? ` ${unit}` : ''}`);
    close.title = close.ariaLabel = `Remove ${curve.name}`;
    close.onclick = curve.remove;
  });
}

function draw(made: Parts, unit: string, curves: Curve[], axis: Axis): void {
  const {canvas} = made;
  const width = canvas.clientWidth;
  const at = made.pointer === null ? Math.max(axis.from, Math.min(axis.to, axis.now)) : positionAt(made.pointer, width, axis);
  showLegend(made, unit, curves, axis, at);
  if (width === 0) return;
  canvas.ariaLabel = `${curves.map(curve => curve.name).join(', ')} over time, ${unit}`;
  const ratio = Math.min(window.devicePixelRatio, 2);
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(HEIGHT * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(HEIGHT * ratio);
  }
  const context = canvas.getContext('2d')!;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, HEIGHT);
  const [low, high] = limits(curves, axis);
  const bottom = HEIGHT - BOTTOM;
  const x = (position: number): number => LEFT + ((width - LEFT - RIGHT) * (position - axis.from)) / (axis.to - axis.from);
  const y = (value: number): number => bottom - ((bottom - TOP) * (value - low)) / (high - low);

  context.font = '12px system-ui, sans-serif';
  context.lineWidth = 1;
  context.strokeStyle = color('--line');
  context.fillStyle = color('--faint');
  context.textBaseline = 'middle';
  context.textAlign = 'right';
  const step = valueStep(high - low);
  for (let value = Math.ceil(low / step) * step; value <= high; value += step) {
    const line = Math.round(y(value)) + 0.5;
    context.beginPath();
    context.moveTo(LEFT, line);
    context.lineTo(width - RIGHT, line);
    context.stroke();
    context.fillText(valueText(value, step), LEFT - 5, line);
  }
  drawTimes(context, axis, x, width, bottom);

  context.save();
  context.beginPath();
  context.rect(LEFT, 0, width - LEFT - RIGHT, bottom + 1);
  context.clip();
  context.lineWidth = 1.6;
  for (const curve of curves) {
    context.strokeStyle = curve.color;
    context.setLineDash(curve.dash);
    context.beginPath();
    let before: [number, number] | null = null;
    for (const [position, value] of curve.points) {
      if (position < axis.from - axis.every || position > axis.to + axis.every) continue;
      if (value === null) {
        before = null;
        continue;
      }
      const isApart = !before || (curve.isTurn && Math.abs(value - before[1]) > 180);
      if (isApart) context.moveTo(x(position), y(value));
      else context.lineTo(x(position), y(value));
      before = [position, value];
    }
    context.stroke();
  }
  context.restore();

  context.strokeStyle = color(made.pointer === null ? '--accent' : '--faint');
  context.setLineDash([]);
  context.lineWidth = 1;
  const line = Math.round(x(at)) + 0.5;
  context.beginPath();
  context.moveTo(line, TOP - 4);
  context.lineTo(line, bottom);
  context.stroke();
  if (made.pointer === null) return;
  const text = axis.timeOf(Math.round(at));
  const wide = context.measureText(text).width + 8;
  const left = Math.max(LEFT, Math.min(width - wide, line - wide / 2));
  context.fillStyle = color('--card');
  context.fillRect(left, bottom + 1, wide, BOTTOM);
  context.fillStyle = color('--text');
  context.textAlign = 'left';
  context.fillText(text, left + 4, bottom + 10);
}

function drawTimes(
    context: CanvasRenderingContext2D, axis: Axis, x: (position: number) => number, width: number, bottom: number): void {
  const {interval} = axis;
  const step = labelStep((axis.to - axis.from) * interval, 4);
  context.textAlign = 'center';
  let free = LEFT - 20;
  axis.spans.forEach(([first, last, tick], i) => {
    const from = Math.max(first, axis.from);
    const to = Math.min(last, axis.to);
    if (from > to) return;
    if (i > 0 && first > axis.from) {
      context.fillStyle = color('--accent');
      context.fillRect(x(first) - 0.5, TOP, 1, bottom - TOP);
      context.fillStyle = color('--faint');
    }
    const shift = first - tick;
    for (let time = Math.ceil(((from - shift) * interval) / step - 1e-9) * step; time <= (to - shift) * interval + 1e-9; time += step) {
      const at = x(time / interval + shift);
      context.fillRect(Math.round(at), bottom, 1, 3);
      const text = clockText(time, stepDigits(step));
      const half = context.measureText(text).width / 2;
      if (at - half < free || at + half > width) continue;
      context.fillText(text, at, bottom + 11);
      free = at + half + 8;
    }
  });
}
