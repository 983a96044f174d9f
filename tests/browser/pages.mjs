// Pages in a headless Chromium with software rendering, and the problems that they report.
import assert from 'node:assert/strict';
import {existsSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {DEADLINE, Program, until} from './programs.mjs';

// As Chromium draws where there is no graphics card, on any machine.
export const SOFTWARE_GRAPHICS = [
  '--no-sandbox', '--disable-gpu-compositing', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
];

// Of a page: most of the processor time of a test would be of pictures that it does not look at.
const FRAMES_PER_SECOND = 10;

export class Pages {
  // Ends the process as a skipped test, with the reason, where chromium or a package of the page is missing.
  // `packages`: names of further packages, which `loaded` then has.
  static async launch(test, source, packages = []) {
    const skip = reason => {
      console.log(`${test}: ${reason}; nothing was checked`);
      process.exit(77);
    };
    const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(path => existsSync(path));
    if (!executablePath) skip('chromium is not installed');
    const loaded = {};
    try {
      const load = createRequire(`${source}/viewer/web/package.json`);
      for (const name of ['playwright-core', ...packages]) loaded[name] = load(name);
    } catch {
      skip('the packages of viewer/web are not installed');
    }
    const browser = await loaded['playwright-core'].chromium.launch({
      executablePath,
      args: SOFTWARE_GRAPHICS,
      timeout: DEADLINE,
    });
    return new Pages(browser, loaded);
  }

  constructor(browser, loaded) {
    Object.assign(this, {browser, loaded, problems: [], mayLoseGateway: new Set()});
  }

  // A page at the address. Its errors, the complaints on its console, and requests to other hosts are kept in `problems`.
  // `more`: further options of the browser's page, such as a touch screen.
  async open(url, width, height, more = {}) {
    const page = await this.browser.newPage({viewport: {width, height}, ...more});
    page.on('console', message => {
      const isComplaint = ['error', 'warning'].includes(message.type()) && !message.text().includes('GPU stall');
      const isLoss = this.mayLoseGateway.has(page) && /WebSocket|ERR_[A-Z_]+/.test(message.text());
      if (isComplaint && !isLoss) this.problems.push(message.text());
    });
    page.on('pageerror', error => this.problems.push(error.message));
    page.on('request', request => {
      const to = new URL(request.url());
      if (to.protocol.startsWith('http') && to.hostname !== '127.0.0.1') this.problems.push(`request to ${to}`);
    });
    await page.addInitScript(milliseconds => {
      const request = window.requestAnimationFrame.bind(window);
      window.requestAnimationFrame = callback => setTimeout(() => request(callback), milliseconds);
      window.cancelAnimationFrame = clearTimeout.bind(window);
    }, 1000 / FRAMES_PER_SECOND);
    page.setDefaultTimeout(DEADLINE);
    await page.goto(url);
    return page;
  }

  // One that shows a run, when it has a state.
  async openRun(url, width, height, more = {}) {
    const page = await this.open(url, width, height, more);
    await until('the page has a state', () => page.evaluate(() => window.troupe?.state() ?? null));
    return page;
  }

  // Closes it and ends its run.
  async closeRun(page, program) {
    this.expectLossOfGateway(page);
    await page.close();
    await program.stop();
  }

  // The gateway of the pages ends from here on: failed connections are no problems, however late the browser tells of them.
  expectLossOfGateway(...opened) {
    for (const page of opened) this.mayLoseGateway.add(page);
  }

  // The serious findings of axe-core on the page, as texts. REQUIRES: it is among the packages.
  async findings(page) {
    await page.evaluate(this.loaded['axe-core'].source);
    const {violations, passes} = await page.evaluate(() => window.axe.run({preload: false}));
    assert.ok(passes.some(({id}) => id === 'color-contrast'), 'the rules were applied');
    return violations.filter(({impact}) => impact === 'serious' || impact === 'critical')
      .map(({id, nodes}) => `${id}: ${nodes.map(node => node.html.slice(0, 160)).join('\n  ')}`);
  }

  // Runs the tests one after the other, or those that the command line names after its three arguments, and ends the
  // process: with 1 if one has failed. `path`: of a picture of a page that a failed test leaves, by its name. `check`: looked
  // at when all programs have ended.
  async runAll(tests, path, check) {
    const failed = [];
    const attempt = async (name, action) => {
      try {
        await action();
        console.log(`${name}: passed`);
      } catch (error) {
        failed.push(`FAILED ${name}: ${error.message.split('\n').filter(Boolean).slice(0, 8).join('\n  ')}`);
        console.error(`${name}: ${error.stack}`);
        for (const program of Program.all) if (!program.ended) console.error(program.lines.join('\n'));
      }
    };
    const chosen = process.argv.slice(5);
    for (const test of tests) {
      if (chosen.length > 0 && !chosen.includes(test.name)) continue;
      await attempt(test.name, test);
      for (const [i, page] of this.browser.contexts().flatMap(context => context.pages()).entries()) {
        await page.screenshot({path: path(`left-${test.name}-${i}.png`)}).catch(() => {});
        const file = await page.evaluate(() => window.troupe?.file?.() ?? null).catch(() => null);
        if (file) writeFileSync(path(`left-${test.name}-${i}.json`), JSON.stringify(file, null, 1));
        await page.close();
      }
    }
    await this.browser.close();
    for (const program of Program.all) await program.stop();
    await attempt('pagesReportNoProblems', () => {
      if (this.problems.length > 0) throw new Error(this.problems.join('\n'));
    });
    if (check) await attempt('endsAsExpected', check);
    // Again, at the end of a long output.
    if (failed.length > 0) console.error(failed.join('\n'));
    process.exit(failed.length > 0 ? 1 : 0);
  }
}
