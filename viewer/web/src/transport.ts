// Transport: the way of messages between the page and what shows it a run: a gateway, by a WebSocket, or in a file of
// `troupe view --static` the same program as a WebAssembly module, in a worker.
//
// Messages are the same in both; what differs is how they begin and end. A socket connects again by itself, after waits
// that double up to three seconds, and the gateway then sends the world again. A module cannot be lost.

import {contentOf, hasContent, PARTS} from './static_content';

export interface TransportHandler {
  onOpen(): void;
  onClosed(): void;
  onData(data: ArrayBuffer | string): void;
}

export interface Transport {
  // False: not connected.
  send(text: string): boolean;
}

export function makeTransport(handler: TransportHandler): Transport {
  return hasContent() ? new ModuleTransport(handler) : new SocketTransport(handler);
}

const SHORTEST_WAIT = 300;  // ms, before a new attempt
const LONGEST_WAIT = 3000;

// Connects again by itself, for instance when the gateway was restarted.
class SocketTransport implements Transport {
  private socket: WebSocket | null = null;
  private wait = SHORTEST_WAIT;

  constructor(private readonly handler: TransportHandler) {
    this.connect();
  }

  send(text: string): boolean {
    if (!this.socket || this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(text);
    return true;
  }

  private connect(): void {
    const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(`${scheme}//${location.host}/socket${location.search}`, 'troupe');
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.socket = socket;
      this.wait = SHORTEST_WAIT;
      this.handler.onOpen();
    };
    socket.onmessage = event => this.handler.onData(event.data as ArrayBuffer | string);
    socket.onclose = () => {
      this.socket = null;
      this.handler.onClosed();
      setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    };
  }
}

class ModuleTransport implements Transport {
  private worker: Worker | null = null;

  constructor(private readonly handler: TransportHandler) {
    this.start().catch(error => this.fail(String(error)));
  }

  send(text: string): boolean {
    this.worker?.postMessage(text);
    return this.worker !== null;
  }

  private async start(): Promise<void> {
    const [wasm, content, script] = await Promise.all([PARTS.module, PARTS.content, PARTS.worker].map(contentOf));
    const worker = new Worker(URL.createObjectURL(new Blob([script], {type: 'text/javascript'})));
    worker.onmessage = event => {
      // Its first message, before which the page asks for nothing.
      if (!this.worker) {
        this.worker = worker;
        this.handler.onOpen();
      }
      this.handler.onData(event.data as ArrayBuffer | string);
    };
    worker.onerror = event => this.fail(event.message);
    worker.postMessage({wasm, content}, [wasm, content]);
  }

  private fail(problem: string): void {
    this.handler.onData(JSON.stringify({type: 'proof', done: true, equal: 0, states: 0, problem}));
  }
}
