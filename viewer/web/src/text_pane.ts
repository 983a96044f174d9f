// TextPane: the whole text of the file beside its picture. The text is edited in a TextView, which is loaded at first use.
// The text and the picture are two views of one document at the server: a typed text counts once it is applied. When the
// file changes elsewhere, an unchanged text follows it, and a changed one stays, so that nothing that was typed is lost.
import {byId, setText, toast} from './dom';
import type {EditorHelp, FileClient, FileDocument, PaletteRow} from './file_client';
import type {TextView} from './text_view';

export interface TextPaneHost {
  file(): FileDocument | null;
  help(): EditorHelp;
  palette(): PaletteRow[];
  selectedLine(): number;  // in this file; 0: none
  refresh(): Promise<void>;
}

const BUNDLE = '/text_view.js';

export class TextPane {
  private view: TextView | null = null;
  private applied = '';  // the text as the file has it
  private endOfLine = '\n';
  private readonly box = byId('text-editor');

  constructor(
      private readonly client: FileClient, private readonly host: TextPaneHost, private readonly viewOnly: boolean) {
    byId('text-close').onclick = () => this.close();
    byId('text-apply').onclick = () => void this.apply();
    byId('text-apply').hidden = viewOnly;
    // The page's keys are not for a text that is typed here.
    this.box.addEventListener('keydown', event => {
      if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === 's') return;
      event.stopPropagation();
    });
  }

  get isOpen(): boolean {
    return !this.box.hidden;
  }
  get isChanged(): boolean {
    return this.isOpen && this.view !== null && this.view.text !== this.applied;
  }
  get text(): string | null {
    return this.isOpen ? this.view?.text ?? null : null;
  }

  set(text: string): void {
    this.view?.replace(text);
  }

  async open(): Promise<void> {
    const reply = await this.client.edit('text');
    const file = this.host.file();
    if (!reply.done || !file) return;
    if (!this.view) {
      const {TextView} = await import(BUNDLE) as typeof import('./text_view');
      this.view = new TextView(byId('text-area'), {
        kind: file.kind, readOnly: this.viewOnly, words: () => this.words(), colors: () => Object.keys(this.host.help().colors),
        apply: () => void this.apply(), changed: () => this.showState(),
      });
    }
    const text = reply.text as string;
    this.endOfLine = text.includes('\r\n') ? '\r\n' : '\n';
    this.applied = text.replace(/\r\n/g, '\n');
    setText(byId('text-name'), file.file.split('/').pop() ?? '');
    byId('text-name').title = file.file;
    this.box.hidden = false;
    this.view.open(this.applied, file.error_place?.line || this.host.selectedLine() || 1);
    this.markError();
    this.showState();
  }

  // The file has been changed elsewhere: an unchanged text follows.
  async follow(): Promise<void> {
    this.markError();
    if (!this.isOpen || !this.view || this.isChanged) return;
    const reply = await this.client.ask('text');
    if (!reply.done || this.isChanged) return;
    const text = (reply.text as string).replace(/\r\n/g, '\n');
    if (text === this.applied) return;
    this.applied = text;
    this.view.replace(text);
    this.showState();
  }

  private close(): void {
    if (this.isChanged && !window.confirm('The text has changes that are not applied. Close it without them?')) return;
    this.box.hidden = true;
  }

  // True if the file has the text, perhaps with an error.
  async apply(): Promise<boolean> {
    if (!this.view || this.viewOnly) return true;
    const text = this.view.text;
    const written = this.endOfLine === '\r\n' ? text.replace(/\n/g, '\r\n') : text;
    const reply = await this.client.edit('set_text', {text: written});
    if (reply.done) this.applied = text;
    await this.host.refresh();
    this.showState();
    if (!reply.done) return false;
    if (!reply.error) {
      toast('The text is applied');
      this.view.mark(0);
      return true;
    }
    this.markError();
    const line = this.errorLine();
    if (line > 0) this.view.show(line);
    return true;
  }

  private errorLine(): number {
    const file = this.host.file();
    return file?.error && file.error_place?.file === file.file ? file.error_place.line : 0;
  }

  private markError(): void {
    if (this.isOpen) this.view?.mark(this.errorLine());
  }

  private showState(): void {
    setText(byId('text-state'), this.isChanged ? 'changed' : '');
    byId('text-apply').classList.toggle('strong', this.isChanged);
  }

  private words(): Array<{label: string; type: string; detail?: string; info?: string}> {
    const {properties, controllers} = this.host.help();
    const file = this.host.file();
    const seen = new Set<string>();
    const names = properties.filter(({name}) => !seen.has(name) && seen.add(name)).map(({name, type, unit, help}) => ({
      label: name, type: 'property', detail: unit || (type === '*' ? '' : type), info: help,
    }));
    const types = [...new Set(properties.map(({type}) => type))].filter(type => type !== '*' && type !== 'world')
      .map(label => ({label, type: 'class'}));
    const models = this.host.palette().filter(row => !row.library).map(({name}) => ({label: name, type: 'class', detail: 'model'}));
    if (file?.kind !== 'scenario') return [...names, ...types, ...models, {label: 'define', type: 'keyword'}, {label: 'include', type: 'keyword'}];
    const keys = Object.entries(this.host.help().schema?.properties ?? {}).map(([label, {description}]) => ({
      label, type: 'keyword', info: description,
    }));
    const entry = ['model', 'pose', 'parameters', 'children', 'match', 'region', 'count'].map(label => ({label, type: 'keyword'}));
    return [...keys, ...entry, ...names, ...models, ...controllers.map(({name, help}) => ({label: name, type: 'function', info: help}))];
  }
}
