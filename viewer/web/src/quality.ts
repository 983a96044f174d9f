// Quality: draws less where the graphics are slow, as they are without a graphics card. It looks at the time from a
// drawing to the next frame of the browser. There each name and each text of a panel costs as well: the browser composes
// the page from them on the processor, too.
const SLOW = 70;  // ms
const PATIENCE = 4;  // slow drawings in a row

export class Quality {
  private slow = 0;
  private drawnAt: number | null = null;

  // `level`: 0: everything; 1: no shadows; 2: fewer pixels, names and texts as well. `fixed`: it remains at that.
  constructor(public level: number, readonly fixed: boolean) {}

  // Of the picture, for each of the page.
  get pixelRatio(): number {
    return this.level < 2 ? Math.min(window.devicePixelRatio, 2) : 0.75;
  }
  get mostNames(): number {
    return this.level < 2 ? 120 : 25;
  }
  // ms between two texts of the panels.
  get panelPeriod(): number {
    return this.level < 2 ? 100 : 250;
  }

  drawn(now: number): void {
    this.drawnAt = now;
  }

  // At each frame of the browser. True when the level has changed.
  next(now: number): boolean {
    if (this.drawnAt === null) return false;
    const took = now - this.drawnAt;
    this.drawnAt = null;
    // A page in the background gets no frames at all.
    this.slow = took > SLOW && took < 5000 ? this.slow + 1 : 0;
    if (this.fixed || this.slow < PATIENCE || this.level === 2) return false;
    this.slow = 0;
    ++this.level;
    return true;
  }
}
