#include "viewer/foxglove/messages.h"

#include <array>
#include <cmath>
#include <variant>

#include "common/base/base64.h"
#include "common/base/json_writer.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/occupancy_grid.h"

namespace troupe::foxglove {
namespace {

constexpr Time kSecond = 1'000'000'000;
constexpr std::uint64_t kMaxCells = std::uint64_t{4} << 20;  // in the message of the map
constexpr int kUint8 = 1;                                    // of foxglove.PackedElementField
constexpr int kInfo = 2;                                     // of foxglove.Log
constexpr int kWarning = 3;

// Foxglove has quaternions; a heading turns about z alone.
Json PoseOf(const Pose& pose) {
  const auto [sine, cosine] = SinCos(0.5 * pose.heading);
  return {{"position", {{"x", pose.x}, {"y", pose.y}, {"z", pose.z}}},
          {"orientation", {{"x", 0.0}, {"y", 0.0}, {"z", sine}, {"w", cosine}}}};
}

// The surface of a prism, as a list of triangles.
Json TrianglesOf(const ConvexPiece& piece, const Color& color) {
  Json points = Json::array();
  const auto add = [&](const Vec2& point, double z) {
    points.push_back({{"x", point.x()}, {"y", point.y()}, {"z", z}});
  };
  // Two triangles for each side, and a fan for the top. The bottom is never seen.
  const std::size_t count = piece.vertices.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2& a = piece.vertices[i];
    const Vec2& b = piece.vertices[(i + 1) % count];
    add(a, piece.z.min);
    add(b, piece.z.min);
    add(b, piece.z.max);
    add(a, piece.z.min);
    add(b, piece.z.max);
    add(a, piece.z.max);
    if (i < 1 || i + 1 >= count) continue;
    add(piece.vertices[0], piece.z.max);
    add(a, piece.z.max);
    add(b, piece.z.max);
  }
  return {{"pose", PoseOf({})},
          {"points", std::move(points)},
          {"color", {{"r", color.r}, {"g", color.g}, {"b", color.b}, {"a", 1.0}}},
          {"colors", Json::array()},
          {"indices", Json::array()}};
}

// All lists of the schema are given: clients reject an entity without one of them.
Json Entity(const std::string& id, const std::string& frame, Json triangles, Time time) {
  Json entity = {{"timestamp", TimeOf(time)}, {"frame_id", frame},    {"id", id},
                 {"lifetime", TimeOf(0)},     {"frame_locked", true}, {"triangles", std::move(triangles)}};
  for (const char* other : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines", "texts", "models"}) {
    entity[other] = Json::array();
  }
  return entity;
}

// Names of frames are the contract of messages.h.
std::string FrameOf(const WorldDescription& world, ModelId root, const std::optional<JointId>& joint) {
  const std::string& name = world.model(root).name;
  return joint ? name + "/" + world.joint(*joint).name : name;
}

void AddBody(const Scene& scene, BodyId id, ModelId root, Time time, Json& entities) {
  const WorldDescription& world = scene.world();
  const Body& body = scene.body(id);
  std::vector<Json> triangles(body.links.size(), Json::array());
  for (std::size_t i = 0; i < body.pieces.size(); ++i) {
    triangles[body.piece_links[i]].push_back(TrianglesOf(body.pieces[i], world.model(body.pieces[i].model).color));
  }
  for (std::size_t link = 0; link < body.links.size(); ++link) {
    if (triangles[link].empty()) continue;
    const std::string frame = FrameOf(world, root, body.links[link].joint);
    entities.push_back(Entity(frame, frame, std::move(triangles[link]), time));
  }
}

// Bounded; a client gets the rest by the grid of /map.
void AddStaticMap(const Scene& scene, Time time, Json& entities) {
  const WorldDescription& world = scene.world();
  Json triangles = Json::array();
  for (std::size_t i = 0; i < world.models.size() && triangles.size() < kMaxStaticPieces; ++i) {
    const ModelId model(i);
    if (scene.body_of(model)) continue;
    for (const ConvexPiece& piece : MakePieces(world, model, scene.X_LM(model))) {
      if (triangles.size() >= kMaxStaticPieces) break;
      triangles.push_back(TrianglesOf(piece, world.model(model).color));
    }
  }
  entities.push_back(Entity("map", "map", std::move(triangles), time));
}

// Calls `visit` with each body of the world, its root and its pose.
// Deleted entities stay in the description, and are left out.
template <typename Visit>
void VisitBodies(const Scene& scene, const WorldState& state, const Visit& visit) {
  const WorldDescription& world = scene.world();
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (RobotExists(world, RobotId(i))) visit(scene.body_of(RobotId(i)), world.robots[i].root, state.robots[i].X_WR);
  }
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (world.model(world.objects[i]).removed) continue;
    visit(scene.body_of(ObjectId(i)), world.objects[i], state.objects[i].X_WO);
  }
  for (std::size_t i = 0; i < world.people.size(); ++i) {
    if (world.model(world.people[i].root).removed || IsAway(state.people[i])) continue;
    visit(scene.body_of(PersonId(i)), world.people[i].root, state.people[i].X_WP);
  }
}

// Written without a tree of JSON: it is the message of each update, with a row for each body.
void WriteTransform(const std::string& parent, const std::string& child, const Pose& pose, Time time,
                    JsonWriter& json) {
  const auto [sine, cosine] = SinCos(0.5 * pose.heading);
  json.BeginObject().Key("timestamp").BeginObject();
  json.Member("sec", time / kSecond).Member("nsec", time % kSecond).EndObject();
  json.Member("parent_frame_id", parent).Member("child_frame_id", child).Key("translation").BeginObject();
  json.Member("x", pose.x).Member("y", pose.y).Member("z", pose.z).EndObject().Key("rotation").BeginObject();
  json.Member("x", 0).Member("y", 0).Member("z", sine).Member("w", cosine).EndObject().EndObject();
}

constexpr const char* kSceneSchema = R"({"title":"foxglove.SceneUpdate","type":"object","properties":{
"deletions":{"type":"array","items":{"type":"object"}},
"entities":{"type":"array","items":{"type":"object","properties":{
"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"frame_id":{"type":"string"},"id":{"type":"string"},
"lifetime":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"frame_locked":{"type":"boolean"},
"metadata":{"type":"array","items":{"type":"object"}},"arrows":{"type":"array","items":{"type":"object"}},
"cubes":{"type":"array","items":{"type":"object"}},"spheres":{"type":"array","items":{"type":"object"}},
"cylinders":{"type":"array","items":{"type":"object"}},"lines":{"type":"array","items":{"type":"object"}},
"triangles":{"type":"array","items":{"type":"object"}},"texts":{"type":"array","items":{"type":"object"}},
"models":{"type":"array","items":{"type":"object"}}}}}}})";

constexpr const char* kTransformsSchema = R"({"title":"foxglove.FrameTransforms","type":"object","properties":{
"transforms":{"type":"array","items":{"type":"object","properties":{
"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},
"translation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}},
"rotation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},
"w":{"type":"number"}}}}}}}})";

constexpr const char* kGridSchema = R"({"title":"foxglove.Grid","type":"object","properties":{
"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"frame_id":{"type":"string"},"pose":{"type":"object"},"column_count":{"type":"integer"},
"cell_size":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"}}},
"row_stride":{"type":"integer"},"cell_stride":{"type":"integer"},
"fields":{"type":"array","items":{"type":"object","properties":{"name":{"type":"string"},"offset":{"type":"integer"},
"type":{"type":"integer"}}}},
"data":{"type":"string","contentEncoding":"base64"}}})";

constexpr const char* kLogSchema = R"({"title":"foxglove.Log","type":"object","properties":{
"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"level":{"type":"integer"},"message":{"type":"string"},"name":{"type":"string"},"file":{"type":"string"},
"line":{"type":"integer"}}})";

constexpr const char* kScanSchema = R"({"title":"foxglove.LaserScan","type":"object","properties":{
"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"frame_id":{"type":"string"},"pose":{"type":"object"},"start_angle":{"type":"number"},
"end_angle":{"type":"number"},"ranges":{"type":"array","items":{"type":"number"}},
"intensities":{"type":"array","items":{"type":"number"}}}})";

// Of a table: a number, 0 or 1 of a truth, or a text by each signal's name.
std::string SchemaOf(const StateTable& table) {
  Json properties = {{"name", {{"type", "string"}}}};
  for (const Signal& signal : table.signals) {
    const char* type = signal.type == ValueType::kText    ? "string"
                       : signal.type == ValueType::kTruth ? "integer"
                                                          : "number";
    properties[signal.name] = {{"type", type}, {"description", signal.documentation}};
    if (!signal.unit.empty()) properties[signal.name]["unit"] = signal.unit;
  }
  const Json integer = {{"type", "integer"}};
  const Json rows = {{"type", "array"}, {"items", {{"type", "object"}, {"properties", std::move(properties)}}}};
  const Json timestamp = {{"type", "object"}, {"properties", {{"sec", integer}, {"nsec", integer}}}};
  return Dump({{"title", "troupe." + table.name},
               {"type", "object"},
               {"properties", {{"timestamp", timestamp}, {"rows", rows}}}});
}

// A sensor of a single ray is no scan.
void AddScans(const WorldDescription& world, RobotId robot, std::vector<Channel>& channels) {
  const RobotDescription& description = world.robot(robot);
  for (std::size_t i = 0; i < description.sensors.size(); ++i) {
    const auto* ranger = std::get_if<RangerParameters>(&description.sensors[i].parameters);
    if (ranger == nullptr) continue;
    for (std::size_t k = 0; k < ranger->ray_sensors->size(); ++k) {
      if ((*ranger->ray_sensors)[k].samples < 2 || channels.size() >= kMaxScanChannels) continue;
      std::string topic = "/" + description.name + "/" + description.sensors[i].name;
      if (k > 0) topic += "." + std::to_string(k);
      channels.push_back({.id = static_cast<std::uint32_t>(channels.size() + 1),
                          .kind = ChannelKind::kScan,
                          .topic = std::move(topic),
                          .robot = robot,
                          .sensor = i,
                          .scan = k,
                          .frame = description.name});
    }
  }
}

}  // namespace

std::string SceneText(const Scene& scene, Time time) {
  const WorldDescription& world = scene.world();
  Json entities = Json::array();
  AddStaticMap(scene, time, entities);
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (RobotExists(world, RobotId(i))) AddBody(scene, scene.body_of(RobotId(i)), world.robots[i].root, time, entities);
  }
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (world.model(world.objects[i]).removed) continue;
    AddBody(scene, scene.body_of(ObjectId(i)), world.objects[i], time, entities);
  }
  for (std::size_t i = 0; i < world.people.size(); ++i) {
    if (world.model(world.people[i].root).removed) continue;
    AddBody(scene, scene.body_of(PersonId(i)), world.people[i].root, time, entities);
  }
  // All entities of the previous world.
  Json deletions = Json::array({{{"timestamp", TimeOf(time)}, {"type", 1}, {"id", ""}}});
  return Dump({{"deletions", std::move(deletions)}, {"entities", std::move(entities)}});
}

// Links are relative to the root of their body, so that they need no transform of their own while joints rest.
std::string TransformsText(const Scene& scene, const WorldState& state, Time time) {
  const WorldDescription& world = scene.world();
  std::vector<double> positions;
  for (const JointState& joint : state.joints) positions.push_back(joint.position);
  std::vector<Pose> X_BL;
  std::string text;
  JsonWriter json(text);
  json.BeginObject().Key("transforms").BeginList();
  VisitBodies(scene, state, [&](BodyId id, ModelId root, const Pose& X_WB) {
    WriteTransform("map", FrameOf(world, root, {}), X_WB, time, json);
    const Body& body = scene.body(id);
    if (!body.has_joints()) return;
    scene.ComputeLinkPoses(id, positions, X_BL);
    for (std::size_t link = 1; link < body.links.size(); ++link) {
      WriteTransform(FrameOf(world, root, {}), FrameOf(world, root, body.links[link].joint), X_BL[link], time, json);
    }
  });
  json.EndList().EndObject();
  return text;
}

// Values as in ROS: 100 is occupied.
std::string MapText(const Scene& scene, Time time) {
  const OccupancyGrid grid = MakeOccupancyGrid(scene, std::nullopt, UsualMapHeight(scene), kMaxCells);
  std::string data(grid.occupied.size(), '\0');
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<char>(grid.occupied[i] ? 100 : 0);
  const Json field = {{"name", "occupancy"}, {"offset", 0}, {"type", kUint8}};
  return Dump({{"timestamp", TimeOf(time)},
               {"frame_id", "map"},
               {"pose", PoseOf({grid.origin_x, grid.origin_y, 0.0, 0.0})},
               {"column_count", grid.width},
               {"cell_size", {{"x", grid.resolution}, {"y", grid.resolution}}},
               {"row_stride", grid.width},
               {"cell_stride", 1},
               {"fields", Json::array({field})},
               {"data", Base64(data)}});
}

std::string EventText(const std::string& text, bool warning, Time time) {
  return Dump({{"timestamp", TimeOf(time)},
               {"level", warning ? kWarning : kInfo},
               {"message", text},
               {"name", "troupe"},
               {"file", ""},
               {"line", 0}});
}

std::string ScanText(const RangeScan& scan, const std::string& frame, Time time) {
  return Dump({{"timestamp", TimeOf(time)},
               {"frame_id", frame},
               {"pose", PoseOf(scan.X_RS)},
               {"start_angle", scan.fan.angle_min()},
               {"end_angle", scan.fan.angle_max()},
               {"ranges", scan.ranges},
               {"intensities", scan.intensities}});
}

std::string TableText(const StateTable& table, const SignalView& view, Time time) {
  std::string text;
  JsonWriter json(text);
  json.BeginObject().Key("timestamp").BeginObject();
  json.Member("sec", time / kSecond).Member("nsec", time % kSecond).EndObject();
  json.Key("rows");
  WriteRows(table, view, json);
  json.EndObject();
  return text;
}

// In the same order for the same world, since ids are places in this list.
std::vector<Channel> ChannelsOf(const WorldDescription& world) {
  std::vector<Channel> channels = {{.id = 1, .kind = ChannelKind::kScene, .topic = "/scene"},
                                   {.id = 2, .kind = ChannelKind::kTransforms, .topic = "/tf"},
                                   {.id = 3, .kind = ChannelKind::kMap, .topic = "/map"},
                                   {.id = 4, .kind = ChannelKind::kEvents, .topic = "/events"}};
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (RobotExists(world, RobotId(i))) AddScans(world, RobotId(i), channels);
  }
  const Things things(world);
  for (const StateTable& table : StateTables()) {
    if (!table.varies && things.count(KindOf(table.name)) == 0) continue;
    channels.push_back({.id = static_cast<std::uint32_t>(channels.size() + 1),
                        .kind = ChannelKind::kTable,
                        .topic = "/tables/" + table.name,
                        .table = &table});
  }
  return channels;
}

std::string SchemaName(const Channel& channel) {
  switch (channel.kind) {
    case ChannelKind::kScene:
      return "foxglove.SceneUpdate";
    case ChannelKind::kTransforms:
      return "foxglove.FrameTransforms";
    case ChannelKind::kMap:
      return "foxglove.Grid";
    case ChannelKind::kEvents:
      return "foxglove.Log";
    case ChannelKind::kScan:
      return "foxglove.LaserScan";
    case ChannelKind::kTable:
      return "troupe." + channel.table->name;
  }
  return "";
}

std::string Schema(const Channel& channel) {
  switch (channel.kind) {
    case ChannelKind::kScene:
      return kSceneSchema;
    case ChannelKind::kTransforms:
      return kTransformsSchema;
    case ChannelKind::kMap:
      return kGridSchema;
    case ChannelKind::kEvents:
      return kLogSchema;
    case ChannelKind::kScan:
      return kScanSchema;
    case ChannelKind::kTable:
      return SchemaOf(*channel.table);
  }
  return "";
}

}  // namespace troupe::foxglove
