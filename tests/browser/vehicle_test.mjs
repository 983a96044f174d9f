// Vehicles of VDA 5050 on the page: their orders in the panel, on the floor and among the events; people who take them over.
//   node vehicle_test.mjs FOLDER_OF_PROGRAMS SOURCE_FOLDER FOLDER_FOR_FILES
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdirSync} from 'node:fs';
import {Pages} from './pages.mjs';
import {Program, until} from './programs.mjs';

const [programs, source, files] = process.argv.slice(2);
const pages = await Pages.launch('vehicle_test', source);
const troupe = `${programs}/troupe`;
const domain = String(101 + (process.pid % 19));
const session = `vehicle-${process.pid}`;
mkdirSync(files, {recursive: true});
const path = name => `${files}/${name}`;

const request = (page, command, more) => page.evaluate(([c, m]) => window.troupe.request(c, m), [command, more]);

async function step(page, ticks) {
  const {tick} = await page.evaluate(() => window.troupe.state());
  const reply = await request(page, 'step', {ticks});
  assert.equal(reply.problem, '');
  await until(`tick ${tick + ticks}`, () => page.evaluate(to => window.troupe.state().tick >= to, tick + ticks));
}

// What the panel shows, by the names of its rows.
const rows = page => page.evaluate(() => Object.fromEntries([...document.querySelectorAll('#panel-vehicle dt')].map(
  term => [term.textContent, [...term.nextElementSibling.children].map(line => line.textContent).join('\n')])));
const row = (page, name, text) => until(`${name}: ${text}`, async () => {
  const shown = (await rows(page))[name];
  return shown === text || (text instanceof RegExp && text.test(shown ?? '')) ? shown : null;
});
const events = page => page.evaluate(() => window.troupe.events().map(({text}) => text));
const event = (page, text) => until(text, async () => (await events(page)).some(each => each.includes(text)));

function order(id, stops, released) {
  const nodes = stops.map(([nodeId, x, y], i) => (
    {nodeId, sequenceId: 2 * i, released: i < released, nodePosition: {x, y, mapId: 'hall'}, actions: []}));
  const edges = nodes.slice(1).map((node, i) => ({
    edgeId: `e${i}`, sequenceId: 2 * i + 1, released: node.released, startNodeId: nodes[i].nodeId, endNodeId: node.nodeId, actions: []}));
  return JSON.stringify({
    headerId: 1, timestamp: '2026-01-01T00:00:00.00Z', version: '2.1.0', manufacturer: 'Troupe', serialNumber: 'cart_1', orderId: id,
    orderUpdateId: 0, nodes, edges,
  });
}
const send = (broker, text) => execFileSync('mosquitto_pub', [
  '-h', broker.hostname, '-p', broker.port, '-t', 'uagv/v2/Troupe/cart_1/order', '-q', '1', '-m', text]);

async function showsVehicles() {
  const run = new Program(troupe, [
    'run', `${source}/worlds/scenarios/vda5050.json`, '--domain', domain, '--session', session, '--paused', '--speed', 'max', '--in-process',
    '--record', path('run.mcap'), '--vda5050', 'local']);
  const broker = new URL(await run.line('broker: '));
  const page = await pages.openRun(`${await run.line('viewer: ')}#smooth=0&view=top&robot=cart_1`, 1280, 720);
  await step(page, 2);
  await row(page, 'mode', 'AUTOMATIC, stands');
  assert.equal((await rows(page)).order, 'none');

  send(broker, order('tour', [['a', -3, 0], ['b', -3, -2], ['c', 3, -2], ['d', 3, 2]], 3));
  await until('the order has come', async () => {
    await step(page, 1);
    return (await rows(page)).order === 'tour, update 0';
  });
  await step(page, 2);
  assert.equal((await rows(page)).base, 'b → c');
  assert.equal((await rows(page)).horizon, 'd');
  await until('base and horizon are drawn', async () => {
    const {base, horizon} = await page.evaluate(() => window.troupe.vehicleMarks());
    return base.join() === 'b,c' && horizon.join() === 'd';
  });
  await event(page, 'cart_1: order tour accepted');
  await page.screenshot({path: path('order.png')});

  // A box falls into the aisle, and is taken away.
  assert.equal((await request(page, 'set_pose', {name: 'pallet_1', pose: [-3, -1.1, 0, 0]})).problem, '');
  await step(page, 80);
  await row(page, 'errors', /^pathBlocked: pallet_1 is in the way \(nodeId b, obstacle pallet_1, edgeId e0\)$/);
  await event(page, 'cart_1: error pathBlocked: pallet_1 is in the way');
  await page.click('#tab-events');
  await page.waitForSelector('.event.warning');
  assert.match(await page.textContent('#event-list ~ *, #page-events'), /Orders \d/);
  await page.click('#tab-state');
  assert.equal((await request(page, 'set_pose', {name: 'pallet_1', pose: [5, -3, 0, 0]})).problem, '');
  await step(page, 60);
  await until('the error is gone', async () => !('errors' in await rows(page)));
  await event(page, 'cart_1: error pathBlocked cleared');
  await row(page, 'last node', 'b');

  // A person moves it.
  assert.equal((await request(page, 'set_pose', {name: 'cart_1', pose: [0, 2, 0, 0]})).problem, '');
  await step(page, 3);
  await row(page, 'mode', /^MANUAL/);
  assert.equal((await rows(page)).base, 'at its end');
  await event(page, 'mode MANUAL');
  await step(page, 30);
  await row(page, 'mode', /^AUTOMATIC/);
  // A person drives it.
  await request(page, 'command_robot', {name: 'cart_1', ticks: 5, twist: [0.3, 0, 0]});
  await step(page, 5);
  await row(page, 'mode', /^MANUAL/);
  pages.expectLossOfGateway(page);
  await page.close();
  await run.stop();
}

// The recording of the run before: what was shown at a time is shown again.
async function showsRecordings() {
  const view = new Program(troupe, ['view', path('run.mcap'), '--listen', '127.0.0.1:0']);
  const page = await pages.openRun(`${await view.line('viewer: ')}#smooth=0&view=top&robot=cart_1`, 1280, 720);
  // As a user does: a click on the event goes to its time.
  const goTo = async text => {
    await page.click('#tab-events');
    await page.click(`#event-list .event:has-text("${text}")`);
    await page.click('#tab-state');
  };
  await goTo('order tour accepted');
  await row(page, 'order', 'tour, update 0');
  assert.equal((await rows(page)).horizon, 'd');
  await goTo('error pathBlocked:');
  await row(page, 'errors', /^pathBlocked/);
  await goTo('mode MANUAL');
  await row(page, 'mode', /^MANUAL/);
  pages.expectLossOfGateway(page);
  await page.close();
  await view.stop();
}

await pages.runAll([showsVehicles, showsRecordings], path);
