// Selection: the names of the selected entities of a file. The last one is the one whose properties are shown.
import {make} from './dom';

export class Selection {
  private chosen: string[] = [];

  get names(): readonly string[] {
    return this.chosen;
  }
  // The others than the one whose properties are shown.
  get others(): readonly string[] {
    return this.chosen.slice(0, -1);
  }
  get primary(): string {
    return this.chosen[this.chosen.length - 1] ?? '';
  }
  get isSeveral(): boolean {
    return this.chosen.length > 1;
  }
  has(name: string): boolean {
    return this.chosen.includes(name);
  }

  set(names: readonly string[]): void {
    this.chosen = [...new Set(names.filter(Boolean))];
  }
  toggle(name: string): void {
    this.set(this.has(name) ? this.chosen.filter(each => each !== name) : [...this.chosen, name]);
  }
}

// A rectangle on the window, px, that is dragged around what is to be selected.
export class RubberBand {
  private from: {x: number; y: number} | null = null;
  private readonly box = make('div', 'rubber-band');

  constructor() {
    this.box.hidden = true;
    document.body.append(this.box);
  }

  get isOpen(): boolean {
    return this.from !== null;
  }

  begin({clientX, clientY}: PointerEvent): void {
    this.from = {x: clientX, y: clientY};
  }

  move({clientX, clientY}: PointerEvent): void {
    if (!this.from) return;
    const {left, top, width, height} = this.rect(clientX, clientY);
    this.box.hidden = false;
    Object.assign(this.box.style, {left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px`});
  }

  end({clientX, clientY}: PointerEvent): DOMRect {
    const rect = this.rect(clientX, clientY);
    this.from = null;
    this.box.hidden = true;
    return rect;
  }

  private rect(x: number, y: number): DOMRect {
    const from = this.from ?? {x, y};
    return new DOMRect(Math.min(from.x, x), Math.min(from.y, y), Math.abs(x - from.x), Math.abs(y - from.y));
  }
}
