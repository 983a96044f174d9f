// Event items: events that belong together, for the list and for the timeline: a stall lasts from its begin to its end,
// and a robot that stalls at the same body again within ten seconds has not got away. And the kinds of events, with the
// colours that they have in both.
import {EventType} from '../generated/rows';
import type {RunEvent} from './protocol';

const SAME_AFTER = 10;  // s
const MOST_SEARCHED = 200;  // of the newest items

export interface EventKind {
  name: string;
  color: string;  // of viewer.css
  types: EventType[];
}

export const KINDS: EventKind[] = [
  {name: 'Contacts', color: '--stalled', types: [EventType.StallBegan, EventType.StallEnded, EventType.Blocked]},
  {name: 'Objects', color: '--holding', types: [EventType.Gripped, EventType.Released, EventType.Landed, EventType.Unstable]},
  {name: 'Doors', color: '--rays', types: [EventType.DoorOpened, EventType.DoorClosed, EventType.DoorBlocked]},
  {name: 'Lifts', color: '--lifts', types: [EventType.LiftLeft, EventType.LiftArrived, EventType.LiftBlocked, EventType.LiftOverloaded]},
  {name: 'People', color: '--people', types: [
    EventType.PersonBoarded, EventType.PersonAlighted, EventType.PersonArrived, EventType.PersonEntered, EventType.PersonLeft]},
  {
    name: 'Traffic', color: '--traffic',
    types: [EventType.WaitBegan, EventType.WaitEnded, EventType.DeadlockBroken, EventType.Replanned, EventType.NoWay],
  },
  {name: 'Rules', color: '--faint', types: [EventType.LaneSwitched, EventType.ZoneSwitched]},
  {name: 'Goods', color: '--goods', types: [EventType.GoodsArrived, EventType.GoodsRefused, EventType.GoodsLoaded, EventType.Delivered]},
  {name: 'Orders', color: '--orders', types: []},  // what vehicles of VDA 5050 say
  {name: 'Messages', color: '--accent', types: [EventType.Said, EventType.Reported]},
  {name: 'Energy', color: '--energy', types: [EventType.OutOfEnergy]},
  {name: 'Agents', color: '--lost', types: [EventType.Joined, EventType.Left, EventType.ProposalRejected]},
];

export function kindOf({type, ofVehicle}: RunEvent): EventKind {
  if (type === EventType.Said && ofVehicle) return KINDS.find(({name}) => name === 'Orders')!;
  return KINDS.find(kind => kind.types.includes(type)) ?? KINDS[0];
}

export interface EventItem {
  events: RunEvent[];  // those that began it, the first first
  end: RunEvent | null;  // of the last; null: it lasts, or it takes no time
}

export class EventItems {
  all: EventItem[] = [];
  readonly counts = new Map<EventKind, number>();  // of events
  readonly hidden = new Set<EventKind>();  // by the user
  private source: RunEvent[] | null = null;
  private seen: RunEvent | null = null;

  // `events`: those of before, then new ones; another array begins anew. `interval`: of a tick, s.
  update(events: RunEvent[], interval: number): void {
    const last = events[events.length - 1] ?? null;
    if (events === this.source && last === this.seen) return;
    let from = events === this.source && this.seen ? events.lastIndexOf(this.seen) + 1 : 0;
    if (from === 0) {
      this.all = [];
      this.counts.clear();
    }
    for (; from < events.length; ++from) this.add(events[from], interval);
    this.source = events;
    this.seen = last;
  }

  // Changes whenever an item does.
  get version(): string {
    const last = this.all[this.all.length - 1];
    return [this.all.length, last?.events.length, last?.end?.tick, this.seen?.position, this.source?.length,
            [...this.hidden].map(({name}) => name).join()].join(' ');
  }

  private add(event: RunEvent, interval: number): void {
    const kind = kindOf(event);
    this.counts.set(kind, (this.counts.get(kind) ?? 0) + 1);
    const before = this.findStall(event.robot);
    if (event.type === EventType.StallEnded && before && !before.end) {
      before.end = event;
      return;
    }
    if (event.type === EventType.StallBegan && before) {
      const [first] = before.events;
      const since = event.tick - (before.end ?? before.events[before.events.length - 1]).tick;
      if (first.other === event.other && since >= 0 && since * interval <= SAME_AFTER) {
        before.events.push(event);
        before.end = null;
        return;
      }
    }
    this.all.push({events: [event], end: null});
  }

  // The newest stall of the robot, if it is among the newest items.
  private findStall(robot: string): EventItem | null {
    for (let i = this.all.length - 1; i >= Math.max(0, this.all.length - MOST_SEARCHED); --i) {
      const [first] = this.all[i].events;
      if (first.robot === robot && first.type === EventType.StallBegan) return this.all[i];
    }
    return null;
  }
}
