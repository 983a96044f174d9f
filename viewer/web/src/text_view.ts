// The text of the file, in CodeMirror: a bundle of its own, which only the editor loads. Its styles are those of a shadow
// root, because the page allows no others than its own files.
import {autocompletion, completionKeymap, type Completion, type CompletionContext, type CompletionResult} from '@codemirror/autocomplete';
import {defaultKeymap, history, historyKeymap} from '@codemirror/commands';
import {json} from '@codemirror/lang-json';
import {bracketMatching, HighlightStyle, indentOnInput, StreamLanguage, syntaxHighlighting, type StringStream} from '@codemirror/language';
import {highlightSelectionMatches, search, searchKeymap} from '@codemirror/search';
import {EditorState, StateEffect, StateField, type Extension} from '@codemirror/state';
import {Decoration, drawSelection, EditorView, highlightActiveLine, highlightActiveLineGutter, keymap, lineNumbers, type DecorationSet} from '@codemirror/view';
import {tags} from '@lezer/highlight';

export interface TextSetting {
  kind: 'world' | 'include' | 'scenario';
  readOnly: boolean;
  words(): Completion[];  // names of properties, types and models
  colors(): string[];
  apply(): void;
  changed(): void;
}

// Stage's language: comments, texts, numbers, `define` and `include`, types before a bracket.
const stage = StreamLanguage.define<{}>({
  name: 'stage',
  token: (stream: StringStream): string | null => {
    if (stream.eatSpace()) return null;
    if (stream.match(/^#.*/)) return 'comment';
    if (stream.match(/^"[^"]*"?/)) return 'string';
    if (stream.match(/^[-+]?(\d+\.?\d*|\.\d+)/)) return 'number';
    if (stream.match(/^(define|include)\b/)) return 'keyword';
    if (stream.match(/^[A-Za-z_][\w.-]*(?=\s*\()/)) return 'typeName';
    if (stream.match(/^[A-Za-z_][\w.-]*/)) return 'propertyName';
    stream.next();
    return 'bracket';
  },
  languageData: {commentTokens: {line: '#'}},
});

const colors = HighlightStyle.define([
  {tag: tags.comment, color: 'var(--faint)', fontStyle: 'italic'},
  {tag: tags.string, color: 'var(--code-text)'},
  {tag: [tags.number, tags.bool, tags.null], color: 'var(--code-number)'},
  {tag: tags.keyword, color: 'var(--code-word)', fontWeight: '600'},
  {tag: tags.typeName, color: 'var(--code-type)', fontWeight: '600'},
  {tag: tags.propertyName, color: 'var(--text)'},
]);

const theme = EditorView.theme({
  '&': {height: '100%', color: 'var(--text)', backgroundColor: 'transparent', fontSize: '13px'},
  '&.cm-focused': {outline: 'none'},
  '.cm-scroller': {fontFamily: "ui-monospace, 'DejaVu Sans Mono', monospace", lineHeight: '1.5'},
  '.cm-content': {caretColor: 'var(--text)'},
  '.cm-cursor': {borderLeftColor: 'var(--text)'},
  '.cm-gutters': {backgroundColor: 'transparent', color: 'var(--faint)', border: 'none'},
  '.cm-activeLine, .cm-activeLineGutter': {backgroundColor: 'var(--code-line)'},
  '&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground': {
    backgroundColor: 'var(--accent-soft)',
  },
  '.cm-selectionMatch, .cm-searchMatch': {backgroundColor: 'var(--accent-soft)'},
  '.cm-searchMatch': {outline: '1px solid var(--accent)'},
  '.cm-errorLine': {backgroundColor: 'var(--code-error)'},
  '.cm-panels, .cm-tooltip': {backgroundColor: 'var(--menu)', color: 'var(--text)', border: '1px solid var(--line)'},
  '.cm-tooltip-autocomplete > ul > li[aria-selected]': {backgroundColor: 'var(--accent)', color: 'var(--on-accent)'},
  '.cm-textfield, .cm-button': {backgroundColor: 'transparent', backgroundImage: 'none', color: 'var(--text)', border: '1px solid var(--line)'},
});

const showError = StateEffect.define<number>();  // line; 0: none

const errorLine = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update: (marks, transaction) => {
    let next = marks.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(showError)) continue;
      const {doc} = transaction.state;
      next = effect.value < 1 || effect.value > doc.lines ? Decoration.none
        : Decoration.set([Decoration.line({class: 'cm-errorLine'}).range(doc.line(effect.value).from)]);
    }
    return next;
  },
  provide: field => EditorView.decorations.from(field),
});

export class TextView {
  private readonly view: EditorView;
  private readonly language: Extension[];

  constructor(parent: HTMLElement, private readonly setting: TextSetting) {
    const root = parent.shadowRoot ?? parent.attachShadow({mode: 'open'});
    const box = document.createElement('div');
    box.style.height = '100%';
    root.replaceChildren(box);
    this.language = setting.kind === 'scenario' ? [json()] : [stage];
    this.view = new EditorView({parent: box, root, state: this.stateOf('')});
  }

  private stateOf(text: string): EditorState {
    const {setting} = this;
    return EditorState.create({doc: text, extensions: [
      lineNumbers(), highlightActiveLineGutter(), highlightActiveLine(), drawSelection(), history(), bracketMatching(), indentOnInput(),
      highlightSelectionMatches(), search({top: true}), errorLine, theme, syntaxHighlighting(colors), ...this.language,
      autocompletion({override: [context => this.complete(context)]}),
      EditorState.readOnly.of(setting.readOnly),
      EditorView.contentAttributes.of({'aria-label': 'Text of the file', 'spellcheck': 'false', 'tabindex': '0'}),
      EditorView.updateListener.of(update => {
        if (update.docChanged) setting.changed();
      }),
      keymap.of([
        {key: 'Mod-Enter', run: () => {
          setting.apply();
          return true;
        }},
        ...completionKeymap, ...searchKeymap, ...historyKeymap, ...defaultKeymap,
      ]),
    ]});
  }

  // Names at the place of a name, colours in the text of a colour.
  private complete(context: CompletionContext): CompletionResult | null {
    const before = context.matchBefore(this.setting.kind === 'scenario' ? /"[\w ]*$/ : /[\w.-]+$|"[\w ]*$/);
    if (!before && !context.explicit) return null;
    const from = before?.from ?? context.pos;
    const isText = before?.text.startsWith('"') ?? false;
    const lead = context.state.sliceDoc(Math.max(0, from - 40), from);
    if (isText && /color"?:?\s*$/.test(lead)) {
      return {from: from + 1, options: this.setting.colors().map(label => ({label, type: 'constant'})), validFor: /^[\w ]*$/};
    }
    if (isText && this.setting.kind !== 'scenario') return null;
    const start = isText ? from + 1 : from;
    return {from: start, options: this.setting.words(), validFor: /^[\w.-]*$/};
  }

  get text(): string {
    return this.view.state.doc.toString();
  }

  // Begins a new history.
  open(text: string, line: number): void {
    this.view.setState(this.stateOf(text));
    this.show(line);
  }

  replace(text: string): void {
    this.view.dispatch({changes: {from: 0, to: this.view.state.doc.length, insert: text}});
  }

  show(line: number): void {
    const {doc} = this.view.state;
    const {from, to} = doc.line(Math.min(Math.max(1, line), doc.lines));
    this.view.dispatch({selection: {anchor: from, head: to}, effects: EditorView.scrollIntoView(from, {y: 'center'})});
    this.view.focus();
  }

  mark(line: number): void {
    this.view.dispatch({effects: showError.of(line)});
  }
}
