// Connection: the requests of the page, and the messages to it.
//
// A request with a reply gets a number, and its promise is always resolved: by the reply, or by a problem when the
// connection is lost. Nothing is rejected, so callers need no error handling beyond `done`. Requests are not repeated
// after a loss: whether the run has executed one is unknown, and the user sees its state.
import {decode, type ExpectationsReply, type Message, type RunStatus, type SeriesReply, type TimeSpan, type TotalsReply} from './protocol';
import {makeTransport, type Transport} from './transport';

export interface SessionInfo {
  session: string;
  view_only: boolean;
  connected: boolean;  // the gateway knows the run's state
  recording: boolean;
  editor: boolean;  // the page edits a file
  problem: string;
  command: string[];  // that started the run; empty: it is not known
  runs_again: boolean;  // the run, which is over, can be started again from the page
  expectations: number;  // of the run's scenario
  saves_recording: boolean;  // the page can save the recording of the run, which is over
}

// The agent of a robot.
export interface AgentInfo {
  host: string;
  pid: number;
  present: boolean;  // false: lost
  answer_seconds: number;  // from a frame to the answer, smoothed
  times_last: number;  // ticks in which it was the last to answer
}

export interface Reply {
  done: boolean;
  problem: string;
  state?: string;
  tick?: number;
  entities?: Array<{name: string; type: string; agent?: AgentInfo; signals?: string}>;
}

// The reply to an edit, with the members that viewer/editor gives it.
export interface EditReply {
  done: boolean;
  problem: string;
  conflict?: boolean;  // the file has changed on disk
  [member: string]: any;
}

// What the page itself has found out about its recording (`troupe view --static`).
export interface Proof {
  done: boolean;
  equal: number;  // states that were computed again, with the recorded hash
  states: number;  // that are recorded
  problem: string;  // the first difference, or damage; empty: none so far
  tick?: number;  // of the problem
}

// What a page runs itself (`troupe view SCENARIO --static`).
export interface Scenario {
  seed: number;
  text: string;  // of the file, with the changed values
  values: ScenarioValue[];  // that can be changed
  changed: Array<[string, number | boolean]>;  // of this run, by their paths
}
export interface ScenarioValue {
  of: string;  // the robot, the rule or the scenario
  name: string;
  path: string;
  value: number | boolean;  // in the scenario
}

export interface ConnectionHandler {
  onOpen(): void;
  onClosed(): void;
  onSession(info: SessionInfo): void;
  onStatus(status: RunStatus): void;
  onTimeline(spans: TimeSpan[]): void;
  onMessage(message: Message): void;
  onProof(proof: Proof): void;
  onScenario(scenario: Scenario): void;
}

export class Connection {
  private readonly transport: Transport;
  private lastId = 0;
  private readonly open = new Map<number, (reply: Reply) => void>();

  constructor(private readonly handler: ConnectionHandler) {
    this.transport = makeTransport({
      onOpen: () => handler.onOpen(),
      onClosed: () => {
        for (const resolve of this.open.values()) resolve({done: false, problem: 'the connection to the viewer is lost'});
        this.open.clear();
        handler.onClosed();
      },
      onData: data => this.receive(data),
    });
  }

  // Whose readings the gateway sends. `pictures`: the robot whose camera images are among them. `traffic`: also the moves
  // and waits of robots on lanes.
  select(robots: string[] | 'all', pictures: string, traffic: boolean): void {
    this.send({type: 'select', robots, pictures, traffic});
  }

  // A request for the run. The reply of a lost connection says so.
  request(command: string, more: object = {}): Promise<Reply> {
    return this.ask({type: 'control', command, ...more});
  }

  // No request waits for its reply.
  get isIdle(): boolean {
    return this.open.size === 0;
  }

  private ask(request: object): Promise<Reply> {
    const id = ++this.lastId;
    return new Promise(resolve => {
      if (!this.send({...request, id})) {
        resolve({done: false, problem: 'the viewer is not connected'});
        return;
      }
      this.open.set(id, resolve);
    });
  }

  // A request of the editor.
  edit(op: string, more: object = {}): Promise<EditReply> {
    return this.ask({type: 'edit', op, ...more}) as Promise<EditReply>;
  }

  // Of [thing, signal], at each `every`-th position.
  series(signals: Array<[string, string]>, from: number, to: number, every: number): Promise<SeriesReply> {
    return this.ask({type: 'series', signals, from, to, every}) as Promise<unknown> as Promise<SeriesReply>;
  }

  totals(): Promise<TotalsReply> {
    return this.ask({type: 'totals'}) as Promise<unknown> as Promise<TotalsReply>;
  }

  expectations(): Promise<ExpectationsReply> {
    return this.ask({type: 'expectations'}) as Promise<unknown> as Promise<ExpectationsReply>;
  }

  // The newest state that a vehicle of VDA 5050 had sent at a position; empty: none.
  vehicle(robot: string, position: number): Promise<Reply & {state?: string}> {
    return this.ask({type: 'vehicle', robot, position});
  }

  // `seed`, `values`: null: as in the previous run. Values of a scenario, by their paths.
  runAgain(seed: number | null, values: Array<[string, number | boolean]> | null = null): Promise<Reply> {
    return this.ask({type: 'run_again', ...(seed === null ? {} : {seed}), ...(values === null ? {} : {values})});
  }

  send(value: object): boolean {
    return this.transport.send(JSON.stringify(value));
  }

  private receive(data: ArrayBuffer | string): void {
    if (typeof data !== 'string') {
      this.handler.onMessage(decode(data));
      return;
    }
    const text = JSON.parse(data);
    if (text.type === 'session') this.handler.onSession(text as SessionInfo);
    if (text.type === 'status') this.handler.onStatus(text as RunStatus);
    if (text.type === 'timeline') this.handler.onTimeline(text.spans as TimeSpan[]);
    if (text.type === 'proof') this.handler.onProof(text as Proof);
    if (text.type === 'scenario') this.handler.onScenario(text as Scenario);
    if (text.type === 'reply') {
      this.open.get(text.id)?.(text as Reply);
      this.open.delete(text.id);
    }
  }
}
