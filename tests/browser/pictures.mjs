// Takes the pictures of the viewer and the editor in docs/pictures, in a headless Chromium with full quality. Not a test:
// it fails only when it cannot take one. scripts/pictures runs it.
//   node pictures.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES FOLDER_OF_STAGE_WORLDS [PICTURE ...]
import {existsSync, mkdirSync} from 'node:fs';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files, stage, ...chosen] = process.argv.slice(2);
const troupe = `${programs}/troupe`;
const pages = await Pages.launch('pictures', source);
mkdirSync(files, {recursive: true});

// The wheel turns towards `at`, in the page: closer for positive steps.
async function zoom(page, at, steps) {
  await page.mouse.move(...at);
  for (let i = 0; i < Math.abs(steps); ++i) await page.mouse.wheel(0, steps > 0 ? -120 : 120);
}

async function take(page, name) {
  // Two frames: one with the newest sizes, one that is composed.
  await page.evaluate(() => new Promise(resolve => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  const path = `${source}/docs/pictures/${name}.png`;
  await page.screenshot({path});
  console.log(path);
}

// A state of a recorded run. `select`: of an entity; `dark`: the theme.
async function ofRun(name, {world, tick, hash = '', at, steps = 0, dark = false, width = 1280, height = 720, more = {}, prepare}) {
  const recording = `${files}/${name}.mcap`;
  const run = new Program(troupe, [
    'run', world, '--in-process', '--headless', '--ticks', String(tick + 20), '--speed', 'max', '--session', `pictures-${process.pid}`,
    '--record', recording,
  ]);
  if (await run.end !== 0) throw new Error(run.lines.join('\n'));
  const viewer = new Program(troupe, ['view', recording, '--listen', '127.0.0.1:0']);
  const page = await pages.open(`${await viewer.line('viewer: ')}#quality=full&smooth=0&tick=${tick}${hash}`, width, height, more);
  await until('the state is shown', () => page.evaluate(wanted => window.troupe?.state()?.tick === wanted, tick));
  if (dark) await page.click('#theme');
  if (steps !== 0) await zoom(page, at, steps);
  if (prepare) await prepare(page);
  await page.waitForTimeout(500);  // the wheel of the picture slows down
  await take(page, name);
  await page.close();
  await viewer.stop();
}

// The card at the end of a run that was watched.
async function ofEnd(name, world, ticks) {
  const run = new Program(troupe, ['run', world, '--ticks', String(ticks), '--speed', '10', '--session', `pictures-${process.pid}`]);
  const page = await pages.open(`${await run.line('viewer: ')}#quality=full&smooth=0`, 1280, 720);
  await page.locator('.end-robot').first().waitFor();
  pages.mayComplain = true;
  await take(page, name);
  await page.close();
  await run.stop();
}

// A file in the editor, which does not save it.
async function ofEditor(name, file, prepare) {
  const editor = new Program(troupe, ['edit', file, '--listen', '127.0.0.1:0']);
  const page = await pages.open(`${await editor.line('editor: ')}#quality=full`, 1280, 800);
  await until('the file is shown', () => page.evaluate(() => Boolean(window.troupe?.file() && window.troupe.state())));
  await prepare(page);
  await page.waitForTimeout(500);
  await take(page, name);
  await page.close();
  await editor.stop();
}

const scenarios = `${source}/worlds/scenarios`;
const pictures = {
  viewer: () => ofRun('viewer', {world: `${scenarios}/demo.json`, tick: 160, hash: '&robot=anna'}),
  viewer_top: () => ofRun('viewer_top', {world: `${scenarios}/demo.json`, tick: 160, hash: '&view=top&rays=all', dark: true}),
  viewer_sensors: () => ofRun('viewer_sensors', {world: `${scenarios}/sensors.json`, tick: 60, hash: '&robot=scout&tab=sensors', height: 800}),
  viewer_stack: () => ofRun('viewer_stack', {world: `${scenarios}/stacking.json`, tick: 400, hash: '&robot=builder&follow=1', at: [640, 330], steps: 5}),
  viewer_phone: () => ofRun('viewer_phone', {
    world: `${scenarios}/demo.json`, tick: 160, hash: '&robot=anna', width: 390, height: 844, more: {isMobile: true, hasTouch: true},
  }),
  viewer_lab: () => ofRun('viewer_lab', {world: `${scenarios}/lab.json`, tick: 84, hash: '&rays=all', at: [640, 360], steps: 1}),
  editor_world: () => ofEditor('editor_world', `${source}/worlds/office.world`, async page => {
    await page.click('.entity:has-text("table2")');
    await page.click('button:has-text("Home")');
  }),
  editor_model: () => ofEditor('editor_model', `${source}/worlds/include/grippers.inc`, async page => {
    await page.click('.palette-line:has-text("stacker") .plain');
    await page.locator('#model-editor').waitFor();
    await page.click('.part-name:has-text("gripper")');
  }),
  viewer_plots: () => ofRun('viewer_plots', {
    world: `${scenarios}/demo.json`, tick: 300, hash: '&robot=anna',
    prepare: async page => {
      await page.evaluate(() => {
        window.troupe.select('anna');
        window.troupe.plot(['x', 'y', 'range/ranger:0']);
      });
      await page.locator('.plot-canvas').nth(1).scrollIntoViewIfNeeded();
    },
  }),
  viewer_end: () => ofEnd('viewer_end', `${scenarios}/demo.json`, 300),
  viewer_cave: () => ofRun('viewer_cave', {world: `${stage}/benchmark/cave.world`, tick: 600, hash: '&view=top'}),
};

try {
  for (const [name, picture] of Object.entries(pictures)) {
    if (chosen.length > 0 && !chosen.includes(name)) continue;
    if (name === 'viewer_cave' && !existsSync(stage)) continue;
    await picture();
  }
} catch (error) {
  console.error(error);
  process.exitCode = 1;
}
for (const program of Program.all) {
  if (!program.ended) program.child.kill('SIGKILL');
}
await pages.browser.close();
