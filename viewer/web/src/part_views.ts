// PartViews: the parts of a model in the two views of the model editor: they are selected, dragged and turned, and
// their joints and paddles changed by handles. A drag is one change, at its end.
import {
  areaOf, arcRadius, bodiesOf, draggedPose, handlesOf, isBelow, isInside, pathKey, reshaped, spanOf, toFrame, toModel,
  travelLine, type Body, type Handle, type PartShape, type PlacedPart, type View,
} from './part_geometry';
import {color, NEAR, type Point2, type Sheet} from './sheet';

export interface PartViewsHost {
  partSelected(path: number[] | null): void;
  partShaped(path: number[], shape: PartShape): void;
}

interface Drag {
  view: View;
  from: Point2;
  handle: Handle | null;  // null: the body
  shape: PartShape;  // so far
}

const CLICK = 3;  // px, that a click may move
const MARK = 7;  // px, radius of the mark of a part without a body

const modelOutline = ({outline, z}: Body, view: View): Point2[] => {
  if (view === 'top') return [...outline, outline[0]];
  const {a: [left, right]} = spanOf({outline, z}, view);
  return [[left, z[0]], [right, z[0]], [right, z[1]], [left, z[1]], [left, z[0]]];
};

export class PartViews {
  parts: PlacedPart[] = [];
  private selected = '';  // path; empty: none
  private drag: Drag | null = null;
  private pick: ((path: number[]) => void) | null = null;

  constructor(private readonly host: PartViewsHost) {}

  setParts(parts: PlacedPart[]): void {
    this.parts = parts;
    this.drag = null;
    if (!this.selectedPart()) this.selected = '';
  }

  select(path: number[] | null): void {
    this.selected = path ? pathKey(path) : '';
    this.drag = null;
  }

  selectedPart(): PlacedPart | null {
    return this.parts.find(({path}) => pathKey(path) === this.selected) ?? null;
  }

  // The next click on a part is for this; null: none is awaited.
  setPick(pick: ((path: number[]) => void) | null): void {
    this.pick = pick;
  }

  // True if there was something to cancel.
  cancel(): boolean {
    const was = this.drag !== null || this.pick !== null;
    this.drag = null;
    this.pick = null;
    return was;
  }

  // True if the press was for a part.
  press(event: PointerEvent, sheet: Sheet, view: View): boolean {
    const from = sheet.toMetres(event);
    if (this.pick) {
      const found = this.partAt(event, sheet, view);
      const pick = this.pick;
      if (found) {
        this.pick = null;
        pick(found.path);
      }
      return true;
    }
    const selected = this.selectedPart();
    if (selected) {
      const handles = handlesOf(selected, bodiesOf(selected, selected), view, 1 / sheet.scale);
      const handle = handles.find(({at}) => sheet.isNear(event, at));
      if (handle) {
        // The handle keeps its distance from the pointer.
        this.drag = {view, from: [from[0] - handle.at[0], from[1] - handle.at[1]], handle, shape: {}};
        sheet.canvas.setPointerCapture(event.pointerId);
        return true;
      }
    }
    const found = this.partAt(event, sheet, view);
    if (found) {
      this.selected = pathKey(found.path);
      this.drag = {view, from, handle: null, shape: {}};
      sheet.canvas.setPointerCapture(event.pointerId);
      this.host.partSelected(found.path);
      return true;
    }
    if (!selected) return false;
    this.selected = '';
    this.host.partSelected(null);
    return true;
  }

  // True if a part is dragged.
  move(event: PointerEvent, sheet: Sheet, view: View): boolean {
    const {drag} = this;
    const selected = this.selectedPart();
    if (!drag || !selected || drag.view !== view) return false;
    const to = sheet.toMetres(event);
    if (drag.handle) {
      drag.shape = drag.handle.drag([to[0] - drag.from[0], to[1] - drag.from[1]]);
    } else if (drag.shape.pose || Math.hypot(to[0] - drag.from[0], to[1] - drag.from[1]) * sheet.scale > CLICK) {
      drag.shape = {pose: draggedPose(selected.pose, view, drag.from, to, event.shiftKey)};
    }
    return true;
  }

  release(): void {
    const {drag} = this;
    const selected = this.selectedPart();
    this.drag = null;
    if (!drag || !selected || Object.keys(drag.shape).length === 0) return;
    // It stays as dragged until the file answers.
    this.parts = this.shownParts(drag.shape);
    this.host.partShaped(selected.path, drag.shape);
  }

  draw(sheet: Sheet, view: View): void {
    const parts = this.shownParts(this.drag?.shape ?? {});
    const bodies = parts.map((part, i) => bodiesOf(part, this.parts[i]));
    parts.forEach((part, i) => {
      if (pathKey(part.path) !== this.selected) this.drawPart(part, bodies[i], sheet, view);
    });
    parts.forEach((part, i) => {
      if (pathKey(part.path) === this.selected) this.drawSelected(part, bodies[i], sheet, view);
    });
  }

  // With the change of the selected part, and of all that it carries.
  private shownParts(shape: PartShape): PlacedPart[] {
    const selected = this.selectedPart();
    if (!selected || Object.keys(shape).length === 0) return this.parts;
    return this.parts.map(part => {
      if (part === selected) return reshaped(part, shape);
      const to = shape.pose;
      if (!to || !isBelow(part.path, selected.path)) return part;
      const from = selected.pose;
      const [x, y] = toModel(to, toFrame(from, [part.pose[0], part.pose[1]]));
      return reshaped(part, {pose: [x, y, part.pose[2] + to[2] - from[2], part.pose[3] + to[3] - from[3]]});
    });
  }

  // The smallest at the pointer: what a part carries is above it.
  private partAt(event: PointerEvent, sheet: Sheet, view: View): PlacedPart | null {
    const point = sheet.toMetres(event);
    let best: PlacedPart | null = null;
    let least = Infinity;
    for (const part of this.parts) {
      const bodies = bodiesOf(part, part);
      if (bodies.length === 0 && sheet.isNear(event, this.markOf(part, view), NEAR)) return part;
      for (const body of bodies) {
        const outline = modelOutline(body, view);
        const area = areaOf(outline);
        if (area < least && isInside(point, outline)) {
          least = area;
          best = part;
        }
      }
    }
    return best;
  }

  private markOf({pose: [x, y, z]}: PlacedPart, view: View): Point2 {
    return view === 'top' ? [x, y] : [x, z];
  }

  private drawPart(part: PlacedPart, bodies: Body[], sheet: Sheet, view: View): void {
    const stroke = color('--faint');
    for (const body of bodies) sheet.line(modelOutline(body, view), {stroke, dash: [4, 3]});
    if (bodies.length === 0) sheet.circle(this.markOf(part, view), MARK, stroke);
    const line = travelLine(part, bodies, view);
    if (line) sheet.line([line.from, line.to], {stroke, dash: [1, 3]});
  }

  private drawSelected(part: PlacedPart, bodies: Body[], sheet: Sheet, view: View): void {
    const accent = color('--accent');
    for (const body of bodies) sheet.line(modelOutline(body, view), {stroke: accent, width: 2, fill: accent});
    if (bodies.length === 0) sheet.circle(this.markOf(part, view), MARK, accent, accent);
    this.drawTravel(part, bodies, sheet, view);
    if (view === 'top') this.drawHeading(part, sheet);
    for (const {at, kind} of handlesOf(part, bodies, view, 1 / sheet.scale)) {
      if (kind === 'square') sheet.square(at, color('--red'));
      else sheet.circle(at, 5, accent, kind === 'round' ? color('--ground') : accent);
    }
    this.drawLabel(part, bodies, sheet, view);
  }

  private drawHeading({pose: [x, y, , heading]}: PlacedPart, sheet: Sheet): void {
    const length = 16 / sheet.scale;
    const to: Point2 = [x + length * Math.cos(heading), y + length * Math.sin(heading)];
    sheet.line([[x, y], to], {stroke: color('--red'), width: 2});
  }

  // The way of a joint, and its bodies at the end of it.
  private drawTravel(part: PlacedPart, bodies: Body[], sheet: Sheet, view: View): void {
    const {joint} = part.part;
    if (!joint) return;
    const stroke = color('--red');
    const [min, max] = joint.limits;
    const ghost = (body: Body): Body => {
      const [ax, ay, az] = joint.axis;
      if (joint.type === 'linear') {
        const outline = body.outline.map(([x, y]): Point2 => [x + ax * max, y + ay * max]);
        return {outline, z: [body.z[0] + az * max, body.z[1] + az * max]};
      }
      const turned: typeof part.pose = [part.pose[0], part.pose[1], part.pose[2], part.pose[3] + max];
      return {outline: body.outline.map(corner => toModel(turned, toFrame(part.pose, corner))), z: body.z};
    };
    for (const body of bodies) sheet.line(modelOutline(ghost(body), view), {stroke, dash: [2, 4]});
    if (joint.type === 'rotational') {
      if (view === 'side') return;
      const [x, y, , heading] = part.pose;
      const radius = arcRadius(part, bodies);
      const arc = Array.from({length: 65}, (_, i): Point2 => {
        const angle = heading + min + ((max - min) * i) / 64;
        return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
      });
      sheet.line([[x, y], ...arc, [x, y]], {stroke});
      return;
    }
    const line = travelLine(part, bodies, view);
    if (!line) {
      // Towards the viewer.
      sheet.circle(this.markOf(part, view), 5, stroke);
      sheet.circle(this.markOf(part, view), 1, stroke, stroke);
      return;
    }
    sheet.line([line.from, line.to], {stroke, width: 2});
    const reach = 36 / sheet.scale / Math.hypot(...line.along);
    const tip: Point2 = [line.to[0] + line.along[0] * reach, line.to[1] + line.along[1] * reach];
    sheet.line([line.to, tip], {stroke: color('--accent'), dash: [2, 2]});
  }

  private drawLabel(part: PlacedPart, bodies: Body[], sheet: Sheet, view: View): void {
    const {joint, gripper} = part.part;
    const number = (value: number): string => String(Math.round(value * 1000) / 1000);
    const degrees = (value: number): string => `${Math.round((value * 1800) / Math.PI) / 10}°`;
    const of = joint?.type === 'rotational' ? degrees : (value: number): string => `${number(value)} m`;
    const lines = [part.part.name || part.part.type];
    if (joint) lines.push(`${of(joint.limits[0])} to ${of(joint.limits[1])}`);
    if (gripper?.paddle) {
      const opening = number(part.size[1] - 2 * gripper.paddle[1]);
      lines.push(`paddles ${gripper.paddle.map(number).join(' × ')} m, opening ${opening} m`);
    }
    if (view === 'top') lines.push(`at ${number(part.pose[0])}, ${number(part.pose[1])}, ${degrees(part.pose[3])}`);
    if (view === 'side' && bodies.length > 0) {
      const lowest = Math.min(...bodies.map(({z}) => z[0]));
      const highest = Math.max(...bodies.map(({z}) => z[1]));
      lines.push(`z ${number(lowest)} to ${number(highest)} m`);
    }
    // With an edge, as it lies on the labels of the grid.
    const {context} = sheet;
    context.fillStyle = color('--text');
    context.strokeStyle = color('--ground');
    context.lineWidth = 5;
    context.lineJoin = 'round';
    for (const draw of ['strokeText', 'fillText'] as const) lines.forEach((text, i) => context[draw](text, 8, 16 + 15 * i));
  }
}
