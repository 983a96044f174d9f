// DragLabel: the numbers of a drag in the picture, beside the pointer.
import {fixed, make, setText} from './dom';

export class DragLabel {
  private readonly box = make('div', 'drag-label');

  constructor() {
    this.box.hidden = true;
    this.box.setAttribute('role', 'status');
    document.body.append(this.box);
  }

  // `at`: the pointer, px of the window.
  show(at: {clientX: number; clientY: number}, text: string): void {
    setText(this.box, text);
    this.box.hidden = false;
    const left = Math.min(at.clientX + 16, window.innerWidth - this.box.offsetWidth - 8);
    this.box.style.transform = `translate(${left}px, ${at.clientY + 18}px)`;
  }
  hide(): void {
    this.box.hidden = true;
  }
}

export const metres = (value: number): string => fixed(value, 2);
