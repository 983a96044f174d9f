// A ROS peer in JavaScript: subscribes to topics of a run, decodes the messages with the definitions of ROS and checks
// them. Ends with status 0 after a message of each topic.
//   node read.cjs DOMAIN ROBOT [GRIPPER]   with a gripper: the topics of its joints in place of the sensors
"use strict";
const { Participant } = require("@foxglove/rtps");
const { UdpSocketNode } = require("@foxglove/rtps/nodejs");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const { ros2jazzy, ros2humble } = require("@foxglove/rosmsg-msgs-common");

const [domain, robot, gripper] = [Number(process.argv[2]), process.argv[3], process.argv[4]];
const kVolatile = 0, kTransientLocal = 1, kReliable = 2, kKeepLast = 0;
const definitions = ros2jazzy ?? ros2humble;
// The fields of a message, nested ones included.
function definitionsOf(type) {
  const found = new Map();
  const add = (name) => {
    if (found.has(name)) return;
    const definition = definitions[name];
    if (definition == undefined) throw new Error(`no definition of ${name}`);
    found.set(name, { ...definition, name });
    for (const field of definition.definitions) if (field.isComplex === true) add(field.type);
  };
  type = type.replace("/msg/", "/");
  add(type);
  return [...found.values()].map((d) => (d.name === type ? { ...d, name: undefined } : d));
}

const expected = gripper !== undefined ? {
  [`/${robot}/joint_states`]: ["sensor_msgs/msg/JointState", kVolatile, (m) =>
    m.name.length === 3 && m.name.includes(`${gripper}_lift`) && m.position.length === 3 && m.velocity.length === 3 && m.effort.length === 0],
  "/tf": ["tf2_msgs/msg/TFMessage", kVolatile, (m) => m.transforms.some((t) =>
    t.child_frame_id === `${robot}/${gripper}_lift_link` && t.header.frame_id === `${robot}/base_link`)],
  [`/${robot}/${gripper}/state`]: ["std_msgs/msg/String", kVolatile, (m) => JSON.parse(m.data).largest_opening > 0],
  [`/${robot}/robot_description`]: ["std_msgs/msg/String", kTransientLocal, (m) => m.data.includes(`<joint name="${gripper}_lift" type="prismatic">`)],
} : {
  [`/${robot}/scan`]: ["sensor_msgs/msg/LaserScan", kVolatile, (m) =>
    m.header.frame_id === `${robot}/scan` && m.ranges.length === 181 && m.range_max === 8 && m.ranges.every((r) => r > 0 && (r <= 8 || r === Infinity))],
  [`/${robot}/odom`]: ["nav_msgs/msg/Odometry", kVolatile, (m) =>
    m.header.frame_id === `${robot}/odom` && m.child_frame_id === `${robot}/base_link` && Math.abs(m.pose.pose.orientation.z ** 2 + m.pose.pose.orientation.w ** 2 - 1) < 1e-9],
  [`/${robot}/ground_truth`]: ["nav_msgs/msg/Odometry", kVolatile, (m) => m.header.frame_id === "map" && m.twist.covariance.length === 36],
  "/tf": ["tf2_msgs/msg/TFMessage", kVolatile, (m) => m.transforms.length > 0 && m.transforms[0].child_frame_id.endsWith("/base_link")],
  "/clock": ["rosgraph_msgs/msg/Clock", kVolatile, (m) => m.clock.sec >= 0],
  "/map": ["nav_msgs/msg/OccupancyGrid", kTransientLocal, (m) => m.data.length === m.info.width * m.info.height && m.data.includes(100) && m.data.includes(0)],
  [`/${robot}/robot_description`]: ["std_msgs/msg/String", kTransientLocal, (m) => m.data.includes("<robot ")],
};

async function main() {
  const participant = new Participant({
    name: "foxglove", domainId: domain, addresses: ["127.0.0.1"],
    udpSocketCreate: async (options) => {
      const socket = await UdpSocketNode.Create(options);
      const bind = socket.bind.bind(socket);
      socket.bind = async (where) => {
        await bind(where);
        await socket.setMulticastInterface("127.0.0.1");
        await socket.setMulticastLoopback(true);
        await socket.addMembership("239.255.0.1", "127.0.0.1").catch(() => {});
      };
      return socket;
    },
  });
  const missing = new Set(Object.keys(expected));
  const readers = {};
  participant.on("error", (error) => console.log(`note  ${error.message}`));
  participant.on("userData", (data) => {
    const topic = data.subscription.topicName.slice(2);
    if (!missing.has(topic)) return;
    const message = readers[topic].readMessage(data.serializedData);
    if (!expected[topic][2](message)) {
      console.log(`FAIL  ${topic}: ${JSON.stringify(message).slice(0, 300)}`);
      process.exit(1);
    }
    console.log(`pass  ${topic}`);
    missing.delete(topic);
    if (missing.size === 0) process.exit(0);
  });
  await participant.start();
  for (const [topic, [type, durability]] of Object.entries(expected)) {
    readers[topic] = new MessageReader(definitionsOf(type));
    participant.subscribe({
      topicName: `rt${topic}`, typeName: type.replace("/msg/", "::msg::dds_::") + "_", durability,
      reliability: { kind: kReliable, maxBlockingTime: { sec: 0, nsec: 0 } }, history: { kind: kKeepLast, depth: 10 },
    });
  }
  setTimeout(() => {
    for (const topic of missing) console.log(`FAIL  ${topic}: no message arrived`);
    process.exit(1);
  }, 30000);
}
main().catch((error) => {
  console.log(`FAIL  ${error.stack}`);
  process.exit(1);
});
