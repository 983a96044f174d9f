// Times: the one format of simulated time, and the times of the positions on the timeline.
//
// Positions count states; within a span without a gap a tick is one position, so the tick of a position follows from
// its span. A rewind or an edit begins another span.
import {fixed} from './dom';
import type {TimeSpan} from './protocol';
import type {Run} from './run';

// "0:16.0", "1:02:03.4". `digits`: of the seconds.
export function clockText(seconds: number, digits = 1): string {
  const whole = Number(fixed(Math.abs(seconds), digits));
  const minutes = Math.floor(whole / 60);
  const rest = fixed(whole - 60 * minutes, digits).padStart(digits > 0 ? digits + 3 : 2, '0');
  const hours = Math.floor(minutes / 60);
  const text = hours > 0 ? `${hours}:${String(minutes % 60).padStart(2, '0')}:${rest}` : `${minutes}:${rest}`;
  return seconds < 0 && whole > 0 ? `−${text}` : text;
}

// "1.3 s", "2:05.0": of a duration.
export function durationText(seconds: number): string {
  return seconds < 60 ? `${fixed(seconds, 1)} s` : clockText(seconds);
}

const STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200, 14400, 36000, 86400];

// The distance of labels on an axis of `seconds` with room for `most` of them.
export function labelStep(seconds: number, most: number): number {
  return STEPS.find(step => seconds / step <= most) ?? Math.ceil(seconds / most / 86400) * 86400;
}

// For labels at such a distance.
export function stepDigits(step: number): number {
  return step < 1 ? 1 : 0;
}

// What the timeline has between its ends: the newest span grows, and the oldest may have lost its begin.
export function spansOf(run: Run): TimeSpan[] {
  const spans: TimeSpan[] = run.spans.length > 0 ? run.spans : [[run.first, run.last, run.tick - (run.position - run.first)]];
  return spans.flatMap(([first, last, tick], i): TimeSpan[] => {
    const from = Math.max(first, run.first);
    const to = i === spans.length - 1 ? run.last : Math.min(last, run.last);
    return from <= to ? [[from, to, tick + (from - first)]] : [];
  });
}

// The tick at a position; in a gap, that of the span before.
export function tickAt(run: Run, position: number): number {
  const spans = spansOf(run);
  let found = spans[0];
  for (const span of spans) if (span[0] <= position) found = span;
  return found ? found[2] + (position - found[0]) : run.tick;
}

export function secondsAt(run: Run, position: number): number {
  return tickAt(run, position) * run.world.interval;
}
