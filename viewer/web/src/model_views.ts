// The two views of the model editor: outlines of blocks from above, heights from the side. Metres; x to the right, y or
// z up.
import type {PictureBlock} from './file_client';

export interface Fan {
  x: number;
  y: number;
  heading: number;
  fov: number;
  range: number;
}

export interface ViewsState {
  blocks: PictureBlock[];
  selected: number;  // -1: none
  fans: Fan[];
  newHeights: [number, number];  // of the next block
  others: PictureBlock[];  // of parts, which are not drawn here
}

const SNAP = 0.05;  // m
const NEAR = 9;  // px
const LEAST_HEIGHT = 0.01;  // m

const snap = (value: number): number => Math.round(Math.round(value / SNAP) * SNAP * 1e4) / 1e4;

function color(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// A canvas with its own scale: the middle of its lower or central part is the origin.
class Sheet {
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
      (event.clientX - box.left - this.canvas.width / 2) / this.scale, (this.originY - event.clientY + box.top) / this.scale,
    ];
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
}

export class ModelViews {
  private readonly top: Sheet;
  private readonly side: Sheet;
  private drawn: Array<[number, number]> = [];  // corners of the outline that is being drawn
  private pointer: [number, number] | null = null;
  private corner: {block: number; index: number} | null = null;  // that is dragged
  private edge: {block: number; upper: boolean} | null = null;

  constructor(
      top: HTMLCanvasElement, side: HTMLCanvasElement, private readonly state: ViewsState,
      private readonly changed: () => void) {
    this.top = new Sheet(top, false);
    this.side = new Sheet(side, true);
    top.addEventListener('pointerdown', event => this.onTopDown(event));
    top.addEventListener('pointermove', event => this.onTopMove(event));
    top.addEventListener('contextmenu', event => this.onTopMenu(event));
    side.addEventListener('pointerdown', event => this.onSideDown(event));
    side.addEventListener('pointermove', event => this.onSideMove(event));
    for (const sheet of [this.top, this.side]) {
      sheet.canvas.addEventListener('pointerup', () => {
        this.corner = this.edge = null;
      });
      sheet.canvas.addEventListener('wheel', event => {
        event.preventDefault();
        const factor = event.deltaY < 0 ? 1.2 : 1 / 1.2;
        for (const each of [this.top, this.side]) each.scale = Math.min(2000, Math.max(10, each.scale * factor));
        this.draw();
      }, {passive: false});
    }
    new ResizeObserver(() => this.draw()).observe(top);
  }

  // Everything in the views.
  fit(): void {
    let reach = 0.4;
    let height = 0.4;
    for (const {outline, z} of this.state.blocks) {
      for (const [x, y] of outline) reach = Math.max(reach, Math.abs(x), Math.abs(y));
      height = Math.max(height, z[1]);
    }
    this.top.resize();
    this.side.resize();
    const width = Math.min(this.top.canvas.width, this.top.canvas.height) || 400;
    const tall = (this.side.canvas.height || 400) - 40;
    this.top.scale = this.side.scale = Math.min((0.42 * width) / reach, (0.9 * tall) / height);
    this.drawn = [];
    this.draw();
  }

  clientPoint(view: 'top' | 'side', a: number, b: number): {x: number; y: number} {
    return (view === 'top' ? this.top : this.side).toClient(a, b);
  }

  cancel(): boolean {
    const was = this.drawn.length > 0;
    this.drawn = [];
    this.draw();
    return was;
  }

  draw(): void {
    this.drawTop();
    this.drawSide();
  }

  private drawTop(): void {
    const {top, state} = this;
    top.resize();
    top.drawGrid();
    const {context} = top;
    for (const {x, y, heading, fov, range} of state.fans) {
      context.beginPath();
      const [cx, cy] = top.toPixel(x, y);
      context.moveTo(cx, cy);
      context.arc(cx, cy, range * top.scale, -heading - fov / 2, -heading + fov / 2);
      context.closePath();
      context.globalAlpha = 0.12;
      context.fillStyle = color('--rays');
      context.fill();
      context.globalAlpha = 0.6;
      context.strokeStyle = color('--rays');
      context.stroke();
      context.globalAlpha = 1;
    }
    context.setLineDash([4, 3]);
    context.strokeStyle = color('--faint');
    for (const {outline} of state.others) {
      context.beginPath();
      for (const [x, y] of [...outline, outline[0]]) context.lineTo(...top.toPixel(x, y));
      context.stroke();
    }
    context.setLineDash([]);
    state.blocks.forEach(({outline}, i) => {
      const isSelected = i === state.selected;
      context.beginPath();
      outline.forEach(([x, y], k) => {
        const [px, py] = top.toPixel(x, y);
        if (k === 0) context.moveTo(px, py);
        else context.lineTo(px, py);
      });
      context.closePath();
      context.globalAlpha = isSelected ? 0.45 : 0.25;
      context.fillStyle = color(isSelected ? '--accent' : '--faint');
      context.fill();
      context.globalAlpha = 1;
      context.strokeStyle = color(isSelected ? '--accent' : '--text');
      context.lineWidth = isSelected ? 2 : 1;
      context.stroke();
      if (!isSelected) return;
      for (const corner of outline) this.mark(corner);
    });
    if (this.drawn.length > 0) {
      context.beginPath();
      [...this.drawn, ...(this.pointer ? [this.pointer] : [])].forEach(([x, y], k) => {
        const [px, py] = top.toPixel(x, y);
        if (k === 0) context.moveTo(px, py);
        else context.lineTo(px, py);
      });
      context.strokeStyle = color('--accent');
      context.lineWidth = 2;
      context.stroke();
      for (const corner of this.drawn) this.mark(corner);
    }
    context.lineWidth = 1;
    // The model's front.
    const [x, y] = top.toPixel(0, 0);
    context.fillStyle = color('--red');
    context.fillRect(x, y - 1, 26, 2);
    context.fillText('x', x + 30, y + 4);
  }

  private mark([a, b]: [number, number]): void {
    const [x, y] = this.top.toPixel(a, b);
    this.top.context.fillStyle = color('--accent');
    this.top.context.fillRect(x - 4, y - 4, 8, 8);
  }

  private drawSide(): void {
    const {side, state} = this;
    side.resize();
    side.drawGrid();
    const {context} = side;
    context.setLineDash([4, 3]);
    context.strokeStyle = color('--faint');
    for (const {outline, z} of state.others) {
      const xs = outline.map(([x]) => x);
      const [left, upper] = side.toPixel(Math.min(...xs), z[1]);
      const [right, lower] = side.toPixel(Math.max(...xs), z[0]);
      context.strokeRect(left, upper, right - left, lower - upper);
    }
    context.setLineDash([]);
    state.blocks.forEach(({outline, z}, i) => {
      const isSelected = i === state.selected;
      const xs = outline.map(([x]) => x);
      const [left, top] = side.toPixel(Math.min(...xs), z[1]);
      const [right, bottom] = side.toPixel(Math.max(...xs), z[0]);
      context.globalAlpha = isSelected ? 0.45 : 0.25;
      context.fillStyle = color(isSelected ? '--accent' : '--faint');
      context.fillRect(left, top, right - left, bottom - top);
      context.globalAlpha = 1;
      context.strokeStyle = color(isSelected ? '--accent' : '--text');
      context.lineWidth = isSelected ? 2 : 1;
      context.strokeRect(left, top, right - left, bottom - top);
      context.fillStyle = color('--text');
      if (isSelected) context.fillText(`${z[0]} to ${z[1]} m`, right + 6, (top + bottom) / 2);
    });
    context.lineWidth = 1;
  }

  private isNear(event: MouseEvent, sheet: Sheet, [a, b]: [number, number]): boolean {
    const at = sheet.toClient(a, b);
    return Math.hypot(event.clientX - at.x, event.clientY - at.y) < NEAR;
  }

  private onTopDown(event: PointerEvent): void {
    if (event.button !== 0) return;
    const {state} = this;
    if (this.drawn.length === 0) {
      // A corner of the selected block, or another block.
      const selected = state.blocks[state.selected];
      const index = selected ? selected.outline.findIndex(corner => this.isNear(event, this.top, corner)) : -1;
      if (index >= 0) {
        this.corner = {block: state.selected, index};
        this.top.canvas.setPointerCapture(event.pointerId);
        return;
      }
    }
    if (this.drawn.length >= 3 && this.isNear(event, this.top, this.drawn[0])) {
      state.blocks.push({outline: this.drawn, z: [...state.newHeights]});
      state.selected = state.blocks.length - 1;
      this.drawn = [];
      this.changed();
      this.draw();
      return;
    }
    const [x, y] = this.top.toMetres(event);
    this.drawn.push([snap(x), snap(y)]);
    this.draw();
  }

  private onTopMove(event: PointerEvent): void {
    const [x, y] = this.top.toMetres(event);
    this.pointer = [snap(x), snap(y)];
    if (this.corner) {
      this.state.blocks[this.corner.block].outline[this.corner.index] = this.pointer;
      this.changed();
    }
    if (this.corner || this.drawn.length > 0) this.draw();
  }

  private onTopMenu(event: MouseEvent): void {
    event.preventDefault();
    const block = this.state.blocks[this.state.selected];
    if (this.drawn.length > 0) {
      this.drawn.pop();
    } else if (block && block.outline.length > 3) {
      const index = block.outline.findIndex(corner => this.isNear(event, this.top, corner));
      if (index >= 0) block.outline.splice(index, 1);
      this.changed();
    }
    this.draw();
  }

  private onSideDown(event: PointerEvent): void {
    const [x, z] = this.side.toMetres(event);
    const near = NEAR / this.side.scale;
    const found = this.state.blocks.map((block, index) => ({block, index})).filter(({block}) => {
      const xs = block.outline.map(([a]) => a);
      return x > Math.min(...xs) - near && x < Math.max(...xs) + near && z > block.z[0] - near && z < block.z[1] + near;
    });
    if (found.length === 0) return;
    const hit = found.find(({index}) => index === this.state.selected) ?? found[found.length - 1];
    this.state.selected = hit.index;
    const [bottom, top] = hit.block.z;
    const upper = Math.abs(z - top) <= Math.abs(z - bottom);
    if (Math.abs(z - (upper ? top : bottom)) < near) {
      this.edge = {block: hit.index, upper};
      this.side.canvas.setPointerCapture(event.pointerId);
    }
    this.changed();
    this.draw();
  }

  private onSideMove(event: PointerEvent): void {
    if (!this.edge) return;
    const z = Math.max(0, snap(this.side.toMetres(event)[1]));
    const heights = this.state.blocks[this.edge.block].z;
    if (this.edge.upper) heights[1] = Math.max(z, heights[0] + LEAST_HEIGHT);
    else heights[0] = Math.min(z, heights[1] - LEAST_HEIGHT);
    this.changed();
    this.draw();
  }
}
