// Drives the page of `troupe edit` in a headless Chromium: worlds, scenarios and models are edited by mouse and keys, saved,
// and read by the other programs.
//   node editor_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {cpSync, existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import {editorPages} from './editor_pages.mjs';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('editor_test', source, ['ws']);
const WebSocket = pages.loaded.ws;
const troupe = `${programs}/troupe`;
rmSync(files, {recursive: true, force: true});
mkdirSync(files, {recursive: true});
const {path, read, edit, documentOf, settled, fileIs, save, drag, ground, placeOf, close, check} = editorPages(pages, troupe, files);

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

  // Edits by the panel: a property with its help, and one that is refused with its place.
  await page.click('.entity:has-text("table0")');
  await page.click('#file-properties summary:has-text("Look")');
  const color = page.locator('#file-properties input[data-property=color]');
  await color.waitFor();
  await color.fill('blue');
  await color.press('Enter');
  await fileIs(page, 'the colour is changed', now => now.undo === 'the color of table0');
  await page.click('#file-properties summary:has-text("Body")');
  const bitmap = page.locator('#file-properties input[data-property=bitmap]');
  await bitmap.fill('nowhere.png');
  await bitmap.press('Enter');
  await page.locator('.toast.error').first().waitFor();
  assert.equal((await documentOf(page)).undo, 'the color of table0', 'a bitmap that is not there is refused');

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

// A duplicate beside it, and a copy at the pointer, with all that the entry has; the picture stays where it is.
async function copiesATable() {
  cpSync(`${source}/worlds/include`, path('include'), {recursive: true});
  writeFileSync(path('copied.world'), 'include "include/furniture.inc"\ntable ( name "desk" pose [ 1 1 0 30 ] color "blue" )  # mine\n');
  const editor = await edit('copied.world');
  const {page} = editor;
  await page.click('.entity:has-text("desk")');
  await until('it is selected', async () => (await page.textContent('#file-panel-name')) === 'desk');
  const before = await ground(page, 0, 0);
  await page.click('#file-duplicate');
  await fileIs(page, 'there is a duplicate', now => now.entities.some(entity => entity.name === 'desk1'));
  await until('the duplicate is selected', async () => (await page.textContent('#file-panel-name')) === 'desk1');
  assert.deepEqual(await ground(page, 0, 0), before, 'the picture has not jumped');
  // By keys, at the pointer, on the grid of 5 cm.
  await page.click('.entity:has-text("desk")');
  await page.locator('#scene').focus();
  await page.keyboard.press('Control+c');
  const at = await ground(page, -2, 2);
  await page.mouse.move(at.x, at.y);
  await page.keyboard.press('Control+v');
  await fileIs(page, 'there is a copy', now => now.entities.some(entity => entity.name === 'desk2'));
  await page.screenshot({path: path('copies.png')});
  await save(page);
  const text = read('copied.world');
  assert.match(text, /# mine\ntable \( name "desk2" pose \[ -(2|1\.95|2\.05) (2|1\.95|2\.05) 0 30 \] color "blue" \)\ntable \( name "desk1" pose \[ 1\.5 0\.5 0 30 \] color "blue" \)/, text);
  await page.click('#undo');
  await fileIs(page, 'the copy is gone', now => !now.entities.some(entity => entity.name === 'desk2'));
  await close(editor);
}

// The waypoints of a robot are drawn into the picture.
async function drawsWaypoints() {
  cpSync(`${source}/worlds/include`, path('include'), {recursive: true});
  writeFileSync(path('ways.world'), 'include "include/robots.inc"\nscout ( name "rover" pose [ 0 0 0 0 ] ctrl "go_to" )\n');
  const editor = await edit('ways.world');
  const {page} = editor;
  await page.click('.entity:has-text("rover")');
  await page.click('button[title="Draw the waypoints in the picture"]');
  for (const [x, y] of [[2, 0], [2, 2]]) {
    const at = await ground(page, x, y);
    await page.mouse.click(at.x, at.y);
  }
  await page.screenshot({path: path('waypoints.png')});
  await page.keyboard.press('Enter');
  await fileIs(page, 'they are in the file', now => now.undo === 'the ctrl of rover');
  await save(page);
  const [, waypoints] = read('ways.world').match(/ctrl "go_to waypoints=(\[\[.*\]\])"/) ?? assert.fail(read('ways.world'));
  JSON.parse(waypoints).forEach(([x, y], i) => assert.ok(Math.hypot(x - 2, y - 2 * i) < 0.1, waypoints));
  await check('ways.world');
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

const OBJECTS = `define crate model( size [0.1 0.2 0.3] color "tan" gripper_return 1 )
crate( name "crate1" pose [0.55 0 0 0] )
`;

// All by mouse: a gripper is put down, its fingers are drawn, chosen and limited; it grips in a run.
async function buildsAGripper() {
  writeFileSync(path('gripper.world'), OBJECTS);
  const editor = await edit('gripper.world');
  const {page} = editor;
  const at = (view, a, b) => page.evaluate(([v, x, y]) => window.troupe.modelPoint(v, x, y), [view, a, b]);
  const dragModel = async (view, from, to, modifiers = []) => drag(page, await at(view, ...from), await at(view, ...to), modifiers);
  const done = label => fileIs(page, label, now => now.undo === label);
  const model = async () => page.evaluate(() => window.troupe.edit('model', {name: 'carrier'}));
  const near = (values, wanted, what) => values.forEach((value, i) => {
    assert.ok(Math.abs(value - wanted[i]) < 2e-4, `${what}: ${values} for ${wanted}`);
  });
  // Waits until the file has the change, and the page shows it, and returns the part.
  const partIs = async (what, pathOf, wanted) => {
    const found = await until(what, async () => {
      const part = pathOf((await model()).parts);
      return part && wanted(part) ? part : null;
    });
    await settled(page);
    return found;
  };

  await page.click('#file-model');
  await page.fill('#model-name', 'carrier');
  await page.fill('#model-base', 'position');
  for (const [x, y] of [[-0.2, -0.15], [0.2, -0.15], [0.2, 0.15], [-0.2, 0.15], [-0.2, -0.15]]) {
    const point = await at('top', x, y);
    await page.mouse.click(point.x, point.y);
  }
  await page.click('#model-apply');
  await done('the new model carrier');

  // A gripper with paddles of its own: its opening and the length of its paddles by handles, its place by dragging.
  await page.selectOption('#part-type', 'gripper');
  await page.click('#part-add');
  await done('the gripper of carrier');
  await page.locator('.part.selected .part-name:has-text("gripper")').waitFor();
  await dragModel('top', [0.334, 0.15], [0.334, 0.2]);
  await done('the paddles of carrier');
  near((await model()).parts[0].size, [0.2, 0.4, 0.2], 'the opening is wider');
  await dragModel('top', [0.4, 0.185], [0.45, 0.185]);
  const longer = await partIs('the paddles are longer', parts => parts[0], part => part.size[0] > 0.24);
  near([...longer.gripper.paddle, longer.pose[0]], [0.182, 0.03, 0.08, 0.325], 'paddles');
  await page.screenshot({path: path('paddles.png')});
  await dragModel('top', [0.22, 0], [0.265, 0]);
  const moved = await partIs('the gripper is moved', parts => parts[0], part => part.pose[0] > 0.34);
  near(moved.pose, [0.37, 0, 0, 0], 'the pose is on the grid of the pointer');

  // Its own fingers, drawn on it: they close towards each other.
  await page.click('.part-name:has-text("gripper")');
  await page.locator('.part.selected').waitFor();
  await page.selectOption('#part-type', 'actuator');
  for (const [count, y] of [[1, 0.15], [2, -0.2]]) {
    await page.click('#part-draw');
    await dragModel('top', [0.4, y], [0.6, y + 0.05]);
    await partIs('the finger is drawn', parts => parts[0].parts[count - 1], part => part.joint);
    await page.locator('.part .part.selected').waitFor();
  }
  const [left, right] = (await model()).parts[0].parts;
  near([...left.pose, ...left.joint.axis, ...left.joint.limits], [0.5, 0.175, 0, 0, 0, -1, 0, 0, 0.15], 'left finger');
  near([...right.pose, ...right.joint.axis], [0.5, -0.175, 0, 0, 0, 1, 0], 'right finger');
  assert.equal(left.name, 'gripper:0.left');
  // The left one by the list, the right one from the picture.
  await page.click('.part-name:has-text("gripper")');
  await page.selectOption('select[data-role=left_finger]', '0.0');
  await page.click('[data-pick=right_finger]');
  const pad = await at('top', 0.5, -0.175);
  await page.mouse.click(pad.x, pad.y);
  await done('the fingers of carrier.gripper:0');
  near((await model()).parts[0].gripper.left_finger, [0, 0], 'left finger');

  // Limits, direction and height of the left finger by its handles.
  await page.click('.part-name:has-text("left")');
  await dragModel('top', [0.5, 0], [0.5, 0.03]);
  await done('the joint of carrier');
  near((await model()).parts[0].parts[0].joint.limits, [0, 0.12], 'limits');
  await page.screenshot({path: path('fingers.png')});
  await dragModel('side', [0.5, 0.05], [0.5, 0.15]);
  near((await partIs('the finger is raised', parts => parts[0].parts[0], part => part.pose[2] > 0.09)).pose,
       [0.5, 0.175, 0.1, 0], 'height');
  await page.click('#model-close');
  await page.click('#undo');
  await fileIs(page, 'the height is undone', now => now.redo === 'the move of a part of carrier');
  await page.click('.palette-line:has-text("carrier") .plain');
  await page.locator('#model-editor').waitFor();

  // A ranger is turned, and an arm with an arc and a direction of its own.
  await page.selectOption('#part-parent', '');
  await page.selectOption('#part-type', 'ranger');
  await page.click('#part-add');
  await partIs('there is a ranger', parts => parts[1], part => part.type === 'ranger');
  await page.locator('.part.selected .part-name:has-text("ranger")').waitFor();
  await dragModel('top', [0.02, 0], [0, 0.02], ['Shift']);
  near((await partIs('it is turned', parts => parts[1], part => part.pose[3] > 0)).pose, [0, 0, 0.5, Math.PI / 2], 'heading');
  await page.selectOption('#part-parent', '');
  await page.selectOption('#part-type', 'actuator');
  await page.click('#part-draw');
  await dragModel('top', [-0.15, -0.05], [-0.05, 0.05]);
  const lift = await partIs('there is a joint', parts => parts[2], part => part.joint);
  near(lift.joint.axis, [0, 0, 1], 'upwards');
  await page.locator('.part.selected .part-name:has-text("joint")').waitFor();
  const sheet = await page.evaluate(() => {
    const [a, b] = [0, 1].map(z => window.troupe.modelPoint('side', 0, z).y);
    return a - b;
  });  // px per m
  // The arrow is 36 px beyond the end of the travel, which is the top of the body and half a metre.
  const top = 0.5 + 0.1 + 0.5 + 36 / sheet;
  await dragModel('side', [-0.1, top], [0.5, 0.55]);
  near((await partIs('its axis is turned', parts => parts[2], part => part.joint.axis[0] > 0.9)).joint.axis, [1, 0, 0], 'axis');
  await page.screenshot({path: path('joint.png')});
  await page.locator('.part.selected select[data-property=type]').selectOption('rotational');
  const arm = await partIs('it turns', parts => parts[2], part => part.joint.type === 'rotational');
  // The maximum of before is half a degree now.
  const radius = 0.12 * 1.1;
  const end = arm.joint.limits[1];
  await dragModel('top', [-0.1 + radius * Math.cos(end), radius * Math.sin(end)], [-0.1, radius]);
  const wide = await partIs('its arc is wider', parts => parts[2], part => part.joint.limits[1] > 1);
  near(wide.joint.limits.slice(1), [Math.PI / 2], 'arc');
  await page.screenshot({path: path('arc.png')});
  await page.click('#model-close');
  await save(page);
  await close(editor);

  assert.ok(read('gripper.world').startsWith(OBJECTS.split('\n')[0]), 'the text of before stays');
  assert.match(read('gripper.world'), /max_position 0\.12/);
  await check('gripper.world');
  writeFileSync(path('gripping.json'), JSON.stringify({
    world: 'gripper.world', robots: [{
      name: 'r', model: 'carrier', pose: [0, 0, 0],
      controller: {name: 'script', parameters: {commands: [{at: 0, gripper: 'close'}, {at: 4, vx: -0.5}]}},
    }],
  }));
  const run = new Program(troupe, [
    'run', path('gripping.json'), '--in-process', '--headless', '--ticks', '80', '--speed', 'max', '--poses', path('gripped.csv'),
  ]);
  assert.equal(await run.end, 0, run.lines.join('\n'));
  const rows = read('gripped.csv').trim().split('\n').map(line => line.split(','));
  const crate = rows.filter(([tick, name]) => tick === '80' && name === 'crate1')[0];
  assert.ok(Number(crate[2]) < 0, `the crate goes with the robot that has gripped it: ${crate}`);
}

// Walls in the image of a floor plan: the world shows them, the file is written by Save, and a robot is stopped by one.
async function drawsABitmap() {
  // Posts far apart: the ground between them is in the view.
  writeFileSync(path('plan.world'), [
    'model( name "old" size [1 1 1] pose [0 -4 0 0] bitmap "old.pgm" )', 'model( name "post1" pose [6 5 0 0] )',
    'model( name "post2" pose [-6 -5 0 0] )', '',
  ].join('\n'));
  writeFileSync(path('old.pgm'), 'P2\n2 1\n255\n0 0\n');
  const editor = await edit('plan.world');
  const {page, url} = editor;
  const dragGround = async (from, to) => drag(page, await ground(page, ...from), await ground(page, ...to));
  await page.click('#file-bitmap');
  await page.locator('#bitmap-options .faint').first().waitFor();
  assert.match(await page.locator('#bitmap-options').textContent(), /another format/);

  // A new image of 6 by 4 m: its outline, a wall across, and a door in that.
  await page.click('[data-tool=new]');
  await page.fill('#bitmap-options input[aria-label=image]', 'hall.png');
  await page.locator('#bitmap-options input[aria-label=image]').press('Tab');
  await dragGround([-3, -2], [3, 2]);
  await fileIs(page, 'there is a bitmap', now => now.undo === 'the new bitmap hall.png');
  const width = page.locator('#bitmap-options input[aria-label=width]');
  await width.waitFor();
  await width.fill('4');
  await width.press('Enter');
  const bitmap = async () => (await page.evaluate(() => window.troupe.edit('bitmaps'))).bitmaps.find(each => !each.refusal);
  const created = await bitmap();
  assert.deepEqual([created.width, created.height], [120, 80]);
  const version = async () => (await documentOf(page)).version;
  const draw = async (tool, from, to) => {
    const before = await version();
    await page.click(`[data-tool=${tool}]`);
    await dragGround(from, to);
    await fileIs(page, `a ${tool} is drawn`, now => now.version > before);
  };
  await draw('frame', [-2.975, -1.975], [2.975, 1.975]);
  await draw('line', [1, -1.8], [1, 1.8]);
  await page.screenshot({path: path('bitmap_walls.png')});
  await page.click('#bitmap-erase');
  await draw('brush', [1, 0.6], [1, 1.2]);
  assert.equal((await documentOf(page)).undo, 'the erasure in hall.png');
  const erased = await bitmap();
  assert.ok(Math.abs(erased.pixel[0] - 0.05) < 1e-5, `a pixel stays one: ${erased.pixel}`);
  assert.ok(Math.abs(erased.corner[0] + 3) < 1e-3, 'the image stays in its place');
  await page.screenshot({path: path('bitmap_door.png')});
  await page.click('#undo');
  await fileIs(page, 'the door is undone', now => now.redo === 'the erasure in hall.png');
  await page.click('#redo');
  await fileIs(page, 'the door is redone', now => now.redo === '');
  assert.ok(!existsSync(path('hall.png')), 'nothing is written before Save');
  await save(page);
  assert.ok(existsSync(path('hall.png')));

  // Hostile requests have an answer each, and change nothing.
  const address = new URL(url);
  const saved = readFileSync(path('hall.png'));
  const long = Array.from({length: 5000}, (_, i) => [i % 2 ? 100000 : -100000, i]);
  for (const [op, more] of [
    ['draw_bitmap', {name: 'hall1', tool: 'line', width: 500, points: long}],
    ['draw_bitmap', {name: 'hall1', tool: 'line', width: 1e9, points: [[0, 0]]}],
    ['draw_bitmap', {name: '../hall1', tool: 'line', width: 1, points: [[0, 0]]}],
    ['create_bitmap', {file: '../x.png', size: [1, 1, 1], pixel: 0.05, pose: [0, 0, 0, 0]}],
    ['create_bitmap', {file: 'x.png', size: [1e6, 1e6, 1], pixel: 0.001, pose: [0, 0, 0, 0]}],
    ['change_part', {model: 'x', part: [0], action: 'shape', shape: {pose: [0, 0]}}],
  ]) {
    const reply = await ask(address, JSON.stringify({type: 'edit', id: 1, op, ...more}));
    assert.equal(reply.done, false, `${op}: ${JSON.stringify(reply)}`);
    assert.ok(reply.problem.length > 0);
  }
  assert.equal((await documentOf(page)).modified, false);
  assert.deepEqual(readFileSync(path('hall.png')), saved);

  // Another program writes the image: it is not replaced unasked.
  await page.click('#bitmap-erase');
  await draw('filled', [-2, 1], [-1.5, 1.5]);
  const theirs = Buffer.concat([saved, Buffer.from('changed')]);
  writeFileSync(path('hall.png'), theirs);
  const answers = [false, false];
  page.on('dialog', dialog => void (answers.shift() ? dialog.accept() : dialog.dismiss()));
  await page.click('#file-save');
  await until('both questions are asked', () => answers.length === 0);
  assert.deepEqual(readFileSync(path('hall.png')), theirs);
  answers.push(true);
  await page.click('#file-save');
  await fileIs(page, 'the image is replaced', now => !now.modified);
  await close(editor);

  await check('plan.world');
  const robot = (name, y) => ({
    name, model: 'position', pose: [-1, y, 0], properties: {size: [0.2, 0.2, 0.3]},
    controller: {name: 'script', parameters: {commands: [{at: 0, vx: 0.5}]}},
  });
  writeFileSync(path('walls.json'), JSON.stringify({
    world: 'plan.world', robots: [robot('through', 0.9), robot('stopped', -0.5)],
  }));
  const run = new Program(troupe, [
    'run', path('walls.json'), '--in-process', '--headless', '--ticks', '100', '--speed', 'max', '--poses', path('walls.csv'),
  ]);
  assert.equal(await run.end, 0, run.lines.join('\n'));
  const last = read('walls.csv').trim().split('\n').map(line => line.split(',')).filter(([tick]) => tick === '100');
  const of = name => last.find(row => row[1] === name);
  assert.ok(Number(of('through')[2]) > 2, `the door is open: ${of('through')}`);
  assert.equal(of('stopped')[6], '1', 'the wall stops a robot');
  assert.ok(Math.abs(Number(of('stopped')[2]) - 0.85) < 0.08, `at the wall: ${of('stopped')}`);
}

// Several are selected by a rectangle or with Shift, and moved, turned, copied and deleted as one edit.
async function editsSeveral() {
  cpSync(`${source}/worlds/include`, path('include'), {recursive: true});
  writeFileSync(path('several.world'), ['a', 'b', 'c', 'far'].map(
    (name, i) => `model ( name "${name}" pose [${i === 3 ? '4 -4' : `${i} 0`} 0 0] size [0.3 0.3 0.3] )\n`).join(''));
  const editor = await edit('several.world');
  const {page} = editor;
  const poseOf = async name => (await page.evaluate(n => window.troupe.edit('entity', {name: n}), name)).pose.map(value => Math.round(value * 100) / 100);
  await drag(page, await ground(page, -0.6, -0.6), await ground(page, 1.4, 0.6), ['Shift']);
  await page.locator('#file-several:has-text("2 selected")').waitFor();
  const place = await placeOf(page, 'c');
  await page.keyboard.down('Shift');
  await page.mouse.click(place.x, place.y);
  await page.keyboard.up('Shift');
  await page.locator('#file-several:has-text("3 selected")').waitFor();
  await page.screenshot({path: path('several.png')});

  await page.click('#move');
  await drag(page, await ground(page, 1, 0), await ground(page, 1, 2));
  await fileIs(page, 'all are moved', now => now.undo === 'the move of 3 models');
  assert.deepEqual([await poseOf('a'), await poseOf('b'), await poseOf('c')], [[0, 2, 0, 0], [1, 2, 0, 0], [2, 2, 0, 0]]);
  // They turn about the one that is dragged.
  await drag(page, await ground(page, 1, 2), await ground(page, 1, 3), ['Shift']);
  await until('they have turned', async () => (await poseOf('a'))[1] === 1);
  assert.deepEqual([await poseOf('a'), await poseOf('b'), await poseOf('c')], [[1, 1, 0, 1.57], [1, 2, 0, 1.57], [1, 3, 0, 1.57]]);
  await page.click('#undo');
  await fileIs(page, 'one step back is before all of them', now => now.redo === 'the move of 3 models');
  await page.keyboard.press('Escape');

  await page.keyboard.press('Control+c');
  const at = await ground(page, 1, -2);
  await page.mouse.move(at.x, at.y);
  await page.keyboard.press('Control+v');
  await fileIs(page, 'there are copies', now => ['a1', 'b1', 'c1'].every(name => now.entities.some(each => each.name === name)));
  assert.deepEqual([await poseOf('a1'), await poseOf('c1')], [[0, -2, 0, 0], [2, -2, 0, 0]]);
  await page.locator('#file-several:has-text("3 selected")').waitFor();
  await page.keyboard.press('Delete');
  await fileIs(page, 'the copies are gone', now => now.undo === 'the deletion of 3 models' && now.entities.length === 4);
  await close(editor);
}

// Walls end on other walls and at right angles, models stand beside them, and a scenario leaves out what its world has.
async function snaps() {
  cpSync(`${source}/worlds/include`, path('include'), {recursive: true});
  writeFileSync(path('snap.world'), 'include "include/rooms.inc"\nmodel ( name "wall" pose [0 0 0 0] size [4 0.1 1] )\n');
  const editor = await edit('snap.world');
  const {page} = editor;
  await page.click('#file-wall');
  // From near the end of the wall, not quite upwards.
  await drag(page, await ground(page, 1.9, 0.06), await ground(page, 2.0, 2.02));
  await fileIs(page, 'there is a wall', now => now.entities.some(each => each.name === 'wall1'));
  await page.keyboard.press('Escape');
  await page.click('.palette-row[data-model=desk]');
  const at = await ground(page, -1, 0.47);
  await page.mouse.move(at.x, at.y);
  await page.mouse.click(at.x, at.y);
  await fileIs(page, 'there is a desk', now => now.entities.some(each => each.name === 'desk1'));
  await save(page);
  const text = read('snap.world');
  assert.match(text, /name "wall1" pose \[1\.95 1 0 90\] size \[2 0\.1 1\]/, text);
  assert.match(text, /name "desk1" pose \[-1 0\.4 0 0\]/, text);
  await close(editor);

  writeFileSync(path('less.json'), '{\n  "world": "snap.world"\n}\n');
  const scenario = await edit('less.json');
  await scenario.page.click('.entity:has-text("desk1")');
  await scenario.page.click('#file-delete');
  await fileIs(scenario.page, 'the desk is left out', now => !now.entities.some(each => each.name === 'desk1'));
  assert.deepEqual((await documentOf(scenario.page)).members.without, ['desk1']);
  await close(scenario);
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

  // An area is an entry of a list, whose form opens.
  await page.click('#file-area');
  await drag(page, await ground(page, -1.5, -0.8), await ground(page, 1.5, 0.8));
  await page.keyboard.press('Escape');
  await fileIs(page, 'there is a spawn rule', now => now.members.spawn?.length === 1);
  const field = key => page.locator(`#file-lists [data-path="spawn.0.${key}"]`);
  await field('model').selectOption('cart');
  await fileIs(page, 'of carts', now => now.members.spawn[0].model === 'cart');
  // A number that is being typed is not replaced when another program changes the rule.
  await field('count').fill('3');
  const change = {type: 'edit', id: 1, op: 'set_value', path: ['spawn', 0, 'model'], value: 'scout'};
  assert.equal((await ask(new URL(editor.url), JSON.stringify(change))).done, true);
  await fileIs(page, 'of scouts', now => now.members.spawn[0].model === 'scout');
  assert.equal(await field('count').inputValue(), '3');
  await field('count').press('Enter');
  await fileIs(page, 'of three of them', now => now.members.spawn[0].count === 3 && now.entities.some(each => each.name === 'scout2'));
  // What the file refuses stays in its field, with the reason, until Escape.
  await field('count').fill('-7');
  await field('count').press('Enter');
  await page.locator('#file-lists .property-problem').waitFor();
  assert.equal(await field('count').inputValue(), '-7');
  assert.equal((await documentOf(page)).members.spawn[0].count, 3);
  await field('count').press('Escape');
  await until('the field has the value of the file', async () => await field('count').inputValue() === '3');
  await save(page);
  assert.match(await check('scenarios/demo.json'), /robots: 11/);

  // The text, with an error that is shown at its place, and corrected.
  await page.click('#file-text');
  const text = await until('the text is there', () => page.evaluate(() => window.troupe.text()));
  const setText = next => page.evaluate(value => window.troupe.setText(value), next);
  await setText(text.replace('"seed": 1,', '"seed": "one",'));
  await page.click('#text-apply');
  const broken = await fileIs(page, 'the error is shown', now => now.error !== '');
  assert.match(broken.error, /demo\.json:5:\d+: error: /);
  assert.equal(await page.textContent('#text-error'), broken.error);
  await setText(text);
  await page.click('#text-apply');
  await fileIs(page, 'the error is corrected', now => now.error === '' && !now.modified);
  await page.click('#text-close');
  await page.screenshot({path: path('scenario.png')});
  await close(editor);
}

// The reply to a request by a program, the status by which it was refused, or the code of the end of the connection; of an
// end without a code how it came about.
function ask(url, message, {origin = url.origin, host, token = true} = {}) {
  return new Promise(resolve => {
    const address = `ws://${url.host}/socket${token ? url.search : ''}`;
    const socket = new WebSocket(address, 'troupe', {headers: {Origin: origin, ...(host ? {Host: host} : {})}});
    const began = Date.now();
    const steps = [];
    const note = step => steps.push(`${step} after ${Date.now() - began} ms`);
    socket.on('open', () => {
      note('open');
      socket.send(message);
    });
    socket.on('message', data => {
      const text = data.toString();
      if (!text.includes('"type":"reply"')) return;
      resolve(JSON.parse(text));
      socket.close();
    });
    socket.on('unexpected-response', (_request, response) => resolve(response.statusCode));
    socket.on('error', error => note(error.message));
    socket.on('close', code => {
      note('closed');
      resolve(code === 1006 ? steps.join(', ') : code);
    });
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
    ['set_value', {path: []}], ['together', {edits: [{op: 'save'}]}], ['delete', {name: 'nobody'}], ['delete', {}], ['test', {model: 'nothing'}],
  ]) {
    const reply = await ask(address, request(op, more));
    assert.equal(reply.done, false, `${op} ${JSON.stringify(more)}: ${JSON.stringify(reply)}`);
  }
  assert.equal(await ask(address, deep), 1008);
  assert.equal((await documentOf(open.page)).modified, false);
  await close(open);
}

await pages.runAll([movesATableOfAWorld, copiesATable, drawsWaypoints, drawsAModel, buildsAGripper, drawsABitmap, editsSeveral, snaps, editsAScenario, refusesStrangers], path, () => {
  assert.ok(!readdirSync(files).some(name => name.startsWith('.')), 'no temporary file is left');
});
