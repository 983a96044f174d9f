// The agents of robots, and the states of vehicles, as the run tells them when it is asked.
import type {AgentInfo, Connection} from './connection';
import {fixed} from './dom';

const PERIOD = 1000;  // ms, between two questions for a robot
const VEHICLE_PERIOD = 300;  // ms, for one that is a vehicle
const VEHICLE = 'vehicle ';  // begins the line of a vehicle's state in the signals of a report

export function agentText(agent: AgentInfo): string {
  const answer = agent.answer_seconds > 0 ? `, answers in ${fixed(1000 * agent.answer_seconds, 1)} ms` : '';
  return `${agent.host}, process ${agent.pid}${agent.present ? answer : ', lost'}`;
}

export class Agents {
  private readonly known = new Map<string, AgentInfo>();  // by robot, as the next two
  private readonly vehicles = new Map<string, string>();  // their states, as sent
  private readonly asked = new Map<string, number>();  // when

  // `changed`: an answer has come.
  constructor(private readonly connection: Connection, private readonly changed: () => void) {}

  // The agent of the newest answer; requests it again if the last request is long ago.
  of(robot: string): AgentInfo | null {
    this.askFor(robot);
    return this.known.get(robot) ?? null;
  }

  // The newest state by VDA 5050 of the newest answer; empty: none.
  vehicleOf(robot: string): string {
    this.askFor(robot);
    return this.vehicles.get(robot) ?? '';
  }

  private askFor(robot: string): void {
    const now = performance.now();
    const period = this.vehicles.has(robot) ? VEHICLE_PERIOD : PERIOD;
    if (now - (this.asked.get(robot) ?? -Infinity) < period) return;
    this.asked.set(robot, now);
    void this.ask(robot);
  }

  private async ask(robot: string): Promise<void> {
    const reply = await this.connection.request('entities', {name: robot});
    const entity = reply.entities?.find(({name}) => name === robot);
    if (entity?.agent) this.known.set(robot, entity.agent);
    else this.known.delete(robot);
    const line = entity?.signals?.split('\n').find(each => each.startsWith(VEHICLE));
    if (line) this.vehicles.set(robot, line.slice(VEHICLE.length));
    else this.vehicles.delete(robot);
    this.changed();
  }
}
