// A canvas of the model editor with its own scale: the middle of its lower or central part is the origin. Metres; x to
// the right, y or z up.
import {color} from './colors';

export {color};
export type Point2 = [number, number];

export const NEAR = 9;  // px

export class Sheet {
  scale = 200;  // px per m
  readonly context: CanvasRenderingContext2D;

  // `ground`: y 0 is near the lower edge.
  constructor(readonly canvas: HTMLCanvasElement, private readonly ground: boolean) {
    this.context = canvas.getContext('2d')!;
  }

  resize(): void {
    const {clientWidth, clientHeight} = this.canvas;
    if (this.canvas.width !== clientWidth || this.canvas.height !== clientHeight) {
      this.canvas.width = clientWidth;
      this.canvas.height = clientHeight;
    }
  }
  get originY(): number {
    return this.ground ? this.canvas.height - 28 : this.canvas.height / 2;
  }
  toPixel(a: number, b: number): [number, number] {
    return [this.canvas.width / 2 + a * this.scale, this.originY - b * this.scale];
  }
  toMetres(event: MouseEvent): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [
      (event.clientX - box.left - this.canvas.width / 2) / this.scale,
      (this.originY - event.clientY + box.top) / this.scale,
    ];
  }
  isNear(event: MouseEvent, [a, b]: Point2, distance = NEAR): boolean {
    const at = this.toClient(a, b);
    return Math.hypot(event.clientX - at.x, event.clientY - at.y) < distance;
  }
  // On the window, for tests.
  toClient(a: number, b: number): {x: number; y: number} {
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = this.toPixel(a, b);
    return {x: box.left + x, y: box.top + y};
  }

  drawGrid(): void {
    const {context, canvas} = this;
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.font = '12px system-ui, sans-serif';
    const step = [0.1, 0.5, 1, 5].find(s => s * this.scale >= 16) ?? 10;
    const reach = Math.ceil(Math.max(canvas.width, canvas.height) / this.scale / step) + 1;
    for (let i = -reach; i <= reach; ++i) {
      context.strokeStyle = i === 0 ? color('--faint') : color('--grid');
      context.lineWidth = i % 5 === 0 ? 1 : 0.4;
      const [x, y] = this.toPixel(i * step, i * step);
      context.beginPath();
      context.moveTo(x, 0);
      context.lineTo(x, canvas.height);
      context.moveTo(0, y);
      context.lineTo(canvas.width, y);
      context.stroke();
      if (i !== 0 && i % 5 === 0) {
        context.fillStyle = color('--faint');
        context.fillText(`${Math.round(i * step * 100) / 100} m`, x + 3, this.originY - 3);
        context.fillText(`${Math.round(i * step * 100) / 100} m`, canvas.width / 2 + 3, y - 3);
      }
    }
  }

  // A line through the points; closed ones are filled.
  line(points: Point2[], style: {stroke: string; width?: number; dash?: number[]; fill?: string}): void {
    const {context} = this;
    context.beginPath();
    for (const [a, b] of points) context.lineTo(...this.toPixel(a, b));
    if (style.fill) {
      context.closePath();
      context.globalAlpha = 0.25;
      context.fillStyle = style.fill;
      context.fill();
      context.globalAlpha = 1;
    }
    context.setLineDash(style.dash ?? []);
    context.lineWidth = style.width ?? 1;
    context.strokeStyle = style.stroke;
    context.stroke();
    context.setLineDash([]);
    context.lineWidth = 1;
  }
  square([a, b]: Point2, fill: string): void {
    const [x, y] = this.toPixel(a, b);
    this.context.fillStyle = fill;
    this.context.fillRect(x - 4, y - 4, 8, 8);
  }
  circle([a, b]: Point2, radius: number, stroke: string, fill = ''): void {
    const [x, y] = this.toPixel(a, b);
    const {context} = this;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    if (fill) {
      context.fillStyle = fill;
      context.fill();
    }
    context.strokeStyle = stroke;
    context.stroke();
  }
}
