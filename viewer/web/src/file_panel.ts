// FilePanel: the properties of the selected entity, or of the file itself.
import {byId, refill, setText} from './dom';
import {showController, stageController, type ControllerTarget} from './controller_form';
import {installFailures, keepFailures} from './failures';
import {placeText, type EditorHelp, type EntityReport, type FileClient, type FileDocument, type HelpRow} from './file_client';
import type {Waypoints} from './waypoint_drawing';
import {showProperties, type PropertyTarget, type ShownProperty} from './property_rows';
import {listForm, objectFields, openGroup, resolved, type FormHost, type Path, type Schema} from './value_forms';

export interface FilePanelHost {
  help(): EditorHelp;
  refresh(): Promise<void>;
  renamed(name: string): void;
  // In the picture.
  drawWaypoints(from: [number, number], done: (waypoints: Waypoints) => void, single?: boolean): void;
  models(): string[];
  places(): string[];  // of the scenario
}

const PLAIN = ['string', 'number', 'integer', 'boolean'];
const FIRST = ['robots', 'models', 'spawn', 'people', 'zones', 'places', 'regions', 'flows', 'events'];
const OF_TESTS = ['scenario', 'vary', 'where', 'design', 'expect', 'cover', 'metrics', 'heat'];

export class FilePanel {
  constructor(
      private readonly client: FileClient, private readonly host: FilePanelHost, private readonly viewOnly: boolean) {}

  showEntity(file: FileDocument, report: EntityReport): void {
    byId('file-lists').hidden = true;
    const locked = report.refusal !== '' || this.viewOnly;
    setText(byId('file-panel-name'), report.name);
    setText(byId('file-panel-type'), report.model);
    setText(byId('file-panel-place'), report.refusal || placeText(report.where));
    const isScenario = file.kind === 'scenario';
    const shown = report.properties.map(({name, value, own, where, warning}) => ({name, value, own, warning, from: placeText(where)}));
    const set = async (property: string, value: string | null): Promise<string> => {
      if (isScenario && property === 'pose' && value !== null) return this.setPose(report, value);
      const {done, problem} = await this.client.edit('set_property', {name: report.name, property, value});
      if (done && property === 'name' && value) this.host.renamed(value.replace(/"/g, ''));
      return done ? '' : problem;
    };
    const units = {metres: file.metres ?? 1, radians: file.radians ?? Math.PI / 180};
    const target: PropertyTarget = {types: ['*', report.base_type], locked, of: report.name, units, set, changed: () => this.host.refresh()};
    if (report.controller) {
      const ctrl = report.properties.find(({name}) => name === 'ctrl');
      target.controller = isScenario ? this.scenarioController(report, locked)
        : stageController((ctrl?.value ?? '').replace(/^"|"$/g, ''), report.name, ctrl?.own ?? true, locked, this.host.help(),
                          value => set('ctrl', value ?? (ctrl?.own ? null : '"idle"')), this.drawFrom(report));
    }
    showProperties(byId('file-properties'), isScenario ? this.inMetres(shown, report) : shown, this.host.help(), target);
  }

  // Opens parts of the lists of a scenario.
  open(...paths: Path[]): void {
    for (const path of paths) openGroup(path);
    delete byId('file-lists').dataset.signature;
  }

  private drawFrom({pose: [x, y]}: EntityReport): ControllerTarget['draw'] {
    return (done, single) => this.host.drawWaypoints([x, y], done, single);
  }

  // A scenario's poses are in metres and degrees, and may leave out z.
  private inMetres(shown: ShownProperty[], {pose: [x, y, z, heading]}: EntityReport): ShownProperty[] {
    const number = (value: number, digits: number): string => String(Number(value.toFixed(digits)));
    const value = `[${[x, y, z].map(each => number(each, 4)).join(' ')} ${number((heading * 180) / Math.PI, 3)}]`;
    return shown.map(property => (property.name === 'pose' ? {...property, value} : property));
  }

  private async setPose(report: EntityReport, value: string): Promise<string> {
    const [x, y, z, heading] = value.replace(/[[\]]/g, ' ').trim().split(/\s+/).map(Number);
    const {done, problem} = await this.client.edit('set_pose', {name: report.name, pose: [x, y, z, (heading * Math.PI) / 180]});
    return done ? '' : problem;
  }

  private scenarioController(report: EntityReport, locked: boolean): ControllerTarget {
    const {name, parameters, own} = report.controller!;
    return this.controllerAt([], report.name, {name: own || name !== 'idle' ? name : '', parameters: parameters ?? {}, own}, locked, this.drawFrom(report));
  }

  // The member `controller` of an object of the scenario. `at`: the path of the object, from the entry of `entity`, or from the
  // scenario if that is ''.
  private controllerAt(
      at: Path, entity: string, shown: ControllerTarget['shown'], locked: boolean, draw?: ControllerTarget['draw']): ControllerTarget {
    const {name, parameters, own} = shown;
    const edit = async (more: Path, value: unknown): Promise<string> => {
      const {done, problem} = await this.client.edit('set_value', {...(entity ? {name: entity} : {}), path: [...at, 'controller', ...more], value});
      return done ? '' : problem;
    };
    return {
      shown, locked, of: entity || at.join('.'), isStage: false, draw,
      choose: async chosen => {
        if (chosen === null) return edit([], own ? null : 'idle');
        const needed = this.host.help().controllers.find(each => each.name === chosen)?.parameters.filter(each => each.needed) ?? [];
        const initial = Object.fromEntries(needed.map(each => [each.name, each.initial]));
        return edit([], needed.length > 0 ? {name: chosen, parameters: initial} : chosen);
      },
      set: async (key, value) => {
        if (own && Object.keys(parameters).length > 0) return edit(['parameters', key], value);
        const next = {...parameters, [key]: value};
        if (value === null) delete next[key];
        return edit([], Object.keys(next).length > 0 ? {name, parameters: next} : name);
      },
    };
  }

  private formHost(): FormHost {
    const set = async (path: Path, value: unknown): Promise<string> => {
      const {done, problem} = await this.client.edit('set_value', {path, value});
      if (done) delete byId('file-lists').dataset.signature;
      await this.host.refresh();
      return done ? '' : problem;
    };
    return {
      schema: this.host.help().schema ?? {}, locked: this.viewOnly, set,
      choices: definition => (definition === 'model_name' ? this.host.models() : definition === 'place_name' ? this.host.places() : []),
      controllerForm: (path, value) => {
        const {name = '', parameters = {}} = typeof value === 'string' ? {name: value} : (value ?? {}) as {name?: string; parameters?: Record<string, unknown>};
        const target = this.controllerAt(path.slice(0, -1), '', {name, parameters, own: value !== undefined}, this.viewOnly);
        const changed = async (change: Promise<string>): Promise<string> => {
          const problem = await change;
          if (problem === '') delete byId('file-lists').dataset.signature;
          await this.host.refresh();
          return problem;
        };
        return showController({
          ...target, choose: chosen => changed(target.choose(chosen)), set: (key, next) => changed(target.set(key, next)),
        }, this.host.help());
      },
    };
  }

  // The lists and objects of a scenario.
  private showLists(file: FileDocument): void {
    const box = byId('file-lists');
    const schema: Schema = this.host.help().schema ?? {};
    box.hidden = false;
    const active = document.activeElement;
    if (active instanceof HTMLInputElement && box.contains(active) && (active.dataset.shown ?? active.value) !== active.value
        && !active.classList.contains('wrong')) return;
    const signature = JSON.stringify([file.members, file.more, this.host.models(), this.viewOnly, Boolean(schema.properties)]);
    if (box.dataset.signature === signature) return;
    if (box.dataset.signature === undefined && !box.dataset.installed) {
      box.dataset.installed = 'true';
      installFailures(box, () => 'scenario', () => {
        delete box.dataset.signature;
        void this.host.refresh();
      });
    }
    box.dataset.signature = signature;
    const focused = active instanceof HTMLElement && box.contains(active) ? [active.dataset.path, active.dataset.parameter, active.dataset.add] : null;
    const keys = Object.keys(schema.properties ?? {});
    const ordered = [...FIRST, ...keys.filter(key => !FIRST.includes(key) && !OF_TESTS.includes(key)), ...OF_TESTS];
    const host = this.formHost();
    const forms = ordered.flatMap(key => {
      const member = schema.properties?.[key];
      if (!member) return [];
      const {type} = resolved(member, schema);
      const value = file.members[key];
      const isList = type === 'array' || Array.isArray(value);
      if (isList) return [listForm([key], type === 'array' ? member : {...member, items: resolved(member, schema).items}, Array.isArray(value) ? value : [], file.more[key] ?? 0, host)];
      const isShown = value !== undefined || key === 'controller';
      return [type].flat().every(each => PLAIN.includes(String(each))) || !isShown ? []
        : objectFields([], {...schema, properties: {[key]: member}, required: []}, value === undefined ? {} : {[key]: value}, host);
    });
    refill(box, forms);
    keepFailures(box, 'scenario');
    if (!focused) return;
    [...box.querySelectorAll<HTMLElement>('[data-path], [data-parameter], [data-add]')].find(
      each => [each.dataset.path, each.dataset.parameter, each.dataset.add].every((value, i) => value === focused[i]))?.focus();
  }

  showFile(file: FileDocument): void {
    setText(byId('file-panel-name'), file.file.split('/').pop() ?? '');
    setText(byId('file-panel-type'), file.kind);
    setText(byId('file-panel-place'), file.file);
    const box = byId('file-properties');
    const help = this.host.help();
    const base = {locked: this.viewOnly, of: file.file, units: {metres: 1, radians: Math.PI / 180}, changed: () => this.host.refresh()};
    byId('file-lists').hidden = true;
    if (file.kind !== 'scenario') {
      showProperties(box, file.properties.map(each => ({...each, own: true})), help, {
        ...base, types: ['world'],
        set: async (property, value) => {
          const {done, problem} = await this.client.edit('set_property', {property, value});
          return done ? '' : problem;
        },
      });
      return;
    }
    // The plain members of a scenario, with the help of its schema, and its lists.
    const schema = help.schema ?? {};
    const isPlain = (key: string): boolean => [resolved(schema.properties?.[key] ?? {}, schema).type].flat().every(type => PLAIN.includes(String(type)));
    const rows = Object.entries(schema.properties ?? {}).filter(([key]) => key !== '$schema' && isPlain(key) && !OF_TESTS.includes(key)).map(([key, {description}]): HelpRow => ({
      type: 'scenario', name: key, form: resolved(schema.properties![key], schema).type === 'string' ? 'text' : '', unit: '', initial: '', help: description ?? '',
    }));
    const members = Object.entries(file.members).filter(([key, value]) => rows.some(row => row.name === key) && typeof value !== 'object')
      .map(([name, value]) => ({name, value: JSON.stringify(value), own: true}));
    this.showLists(file);
    showProperties(box, members, {...help, properties: rows}, {
      ...base, types: ['scenario'],
      set: async (key, text) => {
        let value: unknown = null;
        if (text !== null) {
          try {
            value = JSON.parse(text);
          } catch {
            value = text;
          }
        }
        const {done, problem} = await this.client.edit('set_value', {path: [key], value});
        return done ? '' : problem;
      },
    });
  }
}
