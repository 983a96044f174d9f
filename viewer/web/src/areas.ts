// Areas of a scenario on the ground: where models are spawned and people walk, zones and regions. They are drawn by
// dragging, and shown with their names.
import {BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments} from 'three';
import {byId} from './dom';
import type {Point} from './drawing';
import type {FileClient, FileDocument} from './file_client';
import type {WorldScene} from './scene';

interface Kind {
  key: string;  // the list of the scenario
  title: string;
  color: number;
  entry(region: number[], host: AreasHost, number: number): object;
}

export interface AreasHost {
  robots(): string[];  // models of robots
  added(key: string, index: number): void;
}

const KINDS: Kind[] = [
  {key: 'spawn', title: 'robots', color: 0x2b9a5c, entry: (region, host) => ({model: host.robots()[0] ?? 'position', count: 1, region})},
  {key: 'people', title: 'people', color: 0xc2571a, entry: region => ({count: 5, region})},
  {key: 'zones', title: 'keep-out zone', color: 0xc9283c, entry: (region, _, n) => ({name: `zone${n}`, kind: 'keepout', region})},
  {key: 'zones', title: 'speed zone', color: 0xc9283c, entry: (region, _, n) => ({name: `zone${n}`, kind: 'speed', region, speed_limit: 0.3})},
  {key: 'zones', title: 'cleaning zone', color: 0xc9283c, entry: (region, _, n) => ({name: `zone${n}`, kind: 'cleaning', region})},
  {key: 'regions', title: 'region with a name', color: 0x6a4fb3, entry: (region, _, n) => ({name: `region${n}`, region})},
];
const LISTS = [...new Map(KINDS.map(({key, color}) => [key, color]))];
const HEIGHT = 0.02;  // m, above the ground

function cornersOf(region: unknown): Point[] {
  if (!Array.isArray(region)) return [];
  if (region.length === 4 && typeof region[0] === 'number') {
    const [x0, y0, x1, y1] = region as number[];
    return [{x: x0, y: y0}, {x: x1, y: y0}, {x: x1, y: y1}, {x: x0, y: y1}];
  }
  return (region as number[][]).map(([x, y]) => ({x, y}));
}

export class Areas {
  private readonly group = new Group();
  private readonly kind = byId<HTMLSelectElement>('area-kind');
  private members: FileDocument['members'] = {};

  constructor(private readonly scene: WorldScene, private readonly client: FileClient, private readonly host: AreasHost) {
    this.kind.append(...KINDS.map(({title}, i) => new Option(title, String(i))));
    scene.add(this.group);
  }

  // An area from corner to corner, of the kind that is chosen.
  async add(from: Point, to: Point): Promise<void> {
    const round = (value: number): number => Math.round(value * 100) / 100;
    const region = [Math.min(from.x, to.x), Math.min(from.y, to.y), Math.max(from.x, to.x), Math.max(from.y, to.y)].map(round);
    const kind = KINDS[Number(this.kind.value)];
    const index = this.entriesOf(kind.key).length;
    const names = new Set(this.entriesOf(kind.key).map(({name}) => name));
    let number = 1;
    while (names.has((kind.entry(region, this.host, number) as {name?: string}).name ?? '')) ++number;
    const reply = await this.client.edit('set_value', {path: [kind.key, index], value: kind.entry(region, this.host, number)});
    if (reply.done) this.host.added(kind.key, index);
  }

  private entriesOf(key: string): Array<{name?: string; region?: unknown; z?: number}> {
    const entries = this.members[key];
    return Array.isArray(entries) ? entries as Array<{name?: string; region?: unknown}> : [];
  }

  show(members: FileDocument['members']): void {
    this.members = members;
    for (const line of [...this.group.children] as LineSegments[]) {
      this.group.remove(line);
      line.geometry.dispose();
    }
    for (const [key, color] of LISTS) {
      const points = this.entriesOf(key).flatMap(({region, z = 0}) => {
        const corners = cornersOf(region);
        return corners.flatMap((corner, i) => {
          const next = corners[(i + 1) % corners.length];
          return [corner.x, corner.y, z + HEIGHT, next.x, next.y, z + HEIGHT];
        });
      });
      if (points.length === 0) continue;
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
      const lines = new LineSegments(geometry, new LineBasicMaterial({color}));
      lines.frustumCulled = false;
      this.group.add(lines);
    }
    this.scene.invalidate();
  }
}
