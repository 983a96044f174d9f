// The worker of a page without a gateway, behind the loader of the module (troupe-core.js): opens the recording of the page,
// answers the page as the gateway would, and compares all states of the recording beside it.
'use strict';

let module = null;
const requests = [];
const PERIOD = 16;  // ms
const PROOF_SHARE = 40;  // ms of comparing at a time, while the page asks for nothing

function message() {
  const start = module._troupe_message();
  const bytes = module.HEAPU8.slice(start, start + module._troupe_message_size());
  return module._troupe_message_is_text() ? new TextDecoder().decode(bytes) : bytes.buffer;
}

function receive(text) {
  module.ccall('troupe_receive', null, ['string'], [text]);
}

function post(value) {
  if (typeof value === 'string') self.postMessage(value);
  else self.postMessage(value, [value]);
}

let proven = false;
function serve() {
  const start = performance.now();
  for (const text of requests.splice(0)) receive(text);
  while (module._troupe_next()) post(message());
  if (!proven) {
    module._troupe_continue_proof(Math.max(5, PROOF_SHARE - (performance.now() - start)));
    const text = message();
    proven = JSON.parse(text).done;
    post(text);
  }
  setTimeout(serve, proven ? PERIOD : 0);
}

async function open({wasm, recording, name}) {
  module = await createTroupe({wasmBinary: wasm});
  module.FS.writeFile('/run.mcap', new Uint8Array(recording));
  const problem = module.ccall('troupe_open', 'string', ['string', 'string'], ['/run.mcap', name]);
  if (problem) {
    post(JSON.stringify({type: 'proof', done: true, equal: 0, states: 0, problem}));
    return;
  }
  post(JSON.stringify({type: 'open'}));
  serve();
}

self.onmessage = event => {
  if (typeof event.data === 'string') requests.push(event.data);
  else open(event.data).catch(error => post(JSON.stringify({type: 'proof', done: true, equal: 0, states: 0, problem: String(error)})));
};
