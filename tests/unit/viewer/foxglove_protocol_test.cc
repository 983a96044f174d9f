#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "troupe/world_state.h"
#include "viewer/foxglove/messages.h"
#include "viewer/foxglove/protocol.h"

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
  ASSERT_EQ(channels.size(), 5u) << "single rays have no scan";
  EXPECT_EQ(channels[4].topic, "/r0/ranger:0");

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
