// The levels of a building on the page of `troupe view`: all, side by side, or one alone.
//   node levels_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {mkdirSync} from 'node:fs';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('levels_test', source);
const troupe = `${programs}/troupe`;
const domain = String(101 + (process.pid % 19));
const session = `levels-${process.pid}`;
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;

// A paused run of the guesthouse with a page. `hash`: of the address.
async function start(name, hash) {
  const run = new Program(troupe, [
    'run', `${source}/worlds/sites/guesthouse_lift.json`, '--domain', domain, '--session', `${session}-${name}`, '--paused',
    '--speed', 'max',
  ]);
  const page = await pages.openRun(`${await run.line('viewer: ')}#smooth=0&${hash}`, 1280, 800);
  return {run, page};
}

const levels = page => page.evaluate(() => window.troupe.levels());
const placeOf = (page, name) => page.evaluate(of => window.troupe.placeOf(of), name);
const labels = page => page.evaluate(() => [...document.querySelectorAll('.label')].map(label => label.textContent).sort());

const end = (page, run) => pages.closeRun(page, run);

async function choosesLevels() {
  const {run, page} = await start('choice', 'view=top');
  assert.deepEqual(await levels(page), {names: ['L1', 'L2'], choice: 'beside'});
  const list = page.locator('#levels');
  await list.selectOption('stacked');
  assert.equal(new URLSearchParams(new URL(page.url()).hash.slice(1)).get('levels'), 'stacked');
  assert.deepEqual(await list.locator('option').allTextContents(), ['All levels', 'Side by side', 'Level L2', 'Level L1']);

  // A robot is added upstairs by a click: on the floor of the level that is shown.
  await list.selectOption('L2');
  await until('no robot has a label', async () => (await labels(page)).length === 0);
  await page.click('#add');
  await page.locator('.menu-row', {hasText: 'TinyRobot'}).click();
  const at = await page.evaluate(() => window.troupe.groundPoint(3, -4));
  await page.mouse.click(at.x, at.y);
  const added = await until('the robot is added', () => page.evaluate(() => window.troupe.robots()[2] ?? null));
  assert.equal(added.pose.z, 4);
  assert.ok(Math.hypot(added.pose.x - 3, added.pose.y + 4) < 0.1, JSON.stringify(added.pose));
  await until('it is the only one with a label', async () => (await labels(page)).join() === added.name);
  await page.screenshot({path: path('upstairs.png')});

  await list.selectOption('L1');
  await until('the others have labels', async () => (await labels(page)).join() === 'delivery_1,tiny_1');
  await page.screenshot({path: path('downstairs.png')});

  // Side by side: the upper level is right of the lower one, and a click there selects what is there.
  await list.selectOption('beside');
  await until('all have labels', async () => (await labels(page)).length === 3);
  assert.equal(new URLSearchParams(new URL(page.url()).hash.slice(1)).get('levels'), null, 'it is the usual view');
  const above = await placeOf(page, added.name);
  const below = await page.evaluate(() => window.troupe.groundPoint(3, -4));
  const scale = (await page.evaluate(() => window.troupe.groundPoint(4, -4))).x - below.x;
  assert.ok(above.x - below.x > 11.5 * scale, 'it is drawn beside the building, which is 12 m wide');
  assert.ok(Math.abs(above.y - below.y) < 0.2 * scale);
  await page.click('#panel-close');
  await page.mouse.click(above.x, above.y);
  await until('it is selected', async () => (await page.textContent('#panel-name')) === added.name);
  await page.screenshot({path: path('beside.png')});

  await page.locator('#scene').focus();
  for (const [key, choice] of [['e', 'L1'], ['PageUp', 'L2'], ['PageUp', 'L2'], ['PageDown', 'L1'], ['e', 'stacked'], ['e', 'beside']]) {
    await page.keyboard.press(key);
    assert.equal((await levels(page)).choice, choice, key);
    assert.equal(await list.inputValue(), choice);
  }
  await page.keyboard.press('o');
  await page.keyboard.press('h');
  await page.screenshot({path: path('beside_orbit.png')});
  await end(page, run);
}

// A robot that is followed into a lift takes the page to its level.
async function followsIntoALift() {
  const {run, page} = await start('lift', 'robot=tiny_1&follow=1&levels=L1');
  assert.equal((await levels(page)).choice, 'L1');
  void page.evaluate(() => window.troupe.request('step', {ticks: 200}));  // its answer may come late
  await until('the robot is upstairs', () => page.evaluate(
    () => window.troupe.state().tick === 200 && window.troupe.robots().find(({name}) => name === 'tiny_1').pose.z === 4));
  await until('its level is shown', async () => (await levels(page)).choice === 'L2');
  await end(page, run);
}

// All things of the building are found by their kinds and names; what stays when its program has ended says so.
async function findsAllThings() {
  const {run, page} = await start('things', 'view=top');
  const kinds = page.locator('#thing-kinds button');
  await until('the kinds are listed', async () => await kinds.count() > 0);
  assert.deepEqual(await kinds.allTextContents(), ['Robots 2', 'Doors 8', 'Lifts 1', 'People 3', 'Levels 2', 'Lanes 13']);
  const rows = () => page.locator('#robot-list .robot').allTextContents();
  await page.click('#thing-kinds >> text=Doors');
  await until('doors are listed', async () => (await rows()).includes('lobby_dooropen'));
  await page.click('#robot-list >> text=lobby_door');
  await page.locator('#panel-doors >> text=Close').click();
  void page.evaluate(() => window.troupe.request('step', {ticks: 100}));
  await until('the door is closed', async () => (await rows()).includes('lobby_doorclosed'));
  await page.click('#thing-kinds >> text=Lanes');
  await page.click('#robot-list >> text=entrance - lobby');
  void page.evaluate(() => window.troupe.request('step', {ticks: 2}));
  await until('the lane is closed', async () => (await rows()).includes('entrance - lobbyclosed'));
  await page.click('#thing-kinds >> text=Levels');
  await until('levels are listed', async () => /^L1.*,L2.*$/.test((await rows()).join()));
  assert.match((await rows())[0], /robot/);
  await page.click('#robot-list >> text=L2');
  assert.equal((await levels(page)).choice, 'L2');
  // A search goes over all kinds.
  await page.fill('#robot-search', 'lift');
  await until('the lift is found', async () => (await rows()).some(row => row.startsWith('guest_lift')));
  assert.deepEqual(await page.locator('#robot-list h3').allTextContents(), ['Doors', 'Lifts', 'Lanes']);
  await page.screenshot({path: path('things.png')});

  pages.expectLossOfGateway(page);
  await run.stop();
  await until('the page knows that its program has ended', async () => (await page.textContent('#factor')) === 'ended');
  for (const id of ['play', 'live', 'back', 'step', 'timeline']) assert.ok(await page.locator(`#${id}`).isDisabled(), id);
  await page.locator('#end-card >> text=Look at the end').waitFor();
  assert.equal(await page.locator('#end-card >> text=Replay').count(), 0);
  await page.screenshot({path: path('ended.png')});
  await page.locator('#end-card >> text=Run again').click();
  assert.match(await page.textContent('.end-command'), /troupe run .*guesthouse_lift.json/);
  await page.close();
}

await pages.runAll([choosesLevels, followsIntoALift, findsAllThings], path);
