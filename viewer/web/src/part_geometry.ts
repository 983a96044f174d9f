// The geometry of the parts of a model, and the handles by which the mouse changes them. Metres and radians, in the
// frame of the model.
//
// Pure functions: a handle's drag maps a point of the view to a PartShape, the members of a request. The page shows the
// part as `reshaped` would leave it, and the gateway decides. Values snap to a centimetre and to five degrees, with
// which files remain readable.
import type {ModelPart} from './file_client';
import type {Point2} from './sheet';

export type View = 'top' | 'side';
export type Pose4 = [number, number, number, number];  // x, y, z, heading
export type Size = [number, number, number];

// What a drag changes of a part: the "shape" of a request.
export interface PartShape {
  pose?: Pose4;
  size?: Size;
  paddle?: Size;
  axis?: Size;
  limits?: Point2;
}

// A part that is a model, with its place in the tree of parts.
export interface PlacedPart {
  path: number[];
  part: ModelPart;
  pose: Pose4;
  body: Pose4;  // of the middle of its body's underside
  size: Size;
}

export interface Handle {
  view: View;
  at: Point2;
  kind: 'round' | 'square' | 'arrow';
  // The change by a drag to a point of the view.
  drag(to: Point2): PartShape;
}

const GRID = 0.01;  // m
const TURN = Math.PI / 36;  // of a heading
const LEAST = 0.01;  // m, of a length
const ARROW = 0.3;  // of a direction: parts of its length that are seen at least

export const snapTo = (value: number, grid = GRID): number => Math.round(Math.round(value / grid) * grid * 1e6) / 1e6;
const atLeast = (value: number): number => Math.max(LEAST, snapTo(value));

export function toModel([x, y, , heading]: Pose4, [u, v]: Point2): Point2 {
  return [x + Math.cos(heading) * u - Math.sin(heading) * v, y + Math.sin(heading) * u + Math.cos(heading) * v];
}

export function toFrame([x, y, , heading]: Pose4, [a, b]: Point2): Point2 {
  const [dx, dy] = [a - x, b - y];
  return [Math.cos(heading) * dx + Math.sin(heading) * dy, -Math.sin(heading) * dx + Math.cos(heading) * dy];
}

export function pathKey(path: number[]): string {
  return path.join('.');
}

// The parts of a model with a place, from the outermost to the innermost.
export function placedParts(parts: ModelPart[], path: number[] = []): PlacedPart[] {
  return parts.flatMap(part => {
    const own = [...path, part.index];
    const inner = placedParts(part.parts ?? [], own);
    if (!part.pose || !part.body || !part.size) return inner;
    return [{path: own, part, pose: part.pose, body: part.body, size: part.size}, ...inner];
  });
}

export function isBelow(inner: number[], outer: number[]): boolean {
  return inner.length > outer.length && outer.every((index, i) => inner[i] === index);
}

function moved(body: Pose4, from: Pose4, to: Pose4): Pose4 {
  const [x, y] = toModel(to, toFrame(from, [body[0], body[1]]));
  return [x, y, body[2] + to[2] - from[2], body[3] + to[3] - from[3]];
}

// The part as a drag would leave it.
export function reshaped(placed: PlacedPart, shape: PartShape): PlacedPart {
  const pose = shape.pose ?? placed.pose;
  const {part} = placed;
  const joint = part.joint && {
    ...part.joint, axis: shape.axis ?? part.joint.axis, limits: shape.limits ?? part.joint.limits,
  };
  const gripper = part.gripper && {...part.gripper, paddle: shape.paddle ?? part.gripper.paddle};
  return {
    ...placed, pose, body: moved(placed.body, placed.pose, pose), size: shape.size ?? placed.size,
    part: {...part, joint, gripper},
  };
}

function rectangle(body: Pose4, u0: number, v0: number, u1: number, v1: number): Point2[] {
  return ([[u0, v0], [u1, v0], [u1, v1], [u0, v1]] as Point2[]).map(corner => toModel(body, corner));
}

export interface Body {
  outline: Point2[];
  z: Point2;
}

// The bodies of a part as drawn. `from`: the part as it is in the file.
export function bodiesOf(now: PlacedPart, from: PlacedPart): Body[] {
  const {size: [x, y, z], body, part} = now;
  if (part.is_box) return [{outline: rectangle(body, -x / 2, -y / 2, x / 2, y / 2), z: [body[2], body[2] + z]}];
  const paddle = part.gripper?.paddle;
  if (paddle) {
    const [length, thickness, height] = paddle;
    const front = x / 2 - length;
    const paddleBody = (v0: number, v1: number): Body =>
      ({outline: rectangle(body, front, v0, x / 2, v1), z: [body[2], body[2] + height]});
    const back = {outline: rectangle(body, -x / 2, -y / 2, front, y / 2), z: [body[2], body[2] + z] as Point2};
    return [back, paddleBody(y / 2 - thickness, y / 2), paddleBody(-y / 2, -y / 2 + thickness)];
  }
  return (part.bodies ?? []).map(({outline, z: heights}) => movedBody({outline, z: heights}, from.pose, now.pose));
}

export function movedBody({outline, z}: Body, from: Pose4, to: Pose4): Body {
  const up = to[2] - from[2];
  return {outline: outline.map(corner => toModel(to, toFrame(from, corner))), z: [z[0] + up, z[1] + up]};
}

export function spanOf(body: Body, view: View): {a: Point2; b: Point2} {
  const xs = body.outline.map(([x]) => x);
  const ys = body.outline.map(([, y]) => y);
  return {a: [Math.min(...xs), Math.max(...xs)], b: view === 'top' ? [Math.min(...ys), Math.max(...ys)] : body.z};
}

export function isInside([x, y]: Point2, outline: Point2[]): boolean {
  let inside = false;
  outline.forEach(([x1, y1], i) => {
    const [x2, y2] = outline[(i + 1) % outline.length];
    if ((y1 > y) !== (y2 > y) && x < x1 + ((y - y1) / (y2 - y1)) * (x2 - x1)) inside = !inside;
  });
  return inside;
}

export function areaOf(outline: Point2[]): number {
  return Math.abs(outline.reduce((sum, [x, y], i) => {
    const [x2, y2] = outline[(i + 1) % outline.length];
    return sum + x * y2 - x2 * y;
  }, 0)) / 2;
}

// The line of a linear joint: the way of the foremost point of its body, at the middle of the body.
export interface TravelLine {
  from: Point2;
  to: Point2;
  along: Point2;  // of the axis, in the view
}

function middleOf(bodies: Body[], placed: PlacedPart): Size {
  if (bodies.length === 0) return [placed.pose[0], placed.pose[1], placed.pose[2]];
  const spans = bodies.map(body => [spanOf(body, 'top'), spanOf(body, 'side')] as const);
  const middle = (ranges: Point2[]): number =>
    (Math.min(...ranges.map(([least]) => least)) + Math.max(...ranges.map(([, most]) => most))) / 2;
  return [
    middle(spans.map(([top]) => top.a)), middle(spans.map(([top]) => top.b)), middle(spans.map(([, side]) => side.b)),
  ];
}

// Null: the joint does not shift, or towards the viewer.
export function travelLine(placed: PlacedPart, bodies: Body[], view: View): TravelLine | null {
  const joint = placed.part.joint;
  if (!joint || joint.type !== 'linear') return null;
  const [ax, ay, az] = joint.axis;
  const along: Point2 = view === 'top' ? [ax, ay] : [ax, az];
  if (Math.hypot(...along) < ARROW) return null;
  const [x, y, z] = middleOf(bodies, placed);
  const reach = Math.max(0, ...bodies.flatMap(body => body.outline.flatMap(([cx, cy]) =>
    body.z.map(cz => (cx - x) * ax + (cy - y) * ay + (cz - z) * az))));
  const at = (position: number): Point2 => {
    const d = reach + position;
    return view === 'top' ? [x + ax * d, y + ay * d] : [x + ax * d, z + az * d];
  };
  return {from: at(joint.limits[0]), to: at(joint.limits[1]), along};
}

// The radius of the arc of a rotational joint: outside of the body.
export function arcRadius(placed: PlacedPart, bodies: Body[]): number {
  const [x, y] = placed.pose;
  const reach = bodies.flatMap(({outline}) => outline.map(([cx, cy]) => Math.hypot(cx - x, cy - y)));
  return Math.max(0.12, ...reach) * 1.1;
}

// Where both limits are at one point, the upper one is dragged.
function jointHandles(placed: PlacedPart, bodies: Body[], view: View, pixel: number): Handle[] {
  const joint = placed.part.joint;
  if (!joint) return [];
  const [min, max] = joint.limits;
  if (joint.type === 'rotational') {
    if (view === 'side') return [];
    const radius = arcRadius(placed, bodies);
    const [x, y, , heading] = placed.pose;
    const limit = (old: number, to: Point2): number => {
      const turn = Math.atan2(to[1] - y, to[0] - x) - heading - old;
      return snapTo(old + Math.atan2(Math.sin(turn), Math.cos(turn)), TURN);
    };
    const at = (angle: number): Point2 =>
      [x + radius * Math.cos(heading + angle), y + radius * Math.sin(heading + angle)];
    return [
      {view, at: at(max), kind: 'square', drag: to => ({limits: [min, Math.max(limit(max, to), min)]})},
      {view, at: at(min), kind: 'square', drag: to => ({limits: [Math.min(limit(min, to), max), max]})},
    ];
  }
  const line = travelLine(placed, bodies, view);
  if (!line) return [];
  const {from, to: end, along} = line;
  const length = Math.hypot(...along);
  const shift = (start: Point2, to: Point2): number =>
    ((to[0] - start[0]) * along[0] + (to[1] - start[1]) * along[1]) / (length * length);
  const reach = (36 * pixel) / length;
  const arrow: Point2 = [end[0] + along[0] * reach, end[1] + along[1] * reach];
  const [x, y, z] = middleOf(bodies, placed);
  const centre: Point2 = view === 'top' ? [x, y] : [x, z];
  const direction = (to: Point2): Size => {
    const angle = snapTo(Math.atan2(to[1] - centre[1], to[0] - centre[0]), TURN);
    const round = (value: number): number => Math.round(value * 1e6) / 1e6;
    const [a, b] = [round(Math.cos(angle)), round(Math.sin(angle))];
    return view === 'top' ? [a, b, 0] : [a, 0, b];
  };
  return [
    {view, at: end, kind: 'square', drag: to => ({limits: [min, Math.max(snapTo(max + shift(end, to)), min)]})},
    {view, at: from, kind: 'square', drag: to => ({limits: [Math.min(snapTo(min + shift(from, to)), max), max]})},
    {view, at: arrow, kind: 'arrow', drag: to => ({axis: direction(to)})},
  ];
}

// The middle of the body stays where it is.
function boxHandles({body, size}: PlacedPart, view: View): Handle[] {
  const [x, y, z] = size;
  if (view === 'side') {
    const at: Point2 = [body[0], body[2] + z];
    return [{view, at, kind: 'round', drag: to => ({size: [x, y, atLeast(to[1] - body[2])]})}];
  }
  return [{
    view, at: toModel(body, [x / 2, y / 2]), kind: 'round',
    drag: to => {
      const [u, v] = toFrame(body, to);
      return {size: [atLeast(2 * Math.abs(u)), atLeast(2 * Math.abs(v)), z]};
    },
  }];
}

function paddleHandles({body, pose, size, part}: PlacedPart, view: View): Handle[] {
  const paddle = part.gripper?.paddle;
  if (!paddle) return [];
  const [x, y, z] = size;
  const [length, thickness, height] = paddle;
  if (view === 'side') {
    const at = toModel(body, [x / 2 - length / 2, 0])[0];
    return [{
      view, at: [at, body[2] + height], kind: 'round',
      drag: to => ({paddle: [length, thickness, Math.min(atLeast(to[1] - body[2]), z)]}),
    }];
  }
  const handle = (u: number, v: number, drag: (u: number, v: number) => PartShape): Handle =>
    ({view, at: toModel(body, [u, v]), kind: 'round', drag: to => drag(...toFrame(body, to))});
  return [
    // The body behind the paddles stays: the whole grows to the front, and its middle moves.
    handle(x / 2, y / 2 - thickness / 2, u => {
      const longer = Math.max(snapTo(u - x / 2), LEAST - length);
      const [px, py] = toModel(pose, [longer / 2, 0]);
      return {
        pose: [px, py, pose[2], pose[3]], size: [x + longer, y, z], paddle: [length + longer, thickness, height],
      };
    }),
    handle(x / 2 - length / 2, y / 2 - thickness, (_, v) =>
      ({paddle: [length, Math.min(atLeast(y / 2 - v), 0.49 * y), height]})),
    // The opening.
    handle(x / 2 - length / 2, y / 2, (_, v) => {
      const wide = Math.max(atLeast(2 * v), 2.1 * thickness);
      return {size: [x, wide, z], paddle: [length, thickness, height]};
    }),
  ];
}

// `pixel`: m.
export function handlesOf(placed: PlacedPart, bodies: Body[], view: View, pixel: number): Handle[] {
  return [
    ...jointHandles(placed, bodies, view, pixel),
    ...(placed.part.is_box ? boxHandles(placed, view) : []),
    ...paddleHandles(placed, view),
  ];
}

// The pose after a drag of the body, or a turn of it.
export function draggedPose(pose: Pose4, view: View, from: Point2, to: Point2, turns: boolean): Pose4 {
  const [x, y, z, heading] = pose;
  if (view === 'side') return [x, y, snapTo(z + to[1] - from[1]), heading];
  if (!turns) return [snapTo(x + to[0] - from[0]), snapTo(y + to[1] - from[1]), z, heading];
  const angle = Math.atan2(to[1] - y, to[0] - x) - Math.atan2(from[1] - y, from[0] - x);
  const turned = snapTo(heading + angle, TURN);
  return [x, y, z, Math.atan2(Math.sin(turned), Math.cos(turned))];
}
