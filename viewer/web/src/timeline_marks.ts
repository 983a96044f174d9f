// The marks of events on the timeline: a column for each few pixels, as high as there are many events, in the colours of
// their kinds. A contact has a part in each column while it lasts.
import {EventType} from '../generated/rows';
import {color} from './colors';
import {KINDS, kindOf, type EventItem, type EventItems, type EventKind} from './event_items';
import {eventText} from './events';
import type {Run} from './run';
import {clockText, durationText} from './times';

const WIDTH = 3;  // px, of a column
const LOWEST = 5;  // px
const HIGHEST = 13;
const MOST_LINES = 4;  // of its text

export interface Mark {
  left: number;  // px
  items: EventItem[];
}

// `begin`, `end`: of the axis, positions; `last`: to which an item lasts that has no end; `x`: the place of a position.
export function gatherMarks(items: EventItems, begin: number, end: number, last: number, x: (position: number) => number): Mark[] {
  const columns = new Map<number, EventItem[]>();
  const column = (position: number): number => Math.floor(x(position) / WIDTH);
  for (const item of items.all) {
    const [first] = item.events;
    if (items.hidden.has(kindOf(first))) continue;
    const newest = item.events[item.events.length - 1];
    const until = item.end?.position ?? (newest.type === EventType.StallBegan ? last : newest.position);
    if (until < begin || first.position > end) continue;
    const to = column(Math.min(until, end));
    for (let at = column(Math.max(first.position, begin)); at <= to; ++at) {
      const known = columns.get(at);
      if (known) known.push(item);
      else columns.set(at, [item]);
    }
  }
  return [...columns].map(([at, found]) => ({left: at * WIDTH, items: found})).sort((a, b) => a.left - b.left);
}

// In the order of the list of kinds.
function countsOf({items}: Mark): Array<[EventKind, number]> {
  const counts = new Map<EventKind, number>();
  for (const {events} of items) counts.set(kindOf(events[0]), (counts.get(kindOf(events[0])) ?? 0) + 1);
  return KINDS.flatMap((kind): Array<[EventKind, number]> => (counts.has(kind) ? [[kind, counts.get(kind)!]] : []));
}

export function drawMarks(context: CanvasRenderingContext2D, marks: Mark[], bottom: number): void {
  for (const mark of marks) {
    const height = Math.min(HIGHEST, LOWEST + 2 * Math.log2(mark.items.length));
    let y = bottom;
    for (const [kind, count] of countsOf(mark)) {
      const part = (height * count) / mark.items.length;
      context.fillStyle = color(kind.color);
      context.fillRect(mark.left, y - part, WIDTH, part);
      y -= part;
    }
  }
}

export function markAt(marks: Mark[], x: number): Mark | undefined {
  const distance = ({left}: Mark): number => Math.abs(left + WIDTH / 2 - x);
  const near = marks.filter(mark => distance(mark) <= 2 * WIDTH);
  return near.reduce<Mark | undefined>((best, mark) => (best && distance(best) <= distance(mark) ? best : mark), undefined);
}

export const middleOf = ({left}: Mark): number => left + WIDTH / 2;

// "0:16.0 anna stalls at table for 1.3 s", or the numbers of events of each kind.
export function textOfMark(mark: Mark, run: Run): string {
  const time = (tick: number): string => clockText(tick * run.world.interval);
  if (mark.items.length <= MOST_LINES) {
    return mark.items.map(({events, end}) => {
      const [first] = events;
      const lasted = end ? ` for ${durationText((end.tick - first.tick) * run.world.interval)}` : '';
      const times = events.length > 1 ? ` (${events.length} times)` : '';
      return `${time(first.tick)} ${eventText(first)}${lasted}${times}`;
    }).join('\n');
  }
  const [most, ...others] = countsOf(mark).sort((a, b) => b[1] - a[1]).map(([{name}, count]) => `${count} of ${name.toLowerCase()}`);
  return `Events: ${[most, ...others].join(', ')}`;
}
