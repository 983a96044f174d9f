// The site, as scripts/site writes it, opened from the disk: no link leads nowhere, the search finds, both themes and a phone
// are usable, and axe-core has no serious findings.
//   node site_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, mkdirSync, readdirSync, readFileSync, rmSync} from 'node:fs';
import {dirname, join, normalize} from 'node:path';
import {Pages} from './pages.mjs';
import {until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('site_test', source, ['axe-core', 'marked']);
rmSync(files, {recursive: true, force: true});
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;
const site = path('site');
// Without Doxygen and the module: their pages are as the others, and static_test looks at what simulates.
execFileSync('node', [`${source}/viewer/site/build.mjs`, source, site, `${programs}/troupe`, '', ''], {stdio: 'inherit'});

const htmlFiles = readdirSync(site, {recursive: true}).filter(name => name.endsWith('.html'));

async function linksLeadSomewhere() {
  const ids = new Map(htmlFiles.map(name => [name, new Set([...readFileSync(join(site, name), 'utf8').matchAll(/\sid="([^"]*)"/g)].map(match => match[1]))]));
  const broken = [];
  let count = 0;
  for (const name of htmlFiles) {
    const html = readFileSync(join(site, name), 'utf8').replace(/<pre[\s\S]*?<\/pre>/g, '');
    for (const [, target] of html.matchAll(/(?:href|src)="([^"]*)"/g)) {
      if (/^[a-z]+:/.test(target)) continue;
      ++count;
      const [file, fragment] = target.split('#');
      const to = file === '' ? name : normalize(join(dirname(name), file));
      if (!existsSync(join(site, to))) broken.push(`${name}: ${target}`);
      else if (fragment && to.endsWith('.html') && !ids.get(to).has(fragment)) broken.push(`${name}: ${target}: no such heading`);
    }
  }
  assert.deepEqual(broken, []);
  assert.ok(count > 2000, `${count} links`);
}

const open = (name, ...more) => pages.open(`file://${site}/${name}`, ...more);

async function theSearchFinds() {
  const page = await open('index.html', 1280, 800);
  const requests = [];
  page.on('request', request => requests.push(request.url()));
  await page.keyboard.press('/');
  await page.keyboard.type('shrinking case');
  await until('something is found', async () => (await page.locator('#found [role=option] strong').count()) > 0);
  await page.screenshot({path: path('search.png')});
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  await until('the section is shown', () => page.url().includes('docs/testing.html#'));
  // Names of the interface, too.
  await page.fill('#search', 'VectorSimulation.step');
  await until('it is found', async () => /VectorSimulation/.test(await page.locator('#found [role=option] strong').first().textContent()));
  await page.fill('#search', 'zzzz');
  await until('nothing is found', async () => /Nothing has/.test(await page.textContent('#found')));
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#found').isVisible(), false);
  assert.deepEqual(requests.filter(url => !url.startsWith('file:')), []);
}

async function themesAndSizesAreUsable() {
  for (const [width, height] of [[1600, 900], [1280, 800], [820, 1180], [390, 844]]) {
    for (const colorScheme of ['light', 'dark']) {
      const page = await open('index.html', width, height, {colorScheme, hasTouch: width < 1000});
      assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), colorScheme);
      const others = width === 1280 || width === 390
        ? ['docs/running.html', 'reference/python-troupe.html', 'live/index.html', 'source/worlds/scenarios/demo.json.html'] : [];
      for (const name of ['index.html', ...others]) {
        await page.goto(`file://${site}/${name}`);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        assert.ok(wide <= 0, `${name} is ${wide} px wider than ${width}`);
        await page.screenshot({path: path(`${name.replaceAll('/', '_')}-${width}-${colorScheme}.png`)});
        assert.deepEqual(await pages.findings(page), [], `${name}, ${width} px, ${colorScheme}`);
      }
      if (width < 860) {
        await page.click('#menu');
        await until('the contents are shown', () => page.locator('#navigation').isVisible());
        await page.screenshot({path: path(`menu-${width}-${colorScheme}.png`)});
        assert.deepEqual(await pages.findings(page), []);
      }
      await page.click('#theme');
      assert.notEqual(await page.evaluate(() => document.documentElement.dataset.theme), colorScheme);
      await page.close();
    }
  }
}

await pages.runAll([linksLeadSomewhere, theSearchFinds, themesAndSizesAreUsable], path);
