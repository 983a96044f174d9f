// Video: records the picture as a WebM file, by the browser's own encoder.
import {byId, toast} from './dom';

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
