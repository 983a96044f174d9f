// The names of robots, as elements over the picture.
import {Vector3, type Camera} from 'three';
import type {Bodies} from './bodies';
import {sameEntity, type Entity, type Run} from './run';

// px around a name that no other name may have: names of a crowd would only cover each other.
const WIDTH = 62;
const HEIGHT = 17;

export class Labels {
  visible = true;
  most = 120;
  private width = 1;  // px
  private height = 1;
  private readonly elements = new Map<number, HTMLElement>();  // by robot
  private readonly point = new Vector3();

  constructor(private readonly parent: HTMLElement) {}

  // Of the picture, px.
  setSize(width: number, height: number): void {
    this.width = width;
    this.height = height;
  }

  place(run: Run | null, bodies: Bodies | null, camera: Camera, selected: Entity | null): void {
    const shown = new Set<number>();
    const taken: Array<[number, number]> = [];
    if (run && bodies) {
      for (let i = 0; i < run.world.robots.length; ++i) {
        const robot = run.world.robots[i];
        const row = run.robots[i];
        const entity: Entity = {kind: 'robot', index: i};
        const isSelected = sameEntity(entity, selected);
        if (!robot.present || !row) continue;
        if (!isSelected && (!this.visible || shown.size >= this.most)) continue;
        this.point.set(row.pose.x, row.pose.y, row.pose.z + bodies.topOf(entity)).project(camera);
        const {x, y, z} = this.point;
        if (z > 1 || Math.abs(x) > 1 || Math.abs(y) > 1) continue;
        const left = ((x + 1) / 2) * this.width;
        const top = ((1 - y) / 2) * this.height;
        const isFree = !taken.some(([a, b]) => Math.abs(a - left) < WIDTH && Math.abs(b - top) < HEIGHT);
        if (!isFree && !isSelected) continue;
        taken.push([left, top]);
        shown.add(i);
        const element = this.elementOf(i, robot.name);
        element.style.transform = `translate(${left}px, ${top}px) translate(-50%, -135%)`;
        element.classList.toggle('stalled', row.stalled);
        element.classList.toggle('selected', isSelected);
      }
    }
    for (const [i, element] of this.elements) {
      if (shown.has(i)) continue;
      element.remove();
      this.elements.delete(i);
    }
  }

  clear(): void {
    for (const element of this.elements.values()) element.remove();
    this.elements.clear();
  }

  private elementOf(robot: number, name: string): HTMLElement {
    let element = this.elements.get(robot);
    if (!element) {
      element = document.createElement('div');
      element.className = 'label';
      element.textContent = name;
      this.parent.append(element);
      this.elements.set(robot, element);
    }
    return element;
  }
}
