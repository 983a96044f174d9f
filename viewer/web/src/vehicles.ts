// Vehicles of VDA 5050 (docs/vda5050.md): their newest states, as they have sent them to their fleet control.
//
// A state is JSON of the vehicle, in the version that it speaks; here it becomes what the page shows. Of the live run it is
// in the service's report of the robot; of a past state the gateway reads it from the recording.
import type {Agents} from './agents';
import type {Connection} from './connection';
import {VEHICLE_CONTROLLER, type Run} from './run';

export interface VehicleNode {
  id: string;
  released: boolean;  // of the base; else of the horizon
  place: {x: number; y: number} | null;  // null: the state does not tell it
  map: string;
  line: Array<{x: number; y: number}>;  // of the edge that leads there, with its ends; empty: straight
}

export interface VehicleAction {
  id: string;
  type: string;
  status: string;
  result: string;
}

export interface VehicleError {
  type: string;
  level: string;
  text: string;
  references: string;  // "nodeId n1, edgeId e1"
}

export interface VehicleState {
  order: string;  // empty: it never had one
  update: number;
  lastNode: string;
  nodes: VehicleNode[];  // still to be traversed
  actions: VehicleAction[];
  errors: VehicleError[];
  requests: string[];  // to enter zones, with their answers
  loads: string[];
  battery: number;  // %
  charging: boolean;
  mode: string;
  driving: boolean;
  paused: boolean;
  wantsBase: boolean;
  isBlocked: boolean;  // by something in its field of protection
  stopped: boolean;  // by an emergency stop
}

export function isVehicle(run: Run, robot: number): boolean {
  return run.world.robots[robot]?.controller.name === VEHICLE_CONTROLLER;
}

// Members of what a peer has sent: anything may be missing, or of another type.
type Json = Record<string, any>;

function list(value: unknown): Json[] {
  return Array.isArray(value) ? value.filter(each => typeof each === 'object' && each !== null) : [];
}

function text(value: unknown): string {
  return typeof value === 'string' ? value : value === undefined || value === null ? '' : String(value);
}

// Null: it is no state.
export function readVehicleState(json: string): VehicleState | null {
  let state: Json;
  try {
    state = JSON.parse(json) as Json;
  } catch {
    return null;
  }
  if (typeof state !== 'object' || state === null) return null;
  const edges = list(state.edgeStates);
  const power: Json = state.batteryState ?? state.powerSupply ?? {};
  const safety: Json = state.safetyState ?? {};
  const stop = text(safety.eStop ?? safety.activeEmergencyStop);
  return {
    order: text(state.orderId),
    update: Number(state.orderUpdateId) || 0,
    lastNode: text(state.lastNodeId),
    nodes: list(state.nodeStates).map((node): VehicleNode => {
      const place = node.nodePosition;
      const edge = edges.find(({sequenceId}) => sequenceId === node.sequenceId - 1);
      return {
        id: text(node.nodeId),
        released: node.released === true,
        place: place && Number.isFinite(place.x) && Number.isFinite(place.y) ? {x: place.x, y: place.y} : null,
        map: text(place?.mapId),
        line: edge?.trajectory ? pointsOf(edge.trajectory) : [],
      };
    }),
    actions: [...list(state.actionStates), ...list(state.instantActionStates), ...list(state.zoneActionStates)].map((action): VehicleAction => ({
      id: text(action.actionId),
      type: text(action.actionType) || 'action',
      status: text(action.actionStatus),
      result: text(action.resultDescription ?? action.actionResult),
    })),
    errors: list(state.errors).map((error): VehicleError => ({
      type: text(error.errorType),
      level: text(error.errorLevel),
      text: text(error.errorDescription),
      references: list(error.errorReferences).map(({referenceKey, referenceValue}) => `${text(referenceKey)} ${text(referenceValue)}`).join(', '),
    })),
    requests: list(state.zoneRequests).map(({zoneId, requestType, requestStatus}) => `${text(zoneId)}: ${text(requestType)} ${text(requestStatus)}`),
    loads: list(state.loads).map(({loadId, loadType}) => text(loadId) || text(loadType) || 'a load'),
    battery: Number(power.batteryCharge ?? power.stateOfCharge) || 0,
    charging: power.charging === true,
    mode: text(state.operatingMode),
    driving: state.driving === true,
    paused: state.paused === true,
    wantsBase: state.newBaseRequest === true,
    isBlocked: safety.fieldViolation === true,
    stopped: stop !== '' && stop !== 'NONE',
  };
}

const STEPS = 8;  // points of each span of a curve

// Points on a NURBS curve, by de Boor's algorithm in homogeneous coordinates; empty: it is none.
export function pointsOf(trajectory: Json): Array<{x: number; y: number}> {
  const controls = list(trajectory.controlPoints).map(({x, y, weight}) => {
    const w = Number(weight ?? 1);
    return [Number(x) * w, Number(y) * w, w];
  });
  const knots: number[] = (Array.isArray(trajectory.knotVector) ? trajectory.knotVector : []).map(Number);
  const degree = Math.round(Number(trajectory.degree ?? 1));
  if (!(degree >= 1) || controls.length <= degree || knots.length !== controls.length + degree + 1) return [];
  if (![...knots, ...controls.flat()].every(Number.isFinite)) return [];
  const points: Array<{x: number; y: number}> = [];
  for (let span = degree; span < controls.length; ++span) {
    const [begin, end] = [knots[span], knots[span + 1]];
    if (!(end > begin)) continue;
    for (let step = points.length === 0 ? 0 : 1; step <= STEPS; ++step) {
      const t = begin + ((end - begin) * step) / STEPS;
      const work = controls.slice(span - degree, span + 1).map(point => [...point]);
      for (let r = 1; r <= degree; ++r) {
        for (let j = degree; j >= r; --j) {
          const low = knots[j + span - degree];
          const high = knots[j + 1 + span - r];
          const share = high > low ? (t - low) / (high - low) : 0;
          work[j] = work[j].map((value, i) => (1 - share) * work[j - 1][i] + share * value);
        }
      }
      const [x, y, w] = work[degree];
      if (w !== 0) points.push({x: x / w, y: y / w});
    }
  }
  return points;
}

// Of the states of vehicles, the newest that the page knows of one robot.
export class Vehicles {
  private key = '';  // of the past state that is asked for, or was
  private past: VehicleState | null = null;
  private isAsking = false;
  private text = '';  // that `state` was read from
  private state: VehicleState | null = null;

  // `changed`: an answer has come.
  constructor(private readonly connection: Connection, private readonly agents: Agents, private readonly changed: () => void) {}

  // `live`: the service can be asked.
  of(run: Run, robot: number, live: boolean): VehicleState | null {
    if (!isVehicle(run, robot)) return null;
    const {name} = run.world.robots[robot];
    const sent = live ? this.agents.vehicleOf(name) : '';
    if (sent !== '') {
      if (sent !== this.text) this.state = readVehicleState(sent);
      this.text = sent;
      return this.state;
    }
    const key = `${run.world.run} ${name} ${run.position}`;
    if (key !== this.key && !this.isAsking) {
      if (!this.key.startsWith(`${run.world.run} ${name} `)) this.past = null;
      this.key = key;
      this.isAsking = true;
      void this.ask(name, run.position);
    }
    return this.past;
  }

  private async ask(robot: string, position: number): Promise<void> {
    const reply = await this.connection.vehicle(robot, position);
    this.isAsking = false;
    this.past = reply.done && reply.state ? readVehicleState(reply.state) : null;
    this.changed();
  }
}
