// The buttons of the door or lift whose leaf or cabin is selected, and how far it is.
// They send requests as `troupe ctl` does, and show a refusal; the state changes by the run's next update alone.
import type {Connection} from './connection';
import {allow, byId, make, setText, toast} from './dom';
import type {Entity, Run} from './run';

export class DoorButtons {
  private readonly box = byId('panel-doors');
  private buttons: HTMLElement[] = [];
  private readonly text = make('span', 'faint');
  private shown = '';
  private viewOnly = false;

  constructor(private readonly connection: Connection) {}

  setViewOnly(viewOnly: boolean): void {
    this.viewOnly = viewOnly;
    this.shown = '';
  }

  show(run: Run, selected: Entity | null): void {
    const object = selected?.kind === 'object' ? selected.index : -1;
    const door = run.world.doors.findIndex(({leaves}) => leaves.some(leaf => leaf.object === object));
    const lift = run.world.lifts.findIndex(({cabin}) => cabin === object);
    const key = `${run.world.number} ${door} ${lift}`;
    if (key !== this.shown) this.rebuild(run, door, lift);
    this.shown = key;
    if (door >= 0 && run.doors[door]) setText(this.text, doorText(run, door));
    if (lift >= 0 && run.lifts[lift]) setText(this.text, liftText(run, lift));
  }

  // Why they cannot be used now; empty: they can.
  refuse(refusal: string): void {
    for (const button of this.buttons) allow(button, refusal);
  }

  private rebuild(run: Run, door: number, lift: number): void {
    this.buttons = [];
    const row = make('div', 'gripper');
    row.append(this.text);
    const add = (text: string, command: string, fields: object): void => {
      const button = make('button', 'small', text);
      button.onclick = () => void this.send(command, fields);
      this.buttons.push(button);
      row.append(button);
    };
    if (door >= 0 && run.world.doors[door].operated && !this.viewOnly) {
      const name = run.world.models[run.world.doors[door].model].name;
      add('Open', 'door', {name, opening: 1});
      add('Close', 'door', {name, opening: 0});
    }
    if (lift >= 0 && !this.viewOnly) {
      const name = run.world.models[run.world.lifts[lift].model].name;
      for (const {name: floor} of run.world.lifts[lift].floors) add(floor, 'lift', {name, floor});
    }
    this.box.replaceChildren(...(door >= 0 || lift >= 0 ? [row] : []));
  }

  private async send(command: string, fields: object): Promise<void> {
    const reply = await this.connection.request(command, fields);
    if (!reply.done) toast(reply.problem, true);
  }
}

export function doorText(run: Run, door: number): string {
  const {opening, target, held, blocked} = run.doors[door];
  const aim = held ? 1 : target;
  if (blocked) return `blocked, ${Math.round(100 * opening)} % open`;
  if (opening !== aim) return `${aim > opening ? 'opens' : 'closes'}, ${Math.round(100 * opening)} %`;
  return opening === 0 ? 'closed' : opening === 1 ? 'open' : `${Math.round(100 * opening)} % open`;
}

export function liftText(run: Run, lift: number): string {
  const {z, floor, session, blocked} = run.lifts[lift];
  const {floors} = run.world.lifts[lift];
  const name = floors[floor]?.name ?? '?';
  const user = session >= 0 ? `, for ${run.world.robots[session].name}` : '';
  return (blocked ? `blocked on its way to ${name}` : z === floors[floor]?.z ? `at ${name}` : `to ${name}`) + user;
}
