// Drawing on the ground of the scene: walls, rooms and areas, by dragging from one point to another.
//
// Points snap to the grid in world coordinates, metres. A drawn thing becomes text of the file by one request at the
// end of the drag; until then it is a preview that the gateway does not know.
import {BufferAttribute, BufferGeometry, Line, LineBasicMaterial, LineSegments, Vector3} from 'three';
import {byId, fixed, make} from './dom';
import {DragLabel, metres} from './drag_label';
import type {PictureBlock} from './file_client';
import type {Pose} from './protocol';
import {degrees} from './run';
import type {WorldScene} from './scene';

export type DrawTool = 'none' | 'wall' | 'room' | 'area';

export interface Point {
  x: number;
  y: number;
}

export interface DrawnModel {
  pose: Pose;
  blocks: PictureBlock[];
}

const LEAST = 0.1;  // m, of a drag

const HINTS: Record<DrawTool, string> = {
  none: '',
  wall: 'Drag from one end of the wall to the other; Shift: right angles; Alt: free. Escape ends this.',
  room: 'Drag from one corner of the room to the opposite one. Escape ends this.',
  area: 'Drag from one corner of the area to the opposite one. Escape ends this.',
};

function box(x0: number, y0: number, x1: number, y1: number, height: number): PictureBlock {
  const round = (value: number): number => Math.round(value * 1e4) / 1e4;
  return {
    outline: [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(([x, y]) => [round(x), round(y)]),
    z: [0, height],
  };
}

export function wallBetween(from: Point, to: Point, thickness: number, height: number): DrawnModel {
  const length = Math.hypot(to.x - from.x, to.y - from.y);
  return {
    pose: {x: (from.x + to.x) / 2, y: (from.y + to.y) / 2, z: 0, heading: Math.atan2(to.y - from.y, to.x - from.x)},
    blocks: [box(-length / 2, -thickness / 2, length / 2, thickness / 2, height)],
  };
}

// Four walls whose middles are on the rectangle, with a gap in the one below if `door` is not 0.
export function roomBetween(from: Point, to: Point, thickness: number, height: number, door: number): DrawnModel {
  const a = Math.abs(to.x - from.x) / 2;
  const b = Math.abs(to.y - from.y) / 2;
  const t = thickness / 2;
  const gap = Math.min(door, 2 * a - 4 * t) / 2;
  const blocks = [
    box(-a - t, b - t, a + t, b + t, height),
    box(-a - t, -b + t, -a + t, b - t, height),
    box(a - t, -b + t, a + t, b - t, height),
  ];
  if (gap <= 0) blocks.push(box(-a - t, -b - t, a + t, -b + t, height));
  else blocks.push(box(-a - t, -b - t, -gap, -b + t, height), box(gap, -b - t, a + t, -b + t, height));
  return {pose: {x: (from.x + to.x) / 2, y: (from.y + to.y) / 2, z: 0, heading: 0}, blocks};
}

export interface DrawingHost {
  drawn(tool: DrawTool, from: Point, to: Point): void;
}

export class Drawing {
  tool: DrawTool = 'none';
  thickness = 0.1;
  height = 1;
  door = 0.9;
  private from: Point | null = null;
  private to: Point | null = null;
  private readonly lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({color: 0x2563c9}));
  private readonly label = new DragLabel();

  constructor(private readonly scene: WorldScene, private readonly host: DrawingHost) {
    this.lines.frustumCulled = false;
    scene.add(this.lines);
    // Before the page's other tools and the camera.
    window.addEventListener('pointerdown', event => this.onDown(event), {capture: true});
    window.addEventListener('pointermove', event => this.onMove(event), {capture: true});
    window.addEventListener('pointerup', event => this.onUp(event), {capture: true});
  }

  set(tool: DrawTool): void {
    this.tool = tool;
    this.from = this.to = null;
    this.label.hide();
    this.show();
    byId('hint').hidden = tool === 'none';
    byId('hint').textContent = HINTS[tool];
    this.scene.canvas.classList.toggle('aiming', tool !== 'none');
    for (const name of ['wall', 'room', 'area']) byId(`file-${name}`).classList.toggle('on', tool === name);
    this.showOptions();
  }

  private showOptions(): void {
    const options = byId('draw-options');
    byId('area-options').hidden = this.tool !== 'area';
    options.hidden = this.tool !== 'wall' && this.tool !== 'room';
    const field = (text: string, value: number, apply: (value: number) => void): HTMLElement => {
      const label = make('label', '', `${text} `);
      const input = document.createElement('input');
      input.type = 'number';
      input.step = '0.05';
      input.min = '0';
      input.value = String(value);
      input.onchange = () => apply(Math.max(0, Number(input.value)));
      label.append(input, ' m');
      return label;
    };
    options.replaceChildren(
      field('thickness', this.thickness, value => (this.thickness = Math.max(0.01, value))),
      field('height', this.height, value => (this.height = Math.max(0.01, value))));
    if (this.tool === 'room') options.append(field('door', this.door, value => (this.door = value)));
  }

  // Of a wall or a room: the first end.
  get begun(): {from: Point | null; isWall: boolean} | null {
    return this.tool === 'wall' || this.tool === 'room' ? {from: this.from, isWall: this.tool === 'wall'} : null;
  }

  private onDown(event: PointerEvent): void {
    if (this.tool === 'none' || event.button !== 0 || event.target !== this.scene.canvas) return;
    const at = this.scene.pointAt(event.clientX, event.clientY, 0);
    if (!at) return;
    event.stopPropagation();
    this.scene.setControlsEnabled(false);
    this.from = this.to = {x: at.x, y: at.y};
  }

  private onMove(event: PointerEvent): void {
    if (!this.from) return;
    const at = this.scene.pointAt(event.clientX, event.clientY, 0);
    if (at) this.to = {x: at.x, y: at.y};
    this.show();
    if (this.to) this.label.show(event, this.sizeText(this.from, this.to));
  }

  private sizeText(from: Point, to: Point): string {
    const [x, y] = [to.x - from.x, to.y - from.y];
    if (this.tool !== 'wall') return `${metres(Math.abs(x))} × ${metres(Math.abs(y))} m`;
    return `${metres(Math.hypot(x, y))} m, ${fixed((Math.atan2(y, x) * 180) / Math.PI, 0)}°`;
  }

  private onUp(event: PointerEvent): void {
    if (!this.from || !this.to) return;
    event.stopPropagation();
    this.scene.setControlsEnabled(true);
    const {from, to} = this;
    const tool = this.tool;
    this.from = this.to = null;
    this.label.hide();
    this.show();
    if (Math.hypot(to.x - from.x, to.y - from.y) >= LEAST) this.host.drawn(tool, from, to);
  }

  private show(): void {
    const points: number[] = [];
    if (this.from && this.to) {
      const {from, to} = this;
      const corners = this.tool === 'wall' ? [from, to] : [from, {x: to.x, y: from.y}, to, {x: from.x, y: to.y}];
      corners.forEach((corner, i) => {
        const next = corners[(i + 1) % corners.length];
        points.push(corner.x, corner.y, 0.03, next.x, next.y, 0.03);
      });
    }
    this.lines.geometry.dispose();
    this.lines.geometry = new BufferGeometry();
    this.lines.geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    this.scene.invalidate();
  }
}

// Measuring: the distance and the direction between two points of the ground or of bodies, as a line in the picture.

export class Measuring {
  private from: Vector3 | null = null;
  private ended = false;
  private readonly geometry = new BufferGeometry();
  private readonly line = new Line(this.geometry, new LineBasicMaterial({color: 0xe0602c, depthTest: false}));

  constructor(private readonly scene: WorldScene) {
    this.line.renderOrder = 3;
    this.line.visible = false;
    this.line.frustumCulled = false;
    scene.add(this.line);
  }

  click(clientX: number, clientY: number): void {
    const at = this.scene.floorAt(clientX, clientY);
    if (!at) return;
    if (this.from && !this.ended) {
      this.show(at);
      this.ended = true;
      return;
    }
    this.from = at;
    this.ended = false;
    this.show(at);
  }

  move(clientX: number, clientY: number): void {
    const at = this.from && !this.ended ? this.scene.floorAt(clientX, clientY) : null;
    if (at) this.show(at);
  }

  clear(): void {
    this.from = null;
    this.line.visible = false;
    this.scene.invalidate();
  }

  private show(to: Vector3): void {
    if (!this.from) return;
    const lifted = [this.from, to].map(point => point.clone().add(new Vector3(0, 0, 0.02)));
    this.geometry.setFromPoints(lifted);
    this.line.visible = true;
    this.scene.invalidate();
    const x = to.x - this.from.x;
    const y = to.y - this.from.y;
    byId('hint').textContent =
      `${fixed(Math.hypot(x, y), 3)} m, x ${fixed(x, 3)} m, y ${fixed(y, 3)} m, direction ${fixed(degrees(Math.atan2(y, x)), 1)}°`;
  }
}
