// PageViewer: a viewer that speaks the protocol of the page: session, status and replies as JSON, each world once, then
// updates, each the difference from the one before that this viewer has received.
//
// A message is made when the socket can send it, and not before: so a slow viewer gets the newest state and skips those
// between, and no queue grows. For the same reason an update is made per viewer, from what this one has.
//
// A viewer in the past gets all rows of each state that it seeks, because the state before may be any.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/sensing/sensor_suite.h"
#include "common/spatial/body_index.h"
#include "recording/timeline/timeline.h"
#include "viewer/gateway/page_messages.h"
#include "viewer/gateway/viewer.h"

namespace troupe {

// Whether the camera images of a robot are measured: they are large.
enum class Pictures : std::uint8_t {
  kNone,      // the page does not show them
  kKept,      // it shows the last ones, until it receives others
  kMeasured,  // of the state
};

// RobotReadings: the readings of robots that viewers have selected, measured in the gateway: the same bits as in the
// robots' agents, because a reading is a pure function of the state. So no reading travels from the agents, and a run
// does not know which robots are watched. Encoded once for all viewers.
class RobotReadings {
 public:
  // Until the next call the readings are of this state.
  void SetState(const SharedState& state);

  // Writes the readings of a robot in the state, measured now if need be. Returns true if the robot has a camera whose
  // image is not among them. REQUIRES: SetState was called; the robot exists.
  bool Write(PageWriter& writer, RobotId robot, Pictures pictures);

 private:
  struct Robot {
    SensorSuite suite;
    std::vector<std::string> encoded;  // by sensor, in the state; empty: not measured yet
  };
  const std::string& Encoded(Robot& robot, std::size_t sensor);

  SharedState state_;
  std::optional<BodyIndex> bodies_;
  bool bodies_fresh_ = false;
  std::map<RobotId, Robot> robots_;  // made on first use
};

// ShownWays: the ways to goals of robots that viewers have selected, searched in the gateway as the robots search
// theirs (common/spatial/robot_ways.h), but around static bodies and zones alone. Shared by all viewers, and renewed
// once in a second.
class ShownWays {
 public:
  // The points (m, W) from the robot to its goal; empty for a controller whose ways are not known.
  const std::vector<Vec2>& Of(const TimelineState& state, const RobotCommand& goal);

 private:
  struct Known {
    std::uint32_t goal = 0;
    std::chrono::steady_clock::time_point at;
    std::vector<Vec2> points;
  };
  std::shared_ptr<const Scene> scene_;
  std::map<RobotId, Known> ways_;
};

// The measurement of readings that the pages share, and its share of the time: for all robots of a large world
// measuring takes longer than a period, so it is repeated only after four times its duration.
struct PageReadings {
  using Clock = std::chrono::steady_clock;

  RobotReadings live;
  RobotReadings past;
  ShownWays ways;
  bool measures_all = true;  // in this period: all robots are measured less often if that takes long
  Clock::time_point next_all;

  void BeginPeriod() { measures_all = Clock::now() >= next_all; }
};

class PageViewer final : public Viewer {
 public:
  // Replies that wait for a viewer; a viewer with more of them does not read, and is not answered any more.
  static constexpr std::size_t kMaxReplies = 64;

  // `longest`: bytes of a request. All of them outlive the viewer.
  PageViewer(const ShownRun& run, const Timeline& past, PageReadings& readings, std::size_t longest)
      : Viewer(run), history_(past), readings_(readings), longest_(longest) {}

  Result<std::optional<PageRequest>> Receive(std::string_view message, bool is_text) override;
  void Answer(PageReply reply) override;
  bool NeedsMessage() const override;
  std::optional<WebMessage> Next() override;
  void ReturnToLive() override;

 private:
  using Clock = PageReadings::Clock;

  bool NeedsStatus() const;
  bool NeedsUpdate() const;
  std::string MakeUpdate();
  void WriteRows(PageWriter& writer) const;
  void WriteEvents(PageWriter& writer);
  void WriteGoals(PageWriter& writer);
  void WriteTraffic(PageWriter& writer) const;
  void WriteLaneRules(PageWriter& writer) const;
  void WriteReadings(PageWriter& writer);
  std::vector<RobotId> SelectedRobots() const;

  const Timeline& history_;
  PageReadings& readings_;
  const std::size_t longest_;
  SelectRequest selected_;
  bool selection_is_new_ = false;               // since the last update
  bool readings_missing_ = false;               // the last update left out some of the selection
  Clock::time_point next_pictures_;             // camera images are not sent earlier
  std::shared_ptr<const std::string> session_;  // the messages that it has, as in ShownRun
  std::shared_ptr<const std::string> status_;
  std::shared_ptr<const std::string> timeline_;
  std::uint32_t world_ = 0;   // number of the world that it has; 0: none
  std::uint64_t update_ = 0;  // of that world that it has received last; 0: none
  std::uint64_t event_ = 0;   // number of the last event
  std::uint64_t event_list_ = 0;
};

}  // namespace troupe
