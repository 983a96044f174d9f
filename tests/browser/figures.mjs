// Prints figures of the viewer with real programs and a headless Chromium with software rendering. Not a test: it fails only
// when it cannot measure. scripts/viewer-figures runs it.
//   node figures.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES WORLD
import {mkdirSync, readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {Program, until} from './programs.mjs';

const [programs, source, files, world] = process.argv.slice(2);
const playwright = createRequire(`${source}/viewer/web/package.json`)('playwright-core');
const troupe = `${programs}/troupe`;
const domain = String(141 + (process.pid % 19));
const SECONDS = 10;  // of a measurement
mkdirSync(files, {recursive: true});

const browser = await playwright.chromium.launch({
  executablePath: '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});

async function open(url) {
  const page = await browser.newPage({viewport: {width: 1280, height: 720}});
  page.setDefaultTimeout(120_000);
  await page.goto(url);
  await until('the page has a state', () => page.evaluate(() => window.troupe?.state() ?? null));
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

// Ticks a second of a run as fast as possible, with and without a page, in alternation.
async function measureSlowdown() {
  const rates = {with: [], without: []};
  for (let round = 0; round < 6; ++round) {
    const isViewed = round % 2 === 1;
    const ticks = 600;
    const summary = `${files}/summary.json`;
    const run = new Program(troupe, [
      'run', world, '--domain', domain, '--session', `figures-${process.pid}-${round}`, '--ticks', String(ticks),
      '--robots-per-process', '10', '--summary', summary, '--speed', 'max', ...(isViewed ? ['--paused'] : ['--headless']),
    ]);
    let page = null;
    if (isViewed) {
      page = await open(await run.line('viewer: '));
      await page.click('#play');
    }
    await run.end;
    if (page) await page.close();
    const {wall_seconds: wall} = JSON.parse(readFileSync(summary, 'utf8'));
    rates[isViewed ? 'with' : 'without'].push(ticks / wall);
  }
  const median = values => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
  console.log(`ticks a second: ${median(rates.without).toFixed(0)} without a viewer, ${median(rates.with).toFixed(0)} with one`);
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
