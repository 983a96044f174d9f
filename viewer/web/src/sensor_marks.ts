// The readings of sensors without rays in the scene: lines to recognized models and to the senders of radio messages,
// bumpers, contacts, and the fields of cameras.
import {DoubleSide, Group, LineBasicMaterial, MeshBasicMaterial, PointsMaterial} from 'three';
import {compose} from './pose';
import type {BumperSegment, CameraContent, Content, Pose} from './protocol';
import type {Run} from './run';
import {Stream} from './stream';

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
      case 'fiducials': {
        const sensor = compose(robot, content.pose);
        for (const {pose} of content.fiducials) this.addLine(this.fiducials, sensor, {...pose, z: sensor.z});
        break;
      }
      case 'bumper':
        for (const segment of content.segments) this.addSegment(segment, compose(robot, segment.pose), content.height);
        break;
      case 'contacts':
        for (const {x, y, bottom, top} of content.contacts) this.contacts.push(x, y, 0.5 * (bottom + top));
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
  private addField(camera: CameraContent, sensor: Pose): void {
    const depth = Math.min(FIELD, camera.max);
    const corner = (column: number, row: number): [number, number, number] => {
      const p = compose(sensor, {
        x: depth, y: (depth * (camera.centerX - column)) / camera.focalX,
        z: (depth * (camera.centerY - row)) / camera.focalY, heading: 0,
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
