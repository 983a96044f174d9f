// An animated picture as a GIF file, from frames of red, green, blue and alpha. Format: GIF89a, with the extension
// NETSCAPE2.0 for the repetition; the codes are those of LZW as its appendix F has them.
//
// Colours are those that the first frame has most, of 32 shades of each of red, green and blue: pictures of a scene have few.
// A pixel that is as in the frame before is transparent, so that frames in which little moves take little.

const COLORS = 256;
const TRANSPARENT = COLORS - 1;
const CODE_BITS = 8;
const MOST_CODES = 4096;

const shadeOf = (frame: Uint8ClampedArray, at: number): number =>
  ((frame[at] >> 3) << 10) | ((frame[at + 1] >> 3) << 5) | (frame[at + 2] >> 3);

export class GifFile {
  private readonly parts: Uint8Array[] = [];
  private readonly palette: number[] = [];  // shades
  private readonly nearest = new Int16Array(1 << 15).fill(-1);  // by shade, the index of its colour
  private before: Uint8Array | null = null;  // indices

  constructor(private readonly width: number, private readonly height: number) {}

  // `duration`: s.
  add(frame: Uint8ClampedArray, duration: number): void {
    if (!this.before) this.begin(frame);
    const indices = new Uint8Array(this.width * this.height);
    for (let i = 0; i < indices.length; ++i) indices[i] = this.colorOf(shadeOf(frame, 4 * i));
    const before = this.before;
    const shown = before ? indices.map((index, i) => (index === before[i] ? TRANSPARENT : index)) : indices;
    this.before = indices;
    const hundredths = Math.round(100 * duration);
    this.parts.push(
      bytes(0x21, 0xf9, 4, 0b0101, ...word(hundredths), TRANSPARENT, 0),  // stays, with a transparent colour
      bytes(0x2c, ...word(0), ...word(0), ...word(this.width), ...word(this.height), 0, CODE_BITS), ...blocks(compress(shown)), bytes(0));
  }

  finish(): Blob {
    return new Blob([...this.parts, bytes(0x3b)], {type: 'image/gif'});
  }

  private begin(frame: Uint8ClampedArray): void {
    const counts = new Uint32Array(1 << 15);
    for (let at = 0; at < frame.length; at += 4) ++counts[shadeOf(frame, at)];
    const shades = [...counts.keys()].filter(shade => counts[shade] > 0).sort((a, b) => counts[b] - counts[a]);
    this.palette.push(...shades.slice(0, TRANSPARENT));
    const table = new Uint8Array(3 * COLORS);
    this.palette.forEach((shade, i) => table.set([shade >> 10, (shade >> 5) & 31, shade & 31].map(part => Math.round((part * 255) / 31)), 3 * i));
    this.parts.push(
      new TextEncoder().encode('GIF89a'), bytes(...word(this.width), ...word(this.height), 0b11110111, 0, 0), table,
      bytes(0x21, 0xff, 11), new TextEncoder().encode('NETSCAPE2.0'), bytes(3, 1, 0, 0, 0));  // for ever
  }

  private colorOf(shade: number): number {
    if (this.nearest[shade] >= 0) return this.nearest[shade];
    let best = 0;
    let least = Infinity;
    this.palette.forEach((known, i) => {
      const [r, g, b] = [(known >> 10) - (shade >> 10), ((known >> 5) & 31) - ((shade >> 5) & 31), (known & 31) - (shade & 31)];
      const distance = r * r + g * g + b * b;
      if (distance < least) [best, least] = [i, distance];
    });
    return this.nearest[shade] = best;
  }
}

const bytes = (...values: number[]): Uint8Array => Uint8Array.from(values);
const word = (value: number): [number, number] => [value & 255, value >> 8];

// Codes of growing length, the lowest bit first.
function compress(indices: Uint8Array): Uint8Array {
  const clear = 1 << CODE_BITS;
  const end = clear + 1;
  const out: number[] = [];
  let pending = 0;
  let count = 0;
  let size = CODE_BITS + 1;
  const write = (code: number): void => {
    pending |= code << count;
    count += size;
    for (; count >= 8; count -= 8, pending >>>= 8) out.push(pending & 255);
  };
  let known = new Map<number, number>();  // by the code of a string and the index behind it
  let next = end + 1;
  write(clear);
  let code = indices[0];
  for (let i = 1; i < indices.length; ++i) {
    const key = (code << 8) | indices[i];
    const longer = known.get(key);
    if (longer !== undefined) {
      code = longer;
      continue;
    }
    write(code);
    code = indices[i];
    if (next < MOST_CODES) {
      if (next === 1 << size) ++size;
      known.set(key, next++);
    } else {
      write(clear);
      known = new Map();
      next = end + 1;
      size = CODE_BITS + 1;
    }
  }
  write(code);
  write(end);
  if (count > 0) out.push(pending & 255);
  return Uint8Array.from(out);
}

// Of at most 255 bytes, each behind its length.
function blocks(data: Uint8Array): Uint8Array[] {
  const result: Uint8Array[] = [];
  for (let at = 0; at < data.length; at += 255) {
    const part = data.subarray(at, at + 255);
    result.push(bytes(part.length), part);
  }
  return result;
}
