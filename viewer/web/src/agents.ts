// The agents of robots, as the run tells them when it is asked.
import type {AgentInfo, Connection} from './connection';
import {fixed} from './dom';

const PERIOD = 1000;  // ms, between two questions for a robot

export function agentText(agent: AgentInfo): string {
  const answer = agent.answer_seconds > 0 ? `, answers in ${fixed(1000 * agent.answer_seconds, 1)} ms` : '';
  return `${agent.host}, process ${agent.pid}${agent.present ? answer : ', lost'}`;
}

export class Agents {
  private readonly known = new Map<string, AgentInfo>();  // by robot
  private readonly asked = new Map<string, number>();  // when, by robot

  // `changed`: an answer has come.
  constructor(private readonly connection: Connection, private readonly changed: () => void) {}

  // The agents as they were told last; asks for them again if the last question is long ago.
  of(robot: string): AgentInfo | null {
    const now = performance.now();
    if (now - (this.asked.get(robot) ?? -Infinity) >= PERIOD) {
      this.asked.set(robot, now);
      void this.ask(robot);
    }
    return this.known.get(robot) ?? null;
  }

  private async ask(robot: string): Promise<void> {
    const reply = await this.connection.request('entities', {name: robot});
    const agent = reply.entities?.find(({name}) => name === robot)?.agent;
    if (agent) this.known.set(robot, agent);
    else this.known.delete(robot);
    this.changed();
  }
}
