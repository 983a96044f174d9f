// Drives the page of `troupe view` in a headless Chromium against live runs.
//   node browser_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {existsSync, mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('browser_test', source);
const troupe = `${programs}/troupe`;
// Whose robots touch table tops, which their scanners do not see.
const scenario = `${source}/tests/browser/stalling_office.json`;
const domain = String(101 + (process.pid % 19));
const session = `browser-${process.pid}`;
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;

const open = url => pages.openRun(url, 1200, 640);

// All at one instant of the page.
function look(page, robot) {
  return page.evaluate(name => ({
    state: window.troupe.state(), robots: window.troupe.robots(), readings: window.troupe.readings(name),
  }), robot);
}

function stateOf(page, what, wanted) {
  return until(what, async () => {
    const state = await page.evaluate(() => window.troupe?.state() ?? null);
    return state !== null && wanted(state) ? state : null;  // a page that connects again has none
  });
}

function connected(page) {
  return until('the page is connected', () => page.evaluate(() => window.troupe?.connected()));
}

// The files of a run, by tick.
function readPoses(path) {
  const ticks = new Map();
  for (const line of readFileSync(path, 'utf8').trim().split('\n').slice(1)) {
    const [tick, name, x, y, z, heading, stalled, kind] = line.split(',');
    if (kind !== 'robot') continue;
    if (!ticks.has(+tick)) ticks.set(+tick, new Map());
    ticks.get(+tick).set(name, {x: +x, y: +y, z: +z, heading: +heading, stalled: stalled === '1'});
  }
  return ticks;
}

function readScans(path) {
  const scans = new Map();
  for (const line of readFileSync(path, 'utf8').trim().split('\n')) {
    const {tick, robot, sensor, ranges} = JSON.parse(line);
    scans.set(`${tick} ${robot} ${sensor}`, ranges);
  }
  return scans;
}

function readHashes(path) {
  return new Map(readFileSync(path, 'utf8').trim().split('\n').map(line => {
    const [tick, hash] = line.split(' ');
    return [+tick, hash];
  }));
}

function checkRobots({state, robots}, poses) {
  const expected = poses.get(state.tick);
  assert.equal(robots.length, expected.size, 'as many robots as in the world');
  for (const {name, pose, drawn, stalled} of robots) {
    const wanted = expected.get(name);
    for (const key of ['x', 'y', 'z', 'heading']) {
      assert.equal(pose[key], wanted[key], `${key} of ${name} at tick ${state.tick}`);
    }
    assert.equal(stalled, wanted.stalled);
    // The scene has 32-bit numbers.
    assert.ok(Math.hypot(drawn.x - wanted.x, drawn.y - wanted.y, drawn.z - wanted.z) < 1e-5, `${name} is drawn elsewhere`);
    const turn = Math.abs(drawn.heading - wanted.heading) % (2 * Math.PI);
    assert.ok(Math.min(turn, 2 * Math.PI - turn) < 1e-5, `${name} is drawn with another heading`);
  }
}

function checkReadings({readings, state}, robot, scans) {
  assert.equal(readings.tick, state.tick);
  assert.ok(Object.keys(readings.sensors).length > 0);
  for (const [sensor, fans] of Object.entries(readings.sensors)) {
    fans.forEach((ranges, i) => assert.deepEqual(ranges, scans.get(`${readings.tick} ${robot} ${sensor}.${i}`)));
  }
}

const run = (name, more) => new Program(troupe, [
  'run', scenario, '--domain', domain, '--session', `${session}-${name}`, ...more,
]);

async function showsTheRunAsItIs() {
  const ticks = 1200;  // two minutes until the pause
  const reference = run('reference', ['--headless', '--ticks', String(ticks), '--hash-log', path('reference.hash')]);
  assert.equal(await reference.end, 0, reference.lines.join('\n'));

  const viewed = run('viewed', [
    '--ticks', String(ticks), '--speed', '1', '--paused', '--hash-log', path('viewed.hash'), '--poses', path('poses.csv'),
    '--scans', path('scans.jsonl'),
  ]);
  const url = await viewed.line('viewer: ');
  const page = await open(`${url}#robot=anna&smooth=0`);
  const samples = [];
  const sample = async from => {
    await stateOf(from, 'the page has a state', () => true);  // after another connection
    samples.push(await look(from, 'anna'));
  };
  const readingsArrive = from => until('readings arrive', async () => (await look(from, 'anna')).readings);
  await readingsArrive(page);
  await sample(page);

  await page.click('#step');
  await stateOf(page, 'the run makes a step', state => state.paused && state.tick === 1);
  await sample(page);
  await page.click('#step-ten');
  await stateOf(page, 'the run makes ten steps', state => state.paused && state.tick === 11);
  await sample(page);
  await page.click('#play');
  for (let tick = 12; tick < 40; tick += 4) {
    await stateOf(page, 'the run plays', state => !state.paused && state.tick >= tick);
    await sample(page);
  }
  await until('the agent is shown', async () => /agent.*, process \d+, answers in [\d.]+ ms/.test(await page.textContent('#panel-facts')));
  await page.hover('.robot');
  await until('the agent of the row is shown', async () => {
    const {x, y, height} = await page.locator('.robot').first().boundingBox();
    await page.mouse.move(x + 60, y + height * (0.3 + 0.4 * Math.random()));
    return /, process \d+/.test(await page.getAttribute('.robot', 'title') ?? '');
  });
  // The service waits for most of a tick of 100 ms.
  await stateOf(page, 'the phases of ticks arrive', ({phases}) => phases?.step > 0 && phases.wait > phases.step);
  await until('the phases are shown', async () => /wait \d+.* · step .* ms/.test(await page.textContent('#phases')));
  await page.keyboard.press(' ');
  const paused = await stateOf(page, 'the run is paused', state => state.paused);
  assert.ok(paused.tick < ticks, 'the pause came in time');
  await sample(page);

  // Late, and again.
  const late = await open(`${url}#robot=anna&smooth=0`);
  await readingsArrive(late);
  await sample(late);
  assert.equal((await look(late, 'anna')).state.tick, paused.tick);
  await late.close();
  await page.reload();
  await stateOf(page, 'the page has a state again', state => state !== null);
  await readingsArrive(page);
  await sample(page);

  // Without its gateway the run continues, and the page connects to the next one.
  const [gateway] = viewed.children('view');
  pages.expectLossOfGateway(page);
  process.kill(gateway, 'SIGKILL');
  // Beside other work a killed process with a low priority holds its port for a while.
  await until('the gateway is gone', () => !existsSync(`/proc/${gateway}`));
  await until('the page knows', async () => !(await page.evaluate(() => window.troupe.connected())));
  const second = new Program(troupe, ['view', `${session}-viewed`, '--domain', domain, '--listen', new URL(url).host]);
  await second.line('viewer: ');
  await connected(page);
  await sample(page);
  await page.click('#play');
  await stateOf(page, 'the run plays', state => state.tick > paused.tick);
  await sample(page);
  // The last tick alone: the run waits at its end for some seconds only until viewers, which have a low priority, have all.
  await page.click('#play');
  const stopped = await stateOf(page, 'the run is paused again', state => state.paused);
  await page.evaluate(() => window.troupe.request('speed', {speed: 'max'}));
  await page.evaluate(count => window.troupe.request('step', {ticks: count}), ticks - 1 - stopped.tick);
  await stateOf(page, 'the run is before its last tick', state => state.paused && state.tick === ticks - 1);
  await page.click('#step');
  await stateOf(page, 'the run is over', state => state.over && state.tick === ticks);
  await sample(page);

  assert.equal(await viewed.end, 0, viewed.lines.join('\n'));
  assert.equal(await second.stop(), 0, second.lines.join('\n'));
  await page.close();

  const poses = readPoses(path('poses.csv'));
  const scans = readScans(path('scans.jsonl'));
  const hashes = readHashes(path('viewed.hash'));
  for (const shown of samples) {
    assert.equal(shown.state.hash, hashes.get(shown.state.tick));
    checkRobots(shown, poses);
    // Agents do not measure at the last tick, which they do not answer.
    if (shown.readings && shown.state.tick < ticks) checkReadings(shown, 'anna', scans);
  }
  assert.ok(samples.filter(shown => shown.readings).length >= 8);
  assert.deepEqual(hashes, readHashes(path('reference.hash')), 'a viewer changes no hash');
}

async function editsTheRun() {
  const edited = run('edited', ['--ticks', '1000000', '--speed', '1', '--paused']);
  const page = await open(await edited.line('viewer: '));
  const poseOf = async name => (await look(page, name)).robots.find(robot => robot.name === name)?.pose;
  await stateOf(page, 'the run is paused', state => state.paused);

  // Into a wall: refused, with the reason. Then to a free place, by mouse.
  const refused = await page.evaluate(() => window.troupe.request('set_pose', {name: 'anna', pose: [-8, 1.0, 0, 0]}));
  const before = await poseOf('anna');
  assert.equal(before.x, -8);
  assert.equal(refused.done, false);
  assert.notEqual(refused.problem, '');
  await page.click('#move');
  const from = await page.evaluate(() => window.troupe.placeOf('anna'));
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(from.x + 30, from.y, {steps: 4});
  await page.mouse.up();
  await until('the robot is moved', async () => (await poseOf('anna')).x > -7.9);
  await page.keyboard.press('Escape');
  // A click on a robot selects it.
  const at = await page.evaluate(() => window.troupe.placeOf('bela'));
  await page.mouse.click(at.x, at.y);
  await until('bela is selected', async () => (await page.textContent('#panel-name')) === 'bela');
  assert.match(page.url(), /#robot=bela/);

  await page.click('#delete');
  await until('bela is deleted', async () => !(await poseOf('bela')));
  await page.click('#reset');
  await until('bela is there again', () => poseOf('bela'));
  assert.equal((await poseOf('anna')).x, -8);

  // A viewer that only shows.
  const only = new Program(troupe, ['view', `${session}-edited`, '--domain', domain, '--view-only', '--listen', '127.0.0.1:0']);
  const watching = await open(await only.line('viewer: '));
  const reply = await watching.evaluate(() => window.troupe.request('play'));
  assert.equal(reply.done, false);
  assert.match(reply.problem, /view-only/);
  assert.ok(await watching.isDisabled('#play'));
  pages.expectLossOfGateway(watching, page);
  await watching.close();
  assert.equal(await only.stop(), 0);
  await page.close();
  await edited.stop();
}

async function drivesARobot() {
  const driven = run('driven', ['--ticks', '1000000', '--speed', '1']);
  const page = await open(`${await driven.line('viewer: ')}#robot=anna&smooth=0`);
  const anna = async () => (await look(page, 'anna')).robots.find(robot => robot.name === 'anna');
  const twist = (what, wanted) => until(what, async () => wanted((await anna()).twist));
  await until('anna is selected', async () => (await page.textContent('#panel-name')) === 'anna');

  // The speed of the run.
  await page.selectOption('#speed', '2');
  await stateOf(page, 'the run has another speed', state => state.speed === 2);

  // The robot stands still while it is not driven, whatever its controller commands.
  await page.keyboard.press('c');
  await twist('anna stands still', ([vx, , wz]) => vx === 0 && wz === 0);
  await page.keyboard.down('a');
  await twist('anna turns', ([vx, , wz]) => vx === 0 && wz > 0);
  await page.keyboard.up('a');
  await twist('anna stands still again', ([vx, , wz]) => vx === 0 && wz === 0);
  await page.keyboard.press('Escape');
  await twist('its controller continues', ([vx, , wz]) => vx !== 0 || wz !== 0);

  // A robot whose controller accepts no goals is not sent anywhere.
  const sent = await page.evaluate(() => window.troupe.request('command_robot', {name: 'anna', ticks: 5, goal: {waypoints: [[0, 0]]}}));
  assert.equal(sent.done, false);
  assert.match(sent.problem, /accepts no goals/);

  // Undo and redo.
  await page.click('#play');
  await stateOf(page, 'the run is paused', state => state.paused);
  await page.click('#reset');  // beside a wall, where its controller may have driven it by now, a move can be refused
  await until('anna is at its first pose', async () => (await anna())?.pose.x === -8);
  const before = (await anna()).pose.x;
  await page.click('#move');
  const from = await page.evaluate(() => window.troupe.placeOf('anna'));
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(from.x + 25, from.y, {steps: 4});
  await page.mouse.up();
  await until('anna is moved', async () => Math.abs((await anna()).pose.x - before) > 0.05);
  const after = (await anna()).pose.x;
  await page.keyboard.press('Control+z');
  await until('anna is back', async () => (await anna()).pose.x === before);
  await page.keyboard.press('Control+Shift+Z');
  await until('anna is moved again', async () => (await anna()).pose.x === after);
  await page.keyboard.press('Escape');
  const bela = async () => (await look(page, 'bela')).robots.find(robot => robot.name === 'bela');
  await page.evaluate(() => window.troupe.select('bela'));
  await until('bela is selected', async () => (await page.textContent('#panel-name')) === 'bela');
  await page.click('#delete');
  await until('bela is deleted', async () => !(await bela()));
  await page.click('#undo');
  await until('bela is there again', bela);
  pages.expectLossOfGateway(page);
  await page.close();
  await driven.stop();
}

async function showsThePast() {
  const ticks = 400;
  const recorded = run('recorded', [
    '--ticks', String(ticks), '--speed', '2', '--poses', path('past.csv'), '--hash-log', path('past.hash'),
    '--record', path('past.mcap'), '--keyframe-interval', '50',
  ]);
  const samples = [];
  const sample = async (page, tick) => {
    await stateOf(page, `tick ${tick} is shown`, state => state.past && state.tick === tick);
    samples.push(await look(page, 'anna'));
  };
  // Seeks by the slider, as a user drags it.
  const drag = (page, position) => page.$eval('#timeline', (slider, value) => {
    slider.value = String(value);
    slider.dispatchEvent(new Event('input'));
  }, position);

  const live = await open(`${await recorded.line('viewer: ')}#smooth=0`);
  const some = await stateOf(live, 'there is a past', state => state.last - state.first >= 20);
  await drag(live, some.first + 5);
  const past = await stateOf(live, 'the past is shown', state => state.past && state.tick < some.tick);
  samples.push(await look(live, 'anna'));
  assert.match(live.url(), /tick=/);
  await live.click('#live');
  pages.expectLossOfGateway(live);  // with the end of the run
  await stateOf(live, 'the page returns to the live run', state => !state.past && state.tick > past.tick);
  await stateOf(live, 'the run is over', state => state.over);
  assert.equal(await recorded.end, 0, recorded.lines.join('\n'));
  await live.close();

  const replayed = new Program(troupe, ['view', path('past.mcap'), '--listen', '127.0.0.1:0']);
  const page = await open(`${await replayed.line('viewer: ')}#tick=333&smooth=0`);
  await sample(page, 333);
  for (const tick of [0, 400, 51, 50, 49, 120]) {
    await drag(page, tick);  // without edits positions are ticks
    await sample(page, tick);
  }
  await page.click('#play');
  await stateOf(page, 'the recording plays', state => state.tick > 125);
  await page.click('#play');
  await page.click('#back');
  await stateOf(page, 'the recording plays backwards', state => state.tick < 120);
  await page.click('#back');
  assert.equal((await page.evaluate(() => window.troupe.request('pause'))).done, false);
  pages.expectLossOfGateway(page);
  await page.close();
  assert.equal(await replayed.stop(), 0);

  const poses = readPoses(path('past.csv'));
  const hashes = readHashes(path('past.hash'));
  assert.ok(samples.length >= 8);
  for (const shown of samples) {
    assert.equal(shown.state.hash, hashes.get(shown.state.tick));
    checkRobots(shown, poses);
  }
}

async function namesEventsByTheWorldInWhichTheyHappened() {
  writeFileSync(path('other.world'), 'name "other"\nposition ( name "zora" pose [0 0 0 0] )\n');
  const loaded = run('loaded', ['--ticks', '1000000', '--speed', '1', '--paused', '--record', path('loaded.mcap'), '--allow-files', files,
  ]);
  const url = `${await loaded.line('viewer: ')}#tab=events`;
  const page = await open(url);
  const events = from => from.$$eval('.event-text', texts => texts.map(text => text.textContent));
  const both = shown => shown.includes('anna has an agent') && shown.includes('zora has an agent');
  await until('the agents have joined', async () => (await events(page)).includes('anna has an agent'));
  const load = new Program(troupe, [
    'ctl', 'load', path('other.world'), '--session', `${session}-loaded`, '--domain', domain]);
  assert.equal(await load.end, 0, load.lines.join('\n'));
  await page.click('#step');  // events come with the next tick
  const shown = await until('the new agent has joined', async () => {
    const texts = await events(page);
    return both(texts) ? texts : null;
  });
  // A page that has seen the second world alone.
  const late = await open(url);
  await until('the late page has the events of both worlds', async () => both(await events(late)));
  assert.deepEqual(await events(late), shown);
  pages.expectLossOfGateway(late, page);
  await late.close();
  await page.close();
  await loaded.stop();

  const replayed = new Program(troupe, ['view', path('loaded.mcap'), '--listen', '127.0.0.1:0']);
  const replay = await open(`${await replayed.line('viewer: ')}#tab=events`);
  await until('the page of the recording has the events', async () => both(await events(replay)));
  assert.deepEqual(await events(replay), shown);
  pages.expectLossOfGateway(replay);
  await replay.close();
  assert.equal(await replayed.stop(), 0);
}

// A run that nobody has watched until its middle: what has happened before is listed, and plotted.
async function knowsWhatHappenedBefore() {
  const ticks = 240;
  const run_ = run('history', ['--ticks', String(ticks), '--speed', '4', '--paused', '--poses', path('history.csv')]);
  const control = async (...command) => {
    const program = new Program(troupe, ['ctl', ...command, '--domain', domain, '--session', `${session}-history`]);
    assert.equal(await program.end, 0, program.lines.join('\n'));
  };
  const url = await run_.line('viewer: ');
  await control('step', String(ticks / 2));  // and pauses: a page that opens slowly would miss the end
  const page = await open(`${url}#robot=anna&smooth=0&tab=events`);
  const first = await stateOf(page, 'the past begins with the run', state => state.first === 0 && state.last >= ticks / 2);
  assert.ok(first.tick >= ticks / 2);
  pages.expectLossOfGateway(page);  // with the end of the run
  await control('play');
  await stateOf(page, 'the run is over', state => state.over);

  // The end: a card with each robot, and the way that it has come.
  const poses = readPoses(path('history.csv'));
  let distance = 0;
  for (let tick = 1; tick <= ticks; ++tick) {
    const [a, b] = [poses.get(tick - 1).get('anna'), poses.get(tick).get('anna')];
    distance += Math.hypot(b.x - a.x, b.y - a.y);
  }
  const row = page.locator('.end-robot', {has: page.locator('.end-name', {hasText: 'anna'})});
  await row.waitFor();
  await until('the way of anna is summed up', async () => (await row.locator('.end-distance').textContent()) === `${distance.toFixed(1)} m`);
  assert.equal(await page.locator('.end-robot').count(), poses.get(ticks).size);
  assert.equal(await run_.end, 0, run_.lines.join('\n'));

  // The list has all events from the first tick on: the stalls are those of the file of poses.
  const stalls = [];
  for (let tick = 1; tick <= ticks; ++tick) {
    for (const [name, {stalled}] of poses.get(tick)) if (stalled && !poses.get(tick - 1).get(name).stalled) stalls.push(`${tick} ${name}`);
  }
  const events = await page.evaluate(() => window.troupe.events());
  const listed = events.filter(({text}) => text.includes(' stalls at ')).map(({tick, text}) => `${tick} ${text.split(' ')[0]}`);
  assert.deepEqual(listed.sort(), stalls.sort());
  assert.ok(stalls.some(text => Number(text.split(' ')[0]) < ticks / 2), 'some were before the page');
  await page.close();
}

// A run on a terminal, which its page starts again: with its seed, then with another one.
async function startsTheRunAgain() {
  const hashes = path('again.hashes');
  const terminal = new Program('script', ['-qefc', [
    'exec', 'env', 'NO_COLOR=1', troupe, 'run', scenario, '--domain', domain, '--session', `${session}-again`, '--ticks', '60',
    '--speed', '20', '--seed', '7', '--paused', '--hash-log', hashes,
  ].join(' '), '/dev/null'], 'pipe');
  const addresses = () => terminal.lines.flatMap(line => line.match(/viewer: (http\S+)/)?.[1] ?? []);
  const url = await until('the address is printed', () => addresses()[0]);
  const page = await open(url);
  const card = page.locator('#end-card');
  // The service writes it after the frame that the page shows.
  const lastHash = () => until('the last hash is written', () => readHashes(hashes).get(60));
  const play = async () => {
    await stateOf(page, 'the run can begin', state => state.paused && state.tick === 0);
    await page.click('#play');
    await card.waitFor();
  };
  const hashOf = async seed => {
    const log = path('seed.hashes');
    const alone = new Program(troupe, ['run', scenario, '--in-process', '--headless', '--ticks', '60', '--seed', seed, '--hash-log', log]);
    assert.equal(await alone.end, 0, alone.lines.join('\n'));
    return readHashes(log).get(60);
  };
  await play();
  assert.equal(await lastHash(), await hashOf('7'));
  await page.waitForTimeout(6000);  // longer than the launcher waits for agents that hang
  assert.ok(await connected(page), 'the page stays open');
  pages.expectLossOfGateway(page);  // the page connects again
  await page.evaluate(() => { Math.random = () => 0.25; });  // the seed that the page draws is known
  for (const [button, seed] of [['Run again', '7'], ['Another seed', '250001']]) {
    await card.locator('button', {hasText: button}).click();
    await card.waitFor({state: 'hidden'});
    await play();
    assert.equal(await lastHash(), await hashOf(seed), button);
    assert.equal(addresses().at(-1), url, 'each run has the address of the page');
  }
  assert.equal(addresses().length, 3);
  await page.close();
  terminal.child.stdin.write('\x03');
  assert.equal(await terminal.end, 0);
}

async function plotsAndSeeks() {
  const ticks = 150;
  const recorded = run('plotted', [
    '--ticks', String(ticks), '--headless', '--speed', 'max', '--poses', path('plotted.csv'), '--record', path('plotted.mcap'),
  ]);
  assert.equal(await recorded.end, 0, recorded.lines.join('\n'));
  const poses = readPoses(path('plotted.csv'));
  const viewer = new Program(troupe, ['view', path('plotted.mcap'), '--listen', '127.0.0.1:0']);
  const page = await open(`${await viewer.line('viewer: ')}#robot=anna&smooth=0&tab=events`);

  // A click on an event goes to its state.
  await page.locator('.event').first().waitFor();
  const late = await page.evaluate(() => window.troupe.events().filter(({text}) => text.includes(' stalls at ')).at(-1));
  assert.ok(late.tick > 0);
  await page.locator('.event', {hasText: late.text.split(' stalls')[0]}).filter({hasText: 'stalls'}).first().click();
  const at = await stateOf(page, 'the page is at an event', state => state.past && state.tick > 0);
  assert.ok((await page.evaluate(() => window.troupe.events())).some(({tick}) => tick === at.tick));

  // Kinds that are switched off are not listed.
  const contacts = page.locator('.chip', {hasText: 'Contacts'});
  await contacts.click();
  await until('no contact is listed', async () => !(await page.textContent('#event-list')).includes('stalls'));
  await contacts.click();

  // The export has the values of the file of poses, all of them.
  await page.click('#tab-state');
  await page.evaluate(() => window.troupe.select('anna'));
  await page.locator('.plot-name', {hasText: 'anna speed'}).waitFor();
  await page.selectOption('.plot-window', 'Infinity');
  await page.evaluate(() => window.troupe.plot(['x', 'y', 'heading', 'stalled']));
  const [head, ...lines] = (await page.evaluate(() => window.troupe.csv())).trim().split('\n');
  assert.equal(head, 'tick,time,anna.speed,anna.x,anna.y,anna.heading,anna.stalled');
  assert.equal(lines.length, ticks + 1);
  for (const line of lines) {
    const [tick, time, , x, y, heading, stalled] = line.split(',').map(Number);
    const wanted = poses.get(tick).get('anna');
    assert.deepEqual([x, y, heading, stalled], [wanted.x, wanted.y, wanted.heading, Number(wanted.stalled)], `tick ${tick}`);
    assert.ok(Math.abs(time - 0.1 * tick) < 1e-9);
  }
  // The plots have the values without having seen the states.
  await until('the legend has the value of the shown state', async () => {
    const {tick} = await page.evaluate(() => window.troupe.state());
    const text = await page.locator('.plot-name', {hasText: 'anna x'}).locator('.plot-value').textContent();
    return text === `${poses.get(tick).get('anna').x.toFixed(2)} m`;
  });
  // A click into a plot goes to its moment.
  await page.locator('.plot-canvas').first().scrollIntoViewIfNeeded();
  const canvas = await page.locator('.plot-canvas').first().boundingBox();
  await page.mouse.click(canvas.x + canvas.width - 9, canvas.y + 40);
  await stateOf(page, 'the page is at the end', state => state.tick >= ticks - 2);
  // The card of the last state, with each robot.
  await page.focus('#timeline');
  await page.keyboard.press('End');
  await stateOf(page, 'the page shows the last state', state => state.tick === ticks);
  await page.locator('#end-card', {hasText: 'The end of the recording'}).locator('.end-robot').first().waitFor();
  assert.equal(await page.locator('.end-robot').count(), poses.get(ticks).size);
  await page.locator('#end-card button', {hasText: 'Look back'}).click();
  await page.keyboard.press('Home');
  assert.ok(await page.isHidden('#end-card'));
  pages.expectLossOfGateway(page);
  await page.close();
  assert.equal(await viewer.stop(), 0);
}

await pages.runAll([showsTheRunAsItIs, editsTheRun, drivesARobot, showsThePast, namesEventsByTheWorldInWhichTheyHappened,
  knowsWhatHappenedBefore, startsTheRunAgain, plotsAndSeeks], path);
