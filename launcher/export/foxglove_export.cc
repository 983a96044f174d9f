// The messages of the live channels for Foxglove (viewer/foxglove), in an MCAP file.
#include <optional>
#include <span>
#include <utility>

#include "launcher/export/mcap_file.h"
#include "launcher/export/run_export.h"
#include "viewer/foxglove/messages.h"
#include "world-service/service/event_log.h"

namespace troupe {
namespace {

// The level of the log message, by which Foxglove filters and colours.
bool IsWarning(EventType type) {
  return type == EventType::kLeft || type == EventType::kProposalRejected || type == EventType::kBlocked ||
         type == EventType::kStallBegan || type == EventType::kUnstable || type == EventType::kWaitBegan ||
         type == EventType::kNoWay;
}

// Scene and map are written when the world changes, all else with each state.
class FoxgloveExport final : public RunExport {
 public:
  explicit FoxgloveExport(McapFile file) : file_(std::move(file)) {}

  Status Add(const ReplayedWorld& world, std::uint64_t time) override {
    readings_.SetState(world);
    const bool is_new = scene_ != world.scene();
    if (is_new) {
      scene_ = world.scene();
      things_.emplace(world.world());
      channels_ = foxglove::ChannelsOf(world.world());
    }
    for (const foxglove::Channel& channel : channels_) {
      if (Status status = AddMessages(channel, world, time, is_new); !status.ok()) return status;
    }
    return {};
  }

  Status Close() override { return file_.Close(); }

 private:
  Status AddMessages(const foxglove::Channel& channel, const ReplayedWorld& world, std::uint64_t time, bool is_new) {
    switch (channel.kind) {
      case foxglove::ChannelKind::kScene:
        return is_new ? Write(channel, foxglove::SceneText(*scene_, time), time) : Status();
      case foxglove::ChannelKind::kMap:
        return is_new ? Write(channel, foxglove::MapText(*scene_, time), time) : Status();
      case foxglove::ChannelKind::kTransforms:
        return Write(channel, foxglove::TransformsText(*scene_, world.state(), time), time);
      case foxglove::ChannelKind::kEvents:
        for (const Event& event : world.events()) {
          const std::string text = foxglove::EventText(EventText(world.world(), event), IsWarning(event.type), time);
          if (Status status = Write(channel, text, time); !status.ok()) return status;
        }
        return {};
      case foxglove::ChannelKind::kScan:
        return AddScan(channel, time);
      case foxglove::ChannelKind::kTable:
        return Write(channel, foxglove::TableText(*channel.table, {*things_, world.world(), world.state()}, time),
                     time);
    }
    return {};
  }

  // Only when the sensor is due, as its robot saw it.
  Status AddScan(const foxglove::Channel& channel, std::uint64_t time) {
    if (!readings_.IsDue(channel.robot, channel.sensor)) return {};
    const RangerReading* const reading = readings_.Measure(channel.robot, channel.sensor).ranger();
    if (reading == nullptr || channel.scan >= reading->geometry->size()) return {};
    return Write(channel, foxglove::ScanText(reading->scan(channel.scan), channel.frame, time), time);
  }

  Status Write(const foxglove::Channel& channel, const std::string& text, std::uint64_t time) {
    const std::uint16_t topic = file_.FindTopic(channel.topic, [&]() -> McapFile::Topic {
      return {channel.topic, {foxglove::SchemaName(channel), "jsonschema", foxglove::Schema(channel)}, "json"};
    });
    return file_.Write(topic, time, std::as_bytes(std::span(text)));
  }

  McapFile file_;
  std::shared_ptr<const Scene> scene_;
  std::vector<foxglove::Channel> channels_;
  std::optional<Things> things_;  // of the scene
  RunReadings readings_;
};

}  // namespace

Result<std::unique_ptr<RunExport>> MakeFoxgloveExport(const std::string& file) {
  Result<McapFile> mcap = McapFile::Create(file, "");
  if (!mcap.ok()) return mcap.error();
  return std::unique_ptr<RunExport>(std::make_unique<FoxgloveExport>(std::move(mcap).value()));
}

}  // namespace troupe
