// The traffic of robots on lanes on the page of `troupe view`: next moves, and who waits for whom.
//   node traffic_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {mkdirSync, writeFileSync} from 'node:fs';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('traffic_test', source);
const troupe = `${programs}/troupe`;
const domain = String(101 + (process.pid % 19));
const session = `traffic-${process.pid}`;
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;

async function start(name, file) {
  const run = new Program(troupe, [
    'run', file, '--domain', domain, '--session', `${session}-${name}`, '--paused', '--speed', 'max', '--in-process']);
  const page = await pages.openRun(`${await run.line('viewer: ')}#smooth=0&view=top`, 1280, 640);
  return {run, page};
}

const traffic = page => page.evaluate(() => window.troupe.traffic());

async function stepTo(page, tick) {
  await page.evaluate(async to => {
    const {tick: at} = window.troupe.state();
    if (at < to) await window.troupe.request('step', {ticks: to - at});
  }, tick);
  await until(`tick ${tick}`, () => page.evaluate(to => window.troupe.state().tick >= to, tick));
}

// The four robots of the sidings have ways, and one that has to wait for another has an arrow to it.
async function showsWaysAndWaits() {
  const {run, page} = await start('planned', `${source}/worlds/sites/sidings.json`);
  assert.equal(await page.isVisible('#traffic'), true);
  assert.deepEqual(await traffic(page), {ways: [], waits: []});
  await page.locator('#scene').focus();
  await page.keyboard.press('w');
  assert.equal(await page.getAttribute('#traffic', 'aria-pressed'), 'true');
  let found = null;
  for (let tick = 100; tick <= 1500 && !found; tick += 50) {
    await stepTo(page, tick);
    found = await until('ways are drawn', async () => {
      const drawn = await traffic(page);
      return drawn.ways.length > 0 ? drawn : null;
    });
    if (found.waits.length === 0 || found.ways.length < 3) found = null;
  }
  assert.ok(found, 'a robot waits for another one');
  const robots = ['tug_1', 'tug_2', 'tug_3', 'tug_4'];
  for (const {robot, thing} of found.waits) assert.ok(robots.includes(robot) && robots.includes(thing) && robot !== thing);
  await page.screenshot({path: path('waiting.png')});
  await page.click('#view-orbit');
  await page.screenshot({path: path('orbit.png')});
  await page.click('#traffic');
  assert.deepEqual(await traffic(page), {ways: [], waits: []});
  await pages.closeRun(page, run);
}

// Without a plan two robots stand face to face on the single track: a ring.
async function showsRings() {
  const robots = [['tug_1', '["east_1"]'], ['tug_3', '["west_1"]']].map(
    ([name, places]) => `{"name": "${name}", "controller": {"name": "lanes", "parameters": {"places": ${places}, "planned": false}}}`);
  const file = path('head_on.json');
  writeFileSync(file, `{"world": "${source}/worlds/sites/sidings.building.yaml", "robots": [${robots.join(', ')}]}`);
  const {run, page} = await start('ring', file);
  await page.click('#traffic');
  let ring = [];
  for (let tick = 200; tick <= 600 && ring.length < 2; tick += 10) {
    await stepTo(page, tick);
    ring = (await traffic(page)).waits.filter(wait => wait.ring);
  }
  assert.deepEqual(ring.map(({robot, thing}) => [robot, thing]).sort(), [['tug_1', 'tug_3'], ['tug_3', 'tug_1']]);
  await page.screenshot({path: path('ring.png')});
  await pages.closeRun(page, run);
}

await pages.runAll([showsWaysAndWaits, showsRings], path);
