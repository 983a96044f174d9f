// The requests of the editor's page and their replies: viewer/editor answers them.
import type {Connection, EditReply} from './connection';
import {toast} from './dom';

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

export interface SpawnRule {
  model: string;
  count: number;
  region: number[] | number[][];
  name_prefix?: string;
}

export interface FileDocument {
  file: string;
  kind: 'world' | 'include' | 'scenario';
  modified: boolean;
  version: number;
  error: string;  // of the text; empty: none
  error_place?: Where;
  undo: string;  // label; empty: nothing to undo
  redo: string;
  warnings: string[];
  entities: FileEntity[];
  regions: SpawnRule[];
  members: Record<string, string | number | boolean>;  // of a scenario
  properties: Array<{name: string; value: string}>;  // of the world
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

export interface FileProperty {
  name: string;
  value: string;
  own: boolean;
  where: Where;
}

export interface EntityReport {
  name: string;
  type: string;
  model: string;
  where: Where;
  shelf: boolean;
  refusal: string;  // the reason why it cannot be edited here; empty: it can
  properties: FileProperty[];
}

export interface ModelPart {
  index: number;
  type: string;
  line: number;
  properties: Record<string, string>;
  parts?: ModelPart[];
}

export interface ModelReport {
  name: string;
  base: string;
  type: string;
  here: boolean;
  metres: number;  // per unit of length of the file
  radians: number;  // per unit of angle
  blocks: PictureBlock[];
  picture: PictureBlock[];
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
