// The readings of the selected robot's sensors in its panel, a view for each: pictures, numbers and lists. Ranges have
// the polar plot.
// Each view keeps its elements and canvas while readings of its sensor arrive: one that was rebuilt in each frame would
// lose its scroll position and the user's selection.
import {fixed, make, setText} from './dom';
import type {Content} from '../generated/rows';
import type {BumperSegment, ContentOf, Reading, Reception} from './protocol';
import {degrees, type Run} from './run';

const MOST_LINES = 8;  // of a list
const MOST_MESSAGES = 5;
const MOST_BYTES = 256;  // of a message
const BUMPER_HEIGHT = 64;  // px

function color(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function setSize(canvas: HTMLCanvasElement, width: number, height: number): void {
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
}

// Printable bytes as a text, others in hexadecimal digits.
export function messageText(reception: Reception): string {
  const bytes = reception.bytes.subarray(0, MOST_BYTES);
  const more = reception.bytes.length > bytes.length ? ' …' : '';
  if (bytes.every(byte => byte >= 32 && byte < 127)) return String.fromCharCode(...bytes) + more;
  return [...bytes].map(byte => byte.toString(16).padStart(2, '0')).join(' ') + more;
}

function setLines(list: HTMLElement, lines: string[][], none: string): void {
  const shown = lines.length > 0 ? lines.slice(0, MOST_LINES) : [[none]];
  if (lines.length > MOST_LINES) shown.push([`and ${lines.length - MOST_LINES} more`]);
  while (list.childElementCount > shown.length) list.lastElementChild!.remove();
  while (list.childElementCount < shown.length) list.append(make('div', 'reading-line'));
  list.classList.toggle('faint', lines.length === 0);
  shown.forEach((cells, i) => {
    const line = list.children[i];
    while (line.childElementCount > cells.length) line.lastElementChild!.remove();
    while (line.childElementCount < cells.length) line.append(make('span', ''));
    cells.forEach((cell, k) => setText(line.children[k] as HTMLElement, cell));
  });
}

// The view of one kind of sensor: its elements, and what they show.
interface View<Kind extends Content['kind']> {
  elements: HTMLElement[];
  update(content: ContentOf<Kind>, run: Run): void;
}

type Makers = {[Kind in Content['kind']]?: () => View<Kind>};

function modelName(run: Run, model: number): string {
  return run.world.models[model]?.name ?? '?';
}

function makeList<Kind extends Content['kind']>(
    none: string, lines: (content: ContentOf<Kind>, run: Run) => string[][]): () => View<Kind> {
  return () => {
    const list = make('div', 'reading-list');
    return {elements: [list], update: (content, run) => setLines(list, lines(content, run), none)};
  };
}

function drawCamera(canvas: HTMLCanvasElement, camera: ContentOf<'camera'>): void {
  const {width, height, colors} = camera;
  setSize(canvas, width, height);
  const context = canvas.getContext('2d')!;
  const image = context.createImageData(width, height);
  for (let i = 0; i < width * height; ++i) {
    image.data[4 * i] = colors[3 * i];
    image.data[4 * i + 1] = colors[3 * i + 1];
    image.data[4 * i + 2] = colors[3 * i + 2];
    image.data[4 * i + 3] = 255;
  }
  context.putImageData(image, 0, 0);
}

function drawBlobs(canvas: HTMLCanvasElement, content: ContentOf<'blobfinder'>): void {
  // Small images with sharp edges.
  const scale = Math.max(1, Math.ceil(240 / content.width));
  setSize(canvas, scale * content.width, scale * content.height);
  const context = canvas.getContext('2d')!;
  context.clearRect(0, 0, canvas.width, canvas.height);
  for (const blob of content.blobs) {
    context.fillStyle = `rgb(${blob.color.slice(0, 3).map(value => Math.round(255 * value)).join(' ')})`;
    context.fillRect(
      scale * blob.left, scale * blob.top, scale * (blob.right - blob.left), scale * Math.max(1, blob.bottom - blob.top));
  }
}

// From above, ahead upwards.
function drawBumper(canvas: HTMLCanvasElement, segments: BumperSegment[]): void {
  const ratio = Math.min(window.devicePixelRatio, 2);
  const width = Math.max(1, canvas.clientWidth);
  setSize(canvas, Math.round(width * ratio), Math.round(BUMPER_HEIGHT * ratio));
  const context = canvas.getContext('2d')!;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, BUMPER_HEIGHT);
  const reach = Math.max(
    0.05, ...segments.map(({pose, length}) => Math.max(Math.abs(pose.x), Math.abs(pose.y)) + 0.5 * length));
  const scale = (BUMPER_HEIGHT / 2 - 4) / reach;
  for (const {pose, length, pressedBy} of segments) {
    const dx = -Math.sin(pose.heading) * 0.5 * length;
    const dy = Math.cos(pose.heading) * 0.5 * length;
    context.strokeStyle = color(pressedBy >= 0 ? '--red' : '--faint');
    context.lineWidth = pressedBy >= 0 ? 5 : 2;
    context.beginPath();
    for (const side of [-1, 1]) {
      const x = width / 2 - (pose.y + side * dy) * scale;
      const y = BUMPER_HEIGHT / 2 - (pose.x + side * dx) * scale;
      if (side < 0) context.moveTo(x, y);
      else context.lineTo(x, y);
    }
    context.stroke();
  }
}

function makeCanvas(className: string): HTMLCanvasElement {
  return make('canvas', className) as HTMLCanvasElement;
}

const MAKERS: Makers = {
  break_beam: makeList('no beams', (content, run) => content.beams.map(({brokenBy}, i) => [
    `beam ${i + 1}`, brokenBy >= 0 ? `broken by ${modelName(run, run.world.objects[brokenBy])}` : 'clear',
  ])),
  fiducial: makeList('none in sight', (content, run) => content.fiducials.map(({id, model, range, bearing}) => [
    id === 0 ? '?' : String(id), modelName(run, model), `${fixed(range, 2)} m`, `${fixed(degrees(bearing), 1)}°`,
  ])),
  bumper: () => {
    const canvas = makeCanvas('reading-bumper');
    const text = make('div', 'reading-text');
    return {
      elements: [canvas, text],
      update: ({segments}, run) => {
        drawBumper(canvas, segments);
        const names = new Set(segments.filter(s => s.pressedBy >= 0).map(s => modelName(run, s.pressedBy)));
        setText(text, names.size > 0 ? `pressed by ${[...names].join(', ')}` : 'not pressed');
        text.classList.toggle('faint', names.size === 0);
      },
    };
  },
  contact: makeList('none', (content, run) => content.contacts.map(({part, other, point}) => [
    modelName(run, part), modelName(run, other), `${fixed(point.x, 2)}, ${fixed(point.y, 2)} m`,
  ])),
  blobfinder: () => {
    const canvas = makeCanvas('reading-picture');
    const text = make('div', 'reading-text faint');
    return {
      elements: [canvas, text],
      update: content => {
        drawBlobs(canvas, content);
        const ranges = content.blobs.map(blob => blob.range);
        const count = ranges.length === 1 ? '1 blob' : `${ranges.length} blobs`;
        setText(text, ranges.length > 0 ? `${count}, nearest ${fixed(Math.min(...ranges), 2)} m` : 'no blobs');
      },
    };
  },
  camera: () => {
    const canvas = makeCanvas('reading-picture');
    const text = make('div', 'reading-text faint');
    return {
      elements: [canvas, text],
      update: content => {
        drawCamera(canvas, content);
        setText(text, `${content.width} × ${content.height} pixels, up to ${fixed(content.limits.max, 1)} m`);
      },
    };
  },
  imu: () => {
    const list = make('div', 'reading-list');
    return {
      elements: [list],
      update: ({heading, turn, force, forceZ}) => setLines(list, [
        ['heading', `${fixed(degrees(heading), 1)}°`],
        ['turning', `${fixed(degrees(turn), 2)} °/s`],
        ['force x', `${fixed(force.x, 3)} m/s²`],
        ['force y', `${fixed(force.y, 3)} m/s²`],
        ['force z', `${fixed(forceZ, 3)} m/s²`],
      ], ''),
    };
  },
};

interface Shown {
  content: Content | null;  // that it shows
  update(content: Content, run: Run): void;
}

interface HeardMessage {
  tick: number;  // of the reading
  from: string;
  text: string;
  rssi: number;
}

// A message is in the reading of one tick alone, too short to be read: the last ones stay.
class Heard {
  private messages: HeardMessage[] = [];
  private tick = -1;

  add(run: Run, {tick, content}: Reading): void {
    if (content.kind !== 'radio' || tick === this.tick) return;
    if (tick < this.tick) this.messages = this.messages.filter(message => message.tick <= tick);
    this.tick = tick;
    for (const reception of content.receptions) {
      this.messages.unshift({
        tick, from: run.world.robots[reception.from]?.name ?? '?', text: messageText(reception), rssi: reception.rssi,
      });
    }
    this.messages.length = Math.min(this.messages.length, MOST_MESSAGES);
  }

  lines(run: Run): string[][] {
    return this.messages.map(({tick, from, text, rssi}) => [
      `${fixed(tick * run.world.interval, 1)} s`, from, text, `${fixed(rssi, 1)} dBm`,
    ]);
  }
}

export class SensorViews {
  private key = '';
  private shown: Array<Shown | null> = [];  // by sensor
  private heardKey = '';
  private heard = new Map<string, Heard>();  // by sensor

  constructor(private readonly parent: HTMLElement) {}

  // At each update, also between two of show().
  note(run: Run, robot: number): void {
    const key = `${run.world.name} ${robot}`;
    if (key !== this.heardKey) this.heard.clear();
    this.heardKey = key;
    for (const reading of run.readings.get(robot)?.readings ?? []) {
      if (reading.content.kind !== 'radio') continue;
      if (!this.heard.has(reading.sensor)) this.heard.set(reading.sensor, new Heard());
      this.heard.get(reading.sensor)!.add(run, reading);
    }
  }

  show(run: Run, robot: number): void {
    const readings = run.readings.get(robot)?.readings ?? [];
    const key = `${run.world.number} ${robot} ${readings.map(r => `${r.sensor} ${r.content.kind}`).join()}`;
    if (key !== this.key) {
      this.parent.replaceChildren();
      this.shown = readings.map(reading => this.makeView(run, robot, reading));
    }
    this.key = key;
    readings.forEach(({content}, i) => {
      const shown = this.shown[i];
      if (!shown || shown.content === content) return;
      shown.content = content;
      shown.update(content, run);
    });
  }

  clear(): void {
    this.key = '';
    this.shown = [];
    this.parent.replaceChildren();
  }

  private makeView(run: Run, robot: number, {sensor, content}: Reading): Shown | null {
    const view = content.kind === 'radio' ? this.makeRadio(sensor) : MAKERS[content.kind]?.() as View<Content['kind']>;
    if (!view) return null;
    const element = make('div', 'reading');
    element.dataset.sensor = sensor;
    const title = make('div', 'reading-title', sensor);
    const type = run.world.robots[robot].sensors.find(({name}) => name === sensor)?.parameters.type ?? '';
    if (type !== sensor) title.append(make('span', 'faint', type));
    element.append(title, ...view.elements);
    this.parent.append(element);
    return {content: null, update: (now, of) => view.update(now as never, of)};
  }

  private makeRadio(sensor: string): View<Content['kind']> {
    const list = make('div', 'reading-list');
    return {
      elements: [list],
      update: (_, run) => setLines(list, this.heard.get(sensor)?.lines(run) ?? [], 'no messages yet'),
    };
  }
}
