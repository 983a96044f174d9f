// The scenarios of scenario_hash_test, and the random ones of platforms_test, by the WebAssembly module in Chromium: the
// state hash of every tick and the readings of all sensors are those of the program, byte by byte.
//   node module_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES [FILE ...]
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, mkdirSync, readdirSync, readFileSync, rmSync} from 'node:fs';
import {relative, resolve} from 'node:path';
import {Pages} from './pages.mjs';
import {Program} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2, 5).map(folder => resolve(folder));
const built = `${source}/build/wasm/bin/troupe-core`;
if (!existsSync(`${built}.wasm`)) {
  console.log('module_test: no WebAssembly module (preset wasm); nothing was checked');
  process.exit(77);
}
const pages = await Pages.launch('module_test', source);
rmSync(files, {recursive: true, force: true});
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;

// Of both, [file, ticks].
function goldenCases() {
  const test = readFileSync(`${source}/tests/determinism/scenario_hash_test.cc`, 'utf8');
  const found = [...test.matchAll(/(?:HashAfter|StateAfter)\("([\w./]+\.json)", (\d+)\)/g)];
  assert.ok(found.length >= 12, `found ${found.length} scenarios`);
  return found.map(([, name, ticks]) => [resolve(`${source}/worlds/scenarios`, name), Number(ticks)]);
}
function randomCases() {
  const script = `${source}/tests/determinism/random_scenario.py`;
  const found = execFileSync('python3', [script, files, '1', '12'], {encoding: 'utf8'}).trim().split('\n');
  return found.map(file => [file, 200]);
}
const cases = [...goldenCases(), ...randomCases()];

// In the page as on this machine: the worlds and the random scenarios, as [path, bytes in base64].
const worlds = [`${source}/worlds`, files]
  .flatMap(folder => readdirSync(folder, {recursive: true, withFileTypes: true}))
  .filter(entry => entry.isFile())
  .map(entry => `${entry.parentPath ?? entry.path}/${entry.name}`)
  .map(file => [file, readFileSync(file).toString('base64')]);
const wasm = readFileSync(`${built}.wasm`).toString('base64');

// In the page: runs the scenario, and returns its logs, or what the module complained of.
async function runModule({wasm, worlds, file, ticks}) {
  const bytesOf = base64 => Uint8Array.from(atob(base64), letter => letter.charCodeAt(0));
  const complaints = [];
  const {FS, callMain} = await createTroupe({wasmBinary: bytesOf(wasm), printErr: line => complaints.push(line)});
  for (const [name, base64] of worlds) {
    FS.mkdirTree(name.slice(0, name.lastIndexOf('/')));
    FS.writeFile(name, bytesOf(base64));
  }
  const start = performance.now();
  const status = callMain([file, String(ticks), '/hashes', '/scans']);
  if (status !== 0) return {complaints: [`exit status ${status}`, ...complaints]};
  const textOf = log => FS.analyzePath(log).exists ? FS.readFile(log, {encoding: 'utf8'}) : '';
  return {complaints, hashes: textOf('/hashes'), scans: textOf('/scans'), seconds: (performance.now() - start) / 1000};
}

// The lines of two logs are the same. `ticks`: in the last state the module measures, and the program does not.
function assertSameLines(found, expected, ticks) {
  const lines = [found, expected].map(text => text.split('\n'));
  lines[0] = lines[0].filter(line => !line.includes(`"tick":${ticks},`));
  const differs = lines[0].findIndex((line, i) => line !== lines[1][i]);
  if (differs >= 0) assert.equal(lines[0][differs], lines[1][differs], `line ${differs + 1}`);
  assert.equal(lines[0].length, lines[1].length, 'numbers of lines');
}

const testOf = ([file, ticks]) => async () => {
  const log = name => path(`log.${name}`);
  const program = new Program(`${programs}/troupe`, [
    'run', file, '--in-process', '--headless', '--ticks', String(ticks),
    '--hash-log', log('hashes'), '--scans', log('scans'),
  ]);
  assert.equal(await program.end, 0, program.lines.join('\n'));
  const [hashes, scans] = ['hashes', 'scans'].map(name => existsSync(log(name)) ? readFileSync(log(name), 'utf8') : '');
  assert.equal(hashes.trim().split('\n').length, ticks + 1);

  const page = await pages.open('about:blank', 400, 300);
  await page.addScriptTag({path: `${built}.js`});
  const found = await page.evaluate(runModule, {wasm, worlds, file, ticks});
  assert.deepEqual(found.complaints, []);
  assertSameLines(found.hashes, hashes, ticks);
  assertSameLines(found.scans, scans, ticks);
  console.log(`${ticks} ticks, ${scans.length} bytes of readings, ${found.seconds.toFixed(1)} s in the page`);
  for (const name of ['hashes', 'scans']) rmSync(log(name), {force: true});
};

const tests = cases.map(each => Object.defineProperty(testOf(each), 'name', {value: relative(source, each[0])}));
await pages.runAll(tests, path);
