// The scenarios of scenario_hash_test by the WebAssembly module in Chromium: the state hash of every tick and the
// readings of all sensors are those of the program, byte by byte.
//   node module_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES [SCENARIO ...]
import assert from 'node:assert/strict';
import {existsSync, mkdirSync, readdirSync, readFileSync, rmSync} from 'node:fs';
import {Pages} from './pages.mjs';
import {Program} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const built = `${source}/build/wasm/bin/troupe-core`;
if (!existsSync(`${built}.wasm`)) {
  console.log('module_test: no WebAssembly module (preset wasm); nothing was checked');
  process.exit(77);
}
const pages = await Pages.launch('module_test', source);
rmSync(files, {recursive: true, force: true});
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;

// [file, ticks]; the module reads no buildings, which are YAML.
function goldenCases() {
  const test = readFileSync(`${source}/tests/determinism/scenario_hash_test.cc`, 'utf8');
  const found = [...test.matchAll(/(?:HashAfter|StateAfter)\("([\w./]+\.json)", (\d+)\)/g)];
  const cases = found.map(([, name, ticks]) => [`worlds/scenarios/${name}`, Number(ticks)])
    .filter(([name]) => !/"world":\s*"[^"]*\.yaml"/.test(readFileSync(`${source}/${name}`, 'utf8')));
  assert.ok(cases.length >= 10, `found ${cases.length} scenarios`);
  return cases;
}

// The worlds with all that they name, as [path below the source folder, bytes in base64].
const worlds = readdirSync(`${source}/worlds`, {recursive: true, withFileTypes: true}).filter(entry => entry.isFile())
  .map(entry => `${entry.parentPath ?? entry.path}/${entry.name}`)
  .map(file => [file.slice(source.length), readFileSync(file).toString('base64')]);
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
  const log = name => path(`${file.replaceAll(/\W/g, '_')}.${name}`);
  const program = new Program(`${programs}/troupe`, [
    'run', `${source}/${file}`, '--in-process', '--headless', '--ticks', String(ticks),
    '--hash-log', log('hashes'), '--scans', log('scans'),
  ]);
  assert.equal(await program.end, 0, program.lines.join('\n'));
  const [hashes, scans] = ['hashes', 'scans'].map(name => existsSync(log(name)) ? readFileSync(log(name), 'utf8') : '');
  assert.equal(hashes.trim().split('\n').length, ticks + 1);

  const page = await pages.open('about:blank', 400, 300);
  await page.addScriptTag({path: `${built}.js`});
  const found = await page.evaluate(runModule, {wasm, worlds, file: `/${file}`, ticks});
  assert.deepEqual(found.complaints, []);
  assertSameLines(found.hashes, hashes, ticks);
  assertSameLines(found.scans, scans, ticks);
  console.log(`${ticks} ticks, ${scans.length} bytes of readings, ${found.seconds.toFixed(1)} s in the page`);
  for (const name of ['hashes', 'scans']) rmSync(log(name), {force: true});
};

const tests = goldenCases().map(golden => Object.defineProperty(testOf(golden), 'name', {value: golden[0]}));
await pages.runAll(tests, path);
