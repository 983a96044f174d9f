// The button Download of a page without a server: saves what it shows as files for `troupe run` or `troupe view`.
import type {Scenario} from './connection';
import {byId, toast} from './dom';
import {saveBlob} from './graphics';
import {hasContent, readContent} from './static_content';
import {zipFile} from './zip_file';

// Where the page has the files of its scenario; those of the installation are elsewhere, and the reader has them.
const OWN_FOLDER = '/home/';

export class Download {
  private scenario: Scenario | null = null;

  constructor() {
    byId('download').hidden = !hasContent();
    byId('run-tools').hidden = !hasContent();
    byId('download').onclick = () => void this.save();
  }

  // Of the run that the page computes, with the values that were changed.
  set(scenario: Scenario): void {
    this.scenario = scenario;
  }

  private async save(): Promise<void> {
    const {file, files} = await readContent();
    const name = file.slice(file.lastIndexOf('/') + 1);
    if (!this.scenario) {
      saveBlob(new Blob([files.get(file)!]), name);
      toast(`troupe view ${name} shows it, troupe replay ${name} steps it again`);
      return;
    }
    const stem = name.replace(/\..*/, '');
    const saved = new Map<string, Uint8Array>();
    for (const [path, bytes] of files) {
      if (!path.startsWith(OWN_FOLDER)) continue;
      saved.set(`${stem}/${path.slice(OWN_FOLDER.length)}`, path === file ? new TextEncoder().encode(this.scenario.text) : bytes);
    }
    saveBlob(zipFile(saved), `${stem}.zip`);
    toast(`unzip ${stem}.zip; troupe run ${stem}/${file.slice(OWN_FOLDER.length)} --seed ${this.scenario.seed}`);
  }
}
