// The part of the panel about a vehicle of VDA 5050: its order, what it does, and what is wrong.
import {byId, fixed, make} from './dom';
import type {VehicleState} from './vehicles';

interface Row {
  name: string;
  lines: Array<{text: string; gravity: '' | 'warning' | 'fault'; title: string}>;
}

const MOST = 12;  // lines of a row

function row(name: string, ...lines: string[]): Row {
  return {name, lines: lines.map(text => ({text, gravity: '', title: ''}))};
}

function names(nodes: VehicleState['nodes']): string {
  const shown = nodes.slice(0, MOST).map(({id}) => id).join(' → ');
  return nodes.length > MOST ? `${shown} → … (${nodes.length})` : shown;
}

// What is shown of a state, row by row.
export function vehicleRows(state: VehicleState): Row[] {
  const base = state.nodes.filter(({released}) => released);
  const horizon = state.nodes.filter(({released}) => !released);
  const does = [
    state.stopped ? 'emergency stop' : '', state.paused ? 'paused' : '', state.isBlocked ? 'something is in its way' : '',
    state.driving ? 'drives' : 'stands', state.wantsBase ? 'wants more base' : '',
  ].filter(each => each !== '').join(', ');
  const mode = row('mode', `${state.mode}, ${does}`);
  if (state.mode !== 'AUTOMATIC') mode.lines[0].gravity = 'warning';
  const rows = [
    mode,
    row('battery', `${fixed(state.battery, 0)} %${state.charging ? ', charging' : ''}`),
    row('order', state.order === '' ? 'none' : `${state.order}, update ${state.update}`),
    row('last node', state.lastNode === '' ? 'none' : state.lastNode),
    row('base', base.length > 0 ? names(base) : 'at its end'),
    ...(horizon.length > 0 ? [row('horizon', names(horizon))] : []),
    row('load', state.loads.length > 0 ? state.loads.join(', ') : 'none'),
  ];
  if (state.requests.length > 0) rows.push(row('zones', ...state.requests.slice(0, MOST)));
  if (state.actions.length > 0) {
    const open = state.actions.filter(({status}) => status !== 'FINISHED' && status !== 'FAILED');
    const ended = state.actions.filter(action => !open.includes(action));
    const shown = [...open.slice(0, MOST), ...ended.slice(-Math.max(0, MOST - open.length) || ended.length)].slice(0, MOST);
    rows.push({
      name: 'actions',
      lines: shown.map(({id, type, status, result}) => ({
        text: `${type} ${status}${result ? `: ${result}` : ''}`, gravity: status === 'FAILED' ? 'fault' : '', title: id,
      })),
    });
  }
  if (state.errors.length > 0) {
    rows.push({
      name: 'errors',
      lines: state.errors.slice(0, MOST).map(({type, level, text, references}) => ({
        text: `${type}${text ? `: ${text}` : ''}${references ? ` (${references})` : ''}`,
        gravity: level === 'WARNING' ? 'warning' : 'fault', title: level,
      })),
    });
  }
  return rows;
}

export class VehiclePanel {
  private readonly list = byId('panel-vehicle');
  private shown = '';

  // null: the selected thing is no vehicle, or has sent nothing yet.
  show(state: VehicleState | null): void {
    const rows = state ? vehicleRows(state) : [];
    const key = JSON.stringify(rows);
    if (key === this.shown) return;
    this.shown = key;
    this.list.replaceChildren(...rows.flatMap(({name, lines}) => {
      const cell = make('dd', '');
      for (const {text, gravity, title} of lines) {
        const line = make('div', gravity, text);
        line.title = title;
        cell.append(line);
      }
      return [make('dt', '', name), cell];
    }));
    this.list.hidden = rows.length === 0;
  }
}
