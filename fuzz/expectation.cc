// Feeds any bytes to the language of expectations of a small world: as an expectation, or behind a space as a metric.
// One reading an execution: what costs is the reading, and most texts are neither.
#include "troupe/expectation.h"

#include <span>
#include <string>

#include "fuzz/targets.h"
#include "testing/expectations/syntax.h"
#include "testing/expectations/tick_view.h"

namespace troupe::fuzz {
namespace {

// Two robots with names that texts use, an object, a place.
const WorldDescription& SmallWorld() {
  static const WorldDescription world = [] {
    WorldDescription description;
    description.shapes.push_back({{{{{-0.2, -0.2}, {0.2, -0.2}, {0.2, 0.2}, {-0.2, 0.2}}, {0.0, 0.4}}}, {}, {}});
    for (const char* const name : {"anna", "bob", "can"}) {
      ModelDescription model;
      model.name = name;
      model.X_PM = {1.0 * static_cast<double>(description.models.size()), 0.0, 0.0, 0.0};
      model.shape = ShapeId(0);
      const bool is_object = description.models.size() == 2;
      model.gripper_return = is_object;
      description.models.push_back(model);
      const ModelId root(description.models.size() - 1);
      if (is_object) {
        description.objects.push_back(root);
      } else {
        RobotDescription robot;
        robot.name = name;
        robot.root = root;
        description.robots.push_back(robot);
      }
    }
    description.places.push_back({"dock", {}, {}, {}});
    return description;
  }();
  return world;
}

void CheckError(const Error& error, const std::string& text) {
  Check(!error.message.empty());
  Check(error.where.line == 1);
  Check(error.where.column >= 1 && static_cast<std::size_t>(error.where.column) <= text.size() + 1);
}

// The world at rest, of which only the tick changes.
class Ticks {
 public:
  Ticks() : scene_(SmallWorld()), state_(PlacedState(scene_.world())), bodies_(scene_) { bodies_.Assign(state_); }

  const WorldDescription& world() const { return scene_.world(); }
  template <typename AnyMonitor>
  void PushTo(AnyMonitor& monitor) {
    for (state_.tick = 0; state_.tick < 4; ++state_.tick) {
      Check(monitor.Push(TickView{scene_, bodies_, state_, {}}).ok());
    }
    monitor.Finish();
  }

 private:
  Scene scene_;
  WorldState state_;
  BodyIndex bodies_;
};

}  // namespace

void Expectation(Bytes bytes) {
  static Ticks ticks;
  static const NamedRegion door{"door", {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}};
  static const ExpectationScope scope{ticks.world(), std::span(&door, 1)};
  const std::string text = TextOf(bytes);

  if (text.starts_with(' ')) {
    const Result<Metric> metric = Metric::Parse(text, scope);
    if (!metric.ok()) return CheckError(metric.error(), text);
    MetricMonitor monitor(metric.value());
    return ticks.PushTo(monitor);
  }
  const Result<troupe::Expectation> expectation = troupe::Expectation::Parse(text, scope);
  if (!expectation.ok()) return CheckError(expectation.error(), text);
  // What is printed is the same formula; it may be longer or deeper than what is accepted.
  const std::string formula = expectation.value().formula();
  const Result<Syntax> again = ParseFormula(formula);
  Check(!again.ok() || ToString(again.value()) == formula);
  Monitor monitor(expectation.value());
  ticks.PushTo(monitor);
  // After the end every expectation is decided, and its bounds have met: whatever the text.
  Check(monitor.verdict() != Verdict::kUndecided);
  const Interval bounds = monitor.robustness_bounds();
  Check(bounds.min == bounds.max);
}

}  // namespace troupe::fuzz
