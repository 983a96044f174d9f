// FilePanel: the properties of the selected entity, or of the file itself.
import {byId, setText} from './dom';
import {stageController, type ControllerTarget} from './controller_form';
import {placeText, type EditorHelp, type EntityReport, type FileClient, type FileDocument, type HelpRow} from './file_client';
import type {Waypoints} from './waypoint_drawing';
import {showProperties, type PropertyTarget, type ShownProperty} from './property_rows';

export interface FilePanelHost {
  help(): EditorHelp;
  refresh(): Promise<void>;
  renamed(name: string): void;
  // In the picture.
  drawWaypoints(from: [number, number], done: (waypoints: Waypoints) => void): void;
}

export class FilePanel {
  constructor(
      private readonly client: FileClient, private readonly host: FilePanelHost, private readonly viewOnly: boolean) {}

  showEntity(file: FileDocument, report: EntityReport): void {
    const locked = report.refusal !== '' || this.viewOnly;
    setText(byId('file-panel-name'), report.name);
    setText(byId('file-panel-type'), report.model);
    setText(byId('file-panel-place'), report.refusal || placeText(report.where));
    const isScenario = file.kind === 'scenario';
    const shown = report.properties.map(({name, value, own, where, warning}) => ({name, value, own, warning, from: placeText(where)}));
    const set = async (property: string, value: string | null): Promise<void> => {
      if (isScenario && property === 'pose' && value !== null) {
        await this.setPose(report, value);
      } else {
        const done = await this.client.edit('set_property', {name: report.name, property, value});
        if (done.done && property === 'name' && value) this.host.renamed(value.replace(/"/g, ''));
      }
      await this.host.refresh();
    };
    const units = {metres: file.metres ?? 1, radians: file.radians ?? Math.PI / 180};
    const target: PropertyTarget = {types: ['*', report.base_type], locked, of: report.name, units, set};
    if (report.controller) {
      const ctrl = report.properties.find(({name}) => name === 'ctrl');
      target.controller = isScenario ? this.scenarioController(report, locked)
        : stageController((ctrl?.value ?? '').replace(/^"|"$/g, ''), ctrl?.own ?? true, locked, this.host.help(),
                          value => set('ctrl', value ?? (ctrl?.own ? null : '"idle"')), this.drawFrom(report));
    }
    showProperties(byId('file-properties'), isScenario ? this.inMetres(shown, report) : shown, this.host.help(), target);
  }

  private drawFrom({pose: [x, y]}: EntityReport): ControllerTarget['draw'] {
    return done => this.host.drawWaypoints([x, y], done);
  }

  // A scenario's poses are in metres and degrees, and may leave out z.
  private inMetres(shown: ShownProperty[], {pose: [x, y, z, heading]}: EntityReport): ShownProperty[] {
    const number = (value: number, digits: number): string => String(Number(value.toFixed(digits)));
    const value = `[${[x, y, z].map(each => number(each, 4)).join(' ')} ${number((heading * 180) / Math.PI, 3)}]`;
    return shown.map(property => (property.name === 'pose' ? {...property, value} : property));
  }

  private async setPose(report: EntityReport, value: string): Promise<void> {
    const [x, y, z, heading] = value.replace(/[[\]]/g, ' ').trim().split(/\s+/).map(Number);
    await this.client.edit('set_pose', {name: report.name, pose: [x, y, z, (heading * Math.PI) / 180]});
  }

  private scenarioController(report: EntityReport, locked: boolean): ControllerTarget {
    const {name, parameters: given, own} = report.controller!;
    const parameters = given ?? {};
    const edit = async (key: string, value: unknown, inside: string[] = []): Promise<void> => {
      await this.client.edit('set_member', {name: report.name, key, inside, value});
      await this.host.refresh();
    };
    return {
      shown: {name: own || name !== 'idle' ? name : '', parameters, own}, locked, isStage: false, draw: this.drawFrom(report),
      choose: async chosen => {
        if (chosen === null) return edit('controller', own ? null : 'idle');
        const needed = this.host.help().controllers.find(each => each.name === chosen)?.parameters.filter(each => each.needed) ?? [];
        const initial = Object.fromEntries(needed.map(each => [each.name, each.initial]));
        await edit('controller', needed.length > 0 ? {name: chosen, parameters: initial} : chosen);
      },
      set: async (key, value) => {
        if (own && Object.keys(parameters).length > 0) return edit(key, value, ['controller', 'parameters']);
        const next = {...parameters, [key]: value};
        if (value === null) delete next[key];
        await edit('controller', Object.keys(next).length > 0 ? {name, parameters: next} : name);
      },
    };
  }

  showFile(file: FileDocument): void {
    setText(byId('file-panel-name'), file.file.split('/').pop() ?? '');
    setText(byId('file-panel-type'), file.kind);
    setText(byId('file-panel-place'), file.file);
    const box = byId('file-properties');
    const help = this.host.help();
    const base = {locked: this.viewOnly, of: file.file, units: {metres: 1, radians: Math.PI / 180}};
    if (file.kind !== 'scenario') {
      showProperties(box, file.properties.map(each => ({...each, own: true})), help, {
        ...base, types: ['world'],
        set: async (property, value) => {
          await this.client.edit('set_property', {property, value});
          await this.host.refresh();
        },
      });
      return;
    }
    // The plain members of a scenario, with the help of its schema.
    const rows = Object.entries(help.schema?.properties ?? {}).filter(([key]) => key !== '$schema').map(([key, {description}]): HelpRow => ({
      type: 'scenario', name: key, form: '', unit: '', initial: '', help: description ?? '',
    }));
    const members = Object.entries(file.members).map(([name, value]) => ({name, value: JSON.stringify(value), own: true}));
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
        await this.client.edit('set_member', {key, value});
        await this.host.refresh();
      },
    });
  }
}
