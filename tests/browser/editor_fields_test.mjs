// Drives the fields of the editor's page in a headless Chromium, as a user does who makes a world from nothing: models of
// libraries, controllers with their parameters, typed values, the text, the plan of a floor. Each change is checked by the
// bytes of the saved file.
//   node editor_fields_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {cpSync, mkdirSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import {editorPages} from './editor_pages.mjs';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('editor_fields_test', source, ['axe-core']);
const troupe = `${programs}/troupe`;
rmSync(files, {recursive: true, force: true});
mkdirSync(files, {recursive: true});
const {path, read, edit, documentOf, fileIs, save, drag, ground, close, check} = editorPages(pages, troupe, files);

// Types a value into a field of the panel.
async function fill(page, selector, value) {
  const field = page.locator(`#file-properties ${selector}`);
  await field.fill(value);
  await field.press('Enter');
}

// Playwright chooses nothing, without an error, if the panel is filled anew in that instant.
function choose(page, selector, value) {
  return until(`${value} can be chosen`, async () => {
    const chosen = await page.selectOption(`#file-properties ${selector}`, value);
    return chosen.length > 0;
  });
}

// A new world becomes one with a robot that drives: all by mouse and fields.
async function makesAWorldWithARobot() {
  const editor = await edit('yard.world');
  const {page} = editor;
  // The ground of a new world reaches 5 m to all sides, and still does with a single model.
  const reach = () => page.evaluate(() => window.troupe.ground());
  assert.ok((await reach()).every(each => each >= 5), `the ground of a new world: ${await reach()}`);
  await page.click('.palette-row[data-model=scout]');
  const place = await ground(page, 1.02, 1.98);
  await page.mouse.move(place.x, place.y);
  await page.mouse.click(place.x, place.y);
  await fileIs(page, 'the scout is there', now => now.entities.some(each => each.name === 'scout1'));
  assert.ok((await reach()).every(each => each >= 5), `the ground with one model: ${await reach()}`);
  // It is selected, on the grid of 5 cm.
  await page.locator('#file-panel-name:has-text("scout1")').waitFor();
  await save(page);
  const begun = 'include "robots.inc"\nscout( name "scout1" pose [1 2 0 0] )\n';
  assert.equal(read('yard.world'), begun);

  // Its controller from the list, with a parameter; a value beyond its limits is marked.
  await choose(page, 'select[data-property=controller]', 'wander');
  await fileIs(page, 'it wanders', now => now.undo === 'the ctrl of scout1');
  await save(page);
  const wandering = begun.replace(' )', ' ctrl "wander" )');
  assert.equal(read('yard.world'), wandering);
  await fill(page, 'input[data-parameter=speed]', '0.6');
  await until('it has a speed', () => page.evaluate(() => document.querySelector('[data-parameter=speed]')?.value === '0.6'));
  await page.locator('.parameter button[title="The default of speed"]').waitFor();
  await fill(page, 'input[data-parameter=min_distance]', '0.8');
  await page.locator('.parameter button[title="The default of min_distance"]').waitFor();
  await save(page);
  assert.equal(read('yard.world'), wandering.replace('wander', 'wander speed=0.6 min_distance=0.8'));
  const speed = page.locator('#file-properties input[data-parameter=speed]');
  await speed.fill('900');
  assert.match(await page.locator('.parameter:has([data-parameter=speed]) .field-warning').textContent(), /expected 0 to 100 m\/s/);
  await speed.press('Enter');
  await page.locator('.property-warning:has-text("speed=900")').waitFor();
  await page.screenshot({path: path('out_of_range.png')});
  await page.click('button[title="The default of speed"]');
  await until('the warning is gone', async () => (await page.locator('.property-warning').count()) === 0);

  // Typed values: one number of the pose, the drive, a pair of limits.
  await fill(page, 'input[data-property=pose][data-element=heading]', '45');
  await fileIs(page, 'it is turned', now => now.undo === 'the pose of scout1');
  await choose(page, 'select[data-property=drive]', 'omni');
  await fileIs(page, 'it has another drive', now => now.undo === 'the drive of scout1');
  await fill(page, 'input[data-property=velocity_bounds][data-element=xmax]', '1.5');
  await fileIs(page, 'it is faster', now => now.undo === 'the velocity_bounds of scout1');
  await save(page);
  const written = read('yard.world');
  assert.match(written, /pose \[1 2 0 45\] ctrl "wander min_distance=0\.8" drive "omni" velocity_bounds \[\S+ 1\.5 /);
  await check('yard.world');

  // By keys alone: from the number of x to that of y, and out of it.
  const x = page.locator('#file-properties input[data-property=pose][data-element=x]');
  await x.fill('1.5');
  await page.keyboard.press('Tab');
  await fileIs(page, 'it is moved', now => now.undo === 'the pose of scout1' && now.modified);
  await until('the focus is in the field of y', () => page.evaluate(() => document.activeElement?.dataset.element === 'y'));
  await save(page);
  assert.equal(read('yard.world'), written.replace('[1 2 0 45]', '[1.5 2 0 45]'), 'one number has changed');
  await page.screenshot({path: path('robot.png')});

  // A table of the library, of a colour that is picked.
  await page.click('.palette-row[data-model=table]');
  const corner = await ground(page, -1.5, 1);
  await page.mouse.move(corner.x, corner.y);
  await page.mouse.click(corner.x, corner.y);
  await page.locator('#file-panel-name:has-text("table1")').waitFor();
  await page.click('#file-properties summary:has-text("Look")');
  await page.locator('input[data-picker=color]').fill('#000080');
  await fileIs(page, 'the table has a colour', now => now.undo === 'the color of table1');
  await save(page);
  assert.match(read('yard.world'), /^include "robots\.inc"\ninclude "furniture\.inc"\n/);
  assert.match(read('yard.world'), /table\( name "table1" pose \[-1\.5 1 0 0\] color "(navy|NavyBlue|navy blue)" \)\n$/);

  // A drag keeps to the grid, and shows numbers beside the pointer.
  await page.click('#file-wall');
  const from = await ground(page, -3, -2);
  const to = await ground(page, 1.01, -2);
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move((from.x + to.x) / 2, to.y);
  await page.mouse.move(to.x, to.y);
  await page.locator('.drag-label:has-text("4.00 m, 0°")').waitFor();
  await page.mouse.up();
  await fileIs(page, 'there is a wall', now => now.entities.some(each => each.name === 'wall1'));
  await page.keyboard.press('Escape');
  await save(page);
  assert.match(read('yard.world'), /model\( name "wall1" pose \[-1 -2 0 0\] size \[4 0\.1 1\] /);
  await close(editor);
  const run = new Program(troupe, [
    'run', path('yard.world'), '--in-process', '--headless', '--ticks', '50', '--speed', 'max', '--poses', path('yard.csv'),
  ]);
  assert.equal(await run.end, 0, run.lines.join('\n'));
  const last = read('yard.csv').trim().split('\n').map(line => line.split(',')).filter(([tick, name]) => tick === '50' && name === 'scout1')[0];
  assert.ok(Math.hypot(last[2] - 1.5, last[3] - 2) > 0.3, `the robot has driven: ${last}`);
}

const SCENARIO = `{
  "world": "hall.world",
  "robots": [
    {"name": "a",  "model": "position", "pose": [0, 0, 90], "controller": {"name": "wander", "parameters": {"speed": 0.50,  "turn_rate": 1}}},
    {"name": "b", "model": "position", "pose": [2, 0, 0]}
  ]
}
`;

// A change that arrives meanwhile leaves the list with the focus where it is: an open one would be closed.
async function keepsTheListThatIsOpen() {
  const world = 'define rover position( size [0.4 0.3 0.2] )\nrover( name "rob" pose [1 2 0 0] drive "omni" )\n';
  writeFileSync(path('list.world'), world);
  const editor = await edit('list.world');
  const {page} = editor;
  await page.click('.entity:has-text("rob")');
  await page.locator('#file-panel-name:has-text("rob")').waitFor();
  await fill(page, 'input[data-property=pose][data-element=x]', '3');
  await fileIs(page, 'it is moved', now => now.undo === 'the pose of rob');
  await page.focus('#file-properties select[data-property=drive]');
  await page.evaluate(() => {
    window.list = document.activeElement;
    document.getElementById('undo').click();
  });
  await until('x is as before', () =>
    page.evaluate(() => document.querySelector('#file-properties input[data-property=pose][data-element=x]').value === '1'));
  assert.ok(await page.evaluate(() => window.list.isConnected && document.activeElement === window.list), 'the list is still there');
  assert.equal(await page.locator('#file-properties select[data-property=drive]').count(), 1);
  // It acts on the file as it is now.
  await choose(page, 'select[data-property=drive]', 'car');
  await fileIs(page, 'it has another drive', now => now.undo === 'the drive of rob');
  await save(page);
  assert.equal(read('list.world'), world.replace('omni', 'car'));
  await close(editor);
}

async function editsControllersOfAScenario() {
  writeFileSync(path('hall.world'), 'model( name "post" pose [4 4 0 0] )\n');
  writeFileSync(path('two.json'), SCENARIO);
  const editor = await edit('two.json');
  const {page} = editor;
  await page.click('.entity:has-text("a") >> nth=0');
  await page.locator('#file-panel-name:text-is("a")').waitFor();
  await fill(page, 'input[data-parameter=speed]', '0.7');
  await fileIs(page, 'the speed is another', now => now.undo === 'the change of speed');
  await fill(page, 'input[data-property=pose][data-element=heading]', '45');
  await fileIs(page, 'a is turned', now => now.undo === 'the move of a');
  await save(page);
  const first = SCENARIO.replace('0.50', '0.7').replace('[0, 0, 90]', '[0, 0, 45]');
  assert.equal(read('two.json'), first, 'two numbers have changed');

  // A value that the controller refuses changes nothing, and says why.
  await fill(page, 'input[data-parameter=speed]', '-1');
  await page.locator(".toast.error:has-text(\"found the number -1 as 'speed'\")").first().waitFor();
  assert.equal((await documentOf(page)).modified, false);

  await page.evaluate(() => window.troupe.select('b'));
  await page.locator('#file-panel-name:text-is("b")').waitFor();
  await choose(page, 'select[data-property=controller]', 'script');
  await fileIs(page, 'b has a script', now => now.undo === 'the change of controller');
  await save(page);
  assert.equal(read('two.json'), first.replace('[2, 0, 0]}',
    '[2, 0, 0], "controller": {"name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.3}]}}}'));
  await check('two.json');
  await close(editor);
}

// Line numbers, colours, completion, and an error that is marked in its line.
async function editsTheText() {
  const text = '# a lab\nmodel( name "post" pose [1 1 0 0] )\r\n'.replace('\r', '');
  writeFileSync(path('text.world'), text);
  const editor = await edit('text.world');
  const {page} = editor;
  await page.click('#file-text');
  await page.locator('#text-area .cm-content').waitFor();
  const numbers = await page.locator('#text-area .cm-lineNumbers .cm-gutterElement').allTextContents();
  assert.deepEqual(numbers.filter(each => /^\d+$/.test(each)).slice(-3), ['1', '2', '3']);
  const colors = await page.locator('#text-area .cm-line span').evaluateAll(
    spans => new Set(spans.map(span => getComputedStyle(span).color)).size);
  assert.ok(colors >= 3, `the text has ${colors} colours`);
  // The name of a property from its beginning.
  await page.locator('#text-area .cm-line:has-text("post")').click();
  await page.keyboard.press('End');
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.type('obstacle_r');
  await page.locator('#text-area .cm-tooltip-autocomplete li:has-text("obstacle_return")').first().waitFor();
  await page.screenshot({path: path('completion.png')});
  await page.keyboard.press('Enter');
  await page.keyboard.type(' 0 ');
  await page.keyboard.press('Control+Enter');
  await fileIs(page, 'the text is applied', now => now.undo === 'the change of the text' && now.error === '');
  await save(page);
  assert.equal(read('text.world'), text.replace('[1 1 0 0] )', '[1 1 0 0] obstacle_return 0 )'));
  // An error, at its line. The button has the focus.
  await page.locator('#text-area .cm-content').click();
  await page.keyboard.press('Control+End');
  await page.keyboard.type('model( name');
  await page.keyboard.press('Control+Enter');
  const broken = await fileIs(page, 'the error is shown', now => now.error !== '');
  await page.locator('#text-area .cm-errorLine').waitFor();
  assert.equal(await page.textContent('#text-error'), broken.error);
  await page.screenshot({path: path('text_error.png')});
  await page.click('#undo');
  await fileIs(page, 'the error is undone', now => now.error === '' && !now.modified);
  await until('the text follows', async () => await page.evaluate(() => window.troupe.text()) === read('text.world'));
  await page.click('#text-close');
  await close(editor);
}

// A picture of 200 by 100 pixels, with a wall around it and one across; 180 pixels are 9 m.
async function importsAPlan() {
  const editor = await edit('plan.world');
  const {page} = editor;
  const png = await page.evaluate(async () => {
    const canvas = document.createElement('canvas');
    Object.assign(canvas, {width: 200, height: 100});
    const context = canvas.getContext('2d');
    context.fillStyle = 'white';
    context.fillRect(0, 0, 200, 100);
    context.fillStyle = '#302010';
    for (const [x, y, w, h] of [[10, 10, 180, 2], [10, 88, 180, 2], [10, 10, 2, 80], [188, 10, 2, 80], [100, 10, 2, 40]]) context.fillRect(x, y, w, h);
    return canvas.toDataURL('image/png').split(',')[1];
  });
  writeFileSync(path('floor plan.png'), Buffer.from(png, 'base64'));
  await page.setInputFiles('#plan-file', path('floor plan.png'));
  await page.locator('#plan-import').waitFor();
  const box = await page.locator('#plan-canvas').boundingBox();
  const at = (x, y) => [box.x + (x * box.width) / 200, box.y + (y * box.height) / 100];
  assert.ok(await page.locator('#plan-apply').isDisabled(), 'without a scale there are no walls');
  await page.mouse.click(...at(10, 50));
  await page.mouse.click(...at(190, 50));
  await page.fill('#plan-distance', '9');
  const size = await page.textContent('#plan-size');
  const [, width, height] = size.match(/is ([\d.]+) × ([\d.]+) m/).map(Number);
  assert.ok(Math.abs(width - 10) < 0.1 && Math.abs(height - 5) < 0.05, size);
  await page.screenshot({path: path('plan_import.png')});
  await page.click('#plan-apply');
  await fileIs(page, 'the plan is there', now => now.entities.some(each => each.name.startsWith('floor_plan_walls')));
  await save(page);
  await close(editor);
  assert.ok(readdirSync(files).includes('floor_plan_walls.png'));
  await check('plan.world');
  // A robot in the left room is stopped by the wall across, one below it passes.
  const robot = (name, y) => ({
    name, model: 'position', pose: [-2, y, 0], properties: {size: [0.2, 0.2, 0.3]},
    controller: {name: 'script', parameters: {commands: [{at: 0, vx: 0.5}]}},
  });
  writeFileSync(path('plan.json'), JSON.stringify({world: 'plan.world', robots: [robot('stopped', 1), robot('through', -1)]}));
  const run = new Program(troupe, [
    'run', path('plan.json'), '--in-process', '--headless', '--ticks', '80', '--speed', 'max', '--poses', path('plan.csv'),
  ]);
  assert.equal(await run.end, 0, run.lines.join('\n'));
  const last = read('plan.csv').trim().split('\n').map(line => line.split(',')).filter(([tick]) => tick === '80');
  const of = name => last.find(row => row[1] === name);
  assert.equal(of('stopped')[6], '1', 'the wall across stops a robot');
  assert.ok(Math.abs(Number(of('stopped')[2]) + 0.1) < 0.08, `at the wall: ${of('stopped')}`);
  assert.ok(Number(of('through')[2]) > 1, `the way below is free: ${of('through')}`);
}

// Nothing of the panels is cut, at three sizes of the window: lists fill their place, and the model editor shows its parts.
async function fitsItsWindow() {
  cpSync(`${source}/worlds`, files, {recursive: true});
  const editor = await edit('office.world');
  const {page} = editor;
  for (const [width, height] of [[1280, 720], [1920, 1080], [1024, 768]]) {
    await page.setViewportSize({width, height});
    await page.locator('.entity').first().waitFor();
    const lists = await page.evaluate(() => ['#left', '#file-entities', '#entity-list', '#palette'].map(id => {
      const box = document.querySelector(id).getBoundingClientRect();
      return [box.top, box.bottom];
    }));
    const [left, card, , palette] = lists;
    assert.ok(Math.abs(card[1] - left[1]) < 2 && left[1] - palette[1] < 24, `the lists fill the column: ${JSON.stringify(lists)}`);
  }
  await page.setViewportSize({width: 1280, height: 720});
  await page.click('.palette-line:has-text("scout with mast") .plain');
  await page.locator('#model-editor').waitFor();
  const body = await page.evaluate(() => {
    const box = document.querySelector('#model-body').getBoundingClientRect();
    return [box.width, box.height];
  });
  assert.ok(body[0] > 200 && body[1] > 120, `the body is shown: ${body}`);
  const cut = await page.evaluate(() => [...document.querySelectorAll('#model-lists > div')].filter(column =>
    column.scrollWidth > column.clientWidth + 1 || column.getBoundingClientRect().bottom > document.querySelector('#model-editor').getBoundingClientRect().bottom + 1,
  ).length);
  assert.equal(cut, 0, 'no column of the model editor is cut');
  await page.screenshot({path: path('model_editor.png')});
  await page.click('#model-close');
  await close(editor);
}

// The rules of axe-core, in each of its views and both themes.
async function hasNoSeriousFindings() {
  cpSync(`${source}/worlds`, files, {recursive: true});
  const editor = await edit('office.world');
  const {page} = editor;
  const look = async what => {
    for (const theme of ['light', 'dark']) {
      await page.emulateMedia({colorScheme: theme});
      assert.deepEqual(await pages.findings(page), [], `${what}, ${theme}`);
      await page.screenshot({path: path(`rules-${what}-${theme}.png`)});
    }
  };
  await page.locator('.entity').first().waitFor();
  await look('world');
  await page.click('.entity:has-text("table2")');
  await page.locator('#file-panel-name:has-text("table2")').waitFor();
  await page.click('#file-text');
  await page.locator('#text-area .cm-content').waitFor();
  await look('text');
  await page.click('#file-text');
  await page.click('.palette-line:has-text("scout with mast") .plain');
  await page.locator('#model-editor').waitFor();
  await look('model');
  await page.click('#model-close');
  await page.setInputFiles('#plan-file', `${source}/worlds/bitmaps/office.png`);
  await page.locator('#plan-import').waitFor();
  await look('plan');
  await page.keyboard.press('Escape');
  await close(editor);
}

await pages.runAll([makesAWorldWithARobot, keepsTheListThatIsOpen, editsControllersOfAScenario, editsTheText, importsAPlan, fitsItsWindow,
  hasNoSeriousFindings], path);
