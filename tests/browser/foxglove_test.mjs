// Reads a live run and a recording with Foxglove's own client, over its WebSocket protocol.
//   node foxglove_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {mkdirSync, readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
let FoxgloveClient;
let WebSocket;
try {
  const load = createRequire(`${source}/viewer/web/package.json`);
  ({FoxgloveClient} = load('@foxglove/ws-protocol'));
  WebSocket = load('ws');
} catch {
  console.log('foxglove_test: the packages of viewer/web are not installed; nothing was checked');
  process.exit(77);
}

const troupe = `${programs}/troupe`;
const scenario = `${source}/worlds/scenarios/demo.json`;
const domain = String(121 + (process.pid % 19));
const session = `foxglove-${process.pid}`;
mkdirSync(files, {recursive: true});

const socketUrl = address => address.replace(/^http/, 'ws');

// A client with all that it has received.
class Client {
  constructor(url, protocol) {
    const client = new FoxgloveClient({ws: new WebSocket(url, [protocol])});
    Object.assign(this, {client, channels: new Map(), services: new Map(), messages: new Map(), replies: new Map()});
    client.on('error', error => { this.error = error; });
    client.on('serverInfo', info => { this.info = info; });
    client.on('advertise', list => list.forEach(channel => this.channels.set(channel.topic, channel)));
    client.on('advertiseServices', list => list.forEach(service => this.services.set(service.name, service)));
    client.on('message', ({subscriptionId, timestamp, data}) => {
      const json = JSON.parse(new TextDecoder().decode(data));
      this.messages.set(this.topics.get(subscriptionId), {timestamp, json});
    });
    client.on('time', ({timestamp}) => { this.time = timestamp; });
    client.on('serviceCallResponse', reply => {
      this.replies.set(reply.callId, JSON.parse(new TextDecoder().decode(reply.data)));
    });
    client.on('serviceCallFailure', reply => { this.replies.set(reply.callId, reply.message); });
    this.topics = new Map();
  }

  async subscribe(topic) {
    const channel = await until(`${topic} is advertised`, () => this.channels.get(topic));
    assert.equal(channel.encoding, 'json');
    assert.equal(channel.schemaEncoding, 'jsonschema');
    assert.equal(JSON.parse(channel.schema).title, channel.schemaName);
    this.topics.set(this.client.subscribe(channel.id), topic);
    return channel;
  }

  message(topic, wanted = () => true) {
    return until(`a message of ${topic}`, () => {
      if (this.error) throw this.error;
      const message = this.messages.get(topic);
      return message && wanted(message) ? message : null;
    });
  }

  async call(name, request) {
    const service = await until(`${name} is advertised`, () => this.services.get(name));
    const callId = this.replies.size + 1;
    const data = new TextEncoder().encode(JSON.stringify(request));
    this.client.sendServiceCallRequest({serviceId: service.id, callId, encoding: 'json', data: new DataView(data.buffer)});
    return until(`${name} replies`, () => this.replies.get(callId));
  }
}

function readPoses(path) {
  const poses = new Map();
  for (const line of readFileSync(path, 'utf8').trim().split('\n').slice(1)) {
    const [tick, name, x, y] = line.split(',');
    poses.set(`${tick} ${name}`, [Number(x), Number(y)]);
  }
  return poses;
}

const tickOf = timestamp => Number(timestamp / 1_000_000n) / 100;  // of 0.1 s

function checkTransforms({timestamp, json}, poses) {
  const tick = tickOf(timestamp);
  const anna = json.transforms.find(transform => transform.child_frame_id === 'anna');
  assert.equal(anna.parent_frame_id, 'map');
  assert.deepEqual([anna.translation.x, anna.translation.y], poses.get(`${tick} anna`), `at tick ${tick}`);
}

async function readsALiveRun() {
  const path = name => `${files}/${name}`;
  const run = new Program(troupe, [
    'run', scenario, '--domain', domain, '--session', session, '--ticks', '1000000', '--speed', '1', '--paused',
    '--poses', path('live.csv'),
  ]);
  const url = socketUrl(await run.line('viewer: '));
  const client = new Client(url, 'foxglove.websocket.v1');
  const info = await until('the server introduces itself', () => client.info);
  assert.ok(info.capabilities.includes('services') && info.capabilities.includes('time'));
  for (const topic of ['/scene', '/tf', '/map']) await client.subscribe(topic);
  const scans = await until('scans are advertised', () => [...client.channels.values()].find(channel => channel.schemaName === 'foxglove.LaserScan'));
  await client.subscribe(scans.topic);

  const scene = (await client.message('/scene')).json;
  const ids = scene.entities.map(entity => entity.id);
  for (const id of ['map', 'anna', 'bela']) assert.ok(ids.includes(id), `${id} is in the scene`);
  for (const {triangles} of scene.entities) {
    for (const {points} of triangles) assert.equal(points.length % 3, 0);
  }
  const map = (await client.message('/map')).json;
  assert.equal(Buffer.from(map.data, 'base64').length % map.column_count, 0);
  assert.ok(Buffer.from(map.data, 'base64').includes(100));
  const scan = (await client.message(scans.topic)).json;
  assert.ok(scan.ranges.length > 1 && scan.end_angle > scan.start_angle);

  const shown = [await client.message('/tf')];
  const stepped = await client.call('/step', {ticks: 5});
  assert.equal(stepped.done, true);
  assert.equal(stepped.tick, 5);
  shown.push(await client.message('/tf', ({timestamp}) => tickOf(timestamp) === 5));
  await until('the clock follows', () => client.time === 500_000_000n);
  assert.equal((await client.call('/play', {})).done, true);
  shown.push(await client.message('/tf', ({timestamp}) => tickOf(timestamp) > 8));
  assert.equal((await client.call('/pause', {})).state, 'paused');
  assert.match(await client.call('/spawn', {source: 'no_such_model', pose: [0, 0, 0, 0]}), /no_such_model/);
  assert.match(await client.call('/spawn', {source: '/etc/passwd', pose: [0, 0, 0, 0]}), /expected a model/);
  client.client.close();

  // Without the token, and from a page of another site.
  for (const [address, options] of [[url.replace(/\?.*/, ''), {}], [url.replace(/token=./, 'token=x'), {}]]) {
    const refused = new WebSocket(address, ['foxglove.sdk.v1'], options);
    assert.equal(await new Promise(resolve => refused.on('unexpected-response', (_, response) => resolve(response.statusCode)).on('error', () => {})), 403);
  }
  const allowed = new WebSocket(url, ['foxglove.sdk.v1'], {origin: 'https://app.example'});
  await new Promise((resolve, reject) => allowed.on('open', resolve).on('error', reject));
  allowed.close();
  assert.equal(await run.stop(), 130);
  const poses = readPoses(path('live.csv'));
  for (const message of shown) checkTransforms(message, poses);
}

// The messages are made by hand, because the client of npm knows no playback.
async function playsARecording() {
  const path = name => `${files}/${name}`;
  const run = new Program(troupe, [
    'run', scenario, '--domain', domain, '--session', `${session}-r`, '--ticks', '200', '--headless', '--in-process',
    '--poses', path('recorded.csv'), '--record', path('recorded.mcap'),
  ]);
  assert.equal(await run.end, 0, run.lines.join('\n'));
  const viewer = new Program(troupe, ['view', path('recorded.mcap'), '--listen', '127.0.0.1:0']);
  const socket = new WebSocket(socketUrl(await viewer.line('viewer: ')), ['foxglove.sdk.v1']);
  const texts = [];
  let transforms = null;
  const states = [];
  socket.on('message', (data, isBinary) => {
    if (!isBinary) return texts.push(JSON.parse(data.toString()));
    if (data[0] === 1) transforms = {timestamp: data.readBigUInt64LE(5), json: JSON.parse(data.subarray(13).toString())};
    if (data[0] === 5) {
      states.push({status: data[1], time: data.readBigUInt64LE(2), seek: data[14], request: data.subarray(19).toString()});
    }
  });
  const text = op => until(`${op} arrives`, () => texts.find(message => message.op === op));
  const info = await text('serverInfo');
  assert.ok(info.capabilities.includes('rangedPlayback'));
  assert.deepEqual(info.dataEndTime, {sec: 20, nsec: 0});
  const {channels} = await text('advertise');
  socket.send(JSON.stringify({op: 'subscribe', subscriptions: [{id: 7, channelId: channels.find(c => c.topic === '/tf').id}]}));
  const control = (play, speed, seek, id) => {
    const bytes = Buffer.alloc(19 + id.length);
    bytes.writeUInt8(3, 0);
    bytes.writeUInt8(play ? 0 : 1, 1);
    bytes.writeFloatLE(speed, 2);
    bytes.writeUInt8(seek === null ? 0 : 1, 6);
    bytes.writeBigUInt64LE(seek ?? 0n, 7);
    bytes.writeUInt32LE(id.length, 15);
    bytes.write(id, 19);
    socket.send(bytes);
  };
  const poses = readPoses(path('recorded.csv'));
  const shows = (what, wanted) => until(what, () => transforms && wanted(tickOf(transforms.timestamp)) ? transforms : null);
  checkTransforms(await shows('the start is shown', tick => tick === 0), poses);
  control(false, 1, 12_300_000_000n, 'there');
  const answer = await until('the seek is answered', () => states.find(state => state.request === 'there'));
  assert.deepEqual(answer, {status: 1, time: 12_300_000_000n, seek: 1, request: 'there'});
  checkTransforms(await shows('tick 123 is shown', tick => tick === 123), poses);
  control(true, 4, null, 'play');
  checkTransforms(await shows('it plays', tick => tick > 130), poses);
  control(true, 100, null, 'fast');
  await until('the end is reported', () => states.find(state => state.status === 3));
  checkTransforms(await shows('the end is shown', tick => tick === 200), poses);
  socket.close();
  assert.equal(await viewer.stop(), 0);
}

let failed = false;
try {
  await readsALiveRun();
  await playsARecording();
  console.log('foxglove_test: passed');
} catch (error) {
  failed = true;
  console.error(error);
  for (const program of Program.all) console.error(program.lines.join('\n'));
}
for (const program of Program.all) {
  if (!program.ended) program.child.kill('SIGKILL');
}
process.exit(failed ? 1 : 0);
