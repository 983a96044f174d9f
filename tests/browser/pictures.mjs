// Takes the pictures of the viewer and the editor in docs/pictures, in a headless Chromium with full quality. Not a test:
// it fails only when it cannot take one. scripts/pictures runs it.
//   node pictures.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES FOLDER_OF_STAGE_WORLDS [PICTURE ...]
import {existsSync, mkdirSync, readFileSync, writeFileSync} from 'node:fs';
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
  pages.expectLossOfGateway(page);
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

// A moving picture of a recorded run, from one tick to another, `step` ticks a frame; of the picture alone, without the panels.
// The encoder is gifenc from npm, in build/pictures (scripts/pictures); the page of it turns the pictures into colours.
async function moving(name, {world, first, last, step, width, height, hash = ''}) {
  const encoder = `${source}/build/pictures/node_modules/gifenc/dist/gifenc.esm.js`;
  if (!existsSync(encoder)) {
    console.log(`${name}.gif stays as it is: gifenc is not installed`);
    return;
  }
  const recording = `${files}/${name}.mcap`;
  const run = new Program(troupe, [
    'run', world, '--in-process', '--headless', '--ticks', String(last), '--session', `pictures-${process.pid}`, '--record', recording,
  ]);
  if (await run.end !== 0) throw new Error(run.lines.join('\n'));
  const viewer = new Program(troupe, ['view', recording, '--listen', '127.0.0.1:0']);
  const page = await pages.open(`${await viewer.line('viewer: ')}#quality=full&smooth=0&tick=${first}${hash}`, 1280, 720);
  const canvas = page.locator('canvas').first();
  const frames = [];
  const isShown = tick => until(`tick ${tick} is shown`, () => page.evaluate(wanted => window.troupe?.state()?.tick === wanted, tick));
  await isShown(first);
  for (let tick = first; tick <= last; tick += step) {
    await page.evaluate(wanted => {
      const slider = document.getElementById('timeline');
      slider.value = String(wanted);
      slider.dispatchEvent(new Event('input'));
    }, tick);
    await isShown(tick);
    await page.evaluate(() => new Promise(resolve => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    frames.push((await canvas.screenshot({type: 'jpeg', quality: 95})).toString('base64'));
  }
  await page.close();
  const studio = await pages.browser.newPage();
  const module = `data:text/javascript;base64,${readFileSync(encoder).toString('base64')}`;
  const bytes = await studio.evaluate(async ({module, frames, width, height, delay}) => {
    const {GIFEncoder, quantize, applyPalette} = await import(module);
    const gif = GIFEncoder();
    const canvas = new OffscreenCanvas(width, height);
    const context = canvas.getContext('2d', {willReadFrequently: true});
    let palette = null;  // of the first frame, for all
    let before = null;
    for (const frame of frames) {
      const image = await createImageBitmap(await (await fetch(`data:image/jpeg;base64,${frame}`)).blob());
      // The middle of the picture, in the proportions that are wanted.
      const scale = Math.max(width / image.width, height / image.height);
      context.drawImage(image, (width - image.width * scale) / 2, (height - image.height * scale) / 2, image.width * scale, image.height * scale);
      const {data} = context.getImageData(0, 0, width, height);
      palette ??= quantize(data, 64).slice(0, 63);
      const index = applyPalette(data, palette);
      // What has not changed is transparent, which compresses well.
      const shown = index.slice();
      if (before) for (let i = 0; i < index.length; ++i) if (index[i] === before[i]) shown[i] = palette.length;
      gif.writeFrame(shown, width, height, {
        palette: before ? undefined : [...palette, [0, 0, 0]], delay, transparent: Boolean(before), transparentIndex: palette.length, dispose: 1,
      });
      before = index;
    }
    gif.finish();
    return Array.from(gif.bytes());
  }, {module, frames, width, height, delay: 125});
  await studio.close();
  await viewer.stop();
  const path = `${source}/docs/pictures/${name}.gif`;
  writeFileSync(path, Buffer.from(bytes));
  console.log(`${path} ${bytes.length} bytes, ${frames.length} frames`);
  if (bytes.length > 2_000_000) throw new Error(`${path} is larger than 2 MB`);
}

const scenarios = `${source}/worlds/scenarios`;
const pictures = {
  demo: () => moving('demo', {world: `${scenarios}/demo.json`, first: 60, last: 250, step: 5, width: 720, height: 405}),
  viewer: () => ofRun('viewer', {world: `${scenarios}/demo.json`, tick: 160, hash: '&robot=anna'}),
  viewer_top: () => ofRun('viewer_top', {world: `${scenarios}/demo.json`, tick: 160, hash: '&view=top&rays=all', dark: true}),
  viewer_sensors: () => ofRun('viewer_sensors', {world: `${scenarios}/sensors.json`, tick: 60, hash: '&robot=scout&tab=sensors', height: 800}),
  viewer_stack: () => ofRun('viewer_stack', {world: `${scenarios}/stacking.json`, tick: 400, hash: '&robot=builder&follow=1', at: [640, 330], steps: 5}),
  viewer_levels: () => ofRun('viewer_levels', {world: `${scenarios}/hotel.json`, tick: 240, hash: '&levels=beside&robot=tiny_1',
    prepare: page => page.click('#names')}),
  waiting_graph: () => ofRun('waiting_graph', {
    world: `${source}/worlds/sites/sidings.json`, tick: 700, hash: '&view=top', height: 420, prepare: page => page.click('#traffic'),
  }),
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
  editor_robot: () => {
    const file = `${files}/yard.world`;
    writeFileSync(file, `include "robots.inc"
include "furniture.inc"

model( name "wall1" pose [0 3 0 0] size [6 0.1 1] color "gray60" )
table( name "table1" pose [-1.5 1 0 0] )
chair( name "chair1" pose [-1.5 0.2 0 90] )
shelf( name "shelf1" pose [1.5 2.7 0 0] )

# Keeps away from the table.
scout( name "scout1" pose [1 0.5 0 90] ctrl "wander speed=0.6" )
`);
    return ofEditor('editor_robot', file, async page => {
      await page.click('.entity:has-text("scout1")');
      await page.locator('select[data-property=controller]').waitFor();
      await page.click('#file-text');
      await page.locator('#text-area .cm-content').waitFor();
    });
  },
  editor_plan: () => ofEditor('editor_plan', `${source}/worlds/office.world`, async page => {
    await page.setInputFiles('#plan-file', `${source}/worlds/bitmaps/office.png`);
    await page.locator('#plan-import').waitFor();
    const box = await page.locator('#plan-canvas').boundingBox();
    for (const x of [0.005, 0.25]) await page.mouse.click(box.x + x * box.width, box.y + 0.2 * box.height);
    await page.fill('#plan-distance', '6');
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
  viewer_expectations: () => {
    const file = `${files}/watched.json`;
    writeFileSync(file, JSON.stringify({
      world: `${source}/worlds/robotics_lab.world`,
      robots: [
        {name: 'rover', model: 'scout', pose: [0.6, -6.5, 0], controller: {name: 'script', parameters: {commands: [{at: 0, vx: 0.4}]}}},
        {name: 'guard', model: 'scout', pose: [0.3, -4.6, 180], controller: {name: 'wander'}},
      ],
      expect: [
        {name: 'rover never stalls', that: 'always not stalled(rover)'},
        {name: 'rover drives a metre', that: 'eventually x(rover) > 1 m'},
        {name: 'they keep apart', that: 'always distance(rover, guard) > 0.5 m'},
        {name: 'guard leaves the room', that: 'eventually y(guard) > 6 m'},
      ],
    }));
    return ofRun('viewer_expectations', {world: file, tick: 100, hash: '&tab=events&robot=rover', at: [480, 330], steps: 3,
                                         prepare: page => page.locator('.expect-row').first().waitFor()});
  },
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
