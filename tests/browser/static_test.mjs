// Files of `troupe view --static`, opened from the disk: a recording plays, goes back, measures and is proven; a scenario
// runs in the page, is stepped, changed and started again.
//   node static_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {cpSync, existsSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {gunzipSync, gzipSync} from 'node:zlib';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
if (!existsSync(`${source}/build/wasm/bin/troupe-core.wasm`)) {
  console.log('static_test: no WebAssembly module (preset wasm); nothing was checked');
  process.exit(77);
}
const pages = await Pages.launch('static_test', source, ['axe-core']);
rmSync(files, {recursive: true, force: true});
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;
const TICKS = 200;

async function run(...args) {
  const program = new Program(`${programs}/troupe`, args);
  assert.equal(await program.end, 0, program.lines.join('\n'));
}

// The hash of the host at each tick.
async function hashesOf(scenario, ticks, ...more) {
  const log = path('host.txt');
  await run('run', scenario, '--headless', '--in-process', '--no-ros', '--ticks', String(ticks), '--hash-log', log, ...more);
  return readFileSync(log, 'utf8').trim().split('\n').map(line => line.split(' ')[1]);
}

await run('run', `${source}/worlds/scenarios/sensors.json`, '--headless', '--in-process', '--ticks', String(TICKS),
  '--record', path('run.mcap'), '--hash-log', path('hashes.txt'));
await run('view', path('run.mcap'), '--static', '-o', path('run.html'));
const hashes = new Map(readFileSync(path('hashes.txt'), 'utf8').trim().split('\n').map(line => line.split(' ')));

// Robots in places that the seed chooses, and one that stalls.
const swarm = {
  seed: 1,
  ticks: 300,
  spawn: [{model: 'scout', count: 6, region: [-12, -8, 12, 8], spacing: 0.6, heading: 'random', name_prefix: 'scout',
           controller: {name: 'wander', parameters: {speed: 0.5}}}],
  robots: [{name: 'rover', model: 'scout', pose: [-10, 0, 180],
            controller: {name: 'script', parameters: {commands: [{at: 0, vx: 0.4}]}}}],
  expect: [{name: 'never stalls', that: 'always not stalled(rover)'}, {name: 'sees all', that: 'forall r: always x(r) < 50 m'}],
};
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
  const element = html.match(/(id="static-content"[^>]*>)([^<]*)</);
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

// A scenario beside the worlds that it names, as users have them.
function writeScenario(name, scenario) {
  for (const part of ['office.world', 'include', 'bitmaps']) cpSync(`${source}/worlds/${part}`, path(part), {recursive: true});
  writeFileSync(path(name), JSON.stringify({...scenario, world: 'office.world'}));
}

const request = (page, command, more = {}) => page.evaluate(([c, m]) => window.troupe.request(c, m), [command, more]);

async function paused(page) {
  const reply = await request(page, 'pause');
  assert.ok(reply.done, reply.problem);
  return until('the pause is shown', async () => {
    const state = await stateOf(page);
    return state.paused && state.tick === reply.tick ? state : null;
  });
}

async function runsAtMostSpeed(page) {
  await request(page, 'speed', {speed: 'max'});
  return until('the run is over', async () => {
    const state = await stateOf(page);
    return state.over ? state : null;
  });
}

async function aScenarioRunsInThePage() {
  writeScenario('swarm.json', swarm);
  await run('view', path('swarm.json'), '--static', '-o', path('swarm.html'));
  assert.ok(!readFileSync(path('swarm.html'), 'latin1').includes(files), 'it tells nothing of this machine');
  console.log(`swarm.html: ${statSync(path('swarm.html')).size} bytes`);
  const host = await hashesOf(path('swarm.json'), swarm.ticks);
  const {page, requests} = await open(path('swarm.html'));
  await until('the run has begun', async () => (await stateOf(page))?.tick > 0);
  const stopped = await paused(page);
  assert.equal(stopped.hash, host[stopped.tick]);
  // Stepped by its button, with the hash of each tick on the badge.
  for (const tick of [stopped.tick + 1, stopped.tick + 2]) {
    await page.click('#step');
    await until(`tick ${tick} is shown`, async () => (await stateOf(page)).tick === tick);
    await until('the badge has its hash', async () => (await badgeOf(page)).text === host[tick]);
  }
  // Its past, and the readings of a robot.
  await page.$eval('#timeline', slider => {
    slider.value = '1';
    slider.dispatchEvent(new Event('input'));
  });
  await until('a past state is shown', async () => (await stateOf(page)).hash === host[1]);
  await page.click('#live');
  await page.evaluate(() => window.troupe.select('rover'));
  await until('its readings arrive', async () => Object.keys(await page.evaluate(() => window.troupe.contents('rover')) ?? {}).length > 0);
  await page.click('#play');
  const end = await runsAtMostSpeed(page);
  assert.deepEqual([end.tick, end.hash], [swarm.ticks, host[swarm.ticks]]);
  await until('the expectations are judged', async () =>
    (await page.$$eval('.expect-row', rows => rows.map(row => row.dataset.state))).join() === 'violated,holds');
  await page.screenshot({path: path('scenario.png')});
  assert.deepEqual(requests, [`file://${path('swarm.html')}`]);
}

// A ROS map with a wall across the way of the robot, and a building, which are YAML.
async function mapsAndBuildingsRunInThePage() {
  const scenarios = `${source}/worlds`;
  cpSync(`${scenarios}/sites/guesthouse.building.yaml`, path('guesthouse.building.yaml'));
  const house = JSON.parse(readFileSync(`${scenarios}/sites/guesthouse_lift.json`, 'utf8'));
  writeFileSync(path('house.json'), JSON.stringify({...house, ticks: 300}));
  writeFileSync(path('room.pgm'), `P2\n40 20\n255\n${('255 '.repeat(30) + '0 ' + '255 '.repeat(9)).repeat(20)}\n`);
  writeFileSync(path('room.yaml'), 'image: room.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n'
    + 'occupied_thresh: 0.65\nfree_thresh: 0.196\n');
  const room = {world: 'room.yaml', include: ['include/robots.inc'], ticks: 100,
                robots: [{...swarm.robots[0], pose: [1, 1, 0]}]};
  writeFileSync(path('room.json'), JSON.stringify(room));
  for (const [name, ticks, robot] of [['house', 300, 'tiny_1'], ['room', 100, 'rover']]) {
    await run('view', path(`${name}.json`), '--static', '-o', path(`${name}.html`));
    console.log(`${name}.html: ${statSync(path(`${name}.html`)).size} bytes`);
    const host = await hashesOf(path(`${name}.json`), ticks);
    const {page} = await open(path(`${name}.html`));
    await until('the run has begun', () => stateOf(page));
    const end = await runsAtMostSpeed(page);
    assert.deepEqual([end.tick, end.hash], [ticks, host[ticks]]);
    const shown = await page.evaluate(which => window.troupe.robots().find(each => each.name === which), robot);
    assert.equal(shown.stalled, name === 'room', JSON.stringify(shown));
    await page.screenshot({path: path(`${name}.png`)});
  }
}

// With another seed and other values, from the form; a value that is wrong is refused, and the run stays.
async function aRunIsStartedAgainWithOtherValues() {
  const {page} = await open(path('swarm.html'));
  await until('the run has begun', () => stateOf(page));
  await page.click('#experiment-open');
  await page.fill('#experiment-seed', '5');
  await page.fill('input[aria-label="scout: count"]', '-3');
  await page.click('#experiment .strong');
  await until('the value is refused', async () => /found the number -3/.test(await page.textContent('#experiment-error')));
  await page.fill('input[aria-label="scout: count"]', '3');
  await page.fill('input[aria-label="scout: speed"]', '0.8');
  await page.screenshot({path: path('values.png')});
  await page.click('#experiment .strong');
  await until('the other run is shown', async () => (await page.evaluate(() => window.troupe.robots().length)) === 4);
  const end = await runsAtMostSpeed(page);
  const other = structuredClone(swarm);
  Object.assign(other.spawn[0], {count: 3, controller: {name: 'wander', parameters: {speed: 0.8}}});
  writeScenario('other.json', other);
  const host = await hashesOf(path('other.json'), swarm.ticks, '--seed', '5');
  assert.deepEqual([end.tick, end.hash], [swarm.ticks, host[swarm.ticks]]);
  // From the card at the end, with the same values.
  await page.click('#end-card button:has-text("Run again")');
  await until('it runs again', async () => !(await stateOf(page)).over);
  const again = await runsAtMostSpeed(page);
  assert.equal(again.hash, end.hash);
}

// What the page runs, with changed values, is a scenario for the programs; of a recording it is the recording.
async function whatItShowsIsDownloaded() {
  const {page} = await open(path('swarm.html'));
  await until('the run has begun', () => stateOf(page));
  await page.click('#experiment-open');
  await page.fill('#experiment-seed', '7');
  await page.fill('input[aria-label="scout: count"]', '2');
  await page.click('#experiment .strong');
  await until('the other run is shown', async () => (await page.evaluate(() => window.troupe.robots().length)) === 3);
  const stopped = await paused(page);
  const save = async (from, name) => {
    const waiting = from.waitForEvent('download');
    await from.evaluate(() => document.getElementById('download').click());
    const download = await waiting;
    assert.equal(download.suggestedFilename(), name);
    await download.saveAs(path(`saved-${name}`));
  };
  await save(page, 'swarm.zip');
  execFileSync('python3', ['-m', 'zipfile', '-e', path('saved-swarm.zip'), path('unpacked')]);
  const host = await hashesOf(path('unpacked/swarm/swarm.json'), Math.max(stopped.tick, 1), '--seed', '7');
  assert.equal(stopped.hash, host[stopped.tick]);
  const recorded = (await open(path('run.html'))).page;
  await until('the page has a state', () => stateOf(recorded));
  await save(recorded, 'run.mcap');
  await run('replay', path('saved-run.mcap'), '--verify');
}

async function aRobotIsMovedAndTheRunReset() {
  const {page} = await open(path('swarm.html'));
  await until('the run has begun', () => stateOf(page));
  const host = await hashesOf(path('swarm.json'), 20);
  const poseOf = async () => (await page.evaluate(() => window.troupe.robots().find(robot => robot.name === 'rover'))).pose;
  for (const [x, stands] of [[-6, false], [-4, true]]) {
    if (stands) await paused(page);
    const reply = await request(page, 'set_pose', {name: 'rover', pose: [x, 0, 0, 0]});
    assert.ok(reply.done, reply.problem);
    await until('it is there', async () => Math.abs((await poseOf()).x - x) < 0.5);
  }
  const inWall = await request(page, 'set_pose', {name: 'rover', pose: [1000, 0, 0, 0]});
  assert.ok(!inWall.done || Math.abs((await poseOf()).x) < 1e6);
  await page.click('#reset');
  await until('the start is shown', async () => (await stateOf(page)).tick === 0);
  await request(page, 'step', {ticks: 20});
  await until('tick 20 is shown', async () => (await stateOf(page)).tick === 20);
  assert.equal((await stateOf(page)).hash, host[20]);
  // A robot that is added has an agent, too.
  const spawned = await request(page, 'spawn', {source: 'scout', controller: 'wander', pose: [-2, 0, 0, 0]});
  assert.ok(spawned.done, spawned.problem);
  const before = (await stateOf(page)).tick;
  await request(page, 'step', {ticks: 5});
  await until('it is stepped', async () => (await stateOf(page)).tick === before + 5);
}

async function aPhoneShowsIt() {
  const page = await pages.open('about:blank', 390, 844, {hasTouch: true, isMobile: true, colorScheme: 'dark'});
  await page.goto(`file://${path('swarm.html')}`);
  await until('the run has begun', () => stateOf(page));
  await page.screenshot({path: path('phone.png')});
  assert.deepEqual(await pages.findings(page), []);
  const hash = await page.locator('#proof').boundingBox();
  assert.ok(hash.x >= 0 && hash.x + hash.width <= 390, JSON.stringify(hash));
}

// What a page cannot run is told when it is written.
async function whatAPageCannotRunIsTold() {
  const refusal = async (name, scenario) => {
    writeScenario(name, scenario);
    const program = new Program(`${programs}/troupe`, ['view', path(name), '--static', '-o', path('none.html')]);
    assert.equal(await program.end, 2);
    assert.ok(!existsSync(path('none.html')));
    return program.lines.join('\n');
  };
  const controlled = controller => ({...swarm, robots: [{...swarm.robots[0], controller}]});
  writeFileSync(path('patrol.py'), 'class Patrol:\n  pass\n');
  assert.match(await refusal('python.json', controlled('patrol.py:Patrol')), /rover.*patrol\.py:Patrol is a class in Python.*--record/s);
  assert.match(await refusal('library.json', controlled('./own.so')), /rover.*own\.so is a shared library.*--record/s);
}

// The page beside the recording of a case that fails, linked from the report.
async function aCaseThatFailsLeavesAPage() {
  writeScenario('watched.json', {...swarm, ticks: 120});
  const program = new Program(`${programs}/troupe`, ['test', path('watched.json'), '--no-shrink', '--report', path('report')]);
  assert.equal(await program.end, 1, program.lines.join('\n'));
  const told = program.lines.find(line => line.startsWith('  page: '));
  assert.ok(told, program.lines.join('\n'));
  const file = told.slice('  page: '.length);
  assert.match(readFileSync(path('report/index.html'), 'utf8'), /<a href="watched-0\/run\.html">/);
  const {page} = await open(file);
  await until('the proof is done', async () => (await badgeOf(page)).text.includes('all equal'));
  await until('the expectations are judged', async () => (await page.$$('.expect-row')).length === swarm.expect.length);
  await page.locator('.expect-row').first().click();
  await until('the violation is shown', async () =>
    (await page.evaluate(() => window.troupe.robots().find(robot => robot.name === 'rover'))).stalled);
}

await pages.runAll([
  theBadgeTellsThatAllStatesAreEqual, everyStateAndReadingIsThatOfTheRun, aChangedByteIsNamed, aScenarioRunsInThePage,
  mapsAndBuildingsRunInThePage, aRunIsStartedAgainWithOtherValues, whatItShowsIsDownloaded, aRobotIsMovedAndTheRunReset, aPhoneShowsIt, whatAPageCannotRunIsTold,
  aCaseThatFailsLeavesAPage,
], path);
