// The button GIF: records the picture as an animated file for pages and messages that show no video.
//
// A frame is drawn again and read in the same moment, because a canvas of WebGL has no picture between frames. Frames are
// small and few, since the file grows with each.
import {byId, setOn, toast} from './dom';
import {GifFile} from './gif_file';
import {saveBlob} from './graphics';

const WIDEST = 640;  // px
const PERIOD = 0.125;  // s, between frames
const LONGEST = 30;  // s

export class GifRecording {
  private file: GifFile | null = null;
  private timer = 0;
  private frames = 0;
  private readonly canvas = document.createElement('canvas');

  // `draw`: the present picture into a canvas of that size.
  constructor(
      private readonly source: HTMLCanvasElement, private readonly draw: (into: CanvasRenderingContext2D) => void,
      private readonly name: () => string) {
    byId('gif').onclick = () => this.toggle();
  }

  private toggle(): void {
    if (this.file) return this.stop();
    const {clientWidth, clientHeight} = this.source;
    this.canvas.width = Math.min(WIDEST, clientWidth);
    this.canvas.height = Math.max(1, Math.round((clientHeight * this.canvas.width) / Math.max(1, clientWidth)));
    this.file = new GifFile(this.canvas.width, this.canvas.height);
    this.frames = 0;
    setOn('gif', true);
    toast('Recording: press GIF again to save it');
    this.addFrame();
    this.timer = window.setInterval(() => this.addFrame(), 1000 * PERIOD);
  }

  private addFrame(): void {
    const context = this.canvas.getContext('2d', {willReadFrequently: true})!;
    this.draw(context);
    const {width, height} = this.canvas;
    this.file?.add(context.getImageData(0, 0, width, height).data, PERIOD);
    if (++this.frames * PERIOD >= LONGEST) this.stop();
  }

  private stop(): void {
    clearInterval(this.timer);
    setOn('gif', false);
    if (this.file) saveBlob(this.file.finish(), `${this.name()}.gif`);
    this.file = null;
    toast(`The picture with ${this.frames} frames is saved`);
  }
}
