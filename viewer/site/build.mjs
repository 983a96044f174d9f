// Writes the site: a static folder with the documents, the references, and pages that simulate in the browser. It opens
// from the disk and from any web server, and asks for nothing beside itself.
//   node build.mjs ROOT OUTPUT PROGRAM XML_FOLDER MODULE
// PROGRAM: troupe. XML_FOLDER: of Doxygen. MODULE: the folder of the WebAssembly module; empty: no page simulates.
import {execFileSync} from 'node:child_process';
import {copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync, statSync, writeFileSync} from 'node:fs';
import {dirname, join, posix} from 'node:path';
import {makeLivePages} from './live_pages.mjs';
import {escape, render} from './markdown.mjs';

const [root, output, program, xmlFolder, module] = process.argv.slice(2);
if (module === undefined) {
  console.error('error: found too few arguments, expected ROOT OUTPUT PROGRAM XML_FOLDER MODULE');
  process.exit(2);
}
const own = new URL('.', import.meta.url).pathname;
const contents = JSON.parse(readFileSync(join(own, 'contents.json'), 'utf8'));
const references = JSON.parse(execFileSync('python3', [join(own, 'references.py'), root, xmlFolder, program],
  {encoding: 'utf8', maxBuffer: 64 << 20}));
const live = module === '' ? [] : makeLivePages(contents.live, {root, output, program, module});
const PICTURES = /\.(png|gif|svg|jpg)$/;
const MOST_SOURCE_BYTES = 200_000;

function write(path, content) {
  const file = join(output, path);
  mkdirSync(dirname(file), {recursive: true});
  writeFileSync(file, content);
}

// Pages of documents by their paths in the tree.
const documents = new Map([['README.md', 'index.html']]);
for (const name of readdirSync(join(root, 'docs')).filter(each => each.endsWith('.md')).sort()) {
  documents.set(`docs/${name}`, name === 'README.md' ? 'docs/about.html' : `docs/${name.slice(0, -3)}.html`);
}
const listed = new Set(contents.groups.flatMap(group => group.pages));
for (const path of documents.keys()) {
  const name = path.match(/^docs\/(.*)\.md$/)?.[1];
  if (name && name !== 'README' && !listed.has(name)) {
    throw new Error(`viewer/site/contents.json: found no page ${name}, expected each of docs in one group`);
  }
}

// Files of the tree that the documents link: pictures are copied, texts become pages, a folder is shown by its README or as
// a list.
const sources = new Map();
const pictures = new Set();

function target(from, href) {
  if (/^[a-z]+:/i.test(href) || href.startsWith('#')) return href;
  const [path, fragment] = href.split('#');
  const file = posix.normalize(posix.join(posix.dirname(from.source), path)).replace(/\/$/, '');
  if (!existsSync(join(root, file))) throw new Error(`${from.source}: the link ${href} leads to no file`);
  let to;
  if (documents.has(file)) to = documents.get(file);
  else if (PICTURES.test(file)) {
    pictures.add(file);
    to = `pictures/${posix.basename(file)}`;
  } else to = sourcePage(file);
  return posix.relative(posix.dirname(from.path), to) + (fragment ? `#${fragment}` : '');
}

function sourcePage(file) {
  if (!sources.has(file)) sources.set(file, file.endsWith('.md') ? `source/${file.slice(0, -3)}.html` : `source/${file}.html`);
  return sources.get(file);
}

const up = path => posix.relative(posix.dirname(path), '.') || '.';
const titles = new Map();  // of documents, by page

function navigation(path) {
  const link = (to, title) => {
    const here = to === path ? ' aria-current="page"' : '';
    return `<li><a href="${escape(posix.relative(posix.dirname(path), to))}"${here}>${escape(title)}</a></li>`;
  };
  const groups = contents.groups.map(group => [group.title, group.pages.map(name => [`docs/${name}.html`, titles.get(`docs/${name}.html`)])]);
  for (const page of references) {
    let group = groups.find(([title]) => title === page.group);
    if (!group) groups.push(group = [page.group, []]);
    group[1].push([page.path, page.title]);
  }
  return `<ul class="first">${link('index.html', 'Start')}${link('live/index.html', 'Run it in the browser')}</ul>` + groups.map(([title, pages]) => {
    const open = pages.some(([to]) => to === path) || path === 'index.html' && title === 'First steps' ? ' open' : '';
    return `<details${open}><summary>${escape(title)}</summary><ul>${pages.map(([to, name]) => link(to, name)).join('')}</ul></details>`;
  }).join('\n');
}

function tableOfContents(sections) {
  const shown = sections.filter(({level, anchor}) => anchor && level === 2);
  if (shown.length < 3) return '';
  return `<nav class="toc" aria-label="On this page"><h2>On this page</h2><ul>${
    shown.map(({anchor, title}) => `<li><a href="#${anchor}">${escape(title)}</a></li>`).join('')}</ul></nav>`;
}

function page({path, title, html, sections = [], kind = ''}) {
  const base = up(path);
  return `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>${escape(title === 'Troupe' ? 'Troupe: a simulator of many mobile robots' : `${title} · Troupe`)}</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="${base}/site.css">
<script src="${base}/theme.js"></script>
</head>
<body class="${kind}" data-base="${base}">
<a class="skip" href="#content">To the content</a>
<header>
<button id="menu" aria-expanded="false" aria-controls="navigation" aria-label="Contents">☰</button>
<a class="name" href="${base}/index.html">Troupe</a>
<div role="search"><input id="search" type="search" placeholder="Search" aria-label="Search the site" autocomplete="off" role="combobox" aria-expanded="false" aria-controls="found" aria-autocomplete="list"><ul id="found" role="listbox" aria-label="Found" hidden></ul></div>
<button id="theme" aria-label="Light or dark" title="Light or dark">◐</button>
</header>
<nav id="navigation" aria-label="Contents">
${navigation(path)}
</nav>
<main id="content" tabindex="-1">
<article>
${html}
</article>
${kind === 'start' ? '' : tableOfContents(sections)}
</main>
<script src="${base}/site.js"></script>
</body>
</html>
`;
}

const index = [];  // of the search: [page, title of the page, [[anchor, title, text], ...]]

function add(rendered) {
  write(rendered.path, page(rendered));
  index.push([rendered.path, rendered.title, rendered.sections.map(({anchor, title, text}) => [anchor, title, text])]);
}

const documentPages = [...documents].filter(([source]) => source !== 'README.md').map(([source, path]) => {
  const from = {source, path};
  const rendered = render(readFileSync(join(root, source), 'utf8'), href => target(from, href));
  titles.set(path, rendered.title);
  return {...rendered, path};
});

// The README is the start page: its picture is in front, and runs.
function startPage() {
  const from = {source: 'README.md', path: 'index.html'};
  const text = readFileSync(join(root, 'README.md'), 'utf8');
  const [, introduction, picture, rest] = text.match(/^# Troupe\n([\s\S]*?)\n\[?(!\[[^\]]*\]\([^)]*\))[^\n]*\n([\s\S]*)$/);
  const show = part => render(part, href => target(from, href));
  const {html, sections} = show(rest);
  const first = live[0];
  const hero = `<h1>Troupe</h1>
<div class="lead">${show(introduction).html}</div>
<figure class="hero"${first ? ` data-live="${first.page}"` : ''}>${show(picture).html.replace(/<\/?p>/g, '').replace(' loading="lazy"', '')}
${first ? `<figcaption><a class="button" id="run-here" href="${first.page}">Run it in this page</a><a href="live/index.html">${live.length} pages that simulate</a></figcaption>` : ''}</figure>
${cards('index.html')}`;
  sections[0] = {anchor: '', title: 'Troupe', level: 1, text: introduction};
  return {path: 'index.html', title: 'Troupe', html: hero + html, sections, kind: 'start'};
}

function cards(path) {
  if (live.length === 0) return '';
  const to = each => escape(posix.relative(posix.dirname(path), each));
  return `<ul class="cards">${live.map(each => `<li><a href="${to(each.page)}"><img src="${to(each.picture)}" alt="" loading="lazy"><strong>${escape(each.title)}</strong></a><p>${escape(each.text)}</p>${
    path === 'index.html' ? '' : `<p class="try">${escape(each.try)}</p><p>${each.links.map(([title, link]) => `<a href="${to(link)}">${escape(title)}</a>`).join(' · ')}</p>`}</li>`).join('\n')}</ul>`;
}

function livePage() {
  const introduction = live.length === 0
    ? 'This site was built without the WebAssembly module, so that it has no pages that simulate (scripts/build-module).'
    : 'Each page is one file with the simulation as a WebAssembly module. It steps in this browser, with the state hashes of <code>troupe run</code>, and asks no server for anything. '
      + 'Pause it, change it, run it again with other values, and download what you see as files for <code>troupe run</code>.';
  const text = live.map(each => `${each.title}: ${each.text} ${each.try}`).join(' ');
  return {path: 'live/index.html', title: 'Run it in the browser', html: `<h1>Run it in the browser</h1>\n<p>${introduction}</p>\n${cards('live/index.html')}`,
          sections: [{anchor: '', title: 'Run it in the browser', level: 1, text}]};
}

function sourceHtml(file, path) {
  const full = join(root, file);
  const from = {source: file, path};
  if (statSync(full).isDirectory()) {
    const names = readdirSync(full).filter(name => !name.startsWith('.')).sort();
    const readme = names.includes('README.md')
      ? render(readFileSync(join(full, 'README.md'), 'utf8'), href => target({source: `${file}/README.md`, path}, href)).html : `<h1>${escape(file)}</h1>`;
    return `${readme}<h2>Files</h2><ul>${names.map(name => `<li>${escape(name)}</li>`).join('')}</ul>`;
  }
  if (file.endsWith('.md')) return render(readFileSync(full, 'utf8'), href => target(from, href)).html;
  const bytes = readFileSync(full);
  const text = bytes.length > MOST_SOURCE_BYTES || bytes.includes(0) ? `(${bytes.length} bytes)` : bytes.toString('utf8');
  return `<h1>${escape(file)}</h1><div class="code"><pre tabindex="0"><code>${escape(text)}</code></pre></div>`;
}

const start = startPage();
for (const each of [start, livePage(), ...documentPages, ...references]) add(each);
// A page of a source may link further ones.
const done = new Set();
for (;;) {
  const next = [...sources].find(([file]) => !done.has(file));
  if (!next) break;
  const [file, path] = next;
  done.add(file);
  write(path, page({path, title: file, html: sourceHtml(file, path)}));
}
for (const file of pictures) {
  mkdirSync(join(output, 'pictures'), {recursive: true});
  copyFileSync(join(root, file), join(output, 'pictures', posix.basename(file)));
}
for (const name of ['site.css', 'site.js', 'theme.js']) copyFileSync(join(own, name), join(output, name));
// A script and not JSON: pages from a disk may load scripts, and no other files.
write('search_index.js', `window.searchIndex = ${JSON.stringify(index)};\n`);
console.error(`${index.length + sources.size} pages of text, ${live.length} that simulate`);
