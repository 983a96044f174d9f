#include "viewer/gateway/page_request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "troupe/world_state.h"
#include "viewer/foxglove/messages.h"
#include "viewer/foxglove/protocol.h"

namespace troupe {
namespace {

PageControl Control(const std::string& text) {
  const Result<PageRequest> request = ParsePageRequest(text);
  EXPECT_TRUE(request.ok()) << text << (request.ok() ? "" : request.error().message);
  const PageControl* control = request.ok() ? std::get_if<PageControl>(&request.value()) : nullptr;
  EXPECT_NE(control, nullptr) << text;
  return control != nullptr ? *control : PageControl();
}

TEST(PageRequestTest, CommandsBecomeRequestsOfTheRun) {
  const PageControl step = Control(R"({"type": "control", "id": 7, "command": "step", "ticks": 10})");
  EXPECT_EQ(step.id, 7u);
  EXPECT_EQ(step.request, control::Request(control::Step{10}));
  const PageControl pose =
      Control(R"({"type": "control", "id": 0, "command": "set_pose", "name": "r0", "pose": [1, -2.5, 0, 3]})");
  EXPECT_EQ(pose.request, control::Request(control::SetPose{"r0", {1.0, -2.5, 0.0, 3.0}}));
  const PageControl spawn =
      Control(R"({"type": "control", "id": 1, "command": "spawn", "source": "can", "pose": [0, 0, 0, 0]})");
  EXPECT_EQ(spawn.request, control::Request(control::Spawn{.source = "can", .rename = true}));
  const PageControl robot = Control(
      R"({"type": "control", "id": 1, "command": "spawn", "source": "rover", "controller": "wander", "pose": [0, 0, 0, 0]})");
  EXPECT_EQ(std::get<control::Spawn>(robot.request).controller, "wander");
  const PageControl rewind = Control(R"({"type": "control", "id": 1, "command": "rewind", "tick": 0})");
  EXPECT_EQ(rewind.request, control::Request(control::Rewind{0}));
  const PageControl restore = Control(
      R"({"type": "control", "id": 1, "command": "restore", "source": "can", "name": "tin", "pose": [0, 0, 0, 0]})");
  EXPECT_EQ(restore.request, control::Request(control::Restore{"can", "tin", {}}));
  const PageControl door =
      Control(R"({"type": "control", "id": 1, "command": "door", "name": "gate", "opening": 0.5})");
  EXPECT_EQ(door.request, control::Request(control::Door{"gate", 0.5}));
  const PageControl lift = Control(R"({"type": "control", "id": 1, "command": "lift", "name": "up", "floor": "L2"})");
  EXPECT_EQ(lift.request, control::Request(control::Lift{"up", "L2"}));
  const PageControl light =
      Control(R"({"type": "control", "id": 1, "command": "light", "name": "r0.lamp", "on": false})");
  EXPECT_EQ(light.request, control::Request(control::Light{"r0.lamp", false}));
  const PageControl lane =
      Control(R"({"type": "control", "id": 1, "command": "lane", "from": "a", "to": "b", "speed_limit": 0.5})");
  EXPECT_EQ(lane.request, control::Request(control::Lane{"a", "b", 0.5}));
  const PageControl zone = Control(R"({"type": "control", "id": 1, "command": "zone", "name": "wet", "on": true})");
  EXPECT_EQ(zone.request, control::Request(control::Zone{"wet", true}));
}

TEST(PageRequestTest, AsksForSignals) {
  const Result<PageRequest> series = ParsePageRequest(
      R"({"type": "series", "id": 3, "signals": [["r0", "x"], ["r1", "joint/lift"]], "from": 5, "to": 9, "every": 2})");
  ASSERT_TRUE(series.ok());
  EXPECT_EQ(std::get<SeriesRequest>(series.value()), (SeriesRequest{3, {{"r0", "x"}, {"r1", "joint/lift"}}, 5, 9, 2}));
  for (const char* wrong :
       {R"({"type": "series", "id": 3, "signals": [], "from": 5, "to": 9, "every": 0})",
        R"({"type": "series", "id": 3, "signals": [["r0"]], "from": 5, "to": 9, "every": 1})",
        R"({"type": "series", "id": 3, "signals": "x", "from": 5, "to": 9, "every": 1})", R"({"type": "totals"})"}) {
    EXPECT_FALSE(ParsePageRequest(wrong).ok()) << wrong;
  }
  EXPECT_EQ(std::get<TotalsRequest>(ParsePageRequest(R"({"type": "totals", "id": 8})").value()).id, 8u);
}

TEST(PageRequestTest, SetsTheSpeedAndCommandsRobots) {
  const PageControl speed = Control(R"({"type": "control", "id": 1, "command": "speed", "speed": 2.5})");
  EXPECT_EQ(speed.request, control::Request(control::Speed{2.5}));
  EXPECT_EQ(Control(R"({"type": "control", "id": 1, "command": "speed", "speed": "max"})").request,
            control::Request(control::Speed()));
  const PageControl all = Control(
      R"({"type": "control", "id": 1, "command": "command_robot", "name": "r0", "ticks": 5, "twist": [1, 0, -0.5],
          "grippers": [{"gripper": 1, "opening": 0}, {"gripper": 0, "lift": 50}],
          "goal": {"waypoints": [[1, 2], [3, -4]], "heading": 0.5}})");
  control::CommandRobot expected{.name = "r0", .ticks = 5};
  expected.twist = Twist{1.0, 0.0, -0.5};
  expected.grippers = {{.gripper = 1, .opening = 0.0}, {.gripper = 0, .lift = 50.0}};
  expected.goal = Goal{0, {{1.0, 2.0}, {3.0, -4.0}}, 0.5};
  EXPECT_EQ(all.request, control::Request(expected));
}

TEST(PageRequestTest, GoesBackAndReturns) {
  EXPECT_EQ(std::get<SeekRequest>(test::ValueOf(ParsePageRequest(R"({"type": "seek", "position": 12})"))),
            (SeekRequest{12, std::nullopt}));
  EXPECT_EQ(std::get<SeekRequest>(test::ValueOf(ParsePageRequest(R"({"type": "seek", "tick": 3})"))),
            (SeekRequest{std::nullopt, 3}));
  EXPECT_TRUE(ParsePageRequest(R"({"type": "live"})").ok());
  for (const char* bad : {R"({"type": "seek"})", R"({"type": "seek", "position": 1, "tick": 1})",
                          R"({"type": "seek", "position": -1})", R"({"type": "seek", "tick": 1.5})"}) {
    EXPECT_FALSE(ParsePageRequest(bad).ok()) << bad;
  }
}

TEST(PageRequestTest, ReadsSelections) {
  EXPECT_EQ(std::get<SelectRequest>(test::ValueOf(ParsePageRequest(R"({"type": "select", "robots": ["a", "b"]})"))),
            (SelectRequest{false, {"a", "b"}}));
  EXPECT_EQ(std::get<SelectRequest>(
                test::ValueOf(ParsePageRequest(R"({"type": "select", "robots": ["a"], "pictures": "a"})"))),
            (SelectRequest{false, {"a"}, "a"}));
  EXPECT_TRUE(std::get<SelectRequest>(test::ValueOf(ParsePageRequest(R"({"type": "select", "robots": "all"})"))).all);
}

TEST(PageRequestTest, ReadsRequestsForANewRun) {
  EXPECT_EQ(std::get<RunAgainRequest>(test::ValueOf(ParsePageRequest(R"({"type": "run_again", "id": 3})"))),
            (RunAgainRequest{3, std::nullopt}));
  EXPECT_EQ(std::get<RunAgainRequest>(test::ValueOf(ParsePageRequest(R"({"type": "run_again", "id": 3, "seed": 5})"))),
            (RunAgainRequest{3, 5}));
  const std::string values = R"({"type": "run_again", "id": 3, "values": [["spawn[0].count", 20], ["a.b", true]]})";
  RunAgainRequest again{3, std::nullopt};
  again.values.emplace();
  again.values->emplace_back("spawn[0].count", "20");
  again.values->emplace_back("a.b", "true");
  EXPECT_EQ(std::get<RunAgainRequest>(test::ValueOf(ParsePageRequest(values))), again);
}

TEST(PageRequestTest, RefusesEverythingElse) {
  std::string many = R"({"type": "select", "robots": [)";
  for (std::size_t i = 0; i <= kMaxSelected; ++i) many += i == 0 ? "\"r\"" : ",\"r\"";
  many += "]}";
  const std::string texts[] = {
      "",
      "x",
      "[]",
      "{}",
      "null",
      std::string(4000, '['),
      std::string("\xff\xfe{}"),
      std::string("{\0}", 3),
      std::string(kMaxPageRequest + 1, ' '),
      many,
      R"({"type": "select"})",
      R"({"type": "select", "robots": "some"})",
      R"({"type": "select", "robots": [1]})",
      R"({"type": "other"})",
      R"({"type": "run_again"})",
      R"({"type": "run_again", "id": 1, "seed": -1})",
      R"({"type": "run_again", "id": 1, "seed": "one"})",
      R"({"type": "run_again", "id": 1, "values": [["seed"]]})",
      R"({"type": "run_again", "id": 1, "values": [[1, 2]]})",
      R"({"type": "run_again", "id": 1, "values": {"seed": 2}})",
      R"({"type": "control", "command": "pause"})",
      R"({"type": "control", "id": -1, "command": "pause"})",
      R"({"type": "control", "id": "1", "command": "pause"})",
      R"({"type": "control", "id": 1, "command": "load", "source": "/etc/passwd"})",
      R"({"type": "control", "id": 1, "command": ["pause"]})",
      R"({"type": "control", "id": 1, "command": "step"})",
      R"({"type": "control", "id": 1, "command": "step", "ticks": 0})",
      R"({"type": "control", "id": 1, "command": "step", "ticks": 1.5})",
      R"({"type": "control", "id": 1, "command": "step", "ticks": 99999999999})",
      R"({"type": "control", "id": 1, "command": "delete"})",
      R"({"type": "control", "id": 1, "command": "speed"})",
      R"({"type": "control", "id": 1, "command": "rewind"})",
      R"({"type": "control", "id": 1, "command": "rewind", "tick": -1})",
      R"({"type": "control", "id": 1, "command": "speed", "speed": 0})",
      R"({"type": "control", "id": 1, "command": "speed", "speed": "fast"})",
      R"({"type": "control", "id": 1, "command": "command_robot", "name": "a", "ticks": 1})",
      R"({"type": "control", "id": 1, "command": "command_robot", "name": "a", "twist": [1, 0, 0]})",
      R"({"type": "control", "id": 1, "command": "command_robot", "ticks": 1, "twist": [1, 0, 0]})",
      R"({"type": "control", "id": 1, "command": "command_robot", "name": "a", "ticks": 1, "twist": [1, 0]})",
      R"({"type": "control", "id": 1, "command": "command_robot", "name": "a", "ticks": 1, "grippers": [3]})",
      R"({"type": "control", "id": 1, "command": "command_robot", "name": "a", "ticks": 1, "grippers": [{"gripper": -1}]})",
      R"({"type": "control", "id": 1, "command": "command_robot", "name": "a", "ticks": 1, "goal": [1, 2]})",
      R"({"type": "control", "id": 1, "command": "command_robot", "name": "a", "ticks": 1, "goal": {"waypoints": [1]}})",
      R"({"type": "control", "id": 1, "command": "set_pose", "name": "a", "pose": [1, 2, 3]})",
      R"({"type": "control", "id": 1, "command": "set_pose", "name": "a", "pose": [1, 2, 3, 1e999]})",
      R"({"type": "control", "id": 1, "command": "set_pose", "name": "a", "pose": [1, 2, 3, null]})",
      R"({"type": "control", "id": 1, "command": "spawn", "source": "", "pose": [0, 0, 0, 0]})",
      R"({"type": "control", "id": 1, "command": "spawn", "source": "/tmp/x.world", "pose": [0, 0, 0, 0]})",
      R"({"type": "control", "id": 1, "command": "spawn", "source": "x.json", "pose": [0, 0, 0, 0]})",
      R"({"type": "control", "id": 1, "command": "spawn", "source": "x#y", "pose": [0, 0, 0, 0]})",
      R"({"type": "control", "id": 1, "command": "spawn", "source": "x", "controller": "/tmp/x.so", "pose": [0, 0, 0, 0]})",
      R"({"type": "control", "id": 1, "command": "spawn", "source": "x", "controller": "p.py:P", "pose": [0, 0, 0, 0]})",
      R"({"type": "control", "id": 1, "command": "spawn", "source": "x", "controller": "p.py", "pose": [0, 0, 0, 0]})",
  };
  for (const std::string& text : texts) EXPECT_FALSE(ParsePageRequest(text).ok()) << text.substr(0, 100);
}

TEST(PageRequestTest, RepliesAreJsonWhateverTheyContain) {
  ControlReply reply{.done = true, .state = RunState::kPaused, .tick = 12};
  reply.entities.push_back({"can\xff\"", "model"});
  EXPECT_EQ(
      ReplyToControl(3, reply).text,
      "{\"done\":true,\"entities\":[{\"name\":\"can\xEF\xBF\xBD\\\"\",\"type\":\"model\"}],\"id\":3,\"problem\":\"\","
      "\"state\":\"paused\",\"tick\":12,\"type\":\"reply\"}");
  EXPECT_EQ(ReplyToControl(4, Failure("no \"run\"")).text,
            R"({"done":false,"id":4,"problem":"no \"run\"","type":"reply"})");
}

TEST(PageRequestTest, AsksForTheAgentOfARobot) {
  const PageRequest request =
      test::ValueOf(ParsePageRequest(R"({"type": "control", "id": 4, "command": "entities", "name": "r0"})"));
  const PageControl& control = std::get<PageControl>(request);
  EXPECT_EQ(control.request, control::Request(control::Entities{.name = "r0"}));
  EXPECT_EQ(control::KindOf(control.request), RequestKind::kQuestion);
  ControlReply reply;
  reply.entities.push_back({"r0", "position"});
  reply.entities[0].agent = AgentReport{"bench7", 4711, true, 0.25, 3};
  EXPECT_THAT(ReplyToControl(4, reply).text,
              testing::HasSubstr(R"("agent":{"answer_seconds":0.25,"host":"bench7","pid":4711,"present":true,)"
                                 R"("times_last":3})"));
}

TEST(PageRequestTest, AsksForTheStateOfAVehicle) {
  const PageRequest request =
      test::ValueOf(ParsePageRequest(R"({"type": "vehicle", "id": 5, "robot": "cart_1", "position": 12})"));
  EXPECT_EQ(std::get<VehicleRequest>(request), (VehicleRequest{5, "cart_1", 12}));
  EXPECT_FALSE(ParsePageRequest(R"({"type": "vehicle", "id": 5, "robot": "cart_1"})").ok());
  ControlReply reply;
  reply.entities.push_back({"cart_1", "cart"});
  reply.entities[0].signals = "robot {}\nvehicle {\"orderId\":\"o\"}";
  EXPECT_THAT(ReplyToControl(4, reply).text,
              testing::HasSubstr(R"("signals":"robot {}\nvehicle {\"orderId\":\"o\"}")"));
}

TEST(PageRequestTest, EditsAreLongerThanOtherRequests) {
  const std::string edit =
      R"({"type": "edit", "id": 3, "op": "set_text", "text": ")" + std::string(20'000, 'x') + "\"}";
  EXPECT_FALSE(ParsePageRequest(edit).ok());
  const PageRequest request = test::ValueOf(ParsePageRequest(edit, kMaxEditRequest));
  const PageEdit& parsed = std::get<PageEdit>(request);
  EXPECT_EQ(parsed.id, 3U);
  EXPECT_EQ(std::get<edit::SetText>(parsed.operation.value()).text.size(), 20'000U);
  const std::string select = R"({"type": "select", "robots": [")" + std::string(20'000, 'x') + "\"]}";
  EXPECT_FALSE(ParsePageRequest(select, kMaxEditRequest).ok());
  for (const char* bad : {R"({"type": "edit", "op": "undo"})", R"({"type": "edit", "id": 1})",
                          R"({"type": "edit", "id": -1, "op": "undo"})", R"({"type": "edit", "id": 1, "op": 5})"}) {
    EXPECT_FALSE(ParsePageRequest(bad).ok()) << bad;
  }
}

// The error of a request of the editor.
std::string EditError(const std::string& members) {
  const Result<PageRequest> request = ParsePageRequest(R"({"type": "edit", "id": 7, "op": )" + members + "}");
  if (!request.ok()) return "no request";
  const PageEdit& edit = std::get<PageEdit>(request.value());
  EXPECT_EQ(edit.id, 7U);
  return edit.operation.ok() ? "" : edit.operation.error().message;
}

Result<EditOperation> Decoded(const nlohmann::json& request) {
  return DecodeEditOperation(JsonReader::OfText(request.dump()));
}

TEST(PageRequestTest, ViewersAskOnlyQuestionsOfAFile) {
  const auto is_question = [](const char* op) {
    const Result<EditOperation> operation = Decoded({{"op", op}, {"text", ""}});
    EXPECT_TRUE(operation.ok()) << op;
    return operation.ok() && IsQuestion(operation.value());
  };
  for (const char* op : {"document", "text", "palette", "help", "bitmaps", "entity", "model"}) {
    EXPECT_TRUE(is_question(op)) << op;
  }
  for (const char* op : {"set_text", "save", "reload", "undo", "redo", "test", "end_test", "delete"}) {
    EXPECT_FALSE(is_question(op)) << op;
  }
}

TEST(PageRequestTest, EditsBecomeTypedOperations) {
  EXPECT_EQ(
      std::get<edit::SetPose>(test::ValueOf(Decoded({{"op", "set_pose"}, {"name", "a"}, {"pose", {1, 2, 0, -3.5}}})))
          .pose,
      (Pose{1.0, 2.0, 0.0, -3.5}));
  const EditOperation part = test::ValueOf(Decoded(
      {{"op", "change_part"}, {"model", "m"}, {"part", {0, 2}}, {"action", "shape"}, {"shape", {{"limits", {0, 1}}}}}));
  const auto& shape = std::get<edit::ShapePart>(part);
  EXPECT_EQ(shape.model, "m");
  EXPECT_EQ(shape.part, (PartPath{0, 2}));
  EXPECT_EQ(shape.shape.limits, (std::vector<double>{0.0, 1.0}));
  EXPECT_FALSE(shape.shape.is_only_pose());
  const EditOperation value = test::ValueOf(
      Decoded({{"op", "set_value"}, {"path", {"spawn", 1}}, {"value", {{"count", 2}, {"region", {0, 0, 1, 1}}}}}));
  EXPECT_EQ(std::get<edit::SetValue>(value).path, (JsonPath{"spawn", std::size_t{1}}));
  EXPECT_EQ(std::get<edit::SetValue>(value).value, R"({"count": 2, "region": [0, 0, 1, 1]})");
}

// They are answered, unlike a text that is no request.
TEST(PageRequestTest, MalformedEditsHaveTheirReason) {
  for (
      const auto& [members, reason] : std::vector<std::pair<const char*, const char*>>{
          {R"("undo")", ""},
          {R"("fly")", "found the operation 'fly', expected one of the editor"},
          {R"("set_text", "text": 5)", "found the number 5 as 'text', expected a text"},
          {R"("set_pose", "name": "a", "pose": [1, 2, 3])",
           "found an array of 3 as 'pose', expected a list of 4 numbers from -1e+06 to 1e+06"},
          {R"("set_pose", "name": "a", "pose": [1, 2, 3, 2e6])",
           "found an array of 4 as 'pose', expected a list of 4 numbers from -1e+06 to 1e+06"},
          {R"("set_property", "property": "1x", "value": "1")", "found the property '1x', expected a name"},
          {R"("set_property", "property": "x", "value": "1 2")",
           "'value': found '1 2', expected a number, a text in double quotes, or several in [ ]"},
          {R"("rename", "name": "a", "to": "\"")", "found the name '\"', expected 1 to 100 characters without quotes"},
          {R"("add_model", "name": "a", "pose": [0, 0, 0, 0], "blocks": [])",
           "found an empty array as 'blocks', expected at least one block"},
          {R"("add_model", "name": "a", "pose": [0, 0, 0, 0], "blocks": [{"outline": [[0, 0], [1, 0], [1, 1]], "z": [1, 1]}])",
           "found an object as 'blocks[0]', expected a block whose top, in 'z', is above its underside"},
          {R"("set_model", "name": "a b")", "found the name 'a b', expected a letter, then letters, digits, . - _"},
          {R"("change_part", "model": "m", "action": "turn")",
           "found the action 'turn', expected set, add, remove, shape or roles"},
          {R"("change_part", "model": "m", "action": "remove", "part": [-1])",
           "found the number -1 as 'part[0]', expected a whole number"},
          {R"("change_part", "model": "m", "action": "shape", "shape": {"wings": 2})",
           "found the key 'wings' in 'shape', expected one of axis, blocks, limits, paddle, pose, size"},
          {R"("draw_bitmap", "name": "a", "tool": "spray")", "found the tool 'spray', expected line, frame or filled"},
          {R"("create_bitmap", "file": "a.png", "size": [1, 1, 1], "pixel": 0, "pose": [0, 0, 0, 0])",
           "found the number 0 as 'pixel', expected a number between 0.001 and 1000000"},
          {R"("set_value", "value": 1)", "found no 'path', expected a list of keys and indices"},
          {R"("set_value", "path": ["a", -1], "value": 1)",
           "found the number -1 as 'path[1]', expected a whole number"},
          {R"("together", "edits": [{"op": "save"}])",
           "found the operation 'save' among several, expected set_pose, delete or copy"}}) {
    EXPECT_EQ(EditError(members), reason) << members;
  }
}

TEST(PageRequestTest, AReplyToAnEditHasItsContentOrItsProblem) {
  const PageReply done = ReplyToEdit(4, nlohmann::json{{"name", "wall1"}});
  EXPECT_TRUE(done.done);
  EXPECT_EQ(nlohmann::json::parse(done.text),
            nlohmann::json::parse(R"({"type": "reply", "id": 4, "done": true, "problem": "", "name": "wall1"})"));
  const PageReply refused = ReplyToEdit(5, Error{{}, "changed", ErrorCode::kNoRoom});
  EXPECT_FALSE(refused.done);
  EXPECT_EQ(refused.problem, "changed");
  EXPECT_EQ(nlohmann::json::parse(refused.text)["conflict"], true);
}

}  // namespace

}  // namespace troupe

namespace troupe::foxglove {
namespace {

template <typename Number>
void Append(std::string& bytes, Number value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string PlaybackRequest(std::uint8_t command, float speed, std::optional<Time> seek, const std::string& id) {
  std::string bytes(1, '\3');
  Append(bytes, command);
  Append(bytes, speed);
  Append(bytes, static_cast<std::uint8_t>(seek ? 1 : 0));
  Append(bytes, seek.value_or(0));
  Append(bytes, static_cast<std::uint32_t>(id.size()));
  return bytes + id;
}

TEST(FoxgloveProtocolTest, ReadsSubscriptionsCallsAndPlayback) {
  const ClientMessage subscribe = test::ValueOf(
      ParseText(R"({"op": "subscribe", "subscriptions": [{"id": 3, "channelId": 9}, {"id": 4, "channelId": 1}]})"));
  ASSERT_EQ(std::get<Subscribe>(subscribe).subscriptions.size(), 2u);
  EXPECT_EQ(std::get<Subscribe>(subscribe).subscriptions[0].channel, 9u);
  EXPECT_EQ(std::get<Unsubscribe>(test::ValueOf(ParseText(R"({"op": "unsubscribe", "subscriptionIds": [3]})"))).ids,
            std::vector<std::uint32_t>{3});
  EXPECT_TRUE(std::holds_alternative<Ignored>(ParseText(R"({"op": "getParameters"})").value()));

  std::string call(1, '\2');
  Append(call, std::uint32_t{1});
  Append(call, std::uint32_t{77});
  Append(call, std::uint32_t{4});
  const ClientMessage called = test::ValueOf(ParseBinary(call + "json{}"));
  EXPECT_EQ(std::get<ServiceCall>(called).command, "pause");
  EXPECT_EQ(std::get<ServiceCall>(called).call, 77u);
  EXPECT_EQ(std::get<ServiceCall>(called).json, "{}");

  const ClientMessage playback = test::ValueOf(ParseBinary(PlaybackRequest(0, 2.0F, 5'000'000'000, "id")));
  const auto& control = std::get<PlaybackControl>(playback);
  EXPECT_TRUE(control.play);
  EXPECT_EQ(control.speed, 2.0F);
  EXPECT_EQ(control.seek, 5'000'000'000u);
  EXPECT_EQ(control.request, "id");
}

TEST(FoxgloveProtocolTest, RefusesEverythingElse) {
  for (const char* text :
       {"", "x", "[]", "{}", R"({"op": 1})", R"({"op": "subscribe"})", R"({"op": "subscribe", "subscriptions": [1]})",
        R"({"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 1}]})",
        R"({"op": "unsubscribe", "subscriptionIds": ["a"]})"}) {
    EXPECT_FALSE(ParseText(text).ok()) << text;
  }
  const std::string whole = PlaybackRequest(1, 1.0F, std::nullopt, "request");
  ASSERT_TRUE(ParseBinary(whole).ok());
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_FALSE(ParseBinary(whole.substr(0, size)).ok()) << size;
  EXPECT_FALSE(ParseBinary(PlaybackRequest(2, 1.0F, std::nullopt, "")).ok());
  EXPECT_FALSE(ParseBinary(PlaybackRequest(0, -1.0F, std::nullopt, "")).ok());
  EXPECT_FALSE(ParseBinary("\x7f").ok());
  std::mt19937_64 engine(1);
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes(engine() % 40, '\0');
    for (char& byte : bytes) byte = static_cast<char>(engine() % 256);
    static_cast<void>(ParseBinary(bytes));
    static_cast<void>(ParseText(bytes));
  }
}

TEST(FoxgloveProtocolTest, BodiesAreInFramesThatTransformsMove) {
  SmallWorld world;
  world.AddBox("wall", 3.0, 0.0, 0.2, 4.0, {0.0, 1.0});
  const RobotId robot = world.AddRobot("r0", {1.0, 2.0, 0.0, 0.0});
  world.AddRanger(robot, {}, {Fan(1.0, 5), OneRay()});
  const Scene scene(world.world());
  const std::vector<Channel> channels = ChannelsOf(world.world());
  std::vector<std::string> topics;
  for (const Channel& channel : channels) topics.push_back(channel.topic);
  EXPECT_THAT(topics, testing::ElementsAre("/scene", "/tf", "/map", "/events", "/r0/ranger:0", "/tables/robots",
                                           "/tables/transmissions", "/tables/traffic_robots", "/tables/traffic_moves",
                                           "/tables/lane_closures", "/tables/lane_rules", "/tables/charging_robots",
                                           "/tables/jobs", "/tables/waits", "/tables/sensors"))
      << "single rays have no scan";

  const auto text = nlohmann::json::parse(SceneText(scene, 1'500'000'000));
  ASSERT_EQ(text["entities"].size(), 2u);
  EXPECT_EQ(text["entities"][0]["frame_id"], "map");
  EXPECT_EQ(text["entities"][1]["frame_id"], "r0");
  EXPECT_EQ(text["entities"][1]["timestamp"]["nsec"], 500'000'000);
  // A box: four sides of two triangles, and two triangles on top.
  EXPECT_EQ(text["entities"][0]["triangles"][0]["points"].size(), 30u);

  const auto transforms = nlohmann::json::parse(TransformsText(scene, PlacedState(world.world()), 0));
  ASSERT_EQ(transforms["transforms"].size(), 1u);
  EXPECT_EQ(transforms["transforms"][0]["child_frame_id"], "r0");
  EXPECT_EQ(transforms["transforms"][0]["translation"]["y"], 2.0);

  const auto map = nlohmann::json::parse(MapText(scene, 0));
  EXPECT_EQ(map["cell_size"]["x"], 0.05);
  EXPECT_EQ(map["column_count"], map["row_stride"]);
  EXPECT_GT(map["data"].get<std::string>().size(), 100u);
}

}  // namespace
}  // namespace troupe::foxglove
