// ZoneMarks: the zones of a site as areas on their floors, each in the colour of its kind as in pictures
// (common/picture/zone_areas.cc), with the direction of a one_way zone as an arrow. One that is off is an outline alone.
//
// Made anew for a world and once a zone is switched, not in each tick.
import {
  BufferAttribute, BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineLoop, Mesh, MeshBasicMaterial, ShapeUtils, Vector2
} from 'three';
import type {World} from './protocol';
import type {Run} from './run';

export const ZONE_KINDS = ['keepout', 'speed', 'cleaning', 'one_way', 'release', 'evacuation'];
const COLORS = [0xcc2924, 0xe09414, 0x1a8599, 0x295ccc, 0x853da8];  // by kind
const HEIGHT = 0.015;  // m, above the floor: below the traffic
const ARROW = 0.6;  // m, at most: half the length of an arrow

type Zone = World['zones'][number];

export interface ShownZone {
  name: string;
  kind: string;
  filled: boolean;
}

export class ZoneMarks {
  readonly group = new Group();
  shown: ShownZone[] = [];  // what is drawn
  private world: World | null = null;
  private on = '';  // by zone

  show(run: Run): void {
    const {zones} = run.world;
    const on = zones.map((_, i) => (run.zones[i]?.on ?? true) ? '1' : '0').join('');
    if (run.world === this.world && on === this.on) return;
    this.world = run.world;
    this.on = on;
    this.clear();
    zones.forEach((zone, i) => this.add(zone, on[i] === '1'));
  }

  private clear(): void {
    for (const part of this.group.children) {
      if (!(part instanceof Mesh || part instanceof LineLoop)) continue;
      part.geometry.dispose();
      part.material.dispose();
    }
    this.group.clear();
    this.shown = [];
  }

  private add(zone: Zone, on: boolean): void {
    const color = COLORS[zone.kind] ?? COLORS[0];
    const corners = zone.outline.map(({x, y}) => new Vector2(x, y));
    const places = new Float32Array(corners.flatMap(({x, y}) => [x, y, zone.z + HEIGHT]));
    const filled = on && ZONE_KINDS[zone.kind] !== 'cleaning';
    if (filled) {
      const area = new BufferGeometry();
      area.setAttribute('position', new BufferAttribute(places, 3));
      area.setIndex(ShapeUtils.triangulateShape(corners, []).flat());
      this.addMesh(area, color, 0.18);
    }
    const line = new BufferGeometry();
    line.setAttribute('position', new BufferAttribute(places, 3));
    this.group.add(new LineLoop(line, new LineBasicMaterial({color, transparent: true, opacity: on ? 0.9 : 0.35})));
    if (ZONE_KINDS[zone.kind] === 'one_way') this.addArrow(zone, corners, color);
    this.shown.push({name: zone.name, kind: ZONE_KINDS[zone.kind], filled});
  }

  // From the middle of the corners, along the heading.
  private addArrow(zone: Zone, corners: Vector2[], color: number): void {
    const middle = corners.reduce((sum, corner) => sum.add(corner), new Vector2()).divideScalar(corners.length);
    const reach = Math.min(ARROW, ...corners.map(corner => 0.7 * corner.distanceTo(middle)));
    const [c, s] = [Math.cos(zone.heading), Math.sin(zone.heading)];
    // Along and beside the heading: a shaft of two triangles, and a head.
    const outline = [[-1, 0.12], [-1, -0.12], [0.2, 0.12], [0.2, 0.12], [-1, -0.12], [0.2, -0.12], [0.2, 0.45], [0.2, -0.45], [1, 0]];
    const arrow = new BufferGeometry();
    arrow.setAttribute('position', new BufferAttribute(new Float32Array(outline.flatMap(([a, b]) =>
      [middle.x + reach * (a * c - b * s), middle.y + reach * (a * s + b * c), zone.z + 2 * HEIGHT])), 3));
    this.addMesh(arrow, color, 0.8);
  }

  private addMesh(geometry: BufferGeometry, color: number, opacity: number): void {
    this.group.add(new Mesh(geometry, new MeshBasicMaterial({color, transparent: true, opacity, depthWrite: false, side: DoubleSide})));
  }
}
