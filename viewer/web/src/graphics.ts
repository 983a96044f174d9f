// The graphics context in which the page draws. Without a graphics card each sample of a pixel costs processor time,
// and making a context takes seconds, so that edges are smooth with a card only.
//
// Quality is lowered step by step when frames take long, and never raised again: a page that changes between two
// qualities is worse than a plain one.
import {WebGLRenderer} from 'three';
import {byId, toast} from './dom';

const ATTRIBUTES = {alpha: false, depth: true, stencil: false, premultipliedAlpha: true, preserveDrawingBuffer: false};

function drawsInSoftware(context: WebGL2RenderingContext): boolean {
  const info = context.getExtension('WEBGL_debug_renderer_info');
  const name = String(context.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export interface Graphics {
  renderer: WebGLRenderer;
  fast: boolean;  // by a graphics card
}

// `full`: with smooth edges in any case.
export function makeGraphics(full: boolean): Graphics {
  const canvas = document.createElement('canvas');
  const context = full ? null : canvas.getContext('webgl2', {...ATTRIBUTES, antialias: false});
  if (context && drawsInSoftware(context)) {
    return {renderer: new WebGLRenderer({canvas, context}), fast: false};
  }
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return {renderer: new WebGLRenderer({...ATTRIBUTES, antialias: true}), fast: true};
}

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

  // The pixels of the picture for each pixel of the page.
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

// Video: records the picture as a WebM file, by the browser's own encoder.

const RATE = 30;  // frames a second
const BITS = 8_000_000;  // a second

export class Video {
  private recorder: MediaRecorder | null = null;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly name: () => string) {
    byId('video').onclick = () => this.toggle();
    byId('video').hidden = typeof MediaRecorder === 'undefined' || !('captureStream' in canvas);
  }

  toggle(): void {
    if (this.recorder) this.recorder.stop();
    else this.start();
  }

  private start(): void {
    const type = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'].find(t => MediaRecorder.isTypeSupported(t));
    if (!type) {
      toast('This browser records no WebM video', true);
      return;
    }
    const recorder = new MediaRecorder(this.canvas.captureStream(RATE), {mimeType: type, videoBitsPerSecond: BITS});
    const parts: Blob[] = [];
    recorder.ondataavailable = event => parts.push(event.data);
    recorder.onstop = () => {
      this.recorder = null;
      byId('video').classList.remove('recording');
      save(URL.createObjectURL(new Blob(parts, {type: 'video/webm'})), `${this.name()}.webm`);
      toast('The video is saved');
    };
    recorder.start(1000);
    this.recorder = recorder;
    byId('video').classList.add('recording');
  }
}

export function save(url: string, name: string): void {
  const link = document.createElement('a');
  link.href = url;
  link.download = name;
  link.click();
}

export function saveText(text: string, name: string): void {
  saveBlob(new Blob([text], {type: 'text/csv'}), name);
}

export function saveBlob(blob: Blob, name: string): void {
  const url = URL.createObjectURL(blob);
  save(url, name);
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
