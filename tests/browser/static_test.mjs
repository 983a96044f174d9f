// A file of `troupe view --static`, opened from the disk: it plays, goes back, measures, and proves its recording.
//   node static_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {existsSync, mkdirSync, readFileSync, statSync, writeFileSync} from 'node:fs';
import {gunzipSync, gzipSync} from 'node:zlib';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
if (!existsSync(`${source}/build/wasm/bin/troupe-core.wasm`)) {
  console.log('static_test: no WebAssembly module (preset wasm); nothing was checked');
  process.exit(77);
}
const pages = await Pages.launch('static_test', source);
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;
const TICKS = 200;

async function run(...args) {
  const program = new Program(`${programs}/troupe`, args);
  assert.equal(await program.end, 0, program.lines.join('\n'));
}

await run('run', `${source}/worlds/scenarios/sensors.json`, '--headless', '--in-process', '--ticks', String(TICKS),
  '--record', path('run.mcap'), '--hash-log', path('hashes.txt'));
await run('view', path('run.mcap'), '--static', '-o', path('run.html'));
const hashes = new Map(readFileSync(path('hashes.txt'), 'utf8').trim().split('\n').map(line => line.split(' ')));
console.log(`run.html: ${statSync(path('run.html')).size} bytes`);

// Opens the file, and counts what it asks for beside itself.
async function open(file, fragment = '') {
  const start = Date.now();
  const page = await pages.open('about:blank', 1280, 800);
  const requests = [];
  page.on('request', request => {
    const {protocol} = new URL(request.url());
    if (!['blob:', 'data:'].includes(protocol)) requests.push(request.url());
  });
  await page.goto(`file://${file}${fragment}`);
  return {page, requests, start};
}

const stateOf = page => page.evaluate(() => window.troupe?.state() ?? null);
const badgeOf = page => page.evaluate(() => {
  const badge = document.getElementById('proof');
  return {text: badge.textContent, title: badge.title, bad: badge.classList.contains('lost')};
});

async function theBadgeTellsThatAllStatesAreEqual() {
  const {page, requests, start} = await open(path('run.html'));
  await until('the page has a state', () => stateOf(page));
  console.log(`first state after ${Date.now() - start} ms`);
  const badge = await until('the proof is done', async () => {
    const now = await badgeOf(page);
    return now.text.includes('all equal') ? now : null;
  });
  assert.equal(badge.bad, false);
  assert.match(badge.text, new RegExp(`^${TICKS + 1} states: all equal$`));
  await page.screenshot({path: path('static.png')});
  assert.deepEqual(requests, [`file://${path('run.html')}`]);
}

async function everyStateAndReadingIsThatOfTheRun() {
  const {page} = await open(path('run.html'), '#tick=150&tab=sensors');
  const at = tick => until(`tick ${tick} is shown`, async () => {
    const state = await stateOf(page);
    return state?.tick === tick ? state : null;
  });
  assert.equal((await at(150)).hash, hashes.get('150'));
  // By the slider, back and forth.
  for (const tick of [149, 20, 180, 0, TICKS, 60]) {
    await page.$eval('#timeline', (slider, value) => {
      slider.value = String(value);
      slider.dispatchEvent(new Event('input'));
    }, tick);
    assert.equal((await at(tick)).hash, hashes.get(String(tick)));
  }
  const robot = (await page.evaluate(() => window.troupe.names())).robots[0];
  await page.evaluate(name => window.troupe.select(name), robot);
  const contents = await until('its readings arrive', () => page.evaluate(name => window.troupe.contents(name), robot));
  assert.ok(Object.keys(contents).length > 0);
}

async function aChangedByteIsNamed() {
  const html = readFileSync(path('run.html'), 'utf8');
  const element = html.match(/(id="static-recording"[^>]*>)([^<]*)</);
  const recording = gunzipSync(Buffer.from(element[2], 'base64'));
  recording[Math.floor(recording.length / 2)] ^= 1;
  writeFileSync(path('changed.html'), html.replace(element[0], `${element[1]}${gzipSync(recording).toString('base64')}<`));
  const {page} = await open(path('changed.html'));
  const badge = await until('the badge is bad', async () => {
    const now = await badgeOf(page);
    return now.bad ? now : null;
  });
  assert.match(badge.text, /differs at tick \d+|not equal/);
  console.log(`${badge.text}: ${badge.title}`);
}

await pages.runAll([theBadgeTellsThatAllStatesAreEqual, everyStateAndReadingIsThatOfTheRun, aChangedByteIsNamed], path);
