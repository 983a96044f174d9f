// The two views of the model editor: outlines of blocks from above, heights from the side, and the parts in both.
// Metres; x to the right, y or z up.
// A motion of the pointer changes only what is drawn; the model changes once, at the end of a drag, so that undo has
// one step.
import type {PictureBlock} from './file_client';
import {snapTo} from './part_geometry';
import {PartViews, type PartViewsHost} from './part_views';
import {color, NEAR, Sheet, type Point2} from './sheet';

export interface Fan {
  x: number;
  y: number;
  heading: number;
  fov: number;
  range: number;
}

export interface ModelViewsHost extends PartViewsHost {
  blocksChanged(): void;
  partDrawn(outline: Point2[]): void;
}

export interface ViewsState {
  blocks: PictureBlock[];
  selected: number;  // -1: none
  fans: Fan[];
  newHeights: [number, number];  // of the next block
  others: PictureBlock[];  // of parts, which are not drawn here
}

const SNAP = 0.05;  // m
const LEAST_HEIGHT = 0.01;  // m
const DRAG = 6;  // px, that a click may move

const snap = (value: number): number => snapTo(value, SNAP);

export class ModelViews {
  readonly parts: PartViews;
  private readonly top: Sheet;
  private readonly side: Sheet;
  private drawn: Point2[] = [];  // corners of the outline that is being drawn
  private drawsPart = false;  // it is that of a new part
  private pressed: MouseEvent | null = null;  // that began the outline, until it is released
  private pointer: Point2 | null = null;
  private corner: {block: number; index: number} | null = null;  // that is dragged
  private edge: {block: number; upper: boolean} | null = null;

  constructor(
      top: HTMLCanvasElement, side: HTMLCanvasElement, private readonly state: ViewsState,
      private readonly host: ModelViewsHost) {
    this.parts = new PartViews(host);
    this.top = new Sheet(top, false);
    this.side = new Sheet(side, true);
    top.addEventListener('pointerdown', event => this.onTopDown(event));
    top.addEventListener('pointermove', event => this.onTopMove(event));
    top.addEventListener('pointerup', event => this.onTopUp(event));
    top.addEventListener('contextmenu', event => this.onTopMenu(event));
    side.addEventListener('pointerdown', event => this.onSideDown(event));
    side.addEventListener('pointermove', event => this.onSideMove(event));
    for (const sheet of [this.top, this.side]) {
      sheet.canvas.addEventListener('pointerup', () => {
        this.corner = this.edge = null;
        this.parts.release();
        this.draw();
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
    for (const {part} of this.parts.parts) {
      for (const {outline, z} of part.bodies ?? []) {
        for (const [x, y] of outline) reach = Math.max(reach, Math.abs(x), Math.abs(y));
        height = Math.max(height, z[1]);
      }
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

  // The next outline, or rectangle that is dragged, is that of a new part.
  setDrawsPart(drawsPart: boolean): void {
    this.drawsPart = drawsPart;
    this.drawn = [];
    this.pressed = null;
    this.draw();
  }

  // True if there was something to cancel.
  cancel(): boolean {
    const was = [this.parts.cancel(), this.drawn.length > 0, this.drawsPart].includes(true);
    this.setDrawsPart(false);
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
      for (const corner of outline) top.square(corner, color('--accent'));
    });
    context.lineWidth = 1;
    this.parts.draw(top, 'top');
    if (this.drawn.length > 0) {
      const points = this.draggedRectangle() ?? [...this.drawn, ...(this.pointer ? [this.pointer] : [])];
      top.line(points, {stroke: color('--accent'), width: 2});
      for (const corner of this.drawn) top.square(corner, color('--accent'));
      this.drawSizes(points);
    }
    if (this.corner) this.drawSizes(state.blocks[this.corner.block]?.outline ?? []);
    // The model's front.
    const [x, y] = top.toPixel(0, 0);
    context.fillStyle = color('--red');
    context.fillRect(x, y - 1, 26, 2);
    context.fillText('x', x + 30, y + 4);
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
    this.parts.draw(side, 'side');
  }

  // Of the shape under the pointer: the size of its box, and the length of its newest edge.
  private drawSizes(points: Point2[]): void {
    if (points.length < 2) return;
    const extent = (axis: 0 | 1): number => Math.max(...points.map(p => p[axis])) - Math.min(...points.map(p => p[axis]));
    const [[x0, y0], [x1, y1]] = points.slice(-2);
    const edge = this.corner ? '' : `, edge ${Math.hypot(x1 - x0, y1 - y0).toFixed(2)} m`;
    const {context} = this.top;
    context.fillStyle = color('--text');
    context.font = '13px system-ui, sans-serif';
    context.fillText(`${extent(0).toFixed(2)} × ${extent(1).toFixed(2)} m${edge}`, 8, 18);
  }

  private snapped(event: MouseEvent): Point2 {
    const [x, y] = this.top.toMetres(event);
    return this.drawsPart ? [snapTo(x), snapTo(y)] : [snap(x), snap(y)];
  }

  // The outline of a part that is dragged from corner to corner; null: corners are clicked.
  private draggedRectangle(): Point2[] | null {
    if (!this.drawsPart || !this.pressed || !this.pointer || this.drawn.length !== 1) return null;
    const [[x0, y0], [x1, y1]] = [this.drawn[0], this.pointer];
    if (Math.hypot(x1 - x0, y1 - y0) * this.top.scale < DRAG || x0 === x1 || y0 === y1) return null;
    const [left, right] = [Math.min(x0, x1), Math.max(x0, x1)];
    const [lower, upper] = [Math.min(y0, y1), Math.max(y0, y1)];
    return [[left, lower], [right, lower], [right, upper], [left, upper], [left, lower]];
  }

  private finish(outline: Point2[]): void {
    const isPart = this.drawsPart;
    this.setDrawsPart(false);
    if (isPart) {
      this.host.partDrawn(outline);
      return;
    }
    this.state.blocks.push({outline, z: [...this.state.newHeights]});
    this.state.selected = this.state.blocks.length - 1;
    this.host.blocksChanged();
    this.draw();
  }

  private pressesPart(event: PointerEvent): boolean {
    return !this.drawsPart && this.drawn.length === 0 && this.parts.press(event, this.top, 'top');
  }

  private onTopDown(event: PointerEvent): void {
    if (event.button !== 0) return;
    const {state} = this;
    if (this.parts.selectedPart() && this.pressesPart(event)) {
      this.draw();
      return;
    }
    if (this.drawn.length === 0 && !this.drawsPart) {
      // A corner of the selected block, or another block.
      const selected = state.blocks[state.selected];
      const index = selected ? selected.outline.findIndex(corner => this.top.isNear(event, corner)) : -1;
      if (index >= 0) {
        this.corner = {block: state.selected, index};
        this.top.canvas.setPointerCapture(event.pointerId);
        return;
      }
    }
    if (this.pressesPart(event)) {
      this.draw();
      return;
    }
    if (this.drawn.length >= 3 && this.top.isNear(event, this.drawn[0])) {
      this.finish(this.drawn);
      return;
    }
    this.drawn.push(this.snapped(event));
    this.pressed = event;
    if (this.drawsPart) this.top.canvas.setPointerCapture(event.pointerId);
    this.draw();
  }

  private onTopMove(event: PointerEvent): void {
    if (this.parts.move(event, this.top, 'top')) {
      this.draw();
      return;
    }
    this.pointer = this.snapped(event);
    if (this.corner) {
      this.state.blocks[this.corner.block].outline[this.corner.index] = this.pointer;
      this.host.blocksChanged();
    }
    if (this.corner || this.drawn.length > 0) this.draw();
  }

  private onTopUp(event: PointerEvent): void {
    this.pointer = this.snapped(event);
    const rectangle = this.draggedRectangle();
    this.pressed = null;
    if (rectangle) this.finish(rectangle.slice(0, 4));
  }

  private onTopMenu(event: MouseEvent): void {
    event.preventDefault();
    const block = this.state.blocks[this.state.selected];
    if (this.drawn.length > 0) {
      this.drawn.pop();
    } else if (block && block.outline.length > 3) {
      const index = block.outline.findIndex(corner => this.top.isNear(event, corner));
      if (index >= 0) block.outline.splice(index, 1);
      this.host.blocksChanged();
    }
    this.draw();
  }

  private onSideDown(event: PointerEvent): void {
    if (event.button !== 0) return;
    if (this.parts.press(event, this.side, 'side')) {
      this.draw();
      return;
    }
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
    this.host.blocksChanged();
    this.draw();
  }

  private onSideMove(event: PointerEvent): void {
    if (this.parts.move(event, this.side, 'side')) {
      this.draw();
      return;
    }
    if (!this.edge) return;
    const z = Math.max(0, snap(this.side.toMetres(event)[1]));
    const heights = this.state.blocks[this.edge.block].z;
    if (this.edge.upper) heights[1] = Math.max(z, heights[0] + LEAST_HEIGHT);
    else heights[0] = Math.min(z, heights[1] - LEAST_HEIGHT);
    this.host.blocksChanged();
    this.draw();
  }
}
