// Reads a recording with @mcap/core, both by its index and from its begin on, decodes every message by the schemas in the
// file, and prints the channels. Ends with 1 where the two ways or the recording's own numbers disagree.
//   node read.mjs FILE.mcap
import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader } from "@foxglove/omgidl-serialization";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";
import fs from "node:fs/promises";

const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };

function expect(holds, text) {
  if (!holds) {
    console.error(`error: ${text}`);
    process.exit(1);
  }
}

class Decoder {
  constructor() {
    this.readers = new Map(); // by channel
    this.counts = new Map(); // by topic
    this.last = new Map(); // by topic: the last decoded message
    this.types = new Map(); // by topic
  }
  addChannel(channel, schema) {
    expect(schema.encoding === "omgidl" && channel.messageEncoding === "cdr", `channel ${channel.topic} is not in CDR`);
    const definitions = parseIDL(new TextDecoder().decode(schema.data));
    this.readers.set(channel.id, new MessageReader(schema.name, definitions));
    this.types.set(channel.topic, schema.name);
    this.counts.set(channel.topic, 0);
  }
  add(channel, message) {
    this.last.set(channel.topic, this.readers.get(channel.id).readMessage(message.data));
    this.counts.set(channel.topic, this.counts.get(channel.topic) + 1);
  }
}

async function readIndexed(file) {
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, size) => {
      const bytes = new Uint8Array(Number(size));
      await file.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const decoder = new Decoder();
  for (const channel of reader.channelsById.values()) {
    decoder.addChannel(channel, reader.schemasById.get(channel.schemaId));
  }
  let time = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    expect(message.logTime >= time, "the messages are out of order");
    time = message.logTime;
    decoder.add(reader.channelsById.get(message.channelId), message);
  }
  for (const channel of reader.channelsById.values()) {
    const counted = Number(reader.statistics.channelMessageCounts.get(channel.id) ?? 0n);
    expect(decoder.counts.get(channel.topic) === counted, `the statistics count ${counted} messages of ${channel.topic}`);
  }
  return { decoder, profile: reader.header.profile, chunks: reader.chunkIndexes.length };
}

async function readStreamed(file) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(new Uint8Array(await file.readFile()));
  const decoder = new Decoder();
  const schemas = new Map();
  const channels = new Map();
  let ended = false;
  for (let record; (record = reader.nextRecord()) != undefined; ) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel" && !channels.has(record.id)) {
      channels.set(record.id, record);
      decoder.addChannel(record, schemas.get(record.schemaId));
    }
    if (record.type === "Message") decoder.add(channels.get(record.channelId), record);
    if (record.type === "Footer") ended = true;
  }
  expect(ended && reader.done(), "the file has no end");
  return decoder;
}

const path = process.argv[2];
const { decoder, profile, chunks } = await readIndexed(await fs.open(path));
const streamed = await readStreamed(await fs.open(path));
expect(profile === "troupe", `found the profile ${profile}`);
for (const [topic, count] of decoder.counts) {
  expect(streamed.counts.get(topic) === count, `found ${streamed.counts.get(topic)} and ${count} messages of ${topic}`);
  console.log(`${topic} ${decoder.types.get(topic)} ${count}`);
}
const run = decoder.last.get("/run");
const tick = decoder.last.get("/ticks");
const proposals = decoder.last.get("/proposals");
expect(decoder.counts.get("/run") === 1, "found no start of the run, or several");
expect(Number(tick.number) === decoder.counts.get("/ticks") - 1, "the states are not counted");
expect(proposals.tick === tick.tick, "the last proposals are of another tick");
expect(proposals.vx.length === run.world.robots.length, "found another number of robots");
console.log(`${chunks} chunks; world ${run.world.name}, ${run.world.robots.length} robots, last tick ${tick.tick}`);
const hash = BigInt(tick.state_hash).toString(16).padStart(16, "0");
console.log(`state hash ${hash}`);
