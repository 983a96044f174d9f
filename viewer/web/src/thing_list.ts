// The list of the things of the world, of one kind at a time: robots with their states, doors, lifts, people, objects,
// levels, zones or lanes. A zone is switched, and a lane closed and opened, by its row. From above a door is a pixel wide, and a person stands in a crowd: here both are found by name, since a search
// goes over all kinds. Rows are rebuilt only when the world, the kind, the searched name or the colours change; each frame
// sets their texts and marks.
import {isDark, robotColor} from './colors';
import {doorText, liftText} from './doors';
import {byId, fixed, make, setText} from './dom';
import type {Levels} from './levels';
import {OBJECT_MODES} from './protocol';
import {isAway, nameOf, sameEntity, type Entity, type Run} from './run';
import {ZONE_KINDS} from './zone_marks';

const MOST_SHOWN = 200;  // of a kind
const ROBOTS = 'Robots';

export type RobotState = 'lost' | 'stalled' | 'holding' | 'moving' | 'turning' | 'idle';

export function robotState(run: Run, robot: number, holding: boolean): RobotState {
  const row = run.robots[robot];
  if (run.lostAgents.has(run.world.robots[robot].name)) return 'lost';
  if (!row) return 'idle';
  if (row.stalled) return 'stalled';
  if (holding) return 'holding';
  const {vx, vy, wz} = row.twist;
  return vx !== 0 || vy !== 0 ? 'moving' : wz !== 0 ? 'turning' : 'idle';
}

interface Thing {
  name: string;
  entity: Entity | null;  // null: a level, zone or lane
  text: (run: Run, levels: Levels) => string;
  request?: (run: Run) => [string, object];  // of the row of a zone or a lane
  title?: string;
}

interface Row {
  element: HTMLElement;
  dot: HTMLElement | null;  // of a robot
  state: HTMLElement;
}

interface Host {
  select: (entity: Entity) => void;
  showLevel: (name: string) => void;
  send: (command: string, fields: object) => void;
  refresh: () => void;
  hint: (robot: string) => string;  // for the row of a robot, when the pointer comes to it
}

export class ThingList {
  private readonly list = byId('robot-list');
  private readonly search = byId<HTMLInputElement>('robot-search');
  private robots = new Map<number, Row>();  // by robot
  private readonly kinds = byId('thing-kinds');
  private things = new Map<Thing, Row>();  // of other kinds
  private kind = ROBOTS;
  private key = '';
  private run: Run | null = null;

  constructor(private readonly host: Host) {
    this.list.onkeydown = event => {
      const rows = [...this.list.querySelectorAll<HTMLElement>('button')];
      const step = event.key === 'ArrowDown' ? 1 : event.key === 'ArrowUp' ? -1 : 0;
      const next = step === 0 ? undefined : rows[rows.indexOf(event.target as HTMLElement) + step];
      if (!next) return;
      event.preventDefault();
      next.focus();
    };
  }

  show(run: Run, selected: Entity | null, levels: Levels): void {
    this.run = run;
    const wanted = this.search.value.trim().toLowerCase();
    const key = `${run.world.number} ${this.kind} ${wanted} ${isDark()}`;
    if (key !== this.key) this.rebuild(run, wanted);
    this.key = key;
    this.showRobots(run, selected);
    for (const [thing, row] of this.things) {
      setText(row.state, thing.text(run, levels));
      row.element.classList.toggle('selected', thing.entity !== null && sameEntity(thing.entity, selected));
    }
  }

  private showRobots(run: Run, selected: Entity | null): void {
    const holders = new Set(run.objects.filter(o => o.holder >= 0).map(o => run.world.grippers[o.holder].robot));
    for (const [i, row] of this.robots) {
      const state = robotState(run, i, holders.has(i));
      const speed = run.robots[i] ? Math.hypot(run.robots[i].twist.vx, run.robots[i].twist.vy) : 0;
      if (row.dot!.className !== `dot ${state}`) row.dot!.className = `dot ${state}`;
      if (row.state.className !== `robot-state ${state}`) row.state.className = `robot-state ${state}`;
      setText(row.state, state === 'moving' ? `${fixed(speed, 2)} m/s` : state);
      row.element.classList.toggle('selected', sameEntity({kind: 'robot', index: i}, selected));
    }
  }

  private rebuild(run: Run, wanted: string): void {
    const all = run.world.robots.flatMap((robot, i) => robot.present ? [i] : []);
    const kinds = kindsOf(run).filter(([, things]) => things.length > 0);
    if (!kinds.some(([title]) => title === this.kind)) this.kind = ROBOTS;
    setText(byId('robot-count'), String(all.length));
    this.kinds.hidden = kinds.length === 0;
    this.kinds.replaceChildren(...[[ROBOTS, all.length] as const, ...kinds.map(([title, {length}]) => [title, length] as const)]
      .map(([title, count]) => this.makeChoice(title, count)));
    this.robots = new Map();
    this.things = new Map();
    this.list.replaceChildren();
    const isShown = (title: string): boolean => wanted !== '' || this.kind === title;
    if (isShown(ROBOTS)) this.addRobots(run, all.filter(i => run.world.robots[i].name.toLowerCase().includes(wanted)));
    for (const [title, things] of kinds) {
      const found = isShown(title) ? things.filter(({name}) => name.toLowerCase().includes(wanted)) : [];
      if (found.length > 0 && wanted !== '') this.list.append(make('h3', 'kind', title));
      this.addThings(found);
    }
  }

  private makeChoice(title: string, count: number): HTMLElement {
    const choice = make('button', 'small', title);
    choice.append(make('span', 'faint', ` ${count}`));
    choice.ariaPressed = String(title === this.kind);
    choice.onclick = () => {
      this.kind = title;
      this.search.value = '';
      this.host.refresh();
    };
    return choice;
  }

  private addRobots(run: Run, robots: number[]): void {
    for (const i of robots.slice(0, MOST_SHOWN)) {
      const row: Row = {element: make('button', 'robot'), dot: make('span', 'dot'), state: make('span', 'robot-state')};
      const swatch = make('span', 'swatch');
      swatch.style.background = robotColor(i);
      row.element.append(row.dot!, swatch, make('span', 'robot-name', run.world.robots[i].name), row.state);
      row.element.onpointermove = () => {
        row.element.title = this.host.hint(run.world.robots[i].name);
      };
      row.element.onclick = () => this.host.select({kind: 'robot', index: i});
      this.robots.set(i, row);
      this.list.append(row.element);
    }
    this.addRest(robots.length);
  }

  private addThings(things: Thing[]): void {
    for (const thing of things.slice(0, MOST_SHOWN)) {
      const row: Row = {element: make('button', 'robot'), dot: null, state: make('span', 'robot-state')};
      row.element.append(make('span', 'robot-name', thing.name), row.state);
      row.element.onclick = () => {
        if (thing.entity) this.host.select(thing.entity);
        else if (!thing.request) this.host.showLevel(thing.name);
        else if (this.run) this.host.send(...thing.request(this.run));
      };
      if (thing.title) row.element.title = thing.title;
      this.things.set(thing, row);
      this.list.append(row.element);
    }
    this.addRest(things.length);
  }

  private addRest(count: number): void {
    if (count > MOST_SHOWN) this.list.append(make('div', 'more', `and ${count - MOST_SHOWN} more: search by name`));
  }
}

// The kinds of things but robots, each with a title.
function kindsOf(run: Run): Array<[string, Thing[]]> {
  const {world} = run;
  const thing = (entity: Entity, text: (now: Run) => string, name = nameOf(world, entity)): Thing => ({name, entity, text});
  // A leaf and a cabin stand for the door and the lift that they belong to.
  const doors = world.doors.flatMap(({model, leaves}, i) => {
    const isThere = !world.models[model].removed && leaves.length > 0;
    return isThere ? [thing({kind: 'object', index: leaves[0].object}, now => doorText(now, i), world.models[model].name)] : [];
  });
  const lifts = world.lifts.flatMap(({model, cabin}, i) => world.models[model].removed ? [] :
    [thing({kind: 'object', index: cabin}, now => liftText(now, i), world.models[model].name)]);
  const parts = new Set([...world.doors.flatMap(({leaves}) => leaves.map(({object}) => object)), ...world.lifts.map(({cabin}) => cabin)]);
  const people = world.people.flatMap(({root}, i) => world.models[root].removed ? [] :
    [thing({kind: 'person', index: i}, now => personText(now, i))]);
  const objects = world.objects.flatMap((model, i) => world.models[model].removed || parts.has(i) ? [] :
    [thing({kind: 'object', index: i}, now => OBJECT_MODES[now.objects[i]?.mode] ?? '')]);
  const levels = world.levels.map(({name}, i): Thing => ({name, entity: null, text: (now, all) => levelText(now, all, i)}));
  const zones = world.zones.map(({name, kind}, i): Thing => ({
    name, entity: null, text: now => zoneText(now, i),
    // A one_way zone is a part of the lanes.
    ...ZONE_KINDS[kind] === 'one_way' ? {} : {
      title: 'Switch it on or off', request: (now: Run): [string, object] => ['zone', {name, on: !(now.zones[i]?.on ?? true)}],
    },
  }));
  return [['Doors', doors], ['Lifts', lifts], ['People', people], ['Objects', objects], ['Levels', levels.length > 1 ? levels : []],
    ['Zones', zones], ['Lanes', lanesOf(run)]];
}

// A row for all lanes between two vertices: a request is for all of them.
function lanesOf(run: Run): Thing[] {
  const things = new Map<string, Thing>();
  let number = 0;
  for (const {vertices, lanes} of run.world.laneGraphs) {
    const nameOfVertex = (vertex: number): string => vertices[vertex].name || `vertex ${vertex}`;
    const onward = new Map(lanes.map(({start, end}) => [start, end]));  // of waiting points
    for (const {start, end} of lanes) {
      const lane = number++;
      if (vertices[start].between) continue;  // a part of the lane before
      let last = end;
      while (vertices[last].between) last = onward.get(last) ?? start;
      const [from, to] = [nameOfVertex(start), nameOfVertex(last)];
      const name = `${from} - ${to}`;
      if (things.has(name) || things.has(`${to} - ${from}`)) continue;
      things.set(name, {
        name, entity: null, text: now => laneText(now, lane), title: 'Close it for robots, or open it again',
        request: now => ['lane', {from, to, speed_limit: limitOf(now, lane) === 0 ? -1 : 0}],
      });
    }
  }
  return [...things.values()];
}

function limitOf(run: Run, lane: number): number | undefined {
  return run.laneRules.find(rule => rule.lane === lane)?.speedLimit;
}

function laneText(run: Run, lane: number): string {
  const limit = limitOf(run, lane);
  return limit === undefined ? 'open' : limit === 0 ? 'closed' : `${fixed(limit, 2)} m/s`;
}

function zoneText(run: Run, zone: number): string {
  const {kind, speedLimit} = run.world.zones[zone];
  const effect = ZONE_KINDS[kind] === 'speed' ? `${fixed(speedLimit, 2)} m/s` : ZONE_KINDS[kind];
  return `${effect}, ${run.zones[zone]?.on ?? true ? 'on' : 'off'}`;
}

function personText(run: Run, person: number): string {
  const row = run.people[person];
  if (!row) return '';
  if (isAway(row.pose)) return 'away';
  const speed = Math.hypot(row.vx, row.vy);
  return row.dwellTicks > 0 ? 'waiting' : speed > 0.05 ? `${fixed(speed, 2)} m/s` : 'standing';
}

function levelText(run: Run, levels: Levels, level: number): string {
  const count = (rows: Array<{pose: {z: number}} | undefined>): number =>
    rows.filter(row => row && !isAway(row.pose) && levels.numberAt(row.pose.z) === level).length;
  const robots = count(run.robots.filter((_, i) => run.world.robots[i]?.present));
  const people = count(run.people.filter((_, i) => !run.world.models[run.world.people[i].root].removed));
  return [robots > 0 ? `${robots} robot${robots === 1 ? '' : 's'}` : '', people > 0 ? `${people} people` : '']
    .filter(text => text !== '').join(', ');
}
