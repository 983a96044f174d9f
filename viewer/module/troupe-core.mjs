// Runs troupe-core in node, with the files of the host.
//   node troupe-core.mjs FILE TICKS HASH_LOG [SCANS]
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

const folder = dirname(fileURLToPath(import.meta.url));
const createTroupe = createRequire(import.meta.url)(join(folder, 'troupe-core.js'));
const [file, ticks, ...logs] = process.argv.slice(2);
// Given here, so that the loader needs no fetch, which it takes for that of a browser.
const module = await createTroupe({wasmBinary: readFileSync(join(folder, 'troupe-core.wasm'))});
const host = path => `/host${resolve(path)}`;
module.FS.mkdir('/host');
module.FS.mount(module.FS.filesystems.NODEFS, {root: '/'}, '/host');
process.exitCode = module.callMain([host(file ?? ''), ticks ?? '', ...logs.map(host)].slice(0, process.argv.length - 2));
