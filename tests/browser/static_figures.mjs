// Prints figures of pages of `troupe view --static`: their size, the time to the first picture, and the ticks a second of
// the worker's processor time in a headless Chromium, against those of the programs here, in alternation. Not a test.
//   node static_figures.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES WORLD TICKS [ROUNDS]
// Processor times do not depend much on other work, the time to the picture does. They count 10 ms at a time: TICKS should
// be a second's work.
import {execFileSync} from 'node:child_process';
import {mkdirSync, readFileSync, readdirSync, statSync} from 'node:fs';
import {createRequire} from 'node:module';
import {SOFTWARE_GRAPHICS} from './pages.mjs';
import {until} from './programs.mjs';

const [programs, source, files, world, ticks, rounds = '5'] = process.argv.slice(2);
const playwright = createRequire(`${source}/viewer/web/package.json`)('playwright-core');
mkdirSync(files, {recursive: true});
const server = await playwright.chromium.launchServer({executablePath: '/usr/bin/chromium', args: SOFTWARE_GRAPHICS});
const browser = await playwright.chromium.connect(server.wsEndpoint());

const median = values => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const spread = (values, digits) => !values.every(Number.isFinite) ? 'too short to tell' :
  `${median(values).toFixed(digits)} (${Math.min(...values).toFixed(digits)} to ${Math.max(...values).toFixed(digits)})`;

// Runs the program, and returns its processor time in user mode, s.
function userSeconds(...command) {
  const script = 'TIMEFORMAT=%U; { time "$@" >/dev/null 2>/dev/null; } 2>&1';
  return Number(execFileSync('bash', ['-c', script, 'bash', `${programs}/troupe`, ...command], {encoding: 'utf8'}));
}

const statOf = path => readFileSync(path, 'utf8').split(') ')[1].split(' ');

// The processor time of the workers of all pages of this browser, s.
function workerSeconds() {
  const children = new Map();
  for (const name of readdirSync('/proc').filter(name => /^\d+$/.test(name))) {
    try {
      const parent = statOf(`/proc/${name}/stat`)[1];
      children.set(parent, [...children.get(parent) ?? [], name]);
    } catch {}  // it has ended
  }
  const descendants = pid => [pid, ...(children.get(pid) ?? []).flatMap(descendants)];
  let jiffies = 0;
  for (const pid of descendants(String(server.process().pid))) {
    try {
      for (const task of readdirSync(`/proc/${pid}/task`)) {
        if (!readFileSync(`/proc/${pid}/task/${task}/comm`, 'utf8').startsWith('DedicatedWorker')) continue;
        const fields = statOf(`/proc/${pid}/task/${task}/stat`);
        jiffies += Number(fields[11]) + Number(fields[12]);
      }
    } catch {}  // it has ended
  }
  return jiffies / 100;
}

// The page, once it has shown a picture of a state, and the time until then, s.
async function open(file) {
  const page = await browser.newPage({viewport: {width: 1280, height: 800}});
  page.setDefaultTimeout(120_000);
  const start = performance.now();
  await page.goto(`file://${file}`, {waitUntil: 'commit'});
  await until('the page has a state', () => page.evaluate(() => window.troupe?.state() ?? null).catch(() => null));
  await page.evaluate(() => new Promise(resolve => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  return {page, seconds: (performance.now() - start) / 1000};
}

// Ticks a second of the worker's time, from a reading of `progress`, in ticks, to one at the end or after some seconds.
async function rateOf(page, progress) {
  const read = async () => ({tick: await progress(page), time: workerSeconds()});
  const first = await until('it has begun', async () => {
    const now = await read();
    return now.tick > 0 ? now : null;
  });
  const deadline = Date.now() + 10_000;
  let last = first;
  await until('it has gone far', async () => {
    last = await read();
    return last.tick >= Number(ticks) || Date.now() > deadline;
  });
  return last.time - first.time < 0.1 ? NaN : (last.tick - first.tick) / (last.time - first.time);  // s
}

const proven = page => page.evaluate(() => {
  const text = document.getElementById('proof').textContent;
  return Number(/^[\d,]+/.exec(text)?.[0].replaceAll(',', '') ?? 0);
});
const tickOf = page => page.evaluate(() => window.troupe.state().tick);

// `native`: the program's seconds for all ticks.
async function measure(name, file, native, progress, begin) {
  const starts = [], here = [], there = [], ratios = [];
  for (let round = 0; round < Number(rounds); ++round) {
    const programRate = Number(ticks) / native();
    const {page, seconds} = await open(file);
    await begin(page);
    const pageRate = await rateOf(page, progress);
    await page.close();
    starts.push(seconds);
    here.push(programRate);
    there.push(pageRate);
    ratios.push(pageRate / programRate);
  }
  console.log(`${name}: ${statSync(file).size} bytes, first picture after ${spread(starts, 2)} s, ticks a second of processor ` +
    `time: page ${spread(there, 0)}, program ${spread(here, 0)}, ratio ${spread(ratios, 2)}`);
}

const run = ['run', world, '--headless', '--in-process', '--threads', '1', '--ticks', ticks];
const recording = `${files}/figures.mcap`;
userSeconds(...run, '--record', recording);
userSeconds('view', recording, '--static', '-o', `${files}/recording.html`);
userSeconds('view', world, '--static', '-o', `${files}/scenario.html`);
await measure('recording', `${files}/recording.html`, () => userSeconds('replay', recording), proven, () => {});
await measure('scenario', `${files}/scenario.html`, () => userSeconds(...run), tickOf,
  page => page.evaluate(() => window.troupe.request('speed', {speed: 'max'})));
await browser.close();
await server.close();
