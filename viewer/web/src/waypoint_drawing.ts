// Waypoints of a robot's controller, drawn into the picture of the editor: a click for each, Enter or a click on the last one
// ends.
import {BufferGeometry, Line, LineBasicMaterial, Vector3} from 'three';
import {byId} from './dom';
import type {WorldScene} from './scene';

const NEAR = 10;  // px: a click so near to the last point ends
const HEIGHT = 0.03;  // m, above the ground
const HINT = 'Click the waypoints one after another. Enter, or a click on the last one, ends; Escape gives up.';

export type Waypoints = Array<[number, number]>;  // m, in the world

export class WaypointDrawing {
  private points: Vector3[] = [];
  private start: Vector3 | null = null;
  private done: ((waypoints: Waypoints) => void) | null = null;
  private isSingle = false;
  private readonly line = new Line(new BufferGeometry(), new LineBasicMaterial({color: 0xe0602c, depthTest: false}));

  constructor(private readonly scene: WorldScene) {
    this.line.renderOrder = 3;
    this.line.frustumCulled = false;
    this.line.visible = false;
    scene.add(this.line);
    window.addEventListener('pointerdown', event => this.onDown(event), {capture: true});
    window.addEventListener('pointermove', event => this.onMove(event), {capture: true});
  }

  // `from`: the place of the robot. `single`: one click ends.
  begin(from: [number, number], done: (waypoints: Waypoints) => void, single = false): void {
    this.isSingle = single;
    this.start = new Vector3(...from, HEIGHT);
    this.points = [];
    this.done = done;
    this.show(null);
    byId('hint').hidden = false;
    byId('hint').textContent = single ? 'Click the point. Escape gives up.' : HINT;
    this.scene.canvas.classList.add('aiming');
    byId('scene').focus({preventScroll: true});
  }

  // True if the key belongs to it.
  press({key}: KeyboardEvent): boolean {
    if (!this.done || (key !== 'Enter' && key !== 'Escape')) return false;
    this.end(key === 'Enter');
    return true;
  }

  private end(keep: boolean): void {
    const done = this.done;
    this.done = null;
    this.line.visible = false;
    byId('hint').hidden = true;
    this.scene.canvas.classList.remove('aiming');
    this.scene.invalidate();
    const rounded = (value: number): number => Number(value.toFixed(3));
    if (keep && this.points.length > 0) done?.(this.points.map(({x, y}) => [rounded(x), rounded(y)]));
  }

  private onDown(event: PointerEvent): void {
    if (!this.done || event.button !== 0 || event.target !== this.scene.canvas) return;
    event.stopPropagation();
    const last = this.points[this.points.length - 1];
    const place = last && this.scene.project(last);
    if (place && Math.hypot(place.x - event.clientX, place.y - event.clientY) < NEAR) return this.end(true);
    const at = this.scene.floorAt(event.clientX, event.clientY);
    if (!at) return;
    this.points.push(new Vector3(at.x, at.y, HEIGHT));
    if (this.isSingle) return this.end(true);
    this.show(null);
  }

  private onMove(event: PointerEvent): void {
    if (this.done && event.target === this.scene.canvas) this.show(this.scene.floorAt(event.clientX, event.clientY));
  }

  private show(next: Vector3 | null): void {
    if (!this.start) return;
    const end = next ? [new Vector3(next.x, next.y, HEIGHT)] : [];
    this.line.geometry.dispose();
    this.line.geometry = new BufferGeometry().setFromPoints([this.start, ...this.points, ...end]);
    this.line.visible = true;
    this.scene.invalidate();
  }
}
