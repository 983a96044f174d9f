// lasernoise: stands still and reports the noise of its ranger.
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/rays.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

struct LaserNoiseParameters {
  double samples = 100.0;  // readings of a report
};

Result<LaserNoiseParameters> ParseLaserNoise(const std::string& text) {
  LaserNoiseParameters p;
  Parameters reader("lasernoise", text);
  p.samples = reader.ReadNumber("samples", {2.0, 1e6}).value_or(p.samples);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

class LaserNoiseController final : public Controller {
 public:
  LaserNoiseController(const RobotInfo& info, const LaserNoiseParameters& parameters, std::size_t ranger)
      : parameters_(parameters), ranger_(ranger), rays_(RaysOf(info, ranger)), sums_(rays_->size()) {}

  std::vector<std::size_t> Subscriptions() const override { return {ranger_}; }

  Command Update(const Observation& observation) override {
    Command command;
    const SensorReading& reading = observation.sensors[ranger_];
    if (reading.empty() || reading.tick != observation.tick) return command;
    for (std::size_t i = 0; i < rays_->size(); ++i) {
      const RangerRay& ray = (*rays_)[i];
      const double range = RangeOf(reading, ray);
      if (range < ray.max_range) sums_[i].Add(range);
    }
    if (static_cast<double>(++readings_) < parameters_.samples) return command;
    command.report = Report();
    readings_ = 0;
    sums_.assign(rays_->size(), {});
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<LaserNoiseController>(*this); }

 private:
  // The sums of the ranges of one ray (Welford 1962): stable where the variance is tiny beside the mean.
  struct Sums {
    double count = 0.0;
    double mean = 0.0;     // m
    double squares = 0.0;  // m^2, of the differences from the mean

    void Add(double range) {
      count += 1.0;
      const double difference = range - mean;
      mean += difference / count;
      squares += difference * (range - mean);
    }
  };

  std::string Report() const {
    double rays = 0.0;
    double variances = 0.0;
    double greatest = 0.0;
    std::size_t noisiest = 0;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      if (sums_[i].count < 2.0) continue;
      const double variance = sums_[i].squares / (sums_[i].count - 1.0);
      rays += 1.0;
      variances += variance;
      if (variance <= greatest) continue;
      greatest = variance;
      noisiest = i;
    }
    if (rays == 0.0) return fmt::format("{} readings: no ray has a hit", readings_);
    return fmt::format("{} readings, {} of {} rays with hits: standard deviation {:.6f} m, greatest {:.6f} m (ray {})",
                       readings_, rays, rays_->size(), std::sqrt(variances / rays), std::sqrt(greatest), noisiest);
  }

  LaserNoiseParameters parameters_;
  std::size_t ranger_;
  Shared<std::vector<RangerRay>> rays_;
  std::vector<Sums> sums_;  // by ray
  std::size_t readings_ = 0;
};

Status CheckLaserNoise(const std::string& parameters) {
  const Result<LaserNoiseParameters> parsed = ParseLaserNoise(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

Result<std::unique_ptr<Controller>> CreateLaserNoise(const RobotInfo& info) {
  const Result<LaserNoiseParameters> parameters = ParseLaserNoise(info.parameters);
  if (!parameters.ok()) return parameters.error();
  const std::optional<std::size_t> ranger = FindBestRanger(info);
  if (!ranger) return Error{{}, "lasernoise: the robot has no ranger, expected one"};
  return std::unique_ptr<Controller>(std::make_unique<LaserNoiseController>(info, parameters.value(), *ranger));
}

}  // namespace

BuiltInController LaserNoise() {
  return {"lasernoise", CheckLaserNoise, CreateLaserNoise};
}

}  // namespace troupe
