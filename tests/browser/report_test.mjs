// The reports of troupe test and troupe sweep, opened from the disk: light and dark as the system, narrow and wide, what one
// looks for first, and without serious findings of axe-core.
//   node report_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {mkdirSync, rmSync, writeFileSync} from 'node:fs';
import {Pages} from './pages.mjs';
import {Program} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('report_test', source, ['axe-core']);
rmSync(files, {recursive: true, force: true});
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;

// Robots that drive ahead; the fast ones leave their region.
const test = {
  include: [`${source}/worlds/include/robots.inc`],
  ticks: 40,
  robots: [{name: 'rover', model: 'scout', pose: [0, 0, 0],
            controller: {name: 'script', parameters: {commands: [{at: 0, vx: 0.2}]}}}],
  vary: {'robots[0].controller.parameters.commands[0].vx': [0.1, 0.2, 0.8], seed: [1, 2]},
  expect: [{name: 'stays near', that: 'always x(rover) < 1 m'}],
  metrics: {'way': 'final of x(rover)'},
};
writeFileSync(path('near.test.json'), JSON.stringify(test));
writeFileSync(path('far.test.json'), JSON.stringify({...test, expect: [{name: 'stays', that: 'always x(rover) < 100 m'}]}));

async function run(status, ...args) {
  const program = new Program(`${programs}/troupe`, args);
  assert.equal(await program.end, status, program.lines.join('\n'));
}

async function look(report, check) {
  for (const [width, height] of [[1280, 800], [390, 844]]) {
    for (const colorScheme of ['light', 'dark']) {
      const page = await pages.open(`file://${path(report)}/index.html`, width, height, {colorScheme});
      await page.screenshot({path: path(`${report}-${width}-${colorScheme}.png`), fullPage: true});
      assert.deepEqual(await pages.findings(page), [], `${report}, ${width} px, ${colorScheme}`);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${report} is wider than ${width} px`);
      const [paper, text, plot] = await page.evaluate(() => [getComputedStyle(document.body).backgroundColor,
        getComputedStyle(document.body).color, getComputedStyle(document.querySelector('svg > rect')).fill]);
      assert.equal(plot, paper, 'plots have the colour of the page');
      assert.notEqual(text, paper);
      assert.equal(paper === 'rgb(255, 255, 255)', colorScheme === 'light');
      await check(page);
      await page.close();
    }
  }
}

// True if what the first selector selects comes before that of the second one.
const isBefore = (page, first, second) => page.evaluate(([a, b]) => {
  const [one, other] = [document.querySelector(a), document.querySelector(b)];
  return (one.compareDocumentPosition(other) & Node.DOCUMENT_POSITION_FOLLOWING) !== 0;
}, [first, second]);

async function aTestShowsItsFailuresFirst() {
  await run(1, 'test', path('near.test.json'), '--no-shrink', '--report', path('tested'));
  await look('tested', async page => {
    assert.ok(await isBefore(page, 'details', '.plots'));
    assert.equal(await page.locator('main h1 .failed').textContent(), '2 failed');
  });
}

async function aSweepShowsItsPlotsFirst() {
  await run(0, 'sweep', path('far.test.json'), '-o', path('swept'));
  await look('swept', async page => assert.ok(await isBefore(page, '.plots', 'table')));
}

await pages.runAll([aTestShowsItsFailuresFirst, aSweepShowsItsPlotsFirst], path);
