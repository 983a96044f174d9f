// Drives the page of `troupe edit` in a headless Chromium: worlds, scenarios and models are edited by mouse and keys, saved,
// and read by the other programs.
//   node editor_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {cpSync, existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);

function skip(reason) {
  console.log(`editor_test: ${reason}; nothing was checked`);
  process.exit(77);
}

const chromium = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(path => existsSync(path));
if (!chromium) skip('chromium is not installed');
const require = createRequire(`${source}/viewer/web/package.json`);
let playwright;
let WebSocket;
try {
  playwright = require('playwright-core');
  WebSocket = require('ws');
} catch {
  skip('the packages of viewer/web are not installed');
}

const troupe = `${programs}/troupe`;
rmSync(files, {recursive: true, force: true});
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;
const read = name => readFileSync(path(name), 'utf8');

const browser = await playwright.chromium.launch({
  executablePath: chromium,
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const problems = [];  // of all pages

async function edit(file, more = []) {
  const program = new Program(troupe, ['edit', path(file), '--listen', '127.0.0.1:0', ...more]);
  const url = await program.line('editor: ');
  const page = await browser.newPage({viewport: {width: 1280, height: 800}});
  page.on('console', message => {
    if (['error', 'warning'].includes(message.type()) && !message.text().includes('GPU stall')) problems.push(message.text());
  });
  page.on('pageerror', error => problems.push(error.message));
  page.on('request', request => {
    const to = new URL(request.url());
    if (to.protocol.startsWith('http') && to.hostname !== '127.0.0.1') problems.push(`request to ${to}`);
  });
  page.setDefaultTimeout(120_000);
  await page.goto(`${url}#view=top`);
  await until('the page has the file', () => page.evaluate(() => Boolean(window.troupe?.file() && window.troupe.state())));
  return {program, page, url};
}

const documentOf = page => page.evaluate(() => window.troupe.file());

function fileIs(page, what, wanted) {
  return until(what, async () => {
    const shown = await documentOf(page);
    return wanted(shown) ? shown : null;
  });
}

async function save(page) {
  await page.click('#file-save');
  await fileIs(page, 'the file is saved', shown => !shown.modified);
}

async function drag(page, from, to, modifiers = []) {
  await page.mouse.move(from.x, from.y);
  for (const key of modifiers) await page.keyboard.down(key);
  await page.mouse.down();
  await page.mouse.move((from.x + to.x) / 2, (from.y + to.y) / 2);
  await page.mouse.move(to.x, to.y);
  await page.mouse.up();
  for (const key of modifiers) await page.keyboard.up(key);
}

const ground = (page, x, y) => page.evaluate(([a, b]) => window.troupe.groundPoint(a, b), [x, y]);
const placeOf = (page, name) => until(`${name} has a place`, () => page.evaluate(n => window.troupe.placeOf(n), name));

async function close({program, page}) {
  await page.close({runBeforeUnload: false});
  assert.equal(await program.stop(), 0, program.lines.join('\n'));
}

async function check(file) {
  const checked = new Program(troupe, ['check', path(file)]);
  assert.equal(await checked.end, 0, checked.lines.join('\n'));
  return checked.lines.join('\n');
}

// The words that are in one text only.
function changedLines(before, after) {
  const a = before.split('\n');
  const b = after.split('\n');
  assert.equal(a.length, b.length, 'as many lines as before');
  return a.map((line, i) => [line, b[i]]).filter(([x, y]) => x !== y);
}

async function movesATableOfAWorld() {
  cpSync(`${source}/worlds`, files, {recursive: true});
  const original = read('office.world');
  const editor = await edit('office.world');
  const {page} = editor;
  const shown = await documentOf(page);
  assert.equal(shown.kind, 'world');
  assert.ok(shown.entities.some(entity => entity.name === 'table0' && entity.here));

  await page.click('#move');
  const from = await placeOf(page, 'table0');
  await drag(page, from, {x: from.x + 60, y: from.y});
  await fileIs(page, 'the table is moved', now => now.modified && now.undo === 'the move of table0');
  await page.keyboard.press('Escape');
  await page.click('#undo');
  await fileIs(page, 'the move is undone', now => !now.modified && now.redo === 'the move of table0');
  await page.click('#redo');
  await fileIs(page, 'the move is redone', now => now.modified);
  await save(page);
  const changed = changedLines(original, read('office.world'));
  assert.equal(changed.length, 1, 'one line has changed');
  const tokens = changed[0].map(line => line.split(/([\s[\]()]+)/));
  const different = tokens[0].filter((token, i) => token !== tokens[1][i]);
  assert.equal(different.length, 1, `one token has changed: ${changed[0].join(' -> ')}`);

  // By the panel: a property with its help, and one that is refused with its place.
  await page.click('.entity:has-text("table0")');
  const color = page.locator('#file-properties input[data-property=color]');
  await color.waitFor();
  await color.fill('blue');
  await color.press('Enter');
  await fileIs(page, 'the colour is changed', now => now.undo === 'the color of table0');
  const pose = page.locator('#file-properties input[data-property=pose]');
  await pose.fill('[1 2');
  await pose.press('Enter');
  await page.locator('.toast.error').first().waitFor();
  assert.equal((await documentOf(page)).undo, 'the color of table0', 'the wrong pose is refused');

  // Names and deletion by keys.
  page.once('dialog', dialog => void dialog.accept('desk'));
  await page.click('#file-rename');
  await fileIs(page, 'the table has another name', now => now.entities.some(entity => entity.name === 'desk'));
  await page.click('#file-delete');
  await fileIs(page, 'the table is gone', now => !now.entities.some(entity => entity.name === 'desk'));
  await save(page);
  assert.ok(!read('office.world').includes('desk'));
  await check('office.world');

  // Another program writes the file: the editor does not replace its work unasked.
  await page.click('#file-wall');
  await drag(page, await ground(page, -2, 0.5), await ground(page, 2, 0.5));
  await page.keyboard.press('Escape');
  await fileIs(page, 'there is a wall', now => now.entities.some(entity => entity.name === 'wall1'));
  writeFileSync(path('office.world'), `${read('office.world')}# by hand\n`);
  const answers = [false, false];
  page.on('dialog', dialog => void (answers.shift() ? dialog.accept() : dialog.dismiss()));
  await page.click('#file-save');
  await until('both questions are asked', () => answers.length === 0);
  assert.ok(read('office.world').endsWith('# by hand\n'));
  answers.push(true);
  await page.click('#file-save');
  await fileIs(page, 'the file is replaced', now => !now.modified);
  assert.ok(read('office.world').includes('wall1') && !read('office.world').includes('# by hand'));
  await page.screenshot({path: path('world.png')});
  await close(editor);
}

// The issue of heights: what is drawn in the two views is what robots meet.
async function drawsAModel() {
  const editor = await edit('drawn.world');
  const {page} = editor;
  await page.click('#file-model');
  await page.fill('#model-name', 'bridge');
  const at = (view, a, b) => page.evaluate(([v, x, y]) => window.troupe.modelPoint(v, x, y), [view, a, b]);
  // The outline, corner by corner, closed by the first one.
  for (const [x, y] of [[-0.25, -0.35], [0.25, -0.35], [0.25, 0.35], [-0.25, 0.35], [-0.25, -0.35]]) {
    const point = await at('top', x, y);
    await page.mouse.click(point.x, point.y);
  }
  await until('the block is drawn', async () => (await page.locator('.block-row').count()) === 1);
  // From 0 to 0.5 m to 0.4 to 0.7 m: the top first.
  await drag(page, await at('side', 0, 0.5), await at('side', 0, 0.7));
  await drag(page, await at('side', 0, 0), await at('side', 0, 0.4));
  await page.fill('#model-color', 'orange');
  await page.click('#model-apply');
  const shown = await fileIs(page, 'the model is in the file', now => now.undo === 'the new model bridge');
  assert.equal(shown.error, '');
  await page.screenshot({path: path('model_drawn.png')});

  // A test of it: a probe that is lower than its underside drives below it, a higher one stalls.
  const probe = async height => {
    await page.fill('#model-probe', String(height));
    await page.click('#model-test');
    await fileIs(page, 'the test runs', now => now.testing && now.tested === 'bridge');
    const result = await until('the probe has passed or stalled', async () => {
      const robot = (await page.evaluate(() => window.troupe.robots())).find(each => each.name === 'probe');
      return robot && (robot.stalled || robot.pose.x > 1) ? robot : null;
    });
    await page.click('#file-test');
    await fileIs(page, 'the test has ended', now => !now.testing);
    await page.click('.palette-line:has-text("bridge") .plain');
    await page.locator('#model-editor').waitFor();
    return result;
  };
  assert.ok((await probe(0.35)).pose.x > 1, 'a low probe drives under the bridge');
  const high = await probe(0.45);
  assert.ok(high.stalled && high.pose.x < -0.25, 'a high probe is stopped by it');

  // A sensor, with its fan in the view from above.
  await page.click('#model-close');
  await page.click('#file-model');
  await page.fill('#model-name', 'runner');
  await page.fill('#model-base', 'position');
  for (const [x, y] of [[-0.2, -0.15], [0.2, -0.15], [0.2, 0.15], [-0.2, 0.15], [-0.2, -0.15]]) {
    const point = await at('top', x, y);
    await page.mouse.click(point.x, point.y);
  }
  await page.click('#model-apply');
  await fileIs(page, 'the robot is in the file', now => now.undo === 'the new model runner');
  await page.selectOption('#part-type', 'ranger');
  await page.click('#part-add');
  await fileIs(page, 'it has a ranger', now => now.undo === 'the ranger of runner');
  const range = page.locator('.part .part input[data-property=fov]');
  await range.fill('90');
  await range.press('Enter');
  await fileIs(page, 'the fan is narrower', now => now.undo === 'the fov of runner');
  await page.screenshot({path: path('model.png')});
  await page.click('#model-close');

  // From the palette into the world, by mouse.
  await page.click('.palette-row[data-model=bridge]');
  const place = await ground(page, 1, 0);
  await page.mouse.click(place.x, place.y);
  await fileIs(page, 'the bridge is in the world', now => now.entities.some(entity => entity.name === 'bridge1'));
  await page.click('.palette-row[data-model=runner]');
  const start = await ground(page, -1, 1.5);
  await page.mouse.click(start.x, start.y);
  await fileIs(page, 'the robot is in the world', now => now.entities.some(entity => entity.name === 'runner1'));
  await save(page);
  await page.screenshot({path: path('drawn_world.png')});
  await close(editor);

  assert.match(await check('drawn.world'), /drawn/);
  const robot = (name, y, height) => ({
    name, model: 'position', pose: [-1, y, 0], properties: {size: [0.2, 0.2, height]},
    controller: {name: 'script', parameters: {commands: [{at: 0, vx: 0.5}]}},
  });
  writeFileSync(path('heights.json'), JSON.stringify({
    world: 'drawn.world', robots: [robot('low', 0.2, 0.39), robot('high', -0.2, 0.41)],
  }));
  const run = new Program(troupe, [
    'run', path('heights.json'), '--in-process', '--headless', '--ticks', '100', '--speed', 'max', '--poses', path('poses.csv'),
  ]);
  assert.equal(await run.end, 0, run.lines.join('\n'));
  const last = read('poses.csv').trim().split('\n').map(line => line.split(',')).filter(([tick]) => tick === '100');
  const of = name => last.find(row => row[1] === name);
  assert.ok(Number(of('low')[2]) > 2, 'a robot of 0.39 m drives under a bridge at 0.4 m');
  assert.equal(of('high')[6], '1', 'a robot of 0.41 m is stopped by it');
  assert.ok(Math.abs(Number(of('high')[2]) - 0.65) < 0.02, `at its edge: ${of('high')[2]}`);
}

async function editsAScenario() {
  mkdirSync(path('scenarios'), {recursive: true});
  const original = read('scenarios/demo.json');
  const editor = await edit('scenarios/demo.json');
  const {page} = editor;
  await page.click('#move');
  const anna = await placeOf(page, 'anna');
  await drag(page, anna, {x: anna.x, y: anna.y - 15});
  await fileIs(page, 'anna is moved', now => now.undo === 'the move of anna');
  await page.keyboard.press('Escape');
  await save(page);
  assert.equal(changedLines(original, read('scenarios/demo.json')).length, 1);

  await page.click('#file-region');
  await drag(page, await ground(page, -1.5, -0.8), await ground(page, 1.5, 0.8));
  await fileIs(page, 'there is a spawn region', now => now.regions.length === 1);
  await page.locator('#region-list select').selectOption('scout');
  await fileIs(page, 'of scouts', now => now.regions[0].model === 'scout');
  const count = page.locator('#region-list input');
  await count.fill('3');
  await count.press('Enter');
  await fileIs(page, 'of three of them', now => now.regions[0].count === 3 && now.entities.some(each => each.name === 'scout2'));
  await save(page);
  assert.match(await check('scenarios/demo.json'), /robots: 11/);

  // The text, with an error that is shown at its place, and corrected.
  await page.click('#file-text');
  await page.locator('#text-editor').waitFor();  // with the text
  const text = await page.inputValue('#text-area');
  await page.fill('#text-area', text.replace('"seed": 1,', '"seed": "one",'));
  await page.click('#text-apply');
  const broken = await fileIs(page, 'the error is shown', now => now.error !== '');
  assert.match(broken.error, /demo\.json:4:\d+: error: /);
  assert.equal(await page.textContent('#text-error'), broken.error);
  await page.fill('#text-area', text);
  await page.click('#text-apply');
  await fileIs(page, 'the error is corrected', now => now.error === '' && !now.modified);
  await page.click('#text-close');
  await page.screenshot({path: path('scenario.png')});
  await close(editor);
}

// The reply to a request by a program, or the code of the end of the connection.
function ask(url, message, {origin = url.origin, host, token = true} = {}) {
  return new Promise(resolve => {
    const address = `ws://${url.host}/socket${token ? url.search : ''}`;
    const socket = new WebSocket(address, 'troupe', {headers: {Origin: origin, ...(host ? {Host: host} : {})}});
    socket.on('open', () => socket.send(message));
    socket.on('message', data => {
      const text = data.toString();
      if (!text.includes('"type":"reply"')) return;
      resolve(JSON.parse(text));
      socket.close();
    });
    socket.on('unexpected-response', (_request, response) => resolve(response.statusCode));
    socket.on('close', code => resolve(code));
    socket.on('error', () => {});
  });
}

async function refusesStrangers() {
  const editor = await edit('office.world', ['--view-only']);
  const {page, program} = editor;
  const url = new URL(editor.url);
  const request = (op, more = {}) => JSON.stringify({type: 'edit', id: 1, op, ...more});
  assert.equal(await ask(url, request('document'), {token: false}), 403);
  assert.equal(await ask(url, request('document'), {origin: 'http://evil.example'}), 403);
  assert.equal(await ask(url, request('document'), {host: 'evil.example', origin: 'http://evil.example'}), 403);
  assert.equal((await ask(url, request('document'))).done, true);
  for (const op of ['save', 'set_text', 'undo', 'reload', 'test', 'delete', 'set_model', 'add_model', 'nonsense']) {
    const reply = await ask(url, request(op, {text: '', name: 'walls'}));
    assert.equal(reply.done, false);
    assert.match(reply.problem, /--view-only/);
  }
  assert.equal(await ask(url, request('set_text', {text: 'x'.repeat(1_100_000)})), 1009);
  assert.equal(await ask(url, '{"type": "edit"}'), 1008);
  assert.equal(await ask(url, 'garbage'), 1008);
  assert.ok(await page.locator('#file-save').isHidden());
  assert.equal(program.ended, undefined, 'the editor is still there');
  await close(editor);

  // Requests of another form are refused, and change nothing.
  const open = await edit('office.world');
  const address = new URL(open.url);
  const deep = '['.repeat(100_000);
  for (const [op, more] of [
    ['set_pose', {name: 'walls', pose: [1, 2, 3]}], ['set_pose', {name: 'walls', pose: ['a', 0, 0, 0]}],
    ['set_property', {name: 'walls', property: 'color', value: '"red" ) include "/etc/passwd"'}],
    ['set_property', {name: 'walls', property: 'include', value: '"/etc/passwd"'}],
    ['set_property', {name: 'walls', property: 'a b', value: '1'}], ['rename', {name: 'walls', to: 'a" b "'}],
    ['set_model', {name: 'x', base: 'model', blocks: [{outline: [[0, 0], [1, 1]], z: [0, 1]}]}],
    ['set_model', {name: 'x', base: 'model', blocks: [{outline: [[0, 0], [1, 1], [1, 0], [0, 1]], z: [0, 1]}]}],
    ['set_model', {name: 'x ( ) define', base: 'model'}], ['set_model', {name: 'x', base: 'nothing'}],
    ['add_model', {name: 'x', pose: [0, 0, 0, 0], blocks: 7}], ['change_part', {model: 'table', part: [99], action: 'remove'}],
    ['set_region', {rule: {}}], ['delete', {name: 'nobody'}], ['delete', {}], ['test', {model: 'nothing'}],
  ]) {
    const reply = await ask(address, request(op, more));
    assert.equal(reply.done, false, `${op} ${JSON.stringify(more)}: ${JSON.stringify(reply)}`);
  }
  assert.equal(await ask(address, deep), 1008);
  assert.equal((await documentOf(open.page)).modified, false);
  await close(open);
}

let failed = false;
for (const test of [movesATableOfAWorld, drawsAModel, editsAScenario, refusesStrangers]) {
  try {
    await test();
    console.log(`${test.name}: passed`);
  } catch (error) {
    failed = true;
    console.error(`${test.name}: ${error.stack}`);
    for (const [i, page] of browser.contexts().flatMap(context => context.pages()).entries()) {
      await page.screenshot({path: path(`failure-${test.name}-${i}.png`)}).catch(() => {});
      await page.close();
    }
  }
}
await browser.close();
for (const program of Program.all) await program.stop();
assert.deepEqual(problems, []);
assert.ok(!readdirSync(files).some(name => name.startsWith('.')), 'no temporary file is left');
process.exit(failed ? 1 : 0);
