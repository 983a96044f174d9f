// PlaceGrid: the grid to which pointers snap in the picture of a file, and the place of the dragged entity in numbers.
import type {Vector3} from 'three';
import {byId} from './dom';
import {DragLabel, metres} from './drag_label';
import type {Pose} from './protocol';
import type {WorldScene} from './scene';

const TURN = Math.PI / 12;  // of a turn with Shift

export class PlaceGrid {
  private pointer: PointerEvent | null = null;
  private ghost: Pose | null = null;
  private from: Pose | null = null;  // where the drag has begun
  private readonly label = new DragLabel();
  private readonly step = byId<HTMLSelectElement>('file-snap');

  // `isOff`: pixels are chosen.
  constructor(scene: WorldScene, private readonly isOff: () => boolean) {
    for (const type of ['pointerdown', 'pointermove', 'pointerup'] as const) {
      window.addEventListener(type, event => {
        this.pointer = event;
      }, {capture: true});
    }
    scene.chosenPlace = point => this.chosen(point);
    scene.ghostMoved = pose => this.showGhost(pose);
  }

  private chosen(point: Vector3): Vector3 {
    const step = Number(this.step.value);
    if (step === 0 || this.pointer?.altKey || this.isOff()) return point;
    if (this.pointer?.shiftKey && this.pointer.buttons === 1 && this.ghost) {
      // The direction from the middle of the turned entity.
      const [x, y] = [point.x - this.ghost.x, point.y - this.ghost.y];
      const angle = Math.round(Math.atan2(y, x) / TURN) * TURN;
      const length = Math.hypot(x, y);
      point.x = this.ghost.x + length * Math.cos(angle);
      point.y = this.ghost.y + length * Math.sin(angle);
      return point;
    }
    point.x = Math.round(point.x / step) * step;
    point.y = Math.round(point.y / step) * step;
    return point;
  }

  private showGhost(pose: Pose | null): void {
    this.ghost = pose;
    this.from = pose ? this.from ?? pose : null;
    if (!pose || !this.from || !this.pointer) return this.label.hide();
    const degrees = Math.round((pose.heading * 180) / Math.PI);
    const way = Math.hypot(pose.x - this.from.x, pose.y - this.from.y);
    this.label.show(this.pointer, `x ${metres(pose.x)}  y ${metres(pose.y)} m, ${degrees}°${way > 0 ? `, by ${metres(way)} m` : ''}`);
  }
}
