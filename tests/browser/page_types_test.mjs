// The page's TypeScript fits together, which esbuild, that only strips the types, does not look at. Its rows are those
// that the build of `troupe` has written.
//   page_types_test.mjs PROGRAMS SOURCE
import {spawnSync} from 'node:child_process';
import {createRequire} from 'node:module';

const source = process.argv[3];
let compiler;
try {
  compiler = createRequire(`${source}/viewer/web/package.json`).resolve('typescript/lib/tsc.js');
} catch {
  console.log('page_types_test: the packages of viewer/web are not installed; nothing was checked');
  process.exit(77);
}
const run = spawnSync(process.execPath, [compiler, '--noEmit', '--pretty', 'false', '--project', `${source}/viewer/web`],
  {encoding: 'utf8'});
process.stdout.write(run.stdout);
process.stderr.write(run.stderr);
console.log(run.status === 0 ? 'page_types_test: no type of the page is wrong' : 'page_types_test: see above');
process.exit(run.status ?? 1);
