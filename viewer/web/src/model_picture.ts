// A small picture of a model, drawn from behind and above: its blocks from the lowest and farthest on.
// The painter's algorithm on a flat canvas: a list of models would need as many WebGL contexts, of which browsers allow
// few.
import type {PictureBlock} from './file_client';

export function drawPicture(canvas: HTMLCanvasElement, blocks: PictureBlock[]): void {
  const context = canvas.getContext('2d');
  if (!context || blocks.length === 0) return;
  const project = (x: number, y: number, z: number): [number, number] => [0.87 * (x - y), 0.5 * (x + y) + 0.9 * z];
  let [minX, maxX, minY, maxY] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const {outline, z} of blocks) {
    for (const [x, y] of outline) {
      for (const height of z) {
        const [u, v] = project(x, y, height);
        minX = Math.min(minX, u);
        maxX = Math.max(maxX, u);
        minY = Math.min(minY, v);
        maxY = Math.max(maxY, v);
      }
    }
  }
  const scale = 0.88 * Math.min(canvas.width / Math.max(maxX - minX, 1e-3), canvas.height / Math.max(maxY - minY, 1e-3));
  const at = (x: number, y: number, z: number): [number, number] => {
    const [u, v] = project(x, y, z);
    return [
      canvas.width / 2 + scale * (u - (minX + maxX) / 2), canvas.height / 2 - scale * (v - (minY + maxY) / 2),
    ];
  };
  const far = (block: PictureBlock): number =>
    block.z[0] * 1000 - block.outline.reduce((sum, [x, y]) => sum + x + y, 0) / block.outline.length;
  for (const block of [...blocks].sort((a, b) => far(a) - far(b))) {
    const {outline, z, color = [0.6, 0.6, 0.6]} = block;
    const shade = (factor: number): string => `rgb(${color.map(c => Math.round(255 * Math.min(1, c * factor + 0.06))).join(',')})`;
    const face = (points: Array<[number, number]>, fill: string): void => {
      context.fillStyle = fill;
      context.beginPath();
      points.forEach(([u, v], i) => (i === 0 ? context.moveTo(u, v) : context.lineTo(u, v)));
      context.closePath();
      context.fill();
      context.strokeStyle = 'rgba(0,0,0,0.25)';
      context.lineWidth = 0.5;
      context.stroke();
    };
    const sides = outline.map((a, i) => [a, outline[(i + 1) % outline.length]] as const);
    sides.sort(([a, b], [c, d]) => (c[0] + c[1] + d[0] + d[1]) - (a[0] + a[1] + b[0] + b[1]));
    for (const [a, b] of sides) {
      face([at(a[0], a[1], z[0]), at(b[0], b[1], z[0]), at(b[0], b[1], z[1]), at(a[0], a[1], z[1])],
           shade(Math.abs(a[0] - b[0]) > Math.abs(a[1] - b[1]) ? 0.8 : 0.65));
    }
    face(outline.map(([x, y]) => at(x, y, z[1])), shade(1));
  }
}
