// The parts of a file that `troupe view --static` has added to the page (launcher/commands/static_page.cc): the simulation
// as a WebAssembly module, its worker, and the content: a recording, or a world or a scenario with its files.

export const PARTS = {content: 'static-content', module: 'static-module', worker: 'static-worker'};

export function hasContent(): boolean {
  return document.getElementById(PARTS.content) !== null;
}

// Of an element with a gzip file as base64.
export async function contentOf(id: string): Promise<ArrayBuffer> {
  const bytes = Uint8Array.from(atob(document.getElementById(id)!.textContent!), letter => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
}

export interface StaticContent {
  file: string;  // the path of the one that the page shows
  files: Map<string, Uint8Array>;  // by their paths
}

// As viewer/module/page_worker.js: a line of JSON, then the files one after another.
export async function readContent(): Promise<StaticContent> {
  const bytes = new Uint8Array(await contentOf(PARTS.content));
  const end = bytes.indexOf(10);
  const head = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end))) as {file: string; files: Array<[string, number]>};
  let at = end + 1;
  const files = new Map(head.files.map(([path, size]): [string, Uint8Array] => [path, bytes.subarray(at, at += size)]));
  return {file: head.file, files};
}
