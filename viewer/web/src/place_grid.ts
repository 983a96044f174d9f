// PlaceGrid: the places that pointers choose in the picture of a file: on the grid, at right angles, on other walls, and
// beside other models; and the place of the dragged entity in numbers.
import type {Vector3} from 'three';
import {byId} from './dom';
import {DragLabel, metres} from './drag_label';
import type {PictureBlock} from './file_client';
import type {Pose} from './protocol';
import {findEntity, rootOf, type Run} from './run';
import type {WorldScene} from './scene';
import {outlinesOf, Surroundings, type Point} from './snapping';

const TURN = Math.PI / 12;  // of a turn with Shift
const REACH = 11;  // px, from which walls and models attract

export interface PlaceGridHost {
  run(): Run | null;
  choosesPixels(): boolean;
  // A wall or a room is drawn; its first end.
  drawn(): {from: Point | null; isWall: boolean} | null;
  dragged(): readonly string[];
}

export class PlaceGrid {
  private pointer: PointerEvent | null = null;
  private ghost: Pose | null = null;
  private from: Pose | null = null;  // where the drag has begun
  private readonly label = new DragLabel();
  private readonly step = byId<HTMLSelectElement>('file-snap');
  private around: {run: Run; without: string; value: Surroundings} | null = null;

  constructor(private readonly scene: WorldScene, private readonly host: PlaceGridHost) {
    for (const type of ['pointerdown', 'pointermove', 'pointerup'] as const) {
      window.addEventListener(type, event => {
        this.pointer = event;
      }, {capture: true});
    }
    scene.chosenPlace = point => this.chosen(point);
    scene.ghostMoved = pose => this.showGhost(pose);
  }

  // The pose of a dragged entity, beside what is near.
  besideOthers(name: string, pose: Pose): Pose {
    const run = this.host.run();
    const entity = run ? findEntity(run.world, name) : null;
    return run && entity ? this.touching(pose, outlinesOf(run.world, rootOf(run.world, entity))) : pose;
  }

  // The same of a model that is put down.
  besideOthersNew(picture: PictureBlock[], pose: Pose): Pose {
    return this.touching(pose, picture.map(({outline}) => outline.map(([x, y]) => ({x, y}))));
  }

  private touching(pose: Pose, outlines: Point[][]): Pose {
    const around = this.isFree ? null : this.surroundings();
    return around ? around.touching(pose, outlines, this.reachAt(pose)) : pose;
  }

  private get isFree(): boolean {
    return Number(this.step.value) === 0 || (this.pointer?.altKey ?? false) || this.host.choosesPixels();
  }

  private reachAt({x, y}: Point): number {
    return REACH * this.scene.pixelAt({x, y, z: 0});
  }

  private surroundings(): Surroundings | null {
    const run = this.host.run();
    if (!run?.hasState) return null;
    const dragged = this.host.dragged();
    const without = dragged.join('\n');
    if (this.around?.run !== run || this.around.without !== without) {
      this.around = {run, without, value: new Surroundings(run, dragged)};
    }
    return this.around.value;
  }

  private chosen(point: Vector3): Vector3 {
    if (this.isFree) return point;
    const step = Number(this.step.value);
    const free = {x: point.x, y: point.y};
    const drawn = this.host.drawn();
    if (!drawn && this.pointer?.shiftKey && this.pointer.buttons === 1 && this.ghost) {
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
    const around = drawn ? this.surroundings() : null;
    if (!drawn || !around) return point;
    const {x, y} = around.wallEnd(
      free, {x: point.x, y: point.y}, drawn.isWall ? drawn.from : null, this.reachAt(free),
      drawn.isWall && drawn.from !== null && (this.pointer?.shiftKey ?? false));
    return Object.assign(point, {x, y});
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
