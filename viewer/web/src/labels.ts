// The names of robots, as elements over the picture.
import {Vector3, type Camera} from 'three';
import type {Bodies} from './bodies';
import {sameEntity, type Entity, type Run} from './run';

const MOST = 120;  // more would only cover each other

export class Labels {
  visible = true;
  private readonly elements = new Map<number, HTMLElement>();  // by robot
  private readonly point = new Vector3();

  constructor(private readonly parent: HTMLElement) {}

  place(run: Run | null, bodies: Bodies | null, camera: Camera, selected: Entity | null): void {
    const width = this.parent.clientWidth;
    const height = this.parent.clientHeight;
    const shown = new Set<number>();
    if (run && bodies) {
      for (let i = 0; i < run.world.robots.length && shown.size < MOST; ++i) {
        const robot = run.world.robots[i];
        const row = run.robots[i];
        const entity: Entity = {kind: 'robot', index: i};
        const isSelected = sameEntity(entity, selected);
        if (!robot.present || !row || (!this.visible && !isSelected)) continue;
        this.point.set(row.pose.x, row.pose.y, row.pose.z + bodies.topOf(entity)).project(camera);
        const {x, y, z} = this.point;
        if (z > 1 || Math.abs(x) > 1 || Math.abs(y) > 1) continue;
        shown.add(i);
        const element = this.elementOf(i, robot.name);
        element.style.transform = `translate(${((x + 1) / 2) * width}px, ${((1 - y) / 2) * height}px) translate(-50%, -135%)`;
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
