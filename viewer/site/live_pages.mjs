// The pages of the site that simulate in the browser: files of `troupe view --static`, and the report of a test with the
// page of its smallest failing case.
import {execFileSync} from 'node:child_process';
import {copyFileSync, cpSync, existsSync, mkdirSync, mkdtempSync, readdirSync, rmSync, symlinkSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {basename, dirname, join} from 'node:path';

const PICTURE_TICK = 100;

// [{"name", "title", "text", "try", "picture", "page", "links": [[title, path], ...]}, ...], with paths below the output.
// `pages`: of contents.json. `module`: folder of the WebAssembly module.
export function makeLivePages(pages, {root, output, program, module}) {
  const run = (...args) => execFileSync(program, args, {stdio: ['ignore', 'ignore', 'inherit']});
  const makePage = (scenario, page) => run('view', scenario, '--static', '-o', join(output, page), '--module', module);
  mkdirSync(join(output, 'live'), {recursive: true});

  const makeScenario = each => {
    const page = `live/${each.name}.html`;
    makePage(join(root, each.scenario), page);
    const picture = `live/${each.name}.png`;
    if (each.picture) copyFileSync(join(root, each.picture), join(output, picture));
    else run('snapshot', join(root, each.scenario), '--tick', String(PICTURE_TICK), '-o', join(output, picture));
    return {...each, page, picture, links: [['The page', page]]};
  };

  // Tests keep their failing cases beside them, so that the test is a copy, at the same distance from the worlds.
  const makeTest = each => {
    const work = mkdtempSync(join(tmpdir(), 'troupe-site-'));
    try {
      const test = join(work, each.test);
      mkdirSync(dirname(test), {recursive: true});
      copyFileSync(join(root, each.test), test);
      for (const name of ['worlds', 'configs']) symlinkSync(join(root, name), join(work, name));
      const report = join(work, dirname(each.test), 'report');
      try {
        run('test', test, '--report', report);
        throw new Error(`${each.test}: no case fails, expected one`);
      } catch (error) {
        if (error.status !== 1) throw error;
      }
      const cases = readdirSync(report, {withFileTypes: true}).filter(entry => entry.isDirectory()).map(({name}) => name);
      const first = cases.sort((a, b) => a.localeCompare(b, 'en', {numeric: true}))[0];
      const page = `live/${each.name}.html`;
      makePage(join(report, first, 'scenario.json'), page);
      const picture = `live/${each.name}.png`;
      copyFileSync(join(report, first, 'violation.png'), join(output, picture));
      const links = [['The smallest case, to change and run', page]];
      const folder = `live/${each.name}`;
      cpSync(report, join(output, folder), {recursive: true});
      if (existsSync(join(report, first, 'run.html'))) links.push(['The recorded failure', `${folder}/${first}/run.html`]);
      links.push(['The report of all cases', `${folder}/index.html`]);
      return {...each, page, picture, links};
    } finally {
      rmSync(work, {recursive: true, force: true});
    }
  };

  return pages.map(each => {
    console.error(`live/${each.name}.html of ${basename(each.scenario ?? each.test)}`);
    return each.test ? makeTest(each) : makeScenario(each);
  });
}
