// rasterize: makes a map of cells of all places that it can reach.
//
// It drives to the nearest unknown place again and again (frontier exploration; Yamauchi 1997), and says so when none
// is left in reach.
#include <fmt/format.h>

#include <optional>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/mapped_route.h"
#include "robot-agent/navigation/steering.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

constexpr double kDoneTime = 5.0;  // s without anything unknown in reach

struct RasterizeParameters {
  ClearSteering::Settings motion;
  MappedRoute::Settings map;
};

Result<RasterizeParameters> ParseRasterize(const std::string& text) {
  RasterizeParameters p;
  Parameters reader("rasterize", text);
  p.motion.steer.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.motion.steer.speed);
  p.motion.steer.turn_rate = reader.ReadNumber("turn_rate", {0.0, 100.0}).value_or(p.motion.steer.turn_rate);
  p.motion.clearance = reader.ReadNumber("clearance", {0.0, 100.0}).value_or(p.motion.clearance);
  p.map = ReadMapSettings(reader, p.motion.clearance);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

class RasterizeController final : public Controller {
 public:
  RasterizeController(const RobotInfo& info, const RasterizeParameters& parameters, std::size_t ranger)
      : parameters_(parameters),
        ranger_(ranger),
        steering_(info, ranger, parameters.motion),
        route_(info, ranger, parameters.map) {}

  std::vector<std::size_t> Subscriptions() const override { return {ranger_}; }

  Command Update(const Observation& observation) override {
    route_.Observe(observation);
    if (const std::optional<Vec2> next = route_.NextUnknown(observation)) {
      done_at_.reset();
      reported_ = false;
      return steering_.Towards(observation, Transform2(observation.pose_estimate).InverseTransform(*next),
                               parameters_.motion.steer.speed);
    }
    Command command;
    if (!done_at_) done_at_ = observation.time + kDoneTime;
    if (observation.time < *done_at_ || reported_) return command;
    reported_ = true;
    command.report = fmt::format("the map is complete: {:.1f} m2 seen", route_.KnownArea());
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<RasterizeController>(*this); }

 private:
  RasterizeParameters parameters_;
  std::size_t ranger_;
  ClearSteering steering_;
  MappedRoute route_;
  std::optional<double> done_at_;  // s, simulated
  bool reported_ = false;
};

Status CheckRasterize(const std::string& parameters) {
  const Result<RasterizeParameters> parsed = ParseRasterize(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Result<std::unique_ptr<Controller>> CreateRasterize(const RobotInfo& info) {
  const Result<RasterizeParameters> parameters = ParseRasterize(info.parameters);
  if (!parameters.ok()) return parameters.error();
  const std::optional<std::size_t> ranger = FindBestRanger(info);
  if (!ranger) return Error{{}, "rasterize: the robot has no ranger, expected one"};
  return std::unique_ptr<Controller>(std::make_unique<RasterizeController>(info, parameters.value(), *ranger));
}

}  // namespace

BuiltInController Rasterize() {
  return {"rasterize", CheckRasterize, CreateRasterize};
}

}  // namespace troupe
