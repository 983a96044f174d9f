// The worker of a page without a gateway, behind the loader of the module (troupe-core.js): opens the content of the
// page, a recording or a world with its files, and answers the page as the gateway would.
'use strict';

let module = null;
let waiting = 0;  // for the next call of serve; 0: it is on its way
const requests = [];
const PERIOD = 16;  // ms, between two answers
const again = new MessageChannel();  // unlike a timer, without a shortest time

function message() {
  const start = module._troupe_message();
  const bytes = module.HEAPU8.slice(start, start + module._troupe_message_size());
  return module._troupe_message_is_text() ? new TextDecoder().decode(bytes) : bytes.buffer;
}

function post(value) {
  if (typeof value === 'string') self.postMessage(value);
  else self.postMessage(value, [value]);
}

function tell(problem) {
  post(JSON.stringify({type: 'proof', done: true, equal: 0, states: 0, problem}));
}

function serve() {
  waiting = 0;
  try {
    for (const text of requests.splice(0)) module.ccall('troupe_receive', null, ['string'], [text]);
    const next = module._troupe_work(PERIOD / 1000);  // s
    while (module._troupe_next()) post(message());
    if (next === 0) again.port2.postMessage(null);
    else waiting = setTimeout(serve, Math.min(1000 * next, PERIOD));
  } catch (error) {
    tell(String(error));
  }
}
again.port1.onmessage = serve;

// The content: a line of JSON, {"name": of the page, "file": to open, "files": [[path, bytes], ...], "expectations"}, and
// the files one after another.
async function open({wasm, content}) {
  module = await createTroupe({wasmBinary: wasm});
  const bytes = new Uint8Array(content);
  const end = bytes.indexOf(10);
  const head = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end)));
  const {FS} = module;
  FS.symlink(head.program, '/proc/self/exe');  // beside which the installed worlds are
  let at = end + 1;
  for (const [path, size] of head.files) {
    FS.mkdirTree(path.slice(0, path.lastIndexOf('/')) || '/');
    FS.writeFile(path, bytes.subarray(at, at + size));
    at += size;
  }
  const problem = module.ccall(
    'troupe_open', 'string', ['string', 'string', 'string'], [head.file, head.name, JSON.stringify(head.expectations)]);
  if (problem) return tell(problem);
  post(JSON.stringify({type: 'open'}));
  serve();
}

self.onmessage = event => {
  if (typeof event.data !== 'string') {
    open(event.data).catch(error => tell(String(error)));
    return;
  }
  requests.push(event.data);
  if (waiting === 0) return;
  clearTimeout(waiting);
  serve();
};
