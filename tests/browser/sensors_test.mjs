// The readings of all kinds of sensors, the stores of energy and the lights on the page of `troupe view`, against the scan
// logs of the same runs.
//   node sensors_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('sensors_test', source);
const troupe = `${programs}/troupe`;
const domain = String(101 + (process.pid % 19));
const session = `sensors-${process.pid}`;
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;

const open = url => pages.openRun(url, 1280, 800);

const contentsOf = (page, robot) => page.evaluate(name => window.troupe.contents(name), robot);
const ask = (page, command, more) => page.evaluate(([name, rest]) => window.troupe.request(name, rest), [command, more]);

// Steps the paused run, and returns the contents of the state after, with the images of cameras.
async function step(page, robot, ticks) {
  const before = await page.evaluate(() => window.troupe.state());
  const answer = await ask(page, 'step', {ticks});
  assert.equal(answer.done, true, answer.problem);
  const tick = before.tick + ticks;
  const contents = await until(`the readings of tick ${tick} arrive`, async () => {
    const now = await contentsOf(page, robot);
    return now && Object.values(now).every(({tick: of}) => of === tick) ? now : null;
  });
  return {tick, contents};
}

// The readings by tick, robot and sensor.
function readLog(name) {
  const lines = new Map();
  for (const text of readFileSync(path(name), 'utf8').trim().split('\n')) {
    const line = JSON.parse(text);
    lines.set(`${line.tick} ${line.robot} ${line.sensor}`, line);
  }
  return lines;
}

// The content of the page as the scan log has it. `names`: of models and robots.
const asLogged = {
  fiducial: ({fiducials}, names) => ({
    fiducials: fiducials.map(({id, model, range, bearing}) => ({id, model: names.models[model], range, bearing})),
  }),
  bumper: ({segments}, names) => ({pressed_by: segments.map(({pressedBy}) => names.models[pressedBy] ?? null)}),
  contact: ({contacts}, names) => ({
    contacts: contacts.map(({part, other, point, zMin, zMax}) => ({
      part: names.models[part], other: names.models[other], point: [point.x, point.y], z: [zMin, zMax],
    })),
  }),
  blobfinder: ({blobs}) => ({blobs: blobs.map(({color, ...blob}) => ({color: color.slice(0, 3), ...blob}))}),
  camera: ({width, height, colors}) => ({width, height, colors}),
  radio: ({receptions}, names) => ({
    received: receptions.map(({from, toAll, bytes, rssi, tick, place}) => (
      {from: names.robots[from], to_all: toAll, bytes, rssi, tick, ...place})),
  }),
  imu: ({heading, turn, force, forceZ}) => ({heading, turn, force: [force.x, force.y, forceZ]}),
};

// Only the members that the page has as well.
function restricted(logged, like) {
  if (Array.isArray(like)) return like.map((value, i) => restricted(logged?.[i], value));
  if (like === null || typeof like !== 'object') return logged;
  return Object.fromEntries(Object.entries(like).map(([key, value]) => [key, restricted(logged?.[key], value)]));
}

function checkContents({tick, contents}, robot, log, names) {
  const kinds = new Set();
  for (const [sensor, {content}] of Object.entries(contents)) {
    const what = `${sensor} of ${robot} at tick ${tick}`;
    kinds.add(content.kind);
    if (content.kind === 'ranger') {
      const ranges = content.geometry.flatMap((_, i) => log.get(`${tick} ${robot} ${sensor}.${i}`).ranges);
      assert.deepEqual(content.ranges, ranges, what);
      continue;
    }
    const shown = asLogged[content.kind](content, names);
    const logged = log.get(`${tick} ${robot} ${sensor}`);
    assert.ok(logged, what);
    for (const list of ['fiducials', 'contacts', 'blobs', 'received']) {
      if (shown[list]) assert.equal(shown[list].length, logged[list].length, what);
    }
    assert.deepEqual(shown, restricted(logged, shown), what);
  }
  return kinds;
}

const namesOf = page => page.evaluate(() => window.troupe.names());

// The colours on the canvas of a camera, as in the scan log. They are read from a copy, because Chromium warns of a canvas
// that is read often and was not made for it, as that of the page is not.
const canvasOf = (page, sensor) => page.$eval(`[data-sensor="${sensor}"] canvas`, canvas => {
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', {willReadFrequently: true});
  copy.drawImage(canvas, 0, 0);
  const {data} = copy.getImageData(0, 0, canvas.width, canvas.height);
  let text = '';
  for (let i = 0; i < data.length; ++i) if (i % 4 !== 3) text += data[i].toString(16).padStart(2, '0');
  return text;
});
const textOf = (page, sensor) => page.textContent(`[data-sensor="${sensor}"]`);

async function end(page, run, what) {
  pages.expectLossOfGateway(page);
  await page.click('#play');
  assert.equal(await run.end, 0, `${what}: ${run.lines.join('\n')}`);
  await page.close();
}

async function showsAllKindsOfSensors() {
  const ticks = 20;
  const run = new Program(troupe, [
    'run', `${source}/worlds/scenarios/sensors.json`, '--domain', domain, '--session', `${session}-all`, '--paused',
    '--ticks', String(ticks), '--scans', path('all.jsonl'),
  ]);
  const page = await open(`${await run.line('viewer: ')}#robot=scout&smooth=0`);
  const names = await namesOf(page);
  const samples = [await step(page, 'scout', 1), await step(page, 'scout', 9)];

  // The image of the newest state, though the panel shows few of them.
  const {colors} = samples[1].contents.eye.content;
  assert.equal(colors.length, 2 * 3 * 320 * 240);
  await until('the canvas shows the image of the camera', async () => (await canvasOf(page, 'eye')) === colors);
  assert.match(await textOf(page, 'finder'), /red/);
  assert.match(await textOf(page, 'bumper'), /not pressed/);
  assert.match(await textOf(page, 'blobs'), /blob/);
  assert.match(await textOf(page, 'imu'), /force z9\.8/);
  await page.setViewportSize({width: 1280, height: 1700});  // the whole panel
  await page.screenshot({path: path('all.png')});

  // Against a wall. The log has the lines of that tick from after the edit.
  await step(page, 'scout', 1);
  const moved = await ask(page, 'set_pose', {name: 'scout', pose: [-5.6995, 0, 0, Math.PI]});
  assert.equal(moved.done, true, moved.problem);
  samples.push(await step(page, 'scout', 1));
  const {bumper, skin} = samples[2].contents;
  assert.equal(names.models[bumper.content.segments[0].pressedBy], 'west');
  assert.ok(skin.content.contacts.length > 0);
  await until('the bumper is pressed', async () => (await textOf(page, 'bumper')).includes('pressed by west'));
  await until('the contact is listed', async () => (await textOf(page, 'skin')).includes('west'));
  await page.screenshot({path: path('pressed.png')});

  // Without a panel there are no images, and without a selection no readings.
  await page.click('#panel-close');
  await until('no readings arrive', async () => !(await contentsOf(page, 'scout')));
  await page.click('#rays');
  const all = await until('all readings arrive', () => contentsOf(page, 'scout'));
  assert.equal(all.eye.content.kind, 'none');
  assert.equal(all.finder.content.kind, 'fiducial');
  await end(page, run, 'the run of all kinds');

  const log = readLog('all.jsonl');
  const kinds = new Set(samples.flatMap(sample => [...checkContents(sample, 'scout', log, names)]));
  assert.deepEqual([...kinds].sort(), ['blobfinder', 'bumper', 'camera', 'contact', 'fiducial', 'imu', 'ranger']);
}

async function showsRadioMessages() {
  const run = new Program(troupe, [
    'run', `${source}/worlds/scenarios/radio.json`, '--domain', domain, '--session', `${session}-radio`, '--paused',
    '--ticks', '60', '--scans', path('radio.jsonl'),
  ]);
  const page = await open(`${await run.line('viewer: ')}#robot=bert&smooth=0`);
  const names = await namesOf(page);
  const samples = [];
  const hears = ({contents}) => Object.values(contents).some(({content}) => content.receptions?.length > 0);
  while (!samples.some(hears)) samples.push(await step(page, 'bert', 1));
  const [[radio]] = Object.entries(samples.at(-1).contents).filter(([, {content}]) => content.kind === 'radio');
  await until('the message is listed', async () => /(anna|dora)here is (anna|dora)-?[\d.]+ dBm/.test(await textOf(page, radio)));
  await page.screenshot({path: path('radio.png')});
  await end(page, run, 'the run with radios');
  const log = readLog('radio.jsonl');
  for (const sample of samples) checkContents(sample, 'bert', log, names);
}

// A robot that stands on a charging plate and switches its light off after 1 s, beside a blinking light.
const POWER_WORLD = `
name "power"
model( name "plate" pose [0 0 0 0] size [2 2 0.02] color "light green" obstacle_return 0 joules -1 give_watts 400 )
blinkenlight( name "beacon" pose [2 1 0 0] size [0.4 0.4 0.8] color "orange" period 1000 dutycycle 0.5 )
position
(
  name "carrier" pose [0 0 0 0] size [0.6 0.5 0.25] color "steel blue" drive "diff"
  joules 500 joules_capacity 1000 watts 5 take_watts 105
  blinkenlight( name "lamp" size [0.3 0.3 0.2] color "yellow" )
)
`;

async function showsEnergyAndLights() {
  writeFileSync(path('power.world'), POWER_WORLD);
  writeFileSync(path('power.json'), JSON.stringify({
    name: 'power', world: 'power.world', seed: 1, speed: 'max',
    robots: [{name: 'carrier', controller: {name: 'script', parameters: {commands: [{at: 1, lights: {lamp: false}}]}}}],
  }));
  const run = new Program(troupe, [
    'run', path('power.json'), '--domain', domain, '--session', `${session}-power`, '--paused', '--ticks', '100',
  ]);
  const page = await open(`${await run.line('viewer: ')}#robot=carrier&smooth=0`);
  const lights = () => page.evaluate(() => window.troupe.lights());
  const power = () => page.textContent('#panel-power');
  const at = async ticks => {
    const {tick} = await page.evaluate(() => window.troupe.state());
    if (ticks > tick) assert.equal((await ask(page, 'step', {ticks: ticks - tick})).done, true);
    await until(`tick ${ticks} is shown`, async () => (await page.evaluate(() => window.troupe.state())).tick === ticks);
  };
  await until('the energy is shown', async () => /energy500\.0 Jof 1\.00 kJ/.test(await power()));
  assert.match(await power(), /lampon/);
  assert.deepEqual(await lights(), {beacon: true, 'carrier.lamp': true});
  // Blinking follows simulated time: it is dark in the second half of each second.
  await at(4);
  assert.equal((await lights()).beacon, true);
  await at(5);
  assert.equal((await lights()).beacon, false);
  await page.screenshot({path: path('power.png')});
  await at(10);
  assert.equal((await lights()).beacon, true);
  await at(20);
  assert.deepEqual(await lights(), {beacon: true, 'carrier.lamp': false});
  // 100 W more than it consumes.
  await until('the light is switched off', async () => /lampswitched off/.test(await power()));
  await until('the store is charged', async () => /energy700\.0 J.*charging with 105\.0 W/.test(await power()));
  await page.screenshot({path: path('dark.png')});
  await end(page, run, 'the run with energy');
}

await pages.runAll([showsAllKindsOfSensors, showsRadioMessages, showsEnergyAndLights], path);
