// An office with rooms, doors, furniture, robots with tasks, people and a zone is built in the page of `troupe edit` by mouse
// and keys alone, in less than five minutes of a person's time, and then runs.
//   node editor_office_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
// With TROUPE_HAND=1 it takes that time.
import assert from 'node:assert/strict';
import {mkdirSync, rmSync} from 'node:fs';
import {editorPages} from './editor_pages.mjs';
import {Hand} from './hand.mjs';
import {Pages} from './pages.mjs';
import {Program} from './programs.mjs';

const MOST_SECONDS = 300;

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('editor_office_test', source);
const troupe = `${programs}/troupe`;
rmSync(files, {recursive: true, force: true});
mkdirSync(files, {recursive: true});
const {path, read, edit, settled, fileIs, ground, close, check} = editorPages(pages, troupe, files);

async function buildsAnOffice() {
  const editor = await edit('office.json');
  const {page} = editor;
  const hand = new Hand(page, process.env.TROUPE_HAND ? 1 : 0);
  const at = (x, y) => ground(page, x, y);
  const dragGround = async (from, to, modifier) => hand.drag(await at(...from), await at(...to), modifier);
  const hasEntities = names => fileIs(page, `there are ${names}`, now => names.every(name => now.entities.some(each => each.name === name)));
  // A click puts a model down; with Shift the next one follows.
  const put = async (model, ...places) => {
    await hand.click(`.palette-row[data-model=${model}]`);
    for (const [i, [x, y]] of places.entries()) await hand.clickAt(await at(x, y), i + 1 < places.length ? 'Shift' : undefined);
    await settled(page);
  };

  // Walls: the outer room with its door, and two inner rooms with gaps.
  await hand.click('#file-room');
  await dragGround([-4.5, -3], [4.5, 3]);
  await hand.click('#file-wall');
  await dragGround([0.5, 3.02], [0.52, 0.5]);
  await dragGround([0.5, 0.52], [2.3, 0.53]);
  await dragGround([3.3, 0.55], [4.48, 0.5]);
  await hand.press('Escape');
  await hasEntities(['room1', 'wall1', 'wall2', 'wall3']);

  await put('sliding_door', [0, -3]);
  await put('hinged_door', [2.8, 0.55]);
  await hasEntities(['sliding_door1', 'hinged_door1']);
  const offset = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);
  assert.ok(offset(await page.evaluate(() => window.troupe.placeOf('room1')), await at(0, 0)) < 20, 'the room is shown at its place');

  // A table with chairs, and a copy of all of them.
  await put('table', [1.6, 2.1]);
  await put('chair', [1.3, 1.35], [2.0, 1.35]);
  await hasEntities(['table1', 'chair2']);
  await dragGround([0.72, 2.75], [2.55, 0.98], 'Shift');
  await page.locator('#file-several:has-text("3 selected")').waitFor();
  await hand.press('Control+c');
  await hand.moveTo(await at(3.55, 1.8));
  await hand.press('Control+v');
  await hasEntities(['table2', 'chair4']);
  await put('shelf', [-3.9, 2.65]);
  await put('plant', [4.15, -2.65]);
  await put('sofa', [-0.02, 1.7]);

  // A robot on a round, whose corners are clicked.
  await put('scout', [-3.5, -0.3]);
  await page.locator('#file-panel-name:text-is("scout1")').waitFor();
  await hand.choose('select[data-property=controller]', 'patrol');
  await fileIs(page, 'it patrols', now => now.undo === 'the change of controller');
  await hand.click('button[title="Draw the waypoints in the picture"]');
  for (const [x, y] of [[-3.5, 0.6], [-1.2, 0.6], [-1.2, -0.4], [2.8, -0.4]]) await hand.clickAt(await at(x, y));
  await hand.press('Enter');
  await fileIs(page, 'it has waypoints', now => now.undo === 'the change of waypoints');

  // One with a gripper, which brings a cube: its steps are chosen and clicked.
  await put('cube', [1.5, -2]);
  await put('stacker', [0, -1.7]);
  await page.locator('#file-panel-name:text-is("stacker1")').waitFor();
  await hand.choose('select[data-property=controller]', 'fetch');
  await page.locator('.task').nth(1).waitFor();
  for (const [step, [x, y]] of [[1, [1.5, -2]], [2, [-2.5, -2]]]) {
    await hand.click(`.task:nth-child(${step}) button[title="Click the place in the picture"]`);
    await hand.clickAt(await at(x, y));
    await fileIs(page, 'the step has a place', now => now.undo === 'the change of steps');
    await settled(page);
  }
  await hand.fill('.task:nth-child(2) input[data-task=heading]', '180');
  await settled(page);

  // People in the hall, and a zone that robots do not enter.
  await hand.click('#file-area');
  await hand.choose('#area-kind', '1');
  await dragGround([-4, 1.1], [-0.8, 2.3]);
  await fileIs(page, 'there are people', now => now.members.people?.length === 1);
  await hand.choose('#area-kind', '2');
  await dragGround([2.5, -2.6], [3.6, -1.4]);
  await fileIs(page, 'there is a zone', now => now.members.zones?.length === 1);
  await hand.press('Escape');
  await hand.fill('#file-lists [data-path="people.0.count"]', '3');
  await fileIs(page, 'there are three people', now => now.members.people[0].count === 3);
  await hand.click('#file-save');
  await fileIs(page, 'the file is saved', now => !now.modified);
  await page.screenshot({path: path('office.png')});
  console.log(`a person takes ${Math.round(hand.seconds)} s`);
  assert.ok(hand.seconds < MOST_SECONDS, `${hand.seconds} s`);
  await close(editor);

  // The walls meet, furniture stands at them, and all of it runs.
  const scenario = JSON.parse(read('office.json'));
  const poseOf = name => [...scenario.models, ...scenario.robots].find(each => each.name === name).pose;
  assert.deepEqual(poseOf('wall1'), [0.5, 1.75, -90]);
  assert.deepEqual(scenario.models.filter(({name}) => /^wall[23]$/.test(name)).map(({pose}) => pose[1]), [0.55, 0.55], 'in one line');
  assert.equal(poseOf('sofa1')[0], 0, 'beside the wall');
  await check('office.json');
  const run = new Program(troupe, [
    'run', path('office.json'), '--in-process', '--headless', '--ticks', '900', '--speed', 'max', '--poses', path('office.csv'),
  ]);
  assert.equal(await run.end, 0, run.lines.join('\n'));
  const last = new Map(read('office.csv').trim().split('\n').map(line => line.split(',')).filter(([tick]) => tick === '900')
    .map(([, name, x, y]) => [name, [Number(x), Number(y)]]));
  const [x, y] = last.get('cube1');
  assert.ok(Math.hypot(x + 2.5, y + 2) < 0.1, `the cube was brought: ${x}, ${y}`);
}

await pages.runAll([buildsAnOffice], path);
