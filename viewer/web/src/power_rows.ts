// The stores of energy and the lights of the selected robot, in its panel.
import {fixed, make, setText} from './dom';
import type {Light} from './protocol';
import {isInTree, type Run} from './run';

// Without the robot's name; `own`: of the robot's root itself.
function partName(run: Run, robot: number, model: number, own: string): string {
  const {name, root} = run.world.robots[robot];
  return model === root ? own : run.world.models[model].name.replace(`${name}.`, '');
}

export function energyText(joules: number): string {
  return joules >= 1000 ? `${fixed(joules / 1000, 2)} kJ` : `${fixed(joules, 1)} J`;
}

function lightText(run: Run, light: Light): string {
  if (!run.isSwitchedOn(light)) return 'switched off';
  const blinks = light.on > 0 && light.on < light.period;
  return `${run.isLit(light) ? 'on' : 'dark'}${blinks ? ', blinks' : ''}`;
}

export class PowerRows {
  private key = '';
  private stores: number[] = [];  // indices
  private lights: Light[] = [];

  constructor(private readonly parent: HTMLElement) {}

  show(run: Run, robot: number): void {
    const key = `${run.world.number} ${robot}`;
    if (key !== this.key) this.rebuild(run, robot);
    this.key = key;
    this.stores.forEach((store, i) => this.showStore(run, store, this.parent.children[i]));
    this.lights.forEach((light, i) => {
      const row = this.parent.children[this.stores.length + i];
      const [, dot, value] = [...row.children] as HTMLElement[];
      const color = run.world.models[light.model].color.slice(0, 3).map(c => Math.round(255 * c)).join(' ');
      const background = run.isLit(light) ? `rgb(${color})` : '';
      if (dot.style.backgroundColor !== background) dot.style.backgroundColor = background;
      setText(value, lightText(run, light));
    });
  }

  clear(): void {
    this.key = '';
    this.parent.replaceChildren();
  }

  private rebuild(run: Run, robot: number): void {
    const {root} = run.world.robots[robot];
    const isOf = (model: number): boolean => !run.world.models[model].removed && isInTree(run.world, model, root);
    this.stores = run.world.stores.flatMap(({model}, i) => (isOf(model) ? [i] : []));
    this.lights = run.world.lights.filter(({model}) => isOf(model));
    this.parent.replaceChildren();
    for (const store of this.stores) {
      const row = make('div', 'store');
      const name = partName(run, robot, run.world.stores[store].model, 'energy');
      row.append(make('span', 'joint-name', name), make('meter', 'joint-bar'), make('span', 'joint-value'));
      row.append(make('span', 'store-charge faint'));
      this.parent.append(row);
    }
    for (const {model} of this.lights) {
      const row = make('div', 'light');
      row.append(make('span', 'joint-name', partName(run, robot, model, 'light')), make('span', 'light-dot'), make('span', ''));
      this.parent.append(row);
    }
  }

  private showStore(run: Run, index: number, row: Element): void {
    const {capacity, endless} = run.world.stores[index];
    const {joules, chargeWatts} = run.stores[index] ?? {joules: 0, chargeWatts: 0};
    const [, bar, value, charge] = [...row.children] as [HTMLElement, HTMLMeterElement, HTMLElement, HTMLElement];
    const share = endless ? 1 : capacity > 0 ? joules / capacity : 0;
    bar.low = 0.2;
    if (Math.abs(bar.value - share) > 1e-4) bar.value = share;
    setText(value, endless ? 'endless' : energyText(joules));
    const charging = chargeWatts > 0 ? `charging with ${fixed(chargeWatts, 1)} W` : '';
    const of = endless ? '' : `of ${energyText(capacity)}`;
    setText(charge, [of, charging].filter(text => text !== '').join(', '));
  }
}
