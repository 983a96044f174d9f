// Pages of `troupe edit` in a test: opened on a file of its folder, edited, saved and checked.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {Program, until} from './programs.mjs';

// `pages`: Pages; `troupe`: the program; `files`: the folder of the files.
export function editorPages(pages, troupe, files) {
  const path = name => `${files}/${name}`;
  const read = name => readFileSync(path(name), 'utf8');

  async function edit(file, more = []) {
    const program = new Program(troupe, ['edit', path(file), '--listen', '127.0.0.1:0', ...more]);
    const url = await program.line('editor: ');
    const page = await pages.open(`${url}#view=top`, 1280, 800);
    await until('the page has the file', () => page.evaluate(() => Boolean(window.troupe?.file() && window.troupe.state())));
    return {program, page, url};
  }

  const documentOf = page => page.evaluate(() => window.troupe.file());

  // A field that is filled, or a part that is dragged, as the page is about to show another one is not changed.
  const settled = page => until('the page shows all replies', () => page.evaluate(() => window.troupe.isIdle()));

  async function fileIs(page, what, wanted) {
    const found = await until(what, async () => {
      const shown = await documentOf(page);
      return wanted(shown) ? shown : null;
    });
    await settled(page);
    return found;
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

  return {path, read, edit, documentOf, settled, fileIs, save, drag, ground, placeOf, close, check};
}
