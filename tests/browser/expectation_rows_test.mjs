// Checks what the page tells of a run over time: the reports of controllers among its events, and the rows of the
// expectations of its scenario; in a live run, in its recording and after seeks.
//   node expectation_rows_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {mkdirSync, rmSync, writeFileSync} from 'node:fs';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('expectation_rows_test', source, ['axe-core']);
const troupe = `${programs}/troupe`;
const domain = String(181 + (process.pid % 19));
rmSync(files, {recursive: true, force: true});
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;

// A robot that drives into a bench, and one whose controller reports each 20 ticks.
writeFileSync(path('watched.json'), JSON.stringify({
  world: `${source}/worlds/robotics_lab.world`,
  robots: [
    {name: 'rover', model: 'scout', pose: [0.6, -6.5, 0],
     controller: {name: 'script', parameters: {commands: [{at: 0, vx: 0.4}]}}},
    {name: 'ears', model: 'scout', pose: [0.3, -5.6, 180], controller: {name: 'lasernoise', parameters: {samples: 20}}},
  ],
  expect: [
    {name: 'never stalls', that: 'always not stalled(rover)'},
    {name: 'drives a metre', that: 'eventually x(rover) > 1 m'},
    {name: 'stays in the lab', that: 'forall r: always abs(x(r)) < 50 m'},
    {name: 'comes far', that: 'eventually x(rover) > 40 m'},
  ],
}));

const run = (name, more) => new Program(troupe, [
  'run', path('watched.json'), '--domain', domain, '--session', `expectations-${process.pid}-${name}`, ...more,
]);

const open = (url, width = 1280, height = 720, more = {}) => pages.openRun(url, width, height, more);
const close = (page, program) => pages.closeRun(page, program);

const stateOf = page => page.evaluate(() => window.troupe.state());
const rowsOf = page => page.$$eval('.expect-row', rows => rows.map(row => ({
  name: row.querySelector('.expect-name').textContent, verdict: row.querySelector('.expect-verdict').textContent,
  state: row.dataset.state, label: row.ariaLabel,
})));
const verdictsAre = (page, what, wanted) => until(what, async () =>
  JSON.stringify((await rowsOf(page)).map(({verdict}) => verdict.replace(/ \d.*/, ''))) === JSON.stringify(wanted));
// The gateway judges a long past piece by piece: the first verdicts come before the last states are judged.
const allIsJudged = page => until('the rows reach the newest state', async () =>
  (await bandsOf(page)).every(band => band.endsWith('transparent 100.00%)')));
const reportsOf = page => page.$$eval('.event', rows => rows.map(row => row.textContent).filter(text => text.includes('readings')));

async function seek(page, tick) {
  await page.$eval('#timeline', (slider, position) => {
    slider.value = String(position);
    slider.dispatchEvent(new Event('input'));
  }, tick);
  await until(`tick ${tick} is shown`, async () => (await stateOf(page)).tick === tick);
}

// The reports of controllers are events, which are filtered and sought.
async function reportsAreEvents(page, count) {
  await page.click('#tab-events');
  const reports = await until('all reports are listed', async () => {
    const found = await reportsOf(page);
    return found.length === count ? found : null;
  });
  assert.match(reports[0], /ears: 20 readings/);
  await page.click('.chip:has-text("Messages")');
  await until('reports are filtered', async () => (await reportsOf(page)).length === 0);
  await page.click('.chip:has-text("Messages")');
  await page.locator('.event:has-text("readings")').last().click();
  const state = await until('a report is sought', async () => {
    const shown = await stateOf(page);
    return shown.past && shown.tick < 30 && shown;
  });
  assert.equal(state.tick, 20);
  return reports;
}

async function tellsOfARunAndOfItsRecording() {
  const tick = 150;
  const shown = run('live', ['--paused', '--record', path('watched.mcap')]);
  const url = await shown.line('viewer: ');
  const step = new Program(troupe, [
    'ctl', 'step', String(tick), '--domain', domain, '--session', `expectations-${process.pid}-live`]);
  assert.equal(await step.end, 0, step.lines.join('\n'));
  // A browser that comes later has all of it.
  const page = await open(url);
  await until('the run is shown', async () => (await stateOf(page)).tick === tick);
  await verdictsAre(page, 'the verdicts so far are shown', ['violated', 'holds', 'holds so far', 'not decided']);
  await allIsJudged(page);
  const live = {rows: (await rowsOf(page)).slice(0, 2), bands: await bandsOf(page)};
  const reports = await reportsAreEvents(page, Math.floor(tick / 20));
  await close(page, shown);

  const viewed = new Program(troupe, ['view', path('watched.mcap'), '--listen', '127.0.0.1:0']);
  const recorded = await open(await viewed.line('viewer: '));
  await seek(recorded, tick);
  await verdictsAre(recorded, 'the recording has the verdicts of its end', ['violated', 'holds', 'holds', 'violated at the end']);
  await allIsJudged(recorded);
  assert.deepEqual({rows: (await rowsOf(recorded)).slice(0, 2), bands: await bandsOf(recorded)}, live);
  assert.deepEqual(await reportsAreEvents(recorded, reports.length), reports);

  // At a tick before, and by a click at the violation.
  await seek(recorded, 2);
  await verdictsAre(recorded, 'nothing is decided at tick 2', ['holds so far', 'not decided', 'holds so far', 'not decided']);
  await recorded.locator('.expect-row').first().focus();
  await recorded.keyboard.press('Enter');
  const stalled = await until('the violation is shown', async () => {
    const rover = await recorded.evaluate(() => window.troupe.robots().find(robot => robot.name === 'rover'));
    return rover.stalled && await stateOf(recorded);
  });
  await seek(recorded, stalled.tick - 1);
  await until('it has not stalled before', () =>
    recorded.evaluate(() => !window.troupe.robots().find(robot => robot.name === 'rover').stalled));
  await verdictsAre(recorded, 'it held before', ['holds so far', 'holds', 'holds so far', 'not decided']);
  await recorded.emulateMedia({colorScheme: 'dark'});
  assert.deepEqual(await pages.findings(recorded), []);
  await recorded.screenshot({path: path('dark.png')});
  await recorded.click('#expectations-toggle');
  assert.ok(await recorded.isHidden('.expect-row'));
  await recorded.click('#expectations-toggle');
  assert.ok(await recorded.locator('.expect-row').first().isVisible());
  await close(recorded, viewed);
}

const bandsOf = page => page.$$eval('.expect-band', bands => bands.map(band => band.style.background));

// The bands lie on the axis of the timeline; on a phone the rows are closed at first, and fit a finger.
async function fitsThePage() {
  const viewed = new Program(troupe, ['view', path('watched.mcap'), '--listen', '127.0.0.1:0']);
  const url = await viewed.line('viewer: ');
  const page = await open(url);
  await page.locator('.expect-row').first().waitFor();
  const boxes = await page.evaluate(() => ['#timeline-box', '.expect-band'].map(each => {
    const {left, right} = document.querySelector(each).getBoundingClientRect();
    return [left, right];
  }));
  assert.ok(Math.abs(boxes[1][0] - boxes[0][0] - 7) < 1 && Math.abs(boxes[0][1] - boxes[1][1] - 7) < 1, JSON.stringify(boxes));
  await page.screenshot({path: path('light.png')});
  await page.close();
  const phone = await open(url, 390, 844, {hasTouch: true, isMobile: true});
  await phone.locator('#expectations-toggle').waitFor();
  assert.ok(await phone.isHidden('.expect-row'));
  await phone.tap('#expectations-toggle');
  const row = await phone.locator('.expect-row').first().boundingBox();
  assert.ok(row.height >= 44 && row.x >= 0 && row.x + row.width <= 390, JSON.stringify(row));
  assert.deepEqual(await pages.findings(phone), []);
  await phone.screenshot({path: path('phone.png')});
  await close(phone, viewed);
}

// A recording that stands gives the page one state and no news, however soon after the page's start.
async function asksAtOnce() {
  const viewed = new Program(troupe, ['view', path('watched.mcap'), '--listen', '127.0.0.1:0']);
  const url = await viewed.line('viewer: ');
  const page = await pages.open('about:blank', 1280, 720);
  await page.addInitScript(() => {
    const now = performance.now.bind(performance);
    performance.now = () => now() / 1000;
  });
  await page.goto(url);
  await page.locator('.expect-row').first().waitFor({timeout: 30_000});
  await close(page, viewed);
}

await pages.runAll([tellsOfARunAndOfItsRecording, fitsThePage, asksAtOnce], path);
