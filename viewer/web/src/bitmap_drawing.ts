// BitmapDrawing: walls that are drawn into the image of a floor plan, pixel by pixel, on the ground of the scene. A
// stroke is one edit, at its end.
//
// The page draws a preview only. The gateway changes the pixels, because it has the image, its history and the rule by
// which a pixel is a wall. Pixels count from the upper left corner of the image, whose pose in the world may be turned.
import {BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments} from 'three';
import {byId, make, toast} from './dom';
import type {FileClient} from './file_client';
import type {Point} from './drawing';
import type {WorldScene} from './scene';

// A bitmap of the file, as the editor reports it.
interface BitmapRow {
  name: string;
  file: string;
  refusal: string;  // the reason why it cannot be drawn into; empty: it can
  width: number;  // pixels
  height: number;
  pixel: [number, number];  // m
  corner: [number, number, number, number];  // upper left one of the image in the world: x, y, z, heading
}

type Tool = 'line' | 'frame' | 'filled' | 'brush' | 'new';
type Pixel = [number, number];

const TOOLS: Array<[Tool, string, string]> = [
  ['line', 'Line', 'A straight wall: drag from one end to the other'],
  ['frame', 'Outline', 'The outline of a rectangle: drag from corner to corner'],
  ['filled', 'Filled', 'A filled rectangle: drag from corner to corner'],
  ['brush', 'Brush', 'A wall along the way of the pointer'],
  ['new', 'New', 'A new image: drag over the ground that it is to cover'],
];
const MOST_POINTS = 5000;  // of a request
const WIDEST = 500;  // pixels
const GRID = 0.05;  // m, of a new image
const LIFT = 0.03;  // m, of the preview above the ground

export interface BitmapDrawingHost {
  changed(): void;  // the file
}

export class BitmapDrawing {
  private isOpen = false;
  private tool: Tool = 'line';
  private bitmaps: BitmapRow[] = [];
  private chosen = '';  // name of the model
  private width = 2;  // of the brush, pixels
  private erases = false;
  private newFile = 'plan.png';
  private newPixel = 0.05;  // m
  private newHeight = 1;  // m
  private points: Pixel[] = [];
  private area: [Point, Point] | null = null;  // of a new image
  private pointer: Pixel | null = null;
  private readonly lines = new LineSegments(
    new BufferGeometry(), new LineBasicMaterial({color: 0x2563c9, depthTest: false, transparent: true}));

  constructor(
      private readonly scene: WorldScene, private readonly client: FileClient,
      private readonly host: BitmapDrawingHost) {
    this.lines.frustumCulled = false;
    scene.add(this.lines);
    // Before the page's other tools and the camera.
    window.addEventListener('pointerdown', event => this.onDown(event), {capture: true});
    window.addEventListener('pointermove', event => this.onMove(event), {capture: true});
    window.addEventListener('pointerup', event => this.onUp(event), {capture: true});
  }

  get open(): boolean {
    return this.isOpen;
  }

  async set(open: boolean): Promise<void> {
    if (this.isOpen === open) return;
    this.isOpen = open;
    this.points = [];
    this.area = this.pointer = null;
    this.scene.canvas.classList.toggle('aiming', open);
    byId('file-bitmap').classList.toggle('on', open);
    byId('bitmap-options').hidden = !open;
    if (open) await this.refresh();
    this.draw();
  }

  // The file may have other bitmaps, or the same at another place.
  async refresh(): Promise<void> {
    if (!this.isOpen) return;
    const reply = await this.client.ask('bitmaps');
    this.bitmaps = reply.done ? reply.bitmaps as BitmapRow[] : [];
    const drawable = this.bitmaps.filter(({refusal}) => refusal === '');
    if (!drawable.some(({name}) => name === this.chosen)) this.chosen = drawable[0]?.name ?? '';
    if (this.chosen === '') this.tool = 'new';
    this.showOptions();
    this.draw();
  }

  private bitmap(): BitmapRow | null {
    return this.bitmaps.find(({name, refusal}) => name === this.chosen && refusal === '') ?? null;
  }

  private showOptions(): void {
    const box = byId('bitmap-options');
    if (box.contains(document.activeElement) && document.activeElement instanceof HTMLInputElement) return;
    const select = document.createElement('select');
    select.setAttribute('aria-label', 'Bitmap');
    select.id = 'bitmap-choice';
    for (const {name, file, refusal} of this.bitmaps) {
      const option = new Option(refusal ? `${name}: not to be drawn into` : `${name} (${file})`, name);
      option.disabled = refusal !== '';
      option.title = refusal;
      select.append(option);
    }
    select.value = this.chosen;
    select.onchange = () => {
      this.chosen = select.value;
      this.showOptions();
      this.draw();
    };
    const tools = TOOLS.map(([tool, label, title]) => {
      const button = make('button', tool === this.tool ? 'small on' : 'small', label) as HTMLButtonElement;
      button.title = title;
      button.dataset.tool = tool;
      button.disabled = tool !== 'new' && !this.bitmap();
      button.onclick = () => {
        this.tool = tool;
        this.showOptions();
        this.draw();
      };
      return button;
    });
    const refused = this.bitmaps.filter(({refusal}) => refusal !== '');
    const row = make('div', 'row');
    if (this.bitmaps.length > 0) row.append(select);
    row.append(...tools, ...(this.tool === 'new' ? this.newFields() : this.brushFields()));
    box.replaceChildren(row, ...refused.map(({name, refusal}) => make('div', 'faint', `${name}: ${refusal}`)));
  }

  private field(text: string, value: string, type: string, apply: (value: string) => void, unit = ''): HTMLElement {
    const label = make('label', '', `${text} `);
    const input = document.createElement('input');
    input.type = type;
    input.value = value;
    input.setAttribute('aria-label', text);
    if (type === 'number') Object.assign(input, {step: 'any', min: '0'});
    input.onchange = () => apply(input.value);
    label.append(input, unit);
    return label;
  }

  private brushFields(): HTMLElement[] {
    const bitmap = this.bitmap();
    const metres = bitmap ? ` px = ${Math.round(this.width * bitmap.pixel[0] * 1000) / 1000} m` : ' px';
    const width = this.field('width', String(this.width), 'number', text => {
      this.width = Math.min(WIDEST, Math.max(1, Math.round(Number(text)) || 1));
      (document.activeElement as HTMLElement | null)?.blur();
      this.showOptions();
      this.draw();
    }, metres);
    const label = make('label', '');
    const erase = document.createElement('input');
    erase.type = 'checkbox';
    erase.id = 'bitmap-erase';
    erase.checked = this.erases;
    erase.onchange = () => (this.erases = erase.checked);
    label.append(erase, ' erase');
    return [width, label];
  }

  private newFields(): HTMLElement[] {
    return [
      this.field('image', this.newFile, 'text', text => (this.newFile = text.trim())),
      this.field('pixel', String(this.newPixel), 'number', text => (this.newPixel = Number(text) || 0.05), ' m'),
      this.field('height', String(this.newHeight), 'number', text => (this.newHeight = Number(text) || 1), ' m'),
    ];
  }

  private groundAt(event: PointerEvent): Point | null {
    return this.scene.pointAt(event.clientX, event.clientY, this.tool === 'new' ? 0 : this.bitmap()?.corner[2] ?? 0);
  }

  private pixelAt(event: PointerEvent): Pixel | null {
    const at = this.groundAt(event);
    const bitmap = this.bitmap();
    if (!at || !bitmap) return null;
    const [x, y, , heading] = bitmap.corner;
    const [dx, dy] = [at.x - x, at.y - y];
    const column = Math.floor((Math.cos(heading) * dx + Math.sin(heading) * dy) / bitmap.pixel[0]);
    const row = Math.floor((Math.sin(heading) * dx - Math.cos(heading) * dy) / bitmap.pixel[1]);
    const within = (value: number, count: number): number => Math.min(count - 1, Math.max(0, value));
    return [within(column, bitmap.width), within(row, bitmap.height)];
  }

  private onDown(event: PointerEvent): void {
    if (!this.isOpen || event.button !== 0 || event.target !== this.scene.canvas) return;
    event.stopPropagation();
    if (this.tool === 'new') {
      const at = this.groundAt(event);
      if (at) this.area = [at, at];
    } else {
      const pixel = this.pixelAt(event);
      if (pixel) this.points = [pixel, pixel];
    }
    if (this.area || this.points.length > 0) this.scene.setControlsEnabled(false);
    this.draw();
  }

  private onMove(event: PointerEvent): void {
    if (!this.isOpen) return;
    const at = this.tool === 'new' ? this.groundAt(event) : null;
    if (this.area && at) this.area[1] = at;
    this.pointer = this.tool === 'new' ? null : this.pixelAt(event);
    if (this.points.length > 0 && this.pointer) this.moveTo(this.pointer);
    this.draw();
  }

  private moveTo(pixel: Pixel): void {
    const last = this.points[this.points.length - 1];
    if (this.tool !== 'brush') {
      this.points[1] = pixel;
    } else if ((last[0] !== pixel[0] || last[1] !== pixel[1]) && this.points.length < MOST_POINTS) {
      this.points.push(pixel);
    }
  }

  private onUp(event: PointerEvent): void {
    if (!this.isOpen || (!this.area && this.points.length === 0)) return;
    event.stopPropagation();
    this.scene.setControlsEnabled(true);
    const {area, points} = this;
    this.area = null;
    this.points = [];
    if (area) void this.create(area);
    else void this.stroke(points);
    this.draw();
  }

  private async stroke(points: Pixel[]): Promise<void> {
    const reply = await this.client.edit('draw_bitmap', {
      name: this.chosen, tool: this.tool === 'brush' ? 'line' : this.tool, points, width: this.width,
      erase: this.erases,
    });
    if (reply.done && reply.changed === false) toast('No pixel has changed');
    this.host.changed();
  }

  private async create([a, b]: [Point, Point]): Promise<void> {
    const [x0, x1] = [a.x, b.x].map(value => Math.round(value / GRID) * GRID).sort((p, q) => p - q);
    const [y0, y1] = [a.y, b.y].map(value => Math.round(value / GRID) * GRID).sort((p, q) => p - q);
    if (x1 - x0 < this.newPixel || y1 - y0 < this.newPixel) return;
    const reply = await this.client.edit('create_bitmap', {
      file: this.newFile, size: [x1 - x0, y1 - y0, this.newHeight], pixel: this.newPixel,
      pose: [(x0 + x1) / 2, (y0 + y1) / 2, 0, 0],
    });
    if (reply.done) {
      this.chosen = reply.name as string;
      this.tool = 'line';
    }
    this.host.changed();
  }

  // The edge of the image, and what the stroke would cover.
  private draw(): void {
    const points: number[] = [];
    if (this.area) {
      const [{x: x0, y: y0}, {x: x1, y: y1}] = this.area;
      for (const [p, q, r, s] of [[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]]) {
        points.push(p, q, LIFT, r, s, LIFT);
      }
    }
    const bitmap = this.isOpen && this.tool !== 'new' ? this.bitmap() : null;
    if (bitmap) {
      const [x, y, z, heading] = bitmap.corner;
      const at = ([column, row]: Pixel): number[] => {
        const [u, v] = [column * bitmap.pixel[0], -row * bitmap.pixel[1]];
        const [c, s] = [Math.cos(heading), Math.sin(heading)];
        return [x + c * u - s * v, y + s * u + c * v, z + LIFT];
      };
      const line = (from: Pixel, to: Pixel): void => void points.push(...at(from), ...at(to));
      const box = (x0: number, y0: number, x1: number, y1: number): void => {
        const corners: Pixel[] = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        corners.forEach((corner, i) => line(corner, corners[(i + 1) % 4]));
      };
      const before = Math.floor((this.width - 1) / 2);
      const brush = ([column, row]: Pixel): Pixel[] => [0, this.width].flatMap(dx =>
        [0, this.width].map((dy): Pixel => [column - before + dx, row - before + dy]));
      const square = (pixel: Pixel): void => {
        const [[x0, y0], , , [x1, y1]] = brush(pixel);
        box(x0, y0, x1, y1);
      };
      box(0, 0, bitmap.width, bitmap.height);
      const stroke = this.points;
      if (stroke.length > 0 && (this.tool === 'frame' || this.tool === 'filled')) {
        const [[x0, y0], [x1, y1]] = stroke;
        const [left, right] = [Math.min(x0, x1), Math.max(x0, x1) + 1];
        const [top, bottom] = [Math.min(y0, y1), Math.max(y0, y1) + 1];
        box(left, top, right, bottom);
        const w = this.width;
        if (this.tool === 'frame' && right - left > 2 * w && bottom - top > 2 * w) {
          box(left + w, top + w, right - w, bottom - w);
        }
      } else if (stroke.length > 0) {
        stroke.forEach((pixel, i) => {
          if (i === 0 || i === stroke.length - 1) square(pixel);
          if (i > 0) brush(pixel).forEach((corner, k) => line(brush(stroke[i - 1])[k], corner));
        });
      } else if (this.pointer) {
        square(this.pointer);
      }
    }
    this.lines.geometry.dispose();
    this.lines.geometry = new BufferGeometry();
    this.lines.geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    this.scene.invalidate();
  }
}
