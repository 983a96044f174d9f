// Experiment: the values of a run that the page computes itself: its seed, and numbers and flags of its scenario. The
// run starts again with others. The badge tells the hash of each tick, so that a reader can compare runs of two
// machines.
import type {Connection, Scenario, ScenarioValue} from './connection';
import {byId, make, setText, toast} from './dom';
import type {Run} from './run';
import {Popup} from './toolbar';

const MOST_SEEDS = 1_000_000;  // from which another one is drawn

export class Experiment {
  private readonly box = byId<HTMLFormElement>('experiment');
  private readonly popup = new Popup(byId('experiment-open'), this.box);
  private readonly seed = byId<HTMLInputElement>('experiment-seed');
  private readonly error = byId('experiment-error');
  private readonly badge = byId('proof');
  private scenario: Scenario | null = null;
  private inputs = new Map<ScenarioValue, HTMLInputElement>();

  constructor(private readonly connection: Connection) {
    byId('experiment-open').onclick = () => this.popup.toggle();
    this.box.onsubmit = event => {
      event.preventDefault();
      void this.run();
    };
    byId('experiment-other').onclick = () => {
      this.seed.value = String(1 + Math.floor(MOST_SEEDS * Math.random()));
      void this.run();
    };
    byId('experiment-reset').onclick = () => this.fill([]);
  }

  // Of the run that begins.
  set(scenario: Scenario): void {
    this.scenario = scenario;
    byId('experiment-open').hidden = false;
    this.inputs = new Map(scenario.values.map((value): [ScenarioValue, HTMLInputElement] => [value, this.input(value)]));
    let of = '';
    const rows: HTMLElement[] = [];
    for (const [value, input] of this.inputs) {
      if (value.of !== of) rows.push(make('h3', '', value.of));
      of = value.of;
      const label = make('label', 'value');
      label.append(make('span', '', value.name), input);
      rows.push(label);
    }
    byId('experiment-values').replaceChildren(...rows);
    this.seed.value = String(scenario.seed);
    this.fill(scenario.changed);
  }

  show(run: Run): void {
    if (!this.scenario) return;
    this.badge.hidden = false;
    this.badge.classList.add('idle', 'hash');
    setText(this.badge, run.hash);
    this.badge.title = `The state hash of tick ${run.tick}. ${run.edition > 0
      ? 'The run was changed in this page.'
      : `troupe run --headless --ticks ${run.tick} --seed ${this.scenario.seed} has the same, on any machine.`}`;
  }

  private input(value: ScenarioValue): HTMLInputElement {
    const input = document.createElement('input');
    input.ariaLabel = `${value.of}: ${value.name}`;
    if (typeof value.value === 'boolean') {
      input.type = 'checkbox';
    } else {
      input.type = 'number';
      input.step = 'any';
      input.required = true;
      input.className = 'number';
    }
    return input;
  }

  private fill(changed: Array<[string, number | boolean]>): void {
    const others = new Map(changed);
    for (const [value, input] of this.inputs) {
      const shown = others.get(value.path) ?? value.value;
      if (typeof shown === 'boolean') input.checked = shown;
      else input.value = String(shown);
    }
    setText(this.error, '');
  }

  // Those that differ from the scenario's.
  private changed(): Array<[string, number | boolean]> {
    return [...this.inputs].flatMap(([{path, value}, input]): Array<[string, number | boolean]> => {
      const now = typeof value === 'boolean' ? input.checked : Number(input.value);
      return now === value ? [] : [[path, now]];
    });
  }

  private async run(): Promise<void> {
    const seed = Number(this.seed.value);
    const reply = await this.connection.runAgain(Number.isSafeInteger(seed) && this.seed.value !== '' ? seed : null, this.changed());
    setText(this.error, reply.done ? '' : reply.problem);
    if (!reply.done) return;
    toast(`The run starts again, with seed ${this.scenario?.seed ?? seed}`);
    this.popup.set(false);
  }
}
