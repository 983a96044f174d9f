// The pages of the site that simulate in the browser: files of `troupe view --static`, and the report of a test with the
// page of its smallest failing case.
import {execFileSync, spawnSync} from 'node:child_process';
import {copyFileSync, cpSync, existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {basename, dirname, join, relative, resolve} from 'node:path';

const PICTURE_TICK = 100;

// [{"name", "title", "text", "try", "picture", "page", "links": [[title, path], ...]}, ...], with paths below the output.
// `pages`: of contents.json. `module`: folder of the WebAssembly module.
export function makeLivePages(pages, {root, output, program, module}) {
  const run = (...args) => execFileSync(program, args, {stdio: ['ignore', 'ignore', 'inherit']});
  const full = resolve(program);
  const makePage = (file, page, ...more) => run('view', file, '--static', '-o', join(output, page), '--module', module, ...more);
  mkdirSync(join(output, 'live'), {recursive: true});

  // A page has the files of one folder: scenarios of the site are copied with the models that they include, at the same
  // distance from them.
  const inCopy = (file, make) => {
    const work = mkdtempSync(join(tmpdir(), 'troupe-site-'));
    try {
      const copy = join(work, file);
      mkdirSync(dirname(copy), {recursive: true});
      copyFileSync(join(root, file), copy);
      cpSync(join(root, 'worlds/include'), join(work, 'worlds/include'), {recursive: true});
      return make(copy, work);
    } finally {
      rmSync(work, {recursive: true, force: true});
    }
  };

  const makeScenario = (each, scenario) => {
    const page = `live/${each.name}.html`;
    makePage(scenario, page);
    const picture = `live/${each.name}.png`;
    if (each.picture) copyFileSync(join(root, each.picture), join(output, picture));
    else run('snapshot', scenario, '--tick', String(PICTURE_TICK), '-o', join(output, picture));
    return {...each, page, picture, links: [['Open it', page]]};
  };

  const makeTest = (each, test, work) => {
    const report = join(dirname(test), 'report');
    // There, so that the commands in the report are those of a reader with the sources.
    const {status} = spawnSync(full, ['test', each.test, '--report', report], {cwd: work, stdio: ['ignore', 'ignore', 'inherit']});
    if (status !== 1) throw new Error(`${each.test}: found the exit status ${status}, expected a case that fails`);
    for (const file of readdirSync(report, {recursive: true}).filter(name => basename(name) === 'scenario.json')) {
      const path = join(report, file);
      writeFileSync(path, readFileSync(path, 'utf8').replaceAll(`${work}/`, `${relative(dirname(path), work)}/`));
    }
    const cases = readdirSync(report, {withFileTypes: true}).filter(entry => entry.isDirectory()).map(({name}) => name);
    const first = cases.sort((a, b) => a.localeCompare(b, 'en', {numeric: true}))[0];
    const page = `live/${each.name}.html`;
    makePage(join(report, first, 'scenario.json'), page, '--expect', test);
    const picture = `live/${each.name}.png`;
    copyFileSync(join(report, first, 'violation.png'), join(output, picture));
    const links = [['The smallest case, to change and run', page]];
    const folder = `live/${each.name}`;
    cpSync(report, join(output, folder), {recursive: true});
    // The programs may have been built before the module.
    const recorded = `${folder}/${first}/run.html`;
    if (!existsSync(join(output, recorded))) makePage(join(report, first, 'run.mcap'), recorded);
    links.push(['The recorded failure', recorded]);
    links.push(['The report of all cases', `${folder}/index.html`]);
    return {...each, page, picture, links};
  };

  return pages.map(each => {
    console.error(`live/${each.name}.html of ${basename(each.scenario ?? each.test)}`);
    if (each.test) return inCopy(each.test, (test, work) => makeTest(each, test, work));
    if (each.scenario.startsWith('worlds/')) return makeScenario(each, join(root, each.scenario));
    return inCopy(each.scenario, scenario => makeScenario(each, scenario));
  });
}
