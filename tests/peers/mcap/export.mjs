// Reads exports of a recording with @mcap/core: every message of a ROS bag is decoded by the definitions in the file, with
// Foxglove's reader of ROS 2 messages; every message for Foxglove is compared with the JSON schema of @foxglove/schemas.
//   node export.mjs FOXGLOVE.mcap ROS2.mcap ROBOT
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader } from "@mcap/core";
import Ajv from "ajv";
import { decompress } from "fzstd";
import fs from "node:fs/promises";
import { createRequire } from "node:module";

const require = createRequire(import.meta.url);
const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };

function expect(holds, text) {
  if (!holds) {
    console.error(`error: ${text}`);
    process.exit(1);
  }
}

// Calls `decode(schema, channel)` for each channel, which gives a function for its messages. Returns, by topic, the type, the
// number of messages and the last one.
async function read(path, profile, decode) {
  const file = await fs.open(path);
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, size) => {
      const bytes = new Uint8Array(Number(size));
      await file.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  expect(reader.header.profile === profile, `found the profile ${reader.header.profile}, expected ${profile}`);
  const topics = new Map();
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    topics.set(channel.id, { topic: channel.topic, type: schema.name, count: 0, decode: decode(schema, channel) });
  }
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const topic = topics.get(message.channelId);
    topic.last = topic.decode(message.data);
    ++topic.count;
  }
  await file.close();
  const byTopic = new Map([...topics.values()].map(topic => [topic.topic, topic]));
  for (const [name, { type, count }] of byTopic) console.log(`${name} ${type} ${count}`);
  return byTopic;
}

const [foxglovePath, rosPath, robot] = process.argv.slice(2);
const ajv = new Ajv({ strict: false, allErrors: true });
const foxglove = await read(foxglovePath, "", (schema, channel) => {
  expect(schema.encoding === "jsonschema" && channel.messageEncoding === "json", `${channel.topic} is not in JSON`);
  // A table of things has a schema of its own; the others are Foxglove's.
  const [owner, name] = schema.name.split(".");
  const own = () => JSON.parse(new TextDecoder().decode(schema.data));
  const validate = ajv.compile(owner === "foxglove" ? require("@foxglove/schemas/jsonschema")[name] : own());
  return data => {
    const message = JSON.parse(new TextDecoder().decode(data));
    expect(validate(message), `${channel.topic}: ${ajv.errorsText(validate.errors)}`);
    return message;
  };
});
const ros = await read(rosPath, "ros2", (schema, channel) => {
  expect(schema.encoding === "ros2msg" && channel.messageEncoding === "cdr", `${channel.topic} is not in CDR`);
  const reader = new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true }));
  return data => reader.readMessage(data);
});

expect(foxglove.get("/scene")?.count === 1, "found no scene");
expect(foxglove.get("/tf").count === ros.get("/tf").count, "the frames of the exports differ in number");
const frame = foxglove.get("/tf").last.transforms.find(each => each.child_frame_id === robot);
const transform = ros.get("/tf").last.transforms.find(each => each.child_frame_id === `${robot}/base_link`);
expect(frame && transform, "a frame of the robot is missing");
for (const axis of ["x", "y", "z"]) {
  expect(frame.translation[axis] === transform.transform.translation[axis], `the frames differ in ${axis}`);
}
const truth = ros.get(`/${robot}/ground_truth`).last;
expect(truth.pose.pose.position.x === frame.translation.x, "the true pose is another one than the frame");
const scan = [...ros.values()].find(each => each.type === "sensor_msgs/msg/LaserScan");
expect(scan && scan.last.ranges.length > 1 && scan.last.angle_max > scan.last.angle_min, "found no scan");
const map = ros.get("/map").last;
expect(map.data.length === map.info.width * map.info.height, "the map has another size than it says");
expect(ros.get("/blocks").last.markers.length > 0, "found no markers");
console.log("the exports agree");
