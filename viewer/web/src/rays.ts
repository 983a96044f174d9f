// The readings of ray sensors in the scene: the fans of rangers, and the break beams of grippers.
import {Color, DoubleSide, Group, LineBasicMaterial, MeshBasicMaterial, PointsMaterial} from 'three';
import type {Bodies} from './bodies';
import {compose} from './pose';
import type {ContentOf, Pose, Scan} from './protocol';
import type {Run} from './run';
import {Stream} from './stream';

export function planesOf(scan: Scan): number {
  return Math.max(1, scan.elevations.length);
}

// Of each plane.
export function raysOf(scan: Scan): number {
  return scan.ranges.length / planesOf(scan);
}

// `ray`: of a plane.
export function bearing(scan: Scan, ray: number): number {
  const last = raysOf(scan) - 1;
  return last < 1 ? 0 : scan.fov * ((2 * ray - last) / (2 * last));
}

// The plane nearest to the horizontal.
export function flattestPlane(scan: Scan): number {
  let flattest = 0;
  scan.elevations.forEach((elevation, plane) => {
    if (Math.abs(elevation) < Math.abs(scan.elevations[flattest])) flattest = plane;
  });
  return flattest;
}

export class Rays {
  readonly group = new Group();
  private readonly areaMaterial = new MeshBasicMaterial({
    transparent: true, opacity: 0.13, side: DoubleSide, depthWrite: false,
  });
  private readonly edgeMaterial = new LineBasicMaterial({transparent: true, opacity: 0.5, depthWrite: false});
  private readonly hitMaterial = new PointsMaterial({size: 3, sizeAttenuation: false});
  private readonly area = Stream.triangles(this.areaMaterial);
  private readonly edges = Stream.lines(this.edgeMaterial);
  private readonly hits = Stream.points(this.hitMaterial);
  private readonly beams = Stream.lines(new LineBasicMaterial({color: 0x2e9e5b}));
  private readonly broken = Stream.lines(new LineBasicMaterial({color: 0xd64545}));
  private readonly streams = [this.area, this.edges, this.hits, this.beams, this.broken];

  constructor() {
    this.group.add(...this.streams.map(stream => stream.object));
  }

  setColor(color: Color): void {
    for (const material of [this.areaMaterial, this.edgeMaterial, this.hitMaterial]) material.color = color;
  }

  show(run: Run, bodies: Bodies): void {
    for (const stream of this.streams) stream.begin();
    // The more fans, the fainter.
    this.areaMaterial.opacity = Math.max(0.03, 0.15 / Math.sqrt(Math.max(1, run.readings.size)));
    this.edgeMaterial.opacity = 3 * this.areaMaterial.opacity;
    for (const {robot, readings} of run.readings.values()) {
      const row = run.robots[robot];
      if (!row) continue;
      for (const {content} of readings) {
        if (content.kind === 'ranger') {
          for (const scan of content.scans) this.addScan(scan, compose(row.pose, scan.pose));
        } else if (content.kind === 'beams') {
          this.addBeams(content, bodies.poseOfModel(content.gripperModel, run));
        }
      }
    }
    for (const stream of this.streams) stream.end();
  }

  private addBeams(content: ContentOf<'beams'>, gripper: Pose | null): void {
    if (!gripper) return;
    for (const beam of content.beams) {
      const stream = beam.brokenBy >= 0 ? this.broken : this.beams;
      for (const [x, y] of [beam.from, beam.to]) {
        const p = compose(gripper, {x, y, z: beam.z, heading: 0});
        stream.push(p.x, p.y, p.z);
      }
    }
  }

  // Of several planes all hits, and the field of the flattest one: fields above each other would hide everything.
  private addScan(scan: Scan, sensor: Pose): void {
    const flattest = flattestPlane(scan);
    for (let plane = 0; plane < planesOf(scan); ++plane) {
      if (plane === flattest) this.addField(scan, plane, sensor);
      this.addHits(scan, plane, sensor);
    }
  }

  private addHits(scan: Scan, plane: number, sensor: Pose): void {
    const count = raysOf(scan);
    const elevation = scan.elevations[plane] ?? 0;
    const level = Math.cos(elevation);
    const rise = Math.sin(elevation);
    for (let i = 0; i < count; ++i) {
      const range = scan.ranges[plane * count + i];
      if (range >= scan.max) continue;
      const heading = sensor.heading + bearing(scan, i);
      this.hits.push(
        sensor.x + range * level * Math.cos(heading), sensor.y + range * level * Math.sin(heading), sensor.z + range * rise);
    }
  }

  private addField(scan: Scan, plane: number, sensor: Pose): void {
    const count = raysOf(scan);
    const elevation = scan.elevations[plane] ?? 0;
    const level = Math.cos(elevation);
    const rise = Math.sin(elevation);
    const at = (angle: number, range: number): [number, number, number] => [
      sensor.x + range * level * Math.cos(sensor.heading + angle),
      sensor.y + range * level * Math.sin(sensor.heading + angle), sensor.z + range * rise,
    ];
    const outline: Array<[number, number, number]> = [];
    for (let i = 0; i < count && count > 1; ++i) outline.push(at(bearing(scan, i), scan.ranges[plane * count + i]));
    if (count === 1) {
      // A single ray is a slim cone, because a line is hard to see.
      const half = Math.min(0.5 * scan.fov, 0.05);
      for (const side of [-1, 0, 1]) outline.push(at(side * half, scan.ranges[plane]));
    }
    for (let i = 0; i + 1 < outline.length; ++i) {
      this.area.push(sensor.x, sensor.y, sensor.z);
      this.area.push(...outline[i]);
      this.area.push(...outline[i + 1]);
      this.edges.push(...outline[i]);
      this.edges.push(...outline[i + 1]);
    }
    for (const end of [outline[0], outline[outline.length - 1]]) {
      this.edges.push(sensor.x, sensor.y, sensor.z);
      this.edges.push(...end);
    }
  }
}
