// The readings in the scene: the fans of rangers, and the break beams of grippers.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Group, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, Points, PointsMaterial,
} from 'three';
import type {Bodies} from './bodies';
import {compose} from './pose';
import type {Scan} from './protocol';
import type {Run} from './run';

// A buffer that is filled anew for each picture and grows when it has to.
class Stream {
  private values = new Float32Array(3000);
  private length = 0;

  constructor(private readonly geometry: BufferGeometry) {
    this.attach();
  }

  begin(): void {
    this.length = 0;
  }
  push(x: number, y: number, z: number): void {
    if (this.length + 3 > this.values.length) {
      const grown = new Float32Array(2 * this.values.length);
      grown.set(this.values);
      this.values = grown;
      this.attach();
    }
    this.values[this.length++] = x;
    this.values[this.length++] = y;
    this.values[this.length++] = z;
  }
  end(): void {
    this.geometry.setDrawRange(0, this.length / 3);
    this.geometry.getAttribute('position').needsUpdate = true;
  }

  private attach(): void {
    this.geometry.dispose();
    this.geometry.setAttribute('position', new BufferAttribute(this.values, 3).setUsage(DynamicDrawUsage));
  }
}

export function bearing(scan: Scan, ray: number): number {
  const last = scan.ranges.length - 1;
  return last < 1 ? 0 : scan.fov * ((2 * ray - last) / (2 * last));
}

export class Rays {
  readonly group = new Group();
  private readonly areaMaterial = new MeshBasicMaterial({
    transparent: true, opacity: 0.13, side: DoubleSide, depthWrite: false,
  });
  private readonly edgeMaterial = new LineBasicMaterial({transparent: true, opacity: 0.5, depthWrite: false});
  private readonly hitMaterial = new PointsMaterial({size: 3, sizeAttenuation: false});
  private readonly beamMaterial = new LineBasicMaterial({color: 0x2e9e5b});
  private readonly brokenMaterial = new LineBasicMaterial({color: 0xd64545});
  private readonly area = new Stream(this.add(geometry => new Mesh(geometry, this.areaMaterial)));
  private readonly edges = new Stream(this.add(geometry => new LineSegments(geometry, this.edgeMaterial)));
  private readonly hits = new Stream(this.add(geometry => new Points(geometry, this.hitMaterial)));
  private readonly beams = new Stream(this.add(geometry => new LineSegments(geometry, this.beamMaterial)));
  private readonly broken = new Stream(this.add(geometry => new LineSegments(geometry, this.brokenMaterial)));

  setColor(color: Color): void {
    for (const material of [this.areaMaterial, this.edgeMaterial, this.hitMaterial]) material.color = color;
  }

  show(run: Run, bodies: Bodies): void {
    const streams = [this.area, this.edges, this.hits, this.beams, this.broken];
    for (const stream of streams) stream.begin();
    // The more fans, the fainter.
    this.areaMaterial.opacity = Math.max(0.03, 0.15 / Math.sqrt(Math.max(1, run.readings.size)));
    this.edgeMaterial.opacity = 3 * this.areaMaterial.opacity;
    for (const {robot, readings} of run.readings.values()) {
      const row = run.robots[robot];
      if (!row) continue;
      for (const reading of readings) {
        for (const scan of reading.scans) this.addScan(scan, compose(row.pose, scan.pose));
        const gripper = reading.gripperModel >= 0 ? bodies.poseOfModel(reading.gripperModel, run) : null;
        if (!gripper) continue;
        for (const beam of reading.beams) {
          const stream = beam.broken ? this.broken : this.beams;
          for (const [x, y] of [beam.from, beam.to]) {
            const p = compose(gripper, {x, y, z: beam.z, heading: 0});
            stream.push(p.x, p.y, p.z);
          }
        }
      }
    }
    for (const stream of streams) stream.end();
  }

  private addScan(scan: Scan, sensor: {x: number; y: number; z: number; heading: number}): void {
    const count = scan.ranges.length;
    const at = (angle: number, range: number): [number, number] => [
      sensor.x + range * Math.cos(sensor.heading + angle), sensor.y + range * Math.sin(sensor.heading + angle),
    ];
    const outline: Array<[number, number]> = [];
    for (let i = 0; i < count; ++i) {
      const [x, y] = at(bearing(scan, i), scan.ranges[i]);
      if (count > 1) outline.push([x, y]);
      if (scan.ranges[i] < scan.max) this.hits.push(x, y, sensor.z);
    }
    if (count === 1) {
      // A single ray is a slim cone, because a line is hard to see.
      const half = Math.min(0.5 * scan.fov, 0.05);
      for (const side of [-1, 0, 1]) outline.push(at(side * half, scan.ranges[0]));
    }
    for (let i = 0; i + 1 < outline.length; ++i) {
      this.area.push(sensor.x, sensor.y, sensor.z);
      this.area.push(...outline[i], sensor.z);
      this.area.push(...outline[i + 1], sensor.z);
      this.edges.push(...outline[i], sensor.z);
      this.edges.push(...outline[i + 1], sensor.z);
    }
    for (const end of [outline[0], outline[outline.length - 1]]) {
      this.edges.push(sensor.x, sensor.y, sensor.z);
      this.edges.push(...end, sensor.z);
    }
  }

  private add(make: (geometry: BufferGeometry) => Mesh | LineSegments | Points): BufferGeometry {
    const geometry = new BufferGeometry();
    const object = make(geometry);
    object.frustumCulled = false;
    object.renderOrder = 1;
    this.group.add(object);
    return geometry;
  }
}
