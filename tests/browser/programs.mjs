// Runs of the programs, and waiting for what they do.
import {spawn} from 'node:child_process';
import {readFileSync, readdirSync} from 'node:fs';
import {createInterface} from 'node:readline';

export const DEADLINE = 240_000;  // ms, on the slowest machine, beside a hundred other processes

// Waits until `ask` returns something that is true, and returns that.
export async function until(what, ask) {
  const end = Date.now() + DEADLINE;
  for (;;) {
    const answer = await ask();
    if (answer) return answer;
    if (Date.now() > end) throw new Error(`waited in vain until ${what}`);
    await new Promise(resolve => setTimeout(resolve, 50));
  }
}

// A program of the project. Its lines are kept, and its end can be awaited.
export class Program {
  // `input`: 'pipe' for a program that is written to.
  constructor(path, args, input = 'ignore') {
    this.lines = [];
    this.child = spawn(path, args, {stdio: [input, 'pipe', 'pipe']});
    for (const stream of [this.child.stdout, this.child.stderr]) {
      createInterface({input: stream}).on('line', line => this.lines.push(line));
    }
    this.end = new Promise(resolve => this.child.on('close', (code, signal) => {
      this.ended = true;
      resolve(code ?? signal);
    }));
    Program.all.push(this);
  }

  // The first line that begins with `start`, without that.
  async line(start) {
    const found = await until(`${start} is printed`, () => {
      if (this.ended) throw new Error(`the program has ended:\n${this.lines.join('\n')}`);
      return this.lines.find(line => line.startsWith(start));
    });
    return found.slice(start.length);
  }

  // The process ids of its children whose command line contains `word`.
  children(word) {
    return readdirSync('/proc').filter(name => /^\d+$/.test(name)).map(Number).filter(pid => {
      try {
        const parent = Number(readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ')[1]);
        return parent === this.child.pid && readFileSync(`/proc/${pid}/cmdline`, 'utf8').split('\0').includes(word);
      } catch {
        return false;  // it has ended
      }
    });
  }

  async stop() {
    if (!this.ended) this.child.kill('SIGINT');
    return this.end;
  }
}
Program.all = [];
