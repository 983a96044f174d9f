// The ranges of a robot's rangers around it, ahead upwards.
import {compose} from './pose';
import {scansOf, type Reading} from './protocol';
import {bearing, flattestPlane, raysOf} from './rays';

function color(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export function drawPolarPlot(canvas: HTMLCanvasElement, readings: Reading[]): void {
  const ratio = Math.min(window.devicePixelRatio, 2);
  const size = canvas.clientWidth;
  if (size === 0) return;
  if (canvas.width !== Math.round(size * ratio)) canvas.width = canvas.height = Math.round(size * ratio);
  const context = canvas.getContext('2d')!;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, size, size);
  const scans = readings.flatMap(scansOf);
  const reach = Math.max(0.1, ...scans.map(scan => scan.max + Math.hypot(scan.pose.x, scan.pose.y)));
  const center = size / 2;
  const scale = (center - 12) / reach;
  const at = (x: number, y: number): [number, number] => [center - y * scale, center - x * scale];

  context.strokeStyle = color('--line');
  context.fillStyle = color('--faint');
  context.font = '10px system-ui, sans-serif';
  context.lineWidth = 1;
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find(s => reach / s <= 5) ?? 100;
  for (let r = step; r <= reach * 1.001; r += step) {
    context.beginPath();
    context.arc(center, center, r * scale, 0, 2 * Math.PI);
    context.stroke();
    context.fillText(`${Number(r.toFixed(2))} m`, center + 3, center - r * scale + 11);
  }
  context.beginPath();
  context.moveTo(center, 4);
  context.lineTo(center, size - 4);
  context.moveTo(4, center);
  context.lineTo(size - 4, center);
  context.stroke();

  const line = color('--rays');
  for (const scan of scans) {
    const outline: Array<[number, number]> = [at(scan.pose.x, scan.pose.y)];
    const hits: Array<[number, number]> = [];
    const count = raysOf(scan);
    const plane = flattestPlane(scan);
    const level = Math.cos(scan.elevations[plane] ?? 0);
    scan.ranges.subarray(plane * count, (plane + 1) * count).forEach((range, i) => {
      const spread = count > 1 ? [0] : [-0.04, 0, 0.04];
      for (const side of spread) {
        const p = compose(
          {...scan.pose, heading: scan.pose.heading + bearing(scan, i) + side}, {x: range * level, y: 0, z: 0, heading: 0});
        outline.push(at(p.x, p.y));
        if (side === 0 && range < scan.max) hits.push(at(p.x, p.y));
      }
    });
    context.beginPath();
    outline.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    context.closePath();
    context.globalAlpha = 0.16;
    context.fillStyle = line;
    context.fill();
    context.globalAlpha = 0.9;
    for (const [x, y] of hits) context.fillRect(x - 1, y - 1, 2, 2);
    context.globalAlpha = 1;
  }
  context.fillStyle = color('--text');
  context.beginPath();
  context.moveTo(...at(9 / scale, 0));
  context.lineTo(...at(-6 / scale, 5 / scale));
  context.lineTo(...at(-6 / scale, -5 / scale));
  context.fill();
}
