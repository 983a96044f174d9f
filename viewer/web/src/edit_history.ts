// EditHistory: undo and redo of the edits that were made on this page. The run decides on each again: an undo is refused
// like any edit, for instance when another body is at the place by now.
import {toast} from './dom';

export interface Edit {
  text: string;  // "the move of r0"
  undo(): Promise<boolean>;  // false: refused; the reason was shown
  redo(): Promise<boolean>;
}

const MOST = 100;

export class EditHistory {
  private done: Edit[] = [];
  private undone: Edit[] = [];
  private busy = false;
  off = false;  // a file in editing has its own history

  constructor(private readonly onChange: (canUndo: boolean, canRedo: boolean) => void) {}

  add(edit: Edit): void {
    if (this.off) return;
    this.done.push(edit);
    if (this.done.length > MOST) this.done.shift();
    this.undone = [];
    this.changed();
  }

  undo(): Promise<void> {
    return this.apply(this.done, this.undone, edit => edit.undo(), 'undone');
  }
  redo(): Promise<void> {
    return this.apply(this.undone, this.done, edit => edit.redo(), 'redone');
  }

  // After a reset there is nothing to undo.
  clear(): void {
    this.done = [];
    this.undone = [];
    this.changed();
  }

  private async apply(
      from: Edit[], to: Edit[], make: (edit: Edit) => Promise<boolean>, verb: string): Promise<void> {
    const edit = from[from.length - 1];
    if (!edit || this.busy) return;
    this.busy = true;
    try {
      if (await make(edit)) {
        from.pop();
        to.push(edit);
        toast(`${edit.text} is ${verb}`);
      }
    } finally {
      this.busy = false;
      this.changed();
    }
  }

  private changed(): void {
    this.onChange(this.done.length > 0, this.undone.length > 0);
  }
}
