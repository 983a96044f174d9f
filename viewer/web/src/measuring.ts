// Measuring: the distance and the direction between two points of the ground or of bodies, as a line in the picture.
import {BufferGeometry, Line, LineBasicMaterial, Vector3} from 'three';
import {byId, fixed} from './dom';
import {degrees} from './pose';
import type {WorldScene} from './scene';

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
    const at = this.scene.pointAt(clientX, clientY, 0);
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
    const at = this.from && !this.ended ? this.scene.pointAt(clientX, clientY, 0) : null;
    if (at) this.show(at);
  }

  clear(): void {
    this.from = null;
    this.line.visible = false;
    this.scene.invalidate();
  }

  private show(to: Vector3): void {
    if (!this.from) return;
    const lifted = [this.from, to].map(point => point.clone().setZ(0.02));
    this.geometry.setFromPoints(lifted);
    this.line.visible = true;
    this.scene.invalidate();
    const x = to.x - this.from.x;
    const y = to.y - this.from.y;
    byId('hint').textContent =
      `${fixed(Math.hypot(x, y), 3)} m, x ${fixed(x, 3)} m, y ${fixed(y, 3)} m, direction ${fixed(degrees(Math.atan2(y, x)), 1)}°`;
  }
}
