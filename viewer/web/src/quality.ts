// Quality: draws less where the graphics are slow, as they are without a graphics card. It looks at the time from a
// drawing to the next frame of the browser.
const SLOW = 70;  // ms
const PATIENCE = 4;  // slow drawings in a row

export class Quality {
  private slow = 0;
  private drawnAt: number | null = null;

  // `level`: 0: everything; 1: no shadows; 2: fewer pixels as well. `fixed`: it remains at that.
  constructor(public level: number, readonly fixed: boolean) {}

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
