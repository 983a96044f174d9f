// The levels of a building, and where each is drawn: at its height, alone, or on the ground beside the others.
//
// Levels are intervals of height of one world, not worlds of their own: a lift's cabin and the people in it pass from
// one to the next. Nothing is moved in the scene; the camera is shifted per level and clipped to its heights
// (scene.ts), so that picking and marks work in true coordinates.
import {Box3, Plane, Vector3} from 'three';
import type {Level} from './protocol';

export type LevelView = 'stacked' | 'beside' | 'one';

// The bodies between two heights, and the shift by which they are drawn elsewhere.
export interface LevelPart {
  level: number;
  from: number;  // m
  to: number;
  shift: Vector3;
}

const BELOW = 0.3;  // m: so far below its floor a level begins, with the plate of the floor
const GAP = 0.06;  // of the building's size, between levels that are beside each other
const ASPECT = 1.6;  // width by depth, to which levels beside each other come as near as they can
const FAR = 1e6;  // m

export class Levels {
  private view: LevelView = 'stacked';
  private shown = 0;  // number of the level that is shown alone
  private readonly parts: LevelPart[];
  private readonly box = new Box3();  // of the building, at its true heights
  private readonly step = new Vector3();  // from a level to the one above, where they are beside each other

  constructor(readonly list: Level[] = []) {
    this.parts = list.map(({z}, level) => ({
      level,
      from: level === 0 ? -FAR : z - BELOW,
      to: level + 1 < list.length ? list[level + 1].z - BELOW : FAR,
      shift: new Vector3(),
    }));
  }

  // "stacked", "beside", or the name of the level that is shown alone.
  get choice(): string {
    return this.view === 'one' ? this.list[this.shown].name : this.view;
  }
  // Without effect for a level that is not there.
  choose(choice: string): void {
    const number = this.list.findIndex(({name}) => name === choice);
    if (number < 0 && choice !== 'stacked' && choice !== 'beside') return;
    this.view = number >= 0 ? 'one' : choice as LevelView;
    this.shown = Math.max(number, 0);
    this.place();
  }

  // All are drawn where they are.
  get areStacked(): boolean {
    return this.list.length < 2 || this.view === 'stacked';
  }

  setBox(box: Box3): void {
    this.box.copy(box);
    const {x, y} = box.getSize(new Vector3());
    const count = this.list.length;
    const misfit = (width: number, depth: number): number => Math.abs(Math.log(width / (depth * ASPECT)));
    if (misfit(count * x, y) < misfit(x, count * y)) this.step.set((1 + GAP) * x, 0, 0);
    else this.step.set(0, (1 + GAP) * y, 0);
    this.place();
  }

  // What is drawn apart from the rest.
  get drawn(): LevelPart[] {
    return this.view === 'one' ? [this.parts[this.shown]] : this.parts;
  }

  // The level of a height.
  numberAt(z: number): number {
    return Math.max(0, this.parts.findIndex(({from, to}) => z >= from && z < to));
  }
  // By how much what is at a height is drawn elsewhere; null: it is not drawn.
  shiftAt(z: number): Vector3 | null {
    if (this.areStacked) return new Vector3();
    const part = this.parts[this.numberAt(z)];
    return this.view === 'one' && part.level !== this.shown ? null : part.shift;
  }

  // Around everything that is drawn.
  drawnBox(): Box3 {
    const box = this.box.clone();
    if (this.areStacked) return box;
    const parts = this.drawn;
    const {z} = this.list[parts[0].level];
    box.max.z = Math.min(this.box.max.z, parts[0].to) - z + this.list[0].z;
    return box.expandByPoint(box.max.clone().add(parts[parts.length - 1].shift.clone().setZ(0)));
  }

  // The level on which a point is that is drawn on the ground.
  levelAtDrawn(point: Vector3): LevelPart {
    const along = point.clone().sub(this.box.min).dot(this.step) / Math.max(this.step.lengthSq(), 1e-12);
    const parts = this.drawn;
    return parts[Math.max(0, Math.min(parts.length - 1, Math.floor(along)))];
  }

  private place(): void {
    for (const {level, shift} of this.parts) {
      shift.copy(this.step).multiplyScalar(this.view === 'beside' ? level : 0);
      shift.z = this.list[0].z - this.list[level].z;
    }
  }
}

// Everything between the heights of a part, where it is not shifted.
export function planesOf({from, to}: LevelPart): Plane[] {
  return [new Plane(new Vector3(0, 0, 1), -from), new Plane(new Vector3(0, 0, -1), to)];
}

// The list from which a user chooses: "All levels", "Side by side", and each level alone, the highest first.
export class LevelChoice {
  constructor(private readonly list: HTMLSelectElement, private readonly chosen: (choice: string) => void) {
    list.onchange = () => chosen(list.value);
  }

  // It is hidden where there is one level.
  show(levels: Levels): void {
    const names = levels.list.map(({name}) => name).reverse();
    const options = [['All levels', 'stacked'], ['Side by side', 'beside'], ...names.map(name => [`Level ${name}`, name])];
    this.list.hidden = names.length < 2;
    this.list.replaceChildren(...options.map(([text, value]) => new Option(text, value)));
    this.list.value = levels.choice;
  }

  // The next of the list; `step` above or below 0: the level above or below the one that is shown.
  next(levels: Levels, step: number): void {
    if (levels.list.length < 2) return;
    const names = levels.list.map(({name}) => name);
    const at = names.indexOf(levels.choice);
    if (step === 0) return this.chosen(at >= 0 ? 'stacked' : levels.choice === 'stacked' ? 'beside' : names[0]);
    this.chosen(names[at < 0 ? 0 : Math.max(0, Math.min(names.length - 1, at + step))]);
  }
}
