// The classes of troupe.testing: monitors of expectations and metrics, and `watch`, which steps with them.
#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "python/native/convert.h"
#include "python/native/world.h"
#include "troupe/expectation.h"

namespace troupe::python {
namespace {

using namespace py::literals;
using WorldPointer = std::shared_ptr<World>;

// A monitor, which one thread at a time may use.
template <typename Sentence, typename Inner>
class Watcher {
 public:
  explicit Watcher(const Sentence& sentence) : monitor_(sentence) {}

  class Use {
   public:
    explicit Use(Watcher& watcher) : watcher_(watcher) {
      if (watcher_.used_.exchange(true, std::memory_order_acquire)) {
        throw std::runtime_error("the monitor is in use by another thread, or twice in one call");
      }
    }
    ~Use() { watcher_.used_.store(false, std::memory_order_release); }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;
    Inner* operator->() const { return &watcher_.monitor_; }

   private:
    Watcher& watcher_;
  };

  // Adds the present tick, if it is not the last one added. REQUIRES: a Use exists, here and below.
  Status Push(const Simulation& simulation) {
    // `watch` begins with the present tick, which the call before may have added already.
    if (last_ == simulation.tick()) return {};
    Status problem = monitor_.Push(simulation);
    if (problem.ok()) last_ = simulation.tick();
    return problem;
  }

  void Finish() {
    if (!last_) throw py::value_error("the monitor has received no tick");
    if (!finished_) monitor_.Finish();
    finished_ = true;
  }
  bool finished() const { return finished_; }

 private:
  std::atomic<bool> used_ = false;
  Inner monitor_;
  std::optional<Tick> last_;
  bool finished_ = false;
};
using ExpectationMonitor = Watcher<Expectation, Monitor>;
using NumberMonitor = Watcher<Metric, MetricMonitor>;
using AnyMonitor = std::variant<std::shared_ptr<ExpectationMonitor>, std::shared_ptr<NumberMonitor>>;

std::vector<NamedRegion> RegionsOf(const py::object& regions) {
  std::vector<NamedRegion> named;
  if (regions.is_none()) return named;
  using Outline = std::vector<std::pair<double, double>>;
  using OnLevel = std::pair<Outline, double>;  // with the height of its floor
  for (const auto& [name, region] : regions.cast<std::map<std::string, std::variant<Outline, OnLevel>>>()) {
    const OnLevel* const on_level = std::get_if<OnLevel>(&region);
    Polygon polygon;
    for (const auto& [x, y] : on_level != nullptr ? on_level->first : std::get<Outline>(region)) {
      polygon.emplace_back(x, y);
    }
    if (polygon.size() < 3) throw py::value_error(fmt::format("region {}: expected three or more points", name));
    named.push_back({name, std::move(polygon)});
    if (on_level != nullptr) named.back().z = on_level->second;
  }
  return named;
}

template <typename Sentence, typename Type>
std::shared_ptr<Type> Make(const WorldPointer& world, const std::string& text, const py::object& regions) {
  const std::vector<NamedRegion> named = RegionsOf(regions);
  const World::Use use(*world);
  Result<Sentence> sentence = Sentence::Parse(text, {use->world(), named});
  if (!sentence.ok()) {
    Error error = sentence.error();
    error.message += ", in: " + text;
    error.code = ErrorCode::kBadInput;
    Raise(error);
  }
  return std::make_shared<Type>(sentence.value());
}

// Steps, and adds each tick to the monitors, the present one first. With `stop` until an expectation is false.
void Watch(const WorldPointer& world, std::int64_t ticks, const std::vector<AnyMonitor>& monitors, bool stop) {
  if (ticks < 0) throw py::value_error(fmt::format("ticks: found {}, expected 0 or more", ticks));
  std::vector<std::variant<std::unique_ptr<ExpectationMonitor::Use>, std::unique_ptr<NumberMonitor::Use>>> uses;
  for (const AnyMonitor& each : monitors) {
    std::visit(
        [&](const auto& monitor) {
          if (monitor == nullptr) throw py::type_error("monitors: found None, expected a Monitor or Metric");
          uses.emplace_back(std::make_unique<typename std::remove_reference_t<decltype(*monitor)>::Use>(*monitor));
        },
        each);
  }
  Status problem;
  bool violated = false;
  const auto push = [&](const Simulation& simulation) {
    for (std::size_t i = 0; i < monitors.size() && problem.ok(); ++i) {
      problem = std::visit([&](const auto& monitor) { return monitor->Push(simulation); }, monitors[i]);
      if (const auto* const use = std::get_if<std::unique_ptr<ExpectationMonitor::Use>>(&uses[i])) {
        violated |= (**use)->verdict() == Verdict::kFalse;
      }
    }
    return problem.ok() && !(stop && violated);
  };
  bool goes_on = false;
  {
    const World::Use use(*world);
    goes_on = push(*use);
  }
  if (goes_on) world->Step(static_cast<Tick>(ticks), push);
  RaiseIfBad(problem);
}

template <typename Type>
void DefineCommon(py::class_<Type, std::shared_ptr<Type>>& type) {
  type.def(
          "push",
          [](const std::shared_ptr<Type>& monitor, const WorldPointer& world) {
            const typename Type::Use use(*monitor);
            const World::Use simulation(*world);
            RaiseIfBad(monitor->Push(*simulation));
          },
          py::arg("simulation").none(false),
          "Adds the present tick; the same tick twice counts once. RunError if it is not the next one, or of another "
          "world.")
      .def(
          "finish",
          [](const std::shared_ptr<Type>& monitor) {
            const typename Type::Use use(*monitor);
            monitor->Finish();
          },
          "The run has ended: decides what has been open. ValueError without a tick.");
}

void DefineMonitor(py::module_& module) {
  using Use = ExpectationMonitor::Use;
  using Self = std::shared_ptr<ExpectationMonitor>;
  py::class_<ExpectationMonitor, Self> monitor(module, "Monitor", R"(Judges an expectation, tick by tick.

docs/testing.md has the language. The same states give the same verdicts as `troupe test`.)");
  DefineCommon(monitor);
  monitor
      .def(py::init(&Make<Expectation, ExpectationMonitor>), py::arg("simulation").none(false), "text"_a,
           "regions"_a = py::none(),
           R"(Of a world of which names are resolved and units are checked: InputError with the column in `text`.

regions: {name: [(x, y), ...]}, m in W, simple polygons.)")
      .def_property_readonly(
          "text", [](const Self& self) { return Use(*self)->expectation().text(); }, "The expectation as written.")
      .def_property_readonly(
          "formula", [](const Self& self) { return Use(*self)->expectation().formula(); }, "Without shorthands.")
      .def_property_readonly(
          "verdict",
          [](const Self& self) -> py::object {
            const Verdict verdict = Use(*self)->verdict();
            return verdict == Verdict::kUndecided ? py::none() : py::object(py::bool_(verdict == Verdict::kTrue));
          },
          "True, False, or None as long as later ticks can change it.")
      .def_property_readonly(
          "decided_at", [](const Self& self) { return Use(*self)->decided_at(); },
          "The tick after which the verdict was known, or None.")
      .def_property_readonly(
          "robustness",
          [](const Self& self) {
            const Interval bounds = Use(*self)->robustness_bounds();
            return std::make_pair(bounds.min, bounds.max);
          },
          "(min, max): bounds of how far the run is from the other verdict, in the unit of the comparison that "
          "decides; "
          "equal when it is known.")
      .def_property_readonly(
          "cause",
          [](const Self& self) {
            const Monitor::Cause cause = Use(*self)->cause();
            return py::make_tuple(py::cast(cause.tick), py::tuple(py::cast(cause.names)));
          },
          "(tick or None, names): what decides the robustness so far.")
      .def_property_readonly(
          "history",
          [](const Self& self) {
            const Use use(*self);
            py::list moments;
            for (const Monitor::Moment& moment : use->history()) {
              moments.append(py::make_tuple(moment.tick, moment.robustness));
            }
            return moments;
          },
          "A list of (tick, robustness) of the formula below the outermost temporal operator.");
}

void DefineMetric(py::module_& module) {
  using Use = NumberMonitor::Use;
  using Self = std::shared_ptr<NumberMonitor>;
  py::class_<NumberMonitor, Self> metric(
      module, "Metric", "A number of a run: `max of speed(r)`, `time of first at(r, dock)`. docs/testing.md has all.");
  DefineCommon(metric);
  metric
      .def(py::init(&Make<Metric, NumberMonitor>), py::arg("simulation").none(false), "text"_a,
           "regions"_a = py::none(), "As of Monitor.")
      .def_property_readonly(
          "text", [](const Self& self) { return Use(*self)->metric().text(); }, "The metric as written.")
      .def_property_readonly(
          "unit", [](const Self& self) { return Use(*self)->metric().unit(); },
          "The unit of `value`: 's', 'm/s', '' for a count or ratio.")
      .def_property_readonly(
          "value",
          [](const Self& self) {
            const Use use(*self);
            return self->finished() ? use->value() : std::nullopt;
          },
          "After `finish`, in SI units; None if it does not exist: the time of what never happened.");
}

}  // namespace

void DefineMonitors(py::module_& module) {
  DefineMonitor(module);
  DefineMetric(module);
  module.def("watch", Watch, py::arg("simulation").none(false), "ticks"_a, "monitors"_a, "stop"_a = false,
             R"(Steps by `ticks`, and adds each tick to the monitors, the present one first; they are not finished.

stop: no further than the tick at which an expectation is false. Other threads run meanwhile; Ctrl-C ends it.)");
}

}  // namespace troupe::python
