// The requests of the editor's page and their replies: viewer/editor answers them.
//
// The interfaces mirror the JSON of viewer/editor/editor_reports.cc and model_parts.cc; there is no generator for them,
// so a change there needs one here. Lengths are metres and angles radians wherever a member is a number; members that
// are text are in the file's units.
import type {Connection, EditReply} from './connection';
import {toast} from './dom';
import type {Schema} from './value_forms';

export interface Where {
  file: string;
  line: number;
  column: number;
}

export interface FileEntity {
  name: string;
  type: string;
  model: string;  // the type or define that the file names
  here: boolean;  // in this file, not in an included one
  where: Where;
}

export interface FileDocument {
  file: string;
  kind: 'world' | 'include' | 'scenario';
  modified: boolean;
  version: number;
  edition: number;  // of the world that shows it
  error: string;  // of the text; empty: none
  error_place?: Where;
  undo: string;  // label; empty: nothing to undo
  redo: string;
  warnings: string[];
  entities: FileEntity[];
  members: Record<string, unknown>;  // of a scenario
  more: Record<string, number>;  // entries of its lists that `members` leaves out
  properties: Array<{name: string; value: string}>;  // of the world
  metres?: number;  // per unit of length of the file; with radians, if it has been loaded
  radians?: number;
  testing: boolean;
  tested: string;
  failure?: string;
}

export interface PictureBlock {
  outline: Array<[number, number]>;
  z: [number, number];
  color?: [number, number, number];
}

export interface PaletteRow {
  name: string;
  type: string;
  here: boolean;
  where: Where;
  library?: string;  // that has it; the file does not include it yet
  picture?: PictureBlock[];
}

export interface HelpRow {
  type: string;
  name: string;
  form: string;
  unit: string;
  initial: string;
  help: string;
}

export interface ParameterHelp {
  name: string;
  form: 'number' | 'flag' | 'json';
  unit: string;
  initial: unknown;  // null: none
  least?: number;
  most?: number;
  help: string;
  needed: boolean;  // then `initial` is an example
}

export interface ControllerHelp {
  name: string;
  help: string;
  parameters: ParameterHelp[];
}

// What the editor tells once: of all properties, controllers and colours.
export interface EditorHelp {
  properties: HelpRow[];
  controllers: ControllerHelp[];
  stage_controllers: Record<string, {name: string; arguments: string[]}>;  // by the name in `ctrl`
  colors: Record<string, [number, number, number]>;  // 0 to 255
  schema?: Schema;  // of scenarios
}

export interface FileProperty {
  name: string;
  value: string;
  own: boolean;
  where: Where;
  warning?: string;
}

export interface EntityReport {
  name: string;
  base_type: string;  // of the model; a reply has a type of its own
  model: string;
  where: Where;
  shelf: boolean;
  refusal: string;  // the reason why it cannot be edited here; empty: it can
  properties: FileProperty[];
  pose: [number, number, number, number];  // x, y, z, heading in the world, m and rad
  controller?: {name: string; parameters: Record<string, unknown> | null; own: boolean};  // of a robot; own: in a scenario
}

export interface ModelPart {
  index: number;
  type: string;
  line: number;
  properties: Record<string, string>;
  parts?: ModelPart[];
  // The members of a part that is a model, in m and rad and in the frame of the whole model:
  model?: string;  // base type
  name?: string;
  pose?: [number, number, number, number];  // x, y, z, heading
  body?: [number, number, number, number];  // of the middle of its body's underside
  size?: [number, number, number];
  is_box?: boolean;  // its body is a box of that size
  bodies?: PictureBlock[];
  joint?: PartJoint;
  gripper?: PartGripper;
}

export interface PartJoint {
  type: 'linear' | 'rotational';
  axis: [number, number, number];  // of length 1
  limits: [number, number];  // m or rad
  max_speed: number;
}

export type GripperRole = 'left_finger' | 'right_finger' | 'left_pad' | 'right_pad' | 'lift';

// Its own paddles, or paths of the parts that it is made of.
export type PartGripper = {paddle?: [number, number, number]} & Partial<Record<GripperRole, number[]>>;

export interface ModelReport {
  name: string;
  base: string;
  base_type: string;
  here: boolean;
  metres: number;  // per unit of length of the file
  radians: number;  // per unit of angle
  size: [number, number, number];
  blocks: PictureBlock[];
  others: PictureBlock[];  // bodies of models that are not listed as parts
  properties: Record<string, string>;
  own: Record<string, string>;
  parts: ModelPart[];
}

export class FileClient {
  constructor(private readonly connection: Connection) {}

  // Shows the reason of a refusal.
  async edit(op: string, more: object = {}): Promise<EditReply> {
    const reply = await this.connection.edit(op, more);
    if (!reply.done && !reply.conflict) toast(reply.problem, true);
    if (reply.warning) toast(reply.warning, true);
    return reply;
  }

  // Without a word.
  ask(op: string, more: object = {}): Promise<EditReply> {
    return this.connection.edit(op, more);
  }
}

export function placeText({file, line}: Where): string {
  return `${file.split('/').pop()}:${line}`;
}
