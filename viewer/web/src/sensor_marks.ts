// The readings of sensors without rays in the scene: lines to recognized models and to the senders of radio messages,
// bumpers, contacts, and the fields of cameras.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Group, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, Points, PointsMaterial, type Material, type Object3D
} from 'three';
import type {Bodies} from './bodies';
import type {Content} from '../generated/rows';
import {scansOf, type BumperSegment, type ContentOf, type Pose, type Scan} from './protocol';
import {compose, type Run} from './run';

// Stream: points, lines or triangles of the scene that are filled for each picture.

// Its buffer grows when it has to. Without points it is neither sent nor drawn.
export class Stream {
  readonly object: Object3D;
  private readonly geometry = new BufferGeometry();
  private values = new Float32Array(3000);
  private length = 0;

  private constructor(make: (geometry: BufferGeometry) => Object3D) {
    this.attach();
    this.object = make(this.geometry);
    this.object.frustumCulled = false;
    this.object.renderOrder = 1;
    this.object.visible = false;
  }

  static triangles(material: MeshBasicMaterial): Stream {
    return new Stream(geometry => new Mesh<BufferGeometry, Material>(geometry, material));
  }
  static lines(material: LineBasicMaterial): Stream {
    return new Stream(geometry => new LineSegments(geometry, material));
  }
  static points(material: PointsMaterial): Stream {
    return new Stream(geometry => new Points(geometry, material));
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
    this.object.visible = this.length > 0;
    if (!this.object.visible) return;
    this.geometry.setDrawRange(0, this.length / 3);
    const positions = this.geometry.getAttribute('position') as BufferAttribute;
    positions.clearUpdateRanges();
    positions.addUpdateRange(0, this.length);
    positions.needsUpdate = true;
  }

  private attach(): void {
    this.geometry.dispose();
    this.geometry.setAttribute('position', new BufferAttribute(this.values, 3).setUsage(DynamicDrawUsage));
  }
}

const FIELD = 1.5;  // m: the drawn length of a camera's field, at the most
const RED = 0xd6332f;

export class SensorMarks {
  readonly group = new Group();
  private readonly fiducials = Stream.lines(new LineBasicMaterial({color: 0x9a4fd0}));
  private readonly messages = Stream.lines(new LineBasicMaterial({color: 0x0f9d9d}));
  private readonly segments = Stream.lines(new LineBasicMaterial({color: 0x8a93a0}));
  private readonly pressed = Stream.triangles(new MeshBasicMaterial({color: RED, side: DoubleSide}));
  // Bodies do not hide them: they are inside the robot or the other body.
  private readonly contacts = Stream.points(
    new PointsMaterial({color: RED, size: 9, sizeAttenuation: false, depthTest: false}));
  private readonly fields = Stream.triangles(new MeshBasicMaterial({
    color: 0xd99a20, transparent: true, opacity: 0.1, side: DoubleSide, depthWrite: false,
  }));
  private readonly fieldEdges = Stream.lines(new LineBasicMaterial({color: 0xd99a20}));
  private readonly streams = [
    this.fiducials, this.messages, this.segments, this.pressed, this.contacts, this.fields, this.fieldEdges,
  ];

  constructor() {
    this.group.add(...this.streams.map(stream => stream.object));
  }

  show(run: Run): void {
    for (const stream of this.streams) stream.begin();
    for (const {robot, readings} of run.readings.values()) {
      const row = run.robots[robot];
      if (!row) continue;
      for (const {content} of readings) this.addContent(run, row.pose, content);
    }
    for (const stream of this.streams) stream.end();
  }

  private addContent(run: Run, robot: Pose, content: Content): void {
    switch (content.kind) {
      case 'fiducial': {
        const sensor = compose(robot, content.pose);
        for (const {pose} of content.fiducials) this.addLine(this.fiducials, sensor, {...pose, z: sensor.z});
        break;
      }
      case 'bumper':
        for (const segment of content.segments) this.addSegment(segment, compose(robot, segment.pose), content.height);
        break;
      case 'contact':
        for (const {point, zMin, zMax} of content.contacts) this.contacts.push(point.x, point.y, 0.5 * (zMin + zMax));
        break;
      case 'camera':
        this.addField(content, compose(robot, content.pose));
        break;
      case 'radio': {
        const antenna = compose(robot, content.pose);
        for (const {from} of content.receptions) {
          const sender = run.robots[from];
          if (sender) this.addLine(this.messages, antenna, {...sender.pose, z: antenna.z});
        }
        break;
      }
      default:
        break;
    }
  }

  private addLine(stream: Stream, from: Pose, to: Pose): void {
    stream.push(from.x, from.y, from.z);
    stream.push(to.x, to.y, to.z);
  }

  // A pressed one stands out from the robot a little, else the robot's side would hide it.
  private addSegment(segment: BumperSegment, middle: Pose, height: number): void {
    const out = segment.pressedBy >= 0 ? 0.01 : 0.003;
    const ends = [-0.5, 0.5].map(share => compose(middle, {x: out, y: share * segment.length, z: 0, heading: 0}));
    const [a, b] = ends;
    if (segment.pressedBy < 0) {
      for (const z of [a.z, a.z + height]) this.addLine(this.segments, {...a, z}, {...b, z});
      return;
    }
    // With an upper side, for the view from above.
    const inner = [-0.5, 0.5].map(share => compose(middle, {x: -0.03, y: share * segment.length, z: 0, heading: 0}));
    const top = a.z + height;
    this.addQuad(this.pressed, [[a.x, a.y, a.z], [b.x, b.y, b.z], [b.x, b.y, top], [a.x, a.y, top]]);
    this.addQuad(this.pressed, [[a.x, a.y, top], [b.x, b.y, top], [inner[1].x, inner[1].y, top], [inner[0].x, inner[0].y, top]]);
  }

  // A pyramid, whose base is the image on a vertical plane ahead.
  private addField(camera: ContentOf<'camera'>, sensor: Pose): void {
    const depth = Math.min(FIELD, camera.limits.max);
    const corner = (column: number, row: number): [number, number, number] => {
      const p = compose(sensor, {
        x: depth, y: (depth * (camera.centerX - column)) / camera.focalLengthX,
        z: (depth * (camera.centerY - row)) / camera.focalLengthY, heading: 0,
      });
      return [p.x, p.y, p.z];
    };
    const corners = [corner(0, 0), corner(camera.width, 0), corner(camera.width, camera.height), corner(0, camera.height)];
    corners.forEach((from, i) => {
      const to = corners[(i + 1) % 4];
      this.fields.push(sensor.x, sensor.y, sensor.z);
      this.fields.push(...from);
      this.fields.push(...to);
      this.fieldEdges.push(...from);
      this.fieldEdges.push(...to);
      this.fieldEdges.push(sensor.x, sensor.y, sensor.z);
      this.fieldEdges.push(...from);
    });
  }

  private addQuad(stream: Stream, corners: Array<[number, number, number]>): void {
    for (const i of [0, 1, 2, 0, 2, 3]) stream.push(...corners[i]);
  }
}

// The readings of ray sensors in the scene: the fans of rangers, and the break beams of grippers.

export function planesOf(scan: Scan): number {
  return Math.max(1, scan.elevations.length);
}

// The rays of each plane.
export function raysOf(scan: Scan): number {
  return scan.ranges.length / planesOf(scan);
}

// `ray`: of a plane.
export function bearing(scan: Scan, ray: number): number {
  const last = raysOf(scan) - 1;
  return last < 1 ? 0 : scan.fan.fov * ((2 * ray - last) / (2 * last));
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
          for (const scan of scansOf(content)) this.addScan(scan, compose(row.pose, scan.pose));
        } else if (content.kind === 'break_beam') {
          this.addBeams(content, bodies.poseOfModel(content.gripperModel, run));
        }
      }
    }
    for (const stream of this.streams) stream.end();
  }

  private addBeams(content: ContentOf<'break_beam'>, gripper: Pose | null): void {
    if (!gripper) return;
    for (const {beam, brokenBy} of content.beams) {
      const stream = brokenBy >= 0 ? this.broken : this.beams;
      for (const {x, y} of [beam.from, beam.to]) {
        const p = compose(gripper, {x, y, z: beam.z, heading: 0});
        stream.push(p.x, p.y, p.z);
      }
    }
  }

  // Shows all hits of several planes, and the field of the flattest one: fields above each other would hide everything.
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
      if (range >= scan.limits.max) continue;
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
      const half = Math.min(0.5 * scan.fan.fov, 0.05);
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
