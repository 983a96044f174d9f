// The list of robots with their states.
// Rows are rebuilt only when the world, the searched name or the colours change; each frame sets their texts and marks.
import {isDark, robotColor} from './colors';
import {byId, fixed, make, setText} from './dom';
import type {Run} from './run';

const MOST_SHOWN = 200;

export type RobotState = 'lost' | 'stalled' | 'holding' | 'moving' | 'idle';

export function robotState(run: Run, robot: number, holding: boolean): RobotState {
  const row = run.robots[robot];
  if (run.lostAgents.has(run.world.robots[robot].name)) return 'lost';
  if (!row) return 'idle';
  if (row.stalled) return 'stalled';
  if (holding) return 'holding';
  const {vx, vy, wz} = row.twist;
  return vx !== 0 || vy !== 0 || wz !== 0 ? 'moving' : 'idle';
}

interface Row {
  element: HTMLElement;
  dot: HTMLElement;
  state: HTMLElement;
}

export class RobotList {
  private readonly list = byId('robot-list');
  private readonly search = byId<HTMLInputElement>('robot-search');
  private rows = new Map<number, Row>();  // by robot
  private key = '';

  // `hint`: of a robot, for its row, when the pointer comes to it.
  constructor(private readonly onSelect: (robot: number) => void, private readonly hint: (robot: string) => string) {
    this.list.onkeydown = event => {
      const row = (event.target as Element).closest('.robot');
      const next = event.key === 'ArrowDown' ? row?.nextElementSibling : event.key === 'ArrowUp' ? row?.previousElementSibling : null;
      if (!(next instanceof HTMLButtonElement)) return;
      event.preventDefault();
      next.focus();
    };
  }

  show(run: Run, selected: number): void {
    const wanted = this.search.value.trim().toLowerCase();
    const robots: number[] = [];
    let count = 0;
    run.world.robots.forEach((robot, i) => {
      if (!robot.present) return;
      ++count;
      if (robot.name.toLowerCase().includes(wanted)) robots.push(i);
    });
    setText(byId('robot-count'), String(count));
    const key = `${run.world.number} ${wanted} ${isDark()}`;
    if (key !== this.key) this.rebuild(run, robots);
    this.key = key;
    const holders = new Set(run.objects.filter(o => o.holder >= 0).map(o => run.world.grippers[o.holder].robot));
    for (const [i, row] of this.rows) {
      const state = robotState(run, i, holders.has(i));
      const speed = run.robots[i] ? Math.hypot(run.robots[i].twist.vx, run.robots[i].twist.vy) : 0;
      if (row.dot.className !== `dot ${state}`) row.dot.className = `dot ${state}`;
      if (row.state.className !== `robot-state ${state}`) row.state.className = `robot-state ${state}`;
      setText(row.state, state === 'moving' ? `${fixed(speed, 2)} m/s` : state);
      row.element.classList.toggle('selected', i === selected);
    }
  }

  private rebuild(run: Run, robots: number[]): void {
    this.rows = new Map();
    this.list.replaceChildren();
    for (const i of robots.slice(0, MOST_SHOWN)) {
      const row: Row = {element: make('button', 'robot'), dot: make('span', 'dot'), state: make('span', 'robot-state')};
      const swatch = make('span', 'swatch');
      swatch.style.background = robotColor(i);
      row.element.append(row.dot, swatch, make('span', 'robot-name', run.world.robots[i].name), row.state);
      row.element.onpointermove = () => {
        row.element.title = this.hint(run.world.robots[i].name);
      };
      row.element.onclick = () => this.onSelect(i);
      this.rows.set(i, row);
      this.list.append(row.element);
    }
    if (robots.length > MOST_SHOWN) this.list.append(make('div', 'more', `and ${robots.length - MOST_SHOWN} more: search by name`));
  }
}
