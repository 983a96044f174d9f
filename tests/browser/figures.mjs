// Prints figures of the viewer with real programs and a headless Chromium with software rendering. Not a test: it fails only
// when it cannot measure. scripts/viewer-figures runs it.
//   node figures.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES WORLD
import {mkdirSync, readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {SOFTWARE_GRAPHICS} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files, world] = process.argv.slice(2);
const require = createRequire(`${source}/viewer/web/package.json`);
const playwright = require('playwright-core');
const WebSocket = require('ws');
const troupe = `${programs}/troupe`;
const domain = String(141 + (process.pid % 19));
const SECONDS = 10;  // of a measurement
const ROUNDS = 3;  // of a comparison
mkdirSync(files, {recursive: true});

const browser = await playwright.chromium.launch({
  executablePath: '/usr/bin/chromium',
  args: SOFTWARE_GRAPHICS,
});

async function newTab() {
  const page = await browser.newPage({viewport: {width: 1280, height: 720}});
  page.setDefaultTimeout(120_000);
  return page;
}

async function open(url, tab) {
  const page = tab ?? await newTab();
  await page.goto(url, {waitUntil: 'commit'});
  await until('the page has a state', () => page.evaluate(() => window.troupe?.state() ?? null).catch(() => null));
  return page;
}

// Frames that the browser has shown, and the time of its scripts, over some seconds.
async function measurePage(page) {
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable');
  const read = async () => {
    const {metrics} = await session.send('Performance.getMetrics');
    return Object.fromEntries(metrics.map(({name, value}) => [name, value]));
  };
  await page.evaluate(() => {
    window.frames_ = 0;
    const count = () => { ++window.frames_; requestAnimationFrame(count); };
    requestAnimationFrame(count);
  });
  const before = await read();
  const framesBefore = await page.evaluate(() => window.frames_);
  await new Promise(resolve => setTimeout(resolve, SECONDS * 1000));
  const frames = await page.evaluate(() => window.frames_) - framesBefore;
  const after = await read();
  return {
    framesPerSecond: frames / (after.Timestamp - before.Timestamp),
    scriptMs: 1000 * (after.ScriptDuration - before.ScriptDuration) / Math.max(1, frames),
  };
}

function cpuSeconds(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ');
  return (Number(fields[11]) + Number(fields[12])) / 100;
}

// From the start of the program to the first state in the page, in an open browser.
async function measureStart() {
  const times = [];
  for (let round = 0; round < 5; ++round) {
    const tab = await newTab();
    await tab.goto('about:blank');
    const begin = performance.now();
    const run = new Program(troupe, [
      'run', `${source}/worlds/scenarios/office.json`, '--domain', domain, '--session', `figures-${process.pid}-s${round}`,
      '--ticks', '1000000',
    ]);
    await open(await run.line('viewer: '), tab);
    times.push((performance.now() - begin) / 1000);
    await tab.close();
    await run.stop();
  }
  console.log(`the page shows the demo ${times.map(time => time.toFixed(2)).join(', ')} s after its start`);
}

async function measureRun() {
  const run = new Program(troupe, [
    'run', world, '--domain', domain, '--session', `figures-${process.pid}`, '--ticks', '1000000', '--speed', '6',
    '--robots-per-process', '10',
  ]);
  const page = await open(`${await run.line('viewer: ')}#view=top`);
  const [gateway] = run.children('view');
  const cpu = cpuSeconds(gateway);
  const figures = await measurePage(page);
  const share = (cpuSeconds(gateway) - cpu) / SECONDS;
  console.log(`${figures.framesPerSecond.toFixed(1)} frames a second, ${figures.scriptMs.toFixed(2)} ms of script a frame, gateway ${(100 * share).toFixed(1)} % of a core`);
  await page.close();
  await run.stop();
}

// The tick of a run, by `troupe ctl`, and the time of the answer in s.
async function tickOf(session) {
  const status = new Program(troupe, ['ctl', 'status', '--domain', domain, '--session', session]);
  await status.end;
  const tick = Number(/tick (\d+)/.exec(status.lines.join(' '))[1]);
  return {tick, time: performance.now() / 1000};
}

// A viewer that receives all that a page does, as a browser on another computer would.
function receive(url) {
  const address = new URL(url);
  const socket = new WebSocket(`ws://${address.host}/socket${address.search}`, 'troupe', {headers: {Origin: address.origin}});
  let received = 0;
  socket.on('message', () => ++received);
  return until('updates arrive', () => received > 10 ? {close: () => socket.close()} : null);
}

// Ticks a second of a run as fast as possible, without a viewer, with one that receives, and with a page in the browser
// of this computer, in alternation.
async function measureSlowdown() {
  const viewers = {none: async () => null, receiver: receive, page: open};
  const rates = {none: [], receiver: [], page: []};
  for (let round = 0; round < ROUNDS; ++round) {
    for (const [name, view] of Object.entries(viewers)) {
      const session = `figures-${process.pid}-${round}-${name}`;
      const run = new Program(troupe, [
        'run', world, '--domain', domain, '--session', session, '--ticks', '100000000', '--robots-per-process', '10',
        '--speed', 'max',
      ]);
      const viewer = await view(await run.line('viewer: '));
      await run.line('session ');
      const begin = await tickOf(session);
      await new Promise(resolve => setTimeout(resolve, SECONDS * 1000));
      const end = await tickOf(session);
      rates[name].push((end.tick - begin.tick) / (end.time - begin.time));
      await viewer?.close();
      await run.stop();
    }
  }
  const median = values => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
  const ratios = name => rates[name].map((rate, i) => (rate / rates.none[i]).toFixed(2)).join(', ');
  console.log(`ticks a second: ${median(rates.none).toFixed(0)} without a viewer; of that, with one that receives ` +
    `${ratios('receiver')}, with a page in this computer's browser ${ratios('page')}`);
}

// From the input on the timeline to the picture, in a recording of 10,000 ticks.
async function measureSeeks() {
  const recording = `${files}/figures.mcap`;
  const run = new Program(troupe, [
    'run', world, '--in-process', '--headless', '--ticks', '10000', '--speed', 'max', '--session', `figures-${process.pid}-r`,
    '--record', recording,
  ]);
  if (await run.end !== 0) throw new Error(run.lines.join('\n'));
  const viewer = new Program(troupe, ['view', recording, '--listen', '127.0.0.1:0']);
  const page = await open(`${await viewer.line('viewer: ')}#smooth=0`);
  await until('the timeline has its range', () => page.evaluate(() => document.getElementById('timeline').max === '10000'));
  const times = await page.evaluate(async () => {
    const slider = document.getElementById('timeline');
    const result = [];
    let seed = 1;
    for (let i = 0; i < 30; ++i) {
      seed = (seed * 48271) % 2147483647;
      const position = seed % 10001;
      const begin = performance.now();
      slider.value = String(position);
      slider.dispatchEvent(new Event('input'));
      while (window.troupe.state().tick !== position) await new Promise(resolve => requestAnimationFrame(resolve));
      await new Promise(resolve => requestAnimationFrame(() => requestAnimationFrame(resolve)));
      result.push(performance.now() - begin);
    }
    return result.sort((a, b) => a - b);
  });
  console.log(`seek in 10,000 ticks: median ${times[15].toFixed(0)} ms, longest ${times[29].toFixed(0)} ms`);
  await page.close();
  await viewer.stop();
}

try {
  await measureStart();
  await measureRun();
  await measureSlowdown();
  await measureSeeks();
} catch (error) {
  console.error(error);
  process.exitCode = 1;
}
for (const program of Program.all) {
  if (!program.ended) program.child.kill('SIGKILL');
}
await browser.close();
