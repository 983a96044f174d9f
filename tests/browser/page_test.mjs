// Checks how the page of `troupe view` is used: its layout on windows of all sizes, the rules of axe-core, ten tasks by keys
// alone, and a robot that is driven by touch.
//   node page_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {mkdirSync, readFileSync} from 'node:fs';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('page_test', source, ['axe-core']);
const troupe = `${programs}/troupe`;
const domain = String(161 + (process.pid % 19));
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;

const run = (name, more) => new Program(troupe, [
  'run', `${source}/worlds/scenarios/demo.json`, '--domain', domain, '--session', `page-${process.pid}-${name}`, ...more,
]);
const LIVE = ['--ticks', '1000000', '--speed', '1'];

const open = (url, width, height, more) => pages.openRun(url, width, height, more);
const close = (page, program) => pages.closeRun(page, program);

const robotOf = (page, name) => page.evaluate(
  wanted => window.troupe.robots().find(robot => robot.name === wanted) ?? null, name);
const stateOf = page => page.evaluate(() => window.troupe.state());
const isOn = (page, id) => page.$eval(`#${id}`, button => button.getAttribute('aria-pressed') === 'true');
const selected = (page, name) => until(`${name} is selected`, async () => (await page.textContent('#panel-name')) === name);

// What is wrong with the place or the size of visible controls and texts. `least`: px that a finger needs, 0: a mouse.
const layoutProblems = (page, least) => page.evaluate(smallest => {
  const problems = [];
  const isVisible = element => element.checkVisibility({visibilityProperty: true}) && element.getClientRects().length > 0;
  const isClipped = (element, box) => {
    for (let at = element.parentElement; at; at = at.parentElement) {
      const style = getComputedStyle(at);
      if (/auto|scroll/.test(style.overflowY)) return null;  // scrolls into view
      const around = at.getBoundingClientRect();
      if (/hidden/.test(style.overflowX) && (box.right > around.right + 1 || box.left < around.left - 1)) return at;
    }
    return box.left < -1 || box.right > innerWidth + 1 || box.top < -1 || box.bottom > innerHeight + 1 ? document.body : null;
  };
  for (const button of document.querySelectorAll('button, select')) {
    if (!isVisible(button)) continue;
    const box = button.getBoundingClientRect();
    const name = button.id || button.className;
    const clip = isClipped(button, box);
    if (clip) problems.push(`${name} is cut by ${clip.id || clip.tagName}`);
    if (button.id === 'sheet-handle') continue;
    if (Math.min(box.width, box.height) < smallest - 0.5) problems.push(`${name} is ${box.width} x ${box.height} px`);
  }
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const parent = texts.currentNode.parentElement;
    if (texts.currentNode.textContent.trim() === '' || !isVisible(parent)) continue;
    const size = parseFloat(getComputedStyle(parent).fontSize);
    if (size < 12) problems.push(`"${texts.currentNode.textContent.trim()}" has ${size} px`);
  }
  return problems;
}, least);

// Of each colour of texts, on cards and on what is selected: whatever happens in the run, which axe-core may not see.
const poorContrasts = page => page.evaluate(() => {
  const luminance = name => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const [r, g, b] = [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16) / 255)
      .map(value => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const contrast = (a, b) => (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  return ['--text', '--faint', '--accent', '--moving', '--holding', '--stalled', '--lost'].flatMap(text =>
    ['--card', '--accent-soft', '--hover'].filter(ground => !(contrast(luminance(text), luminance(ground)) >= 4.5))
      .map(ground => `${text} on ${ground}`));
});

const SIZES = [[1280, 720], [1920, 1080], [1024, 768], [390, 844], [844, 390]];

async function fitsWindowsOfAllSizes() {
  const shown = run('sizes', [...LIVE, '--paused']);
  const page = await open(`${await shown.line('viewer: ')}#robot=anna`, 1280, 720);
  await selected(page, 'anna');
  const places = () => page.$$eval('#bottom button', all => all.map(button => {
    const {left, top} = button.getBoundingClientRect();
    return [button.id, left, top];
  }));
  await page.click('#step-ten');
  await until('the run has made ten steps', async () => (await stateOf(page)).tick === 10);
  const live = await places();
  await page.click('#play');
  await until('the run plays', async () => !(await stateOf(page)).paused);
  assert.deepEqual(await places(), live, 'the buttons of the time stay where they are while the run plays');
  await page.focus('#timeline');
  await page.keyboard.press('ArrowLeft');
  await until('the past is shown', async () => (await stateOf(page)).past);
  assert.deepEqual(await places(), live, 'the buttons of the time stay where they are in the past');
  await page.click('#live');

  for (const [width, height] of SIZES) {
    await page.setViewportSize({width, height});
    const phone = width < 500 || height < 480;
    // Twice: the picture and the tools follow the window one frame later.
    await page.evaluate(() => new Promise(resolve => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    for (const theme of ['light', 'dark']) {
      await page.emulateMedia({colorScheme: theme});
      assert.deepEqual(await poorContrasts(page), [], theme);
      assert.deepEqual(await layoutProblems(page, phone ? 44 : 0), [], `at ${width} x ${height}, ${theme}`);
      assert.deepEqual(await pages.findings(page), [], `at ${width} x ${height}, ${theme}`);
      await page.screenshot({path: path(`${width}x${height}-${theme}.png`)});
    }
    // The picture fills the place that bars and columns leave, and a selected robot comes to its middle.
    const scene = await page.locator('#scene').boundingBox();
    const canvas = await page.locator('#scene canvas').boundingBox();
    assert.ok(Math.abs(canvas.width - scene.width) < 1 && Math.abs(canvas.height - scene.height) < 1);
    if (phone) assert.equal((await page.locator('#bottom').boundingBox()).height, 56);
    await page.click('#tab-events');
    assert.deepEqual(await pages.findings(page), [], `events at ${width} x ${height}`);
    await page.click('#tab-state');
  }
  await close(page, shown);
}

async function doesTenTasksByKeys() {
  const shown = run('keys', LIVE);
  const page = await open(await shown.line('viewer: '), 1280, 720);
  const keys = page.keyboard;
  const press = async (...all) => { for (const key of all) await keys.press(key); };

  // 1. Select a robot in the list.
  await page.locator('.robot').nth(1).waitFor();
  await press('1', 'ArrowDown', 'Enter');
  await selected(page, 'bela');
  // 2. Pause, step, and play.
  await press('Escape', ' ');
  const paused = await until('the run is paused', async () => {
    const state = await stateOf(page);
    return state.paused && state;
  });
  await page.locator('#step:enabled').waitFor();
  await press('.');
  await until('the run has made a step', async () => (await stateOf(page)).tick === paused.tick + 1);
  // 3. Turn and move the camera, and look from above.
  const place = () => page.evaluate(() => window.troupe.groundPoint(3, 3));
  for (const key of ['ArrowLeft', 'Shift+ArrowUp', '+', 't', 'ArrowRight', '-', 'h']) {
    await page.evaluate(() => document.activeElement.blur());
    const before = await place();
    await press(key);
    const after = await place();
    assert.ok(Math.hypot(after.x - before.x, after.y - before.y) > 1, `${key} moves the camera`);
  }
  assert.ok(await isOn(page, 'view-top'));
  // 4. Show all rays, and the sensors of the robot.
  await press('r', '3');
  assert.ok(await isOn(page, 'rays'));
  assert.equal(await page.getAttribute('#tab-sensors', 'aria-selected'), 'true');
  await press('ArrowRight');
  assert.equal(await page.getAttribute('#tab-events', 'aria-selected'), 'true', 'arrows move from tab to tab');
  // 5. Move a robot.
  await page.evaluate(() => document.activeElement.blur());
  const before = await robotOf(page, 'bela');
  await press('m', 'ArrowUp', 'ArrowUp', ']', 'Enter');
  await until('bela is moved', async () => Math.abs((await robotOf(page, 'bela')).pose.y - before.pose.y - 0.2) < 1e-9);
  // 6. Undo that.
  await press('Escape', 'Control+z');
  await until('bela is back', async () => (await robotOf(page, 'bela')).pose.y === before.pose.y);
  // 7. Add a robot with a controller.
  await press('a');
  await page.locator('#add-menu .menu-row').first().waitFor();
  await page.locator('#add-menu select').focus();
  await keys.type('idle');
  await page.locator('#add-menu .menu-row:has-text("scout")').first().focus();
  const toAnEmptyRoom = [...Array(4).fill('ArrowLeft'), ...Array(3).fill('ArrowUp')];
  await press('Enter', ...toAnEmptyRoom, 'Enter');
  await until('the robot is selected', async () => /^scout/.test(await page.textContent('#panel-name')));
  await until('it has the controller', async () => /controlleridle/.test(await page.textContent('#panel-facts')));
  const added = await page.textContent('#panel-name');
  // 8. Send it to a point, though its controller accepts no goals: the page drives it there, until it is released.
  await press(' ');
  await until('the run plays', async () => !(await stateOf(page)).paused);
  await press('g', 'ArrowRight', 'Enter');
  await until('it drives', async () => (await robotOf(page, added)).twist[0] > 0);
  assert.match(await page.textContent('#drive'), /Release/);
  await press('Escape');
  await until('it is released', async () => !(await isOn(page, 'drive')));
  // A robot whose controller accepts goals searches its way, which is shown: from the corridor into a room.
  await page.evaluate(() => window.troupe.select('bela'));
  await selected(page, 'bela');
  const sent = await page.evaluate(() => window.troupe.request(
    'command_robot', {name: 'bela', ticks: 100000, goal: {waypoints: [[-8, -7.2]]}}));
  assert.ok(sent.done, sent.problem);
  await until('the way is shown', async () => (await page.evaluate(() => window.troupe.goals()))
    .some(({robot, way}) => robot === 'bela' && way > 0));
  await until('the goal is shown', async () => /goal-8\.00, -7\.20 m/.test(await page.textContent('#panel-facts')));
  const into = await page.evaluate(() => window.troupe.request(
    'command_robot', {name: 'bela', ticks: 100000, goal: {waypoints: [[-4, -3]]}}));
  assert.match(into.problem, /cannot reach the goal: there is no room for it at \(-4\.00, -3\.00\)/);
  await page.evaluate(name => window.troupe.select(name), added);
  await selected(page, added);
  // 9. Drive it.
  await press('c');
  await keys.down('ArrowLeft');
  await until('it turns', async () => (await robotOf(page, added)).twist[2] > 0);
  await keys.up('ArrowLeft');
  await press('Escape');
  // 10. Delete it, and look at the past; the keys of the page work while the timeline has the focus.
  await press('Delete');
  await until('it is deleted', async () => (await robotOf(page, added)) === null);
  await page.focus('#timeline');
  await press('ArrowLeft');
  await until('the past is shown', async () => (await stateOf(page)).past);
  await press('o');
  assert.ok(await isOn(page, 'view-orbit'));
  await press('?');
  assert.ok(await page.isVisible('#help'));
  await press('Escape');
  assert.ok(await page.isHidden('#help'));
  await close(page, shown);
}

// A finger on the screen: `points` on its way, as fractions of the element.
async function touch(page, selector, points) {
  const session = await page.context().newCDPSession(page);
  const box = await page.locator(selector).boundingBox();
  const at = ([x, y]) => [{x: box.x + x * box.width, y: box.y + y * box.height}];
  await session.send('Input.dispatchTouchEvent', {type: 'touchStart', touchPoints: at(points[0])});
  for (const point of points.slice(1)) {
    await session.send('Input.dispatchTouchEvent', {type: 'touchMove', touchPoints: at(point)});
  }
  return () => session.send('Input.dispatchTouchEvent', {type: 'touchEnd', touchPoints: []});
}

// A tap, again if it was none: on a busy machine the finger stays too long on the screen.
async function tap(page, selector, isDone) {
  await until(`a tap on ${selector} has its effect`, async () => {
    await page.tap(selector);
    for (let i = 0; i < 20; ++i) {
      if (await isDone()) return true;
      await page.waitForTimeout(50);
    }
    return false;
  });
}

async function drivesByTouch() {
  const shown = run('touch', LIVE);
  const url = await shown.line('viewer: ');
  for (const [width, height] of [[390, 844], [844, 390]]) {
    const page = await open(url, width, height, {hasTouch: true, isMobile: true});
    const twist = (what, wanted) => until(what, async () => wanted((await robotOf(page, 'anna')).twist));
    await tap(page, '#tab-robots', () => page.isVisible('.robot:has-text("anna")'));
    await tap(page, '.robot:has-text("anna")', async () => (await page.textContent('#panel-name')) === 'anna');
    await tap(page, '#drive', () => isOn(page, 'drive'));
    await twist('anna stands still', ([vx, , wz]) => vx === 0 && wz === 0);
    let lift = await touch(page, '#drive-pad', [[0.5, 0.5], [0.2, 0.5], [0.05, 0.5]]);
    await twist('anna turns left', ([vx, , wz]) => Math.abs(vx) < 1e-9 && wz > 0);
    await page.screenshot({path: path(`drive-${width}x${height}.png`)});
    await lift();
    await twist('anna stands still again', ([vx, , wz]) => vx === 0 && wz === 0);
    // The camera by two fingers is that of three.js; by one it turns.
    const before = await page.evaluate(() => window.troupe.groundPoint(0, 0));
    lift = await touch(page, '#scene', [[0.3, 0.4], [0.4, 0.4], [0.5, 0.4]]);
    await lift();
    await until('the picture turns', async () => {
      const after = await page.evaluate(() => window.troupe.groundPoint(0, 0));
      return Math.hypot(after.x - before.x, after.y - before.y) > 2;
    });
    await tap(page, '#drive', async () => !(await isOn(page, 'drive')));
    await twist('its controller continues', ([vx, , wz]) => vx !== 0 || wz !== 0);
    // Tools that have no place in the bar are behind a button, and those of the time behind another.
    await tap(page, '#more-open', () => page.isVisible('#more'));
    await tap(page, '#more #measure', () => isOn(page, 'measure'));
    assert.ok(await page.isHidden('#more'));
    await tap(page, '#time-more', () => page.isVisible('#speed'));
    await page.tap('#step-ten', {trial: true, force: true});
    assert.ok(await page.isVisible('#speed'));
    pages.expectLossOfGateway(page);
    await page.close();
  }
  await shown.stop();
}

async function explainsWhatIsNotPossible() {
  const recording = path('short.mcap');
  const recorded = run('recorded', ['--ticks', '20', '--speed', 'max', '--headless', '--in-process', '--record', recording]);
  assert.equal(await recorded.end, 0, recorded.lines.join('\n'));
  const shown = new Program(troupe, ['view', recording, '--listen', '127.0.0.1:0']);
  const page = await open(`${await shown.line('viewer: ')}#robot=anna`, 1280, 720);
  await selected(page, 'anna');
  for (const id of ['move', 'add', 'drive', 'send', 'delete']) {
    assert.ok(await page.isVisible(`#${id}`), `${id} is shown`);
    await page.click(`#${id}`, {force: true});  // Playwright waits until it is enabled
    await page.locator('.toast.error:has-text("A recording cannot be changed")').last().waitFor();
  }
  // Those of a gripper, too.
  await page.evaluate(() => window.troupe.select('gino'));
  await selected(page, 'gino');
  await until('its gripper cannot be moved', () => page.$$eval('.gripper button', all =>
    all.length === 4 && all.every(button => button.getAttribute('aria-disabled') === 'true')));
  assert.deepEqual(await pages.findings(page), []);
  await close(page, shown);
}

// The marks of the timeline say what they stand for, by kinds that can be hidden; a film of them is a GIF that browsers read.
async function tellsEventsAndRecordsAPicture() {
  const recording = path('events.mcap');
  const made = new Program(troupe, ['run', `${source}/worlds/scenarios/demo.json`, '--headless', '--in-process', '--no-ros', '--ticks', '400', '--record', recording]);
  assert.equal(await made.end, 0, made.lines.join('\n'));
  const shown = new Program(troupe, ['view', recording, '--listen', '127.0.0.1:0']);
  const page = await open(`${await shown.line('viewer: ')}#tab=events`, 1280, 720);
  const chips = page.locator('.event-kinds .chip:visible');
  await until('kinds are listed', async () => (await chips.count()) > 2);
  const axis = await page.locator('#timeline').boundingBox();
  const tips = async () => {
    const found = new Set();
    for (let x = 4; x < axis.width; x += 12) {
      await page.mouse.move(axis.x + x, axis.y + 10);
      if (await page.isVisible('#timeline-tip')) found.add(await page.textContent('#timeline-tip'));
    }
    return [...found].join('\n');
  };
  assert.match(await tips(), /\d:\d\d\.\d .*gino: .* holds/);
  await page.click('.chip:has-text("Objects")');
  const others = await until('objects are hidden', async () => {
    const now = await tips();
    return now.includes('holds') ? null : now || 'none';
  });
  assert.ok(!others.includes('objects'), others);

  await page.click('#play');
  await page.click('#gif');
  assert.ok(await isOn(page, 'gif'));
  const tick = (await stateOf(page)).tick;
  await until('it moves', async () => Math.abs((await stateOf(page)).tick - tick) > 15);
  const saved = page.waitForEvent('download');
  await page.click('#gif');
  const download = await saved;
  assert.match(download.suggestedFilename(), /^events\.mcap-\d+\.gif$/);
  await download.saveAs(path('events.gif'));
  const data = readFileSync(path('events.gif')).toString('base64');
  const decoded = await page.evaluate(async text => {
    const decoder = new ImageDecoder({type: 'image/gif', data: Uint8Array.from(atob(text), letter => letter.charCodeAt(0))});
    await decoder.tracks.ready;
    const count = decoder.tracks.selectedTrack.frameCount;
    const {image} = await decoder.decode({frameIndex: count - 1});
    return {count, width: image.displayWidth, complete: (await decoder.decode({frameIndex: 0})).complete};
  }, data);
  assert.ok(decoded.count > 2 && decoded.width === 640 && decoded.complete, JSON.stringify(decoded));
  await close(page, shown);
}

await pages.runAll([tellsEventsAndRecordsAPicture, fitsWindowsOfAllSizes, doesTenTasksByKeys, drivesByTouch, explainsWhatIsNotPossible], path);
