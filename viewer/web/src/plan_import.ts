// PlanImport: a picture of a floor plan becomes the walls of the world. Two points of the picture and their distance
// give its scale; what is darker than a threshold is a wall, or the picture lies below the world for walls to be traced.
//
// The browser decodes the picture, so that every format it reads is accepted and the gateway parses none. The request
// has runs of pixels, free and occupied alternating, which for plans are a small part of the image.
import {byId, setText, toast} from './dom';
import type {FileClient} from './file_client';
import {PlanUnderlay} from './plan_underlay';
import type {WorldScene} from './scene';
import {color} from './sheet';

const MOST_PIXELS = 4_000_000;  // of the image; a larger picture is made smaller
const LONGEST_MESSAGE = 900_000;  // bytes, of the runs of pixels
const PAPER = 255;

type Place = [number, number];  // pixels of the picture

export class PlanImport {
  private picture: {width: number; height: number; grey: Uint8Array} | null = null;
  private points: Place[] = [];
  private dragged = -1;  // index of the point
  private name = 'plan.png';
  private underlay: PlanUnderlay | null = null;
  private readonly box = byId('plan-import');
  private readonly canvas = byId<HTMLCanvasElement>('plan-canvas');
  private readonly distance = byId<HTMLInputElement>('plan-distance');
  private readonly threshold = byId<HTMLInputElement>('plan-threshold');
  private readonly height = byId<HTMLInputElement>('plan-height');
  private readonly file = byId<HTMLInputElement>('plan-file');

  constructor(
      private readonly scene: WorldScene, private readonly client: FileClient, private readonly changed: (name: string) => void) {
    this.file.onchange = () => {
      const [file] = this.file.files ?? [];
      this.file.value = '';
      if (file) void this.open(file);
    };
    byId('plan-close').onclick = () => (this.box.hidden = true);
    byId('plan-apply').onclick = () => void this.apply();
    byId('plan-below').onclick = () => this.layBelow();
    byId('plan-away').onclick = () => this.takeAway();
    for (const input of [this.distance, this.threshold]) input.oninput = () => this.draw();
    this.canvas.onpointerdown = event => {
      const at = this.placeOf(event);
      const scale = this.canvas.clientWidth / (this.picture?.width || 1);
      this.dragged = this.points.findIndex(([x, y]) => Math.hypot(x - at[0], y - at[1]) * scale < 14);
      if (this.dragged < 0) {
        if (this.points.length === 2) this.points = [];
        this.dragged = this.points.push(at) - 1;
      }
      this.canvas.setPointerCapture(event.pointerId);
      this.draw();
    };
    this.canvas.onpointermove = event => {
      if (this.dragged < 0) return;
      this.points[this.dragged] = this.placeOf(event);
      this.draw();
    };
    this.canvas.onpointerup = () => (this.dragged = -1);
    this.box.addEventListener('keydown', event => {
      if (event.key === 'Escape') this.box.hidden = true;
      event.stopPropagation();
    });
    new ResizeObserver(() => this.draw()).observe(byId('plan-view'));
  }

  choose(): void {
    this.file.click();
  }

  private async open(file: File): Promise<void> {
    let image: ImageBitmap;
    try {
      image = await createImageBitmap(file);
    } catch {
      toast(`${file.name} is no picture that the browser can read`, true);
      return;
    }
    const shrink = Math.min(1, Math.sqrt(MOST_PIXELS / (image.width * image.height)));
    const width = Math.max(1, Math.round(image.width * shrink));
    const height = Math.max(1, Math.round(image.height * shrink));
    const sheet = document.createElement('canvas');
    Object.assign(sheet, {width, height});
    const context = sheet.getContext('2d')!;
    context.fillStyle = '#fff';
    context.fillRect(0, 0, width, height);
    context.drawImage(image, 0, 0, width, height);
    const {data} = context.getImageData(0, 0, width, height);
    const grey = new Uint8Array(width * height);
    for (let i = 0; i < grey.length; ++i) grey[i] = (data[4 * i] * 3 + data[4 * i + 1] * 6 + data[4 * i + 2]) / 10;
    this.picture = {width, height, grey};
    this.points = [];
    const stem = file.name.replace(/\.[^.]*$/, '').replace(/[^A-Za-z0-9_-]/g, '_').replace(/^[^A-Za-z0-9]+/, '') || 'plan';
    this.name = `${stem.slice(0, 60)}_walls.png`;
    setText(byId('plan-name'), file.name);
    this.box.hidden = false;
    this.draw();
    this.distance.focus();
  }

  private placeOf(event: MouseEvent): Place {
    const box = this.canvas.getBoundingClientRect();
    const scale = (this.picture?.width ?? 1) / box.width;
    return [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
  }

  // m; 0: not known yet.
  private pixel(): number {
    if (this.points.length < 2) return 0;
    const [[x0, y0], [x1, y1]] = this.points;
    const pixels = Math.hypot(x1 - x0, y1 - y0);
    const metres = Number(this.distance.value);
    return pixels > 1 && metres > 0 ? metres / pixels : 0;
  }

  private draw(): void {
    const {picture, canvas} = this;
    if (!picture || this.box.hidden) return;
    const {width, height, grey} = picture;
    const place = byId('plan-view');
    const scale = Math.min(place.clientWidth / width, place.clientHeight / height);
    canvas.style.width = `${Math.floor(width * scale)}px`;
    canvas.style.height = `${Math.floor(height * scale)}px`;
    Object.assign(canvas, {width, height});
    const context = canvas.getContext('2d')!;
    const shown = context.createImageData(width, height);
    const least = Number(this.threshold.value);
    for (let i = 0; i < grey.length; ++i) {
      const isWall = grey[i] < least;
      shown.data[4 * i] = isWall ? 29 : 0.3 * grey[i] + 0.7 * PAPER;
      shown.data[4 * i + 1] = isWall ? 91 : 0.3 * grey[i] + 0.7 * PAPER;
      shown.data[4 * i + 2] = isWall ? 192 : 0.3 * grey[i] + 0.7 * PAPER;
      shown.data[4 * i + 3] = 255;
    }
    context.putImageData(shown, 0, 0);
    const pixel = 1 / scale;
    context.strokeStyle = context.fillStyle = color('--red');
    context.lineWidth = 2 * pixel;
    context.beginPath();
    for (const [x, y] of this.points) context.lineTo(x, y);
    context.stroke();
    for (const [x, y] of this.points) {
      context.beginPath();
      context.arc(x, y, 6 * pixel, 0, 2 * Math.PI);
      context.stroke();
      context.fillRect(x - pixel, y - pixel, 2 * pixel, 2 * pixel);
    }
    const size = this.pixel();
    setText(byId('plan-size'), size === 0 ? 'Click two points whose distance you know, then type it.'
      : `The plan is ${(width * size).toFixed(2)} × ${(height * size).toFixed(2)} m, a pixel ${(size * 100).toFixed(1)} cm.`);
    for (const id of ['plan-apply', 'plan-below']) byId<HTMLButtonElement>(id).disabled = size === 0;
    byId<HTMLButtonElement>('plan-away').hidden = !this.underlay;
  }

  private layBelow(): void {
    const pixel = this.pixel();
    if (!this.picture || pixel === 0) return;
    const {width, height, grey} = this.picture;
    this.takeAway();
    this.underlay = new PlanUnderlay(this.scene, width, height, grey, pixel);
    this.box.hidden = true;
    toast('Draw walls over the plan: its middle is at the origin');
  }

  private takeAway(): void {
    this.underlay?.dispose();
    this.underlay = null;
    this.draw();
  }

  // Alternating runs of free and wall pixels, from the top.
  private runs(): number[] {
    const {grey} = this.picture!;
    const least = Number(this.threshold.value);
    const runs: number[] = [];
    let isWall = false;
    let count = 0;
    for (const value of grey) {
      if (value < least !== isWall) {
        runs.push(count);
        isWall = !isWall;
        count = 0;
      }
      ++count;
    }
    runs.push(count);
    return runs;
  }

  private async apply(): Promise<void> {
    const pixel = this.pixel();
    if (!this.picture || pixel === 0) return;
    const {width, height} = this.picture;
    const runs = this.runs();
    if (runs.length < 2) return toast('No pixel is darker than the threshold', true);
    if (JSON.stringify(runs).length > LONGEST_MESSAGE) {
      return toast('The picture is too rough to be walls: choose another threshold, or make it cleaner', true);
    }
    const tall = Math.max(0.01, Number(this.height.value) || 1);
    let file = this.name;
    for (let i = 2; ; ++i) {
      const reply = await this.client.ask('create_bitmap', {
        file, size: [width * pixel, height * pixel, tall], pixel, pose: [0, 0, 0, 0], runs,
      });
      if (reply.done) {
        this.box.hidden = true;
        this.changed(reply.name as string);
        return;
      }
      if (!/in use|exists/.test(reply.problem) || i > 20) return toast(reply.problem, true);
      file = this.name.replace(/\.png$/, `${i}.png`);
    }
  }
}
