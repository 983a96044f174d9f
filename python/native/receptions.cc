// Worlds::Receptions: the radio messages that arrive in all worlds, as columns.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "python/native/worlds.h"

namespace troupe::python {

py::dict Worlds::Receptions(const py::object& sensor) {
  struct Row {
    std::size_t receiver = 0;
    RadioReception reception;
  };
  const Uses uses(worlds_);
  const std::vector<std::size_t> sensors = worlds_[0]->FindSensors(sensor);
  std::vector<std::vector<Row>> rows(size());
  ForEachWorldByIndex([&](std::size_t i, Interrupt&) {
    World& world = *worlds_[i];
    world.CheckRobots(sensors.size());
    for (std::size_t robot = 0; robot < sensors.size(); ++robot) {
      const RadioReading* const reading =
          sensors[robot] < world.sensor_count(RobotId(robot))
              ? world.simulation().Read(RobotId(robot), sensors[robot]).As<RadioReading>()
              : nullptr;
      if (reading == nullptr) {
        throw py::value_error(fmt::format("sensor {} of robot {} is no radio", sensors[robot],
                                          world.simulation().world().robot(RobotId(robot)).name));
      }
      for (const RadioReception& reception : reading->receptions) rows[i].push_back({robot, reception});
    }
  });
  std::size_t most = 0;
  for (const std::vector<Row>& of_world : rows) most = std::max(most, of_world.size());
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(size()), static_cast<py::ssize_t>(most)};
  const auto column = [&]<typename Number>(Number none, const auto& number_of) {
    py::array_t<Number> numbers(shape);
    Number* next = numbers.mutable_data();
    for (const std::vector<Row>& of_world : rows) {
      for (std::size_t row = 0; row < most; ++row) *next++ = row < of_world.size() ? number_of(of_world[row]) : none;
    }
    return numbers;
  };
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  py::dict columns;
  py::array_t<std::int64_t> counts(static_cast<py::ssize_t>(size()));
  py::tuple data(size());
  for (std::size_t i = 0; i < size(); ++i) {
    counts.mutable_data()[i] = static_cast<std::int64_t>(rows[i].size());
    py::tuple of_world(rows[i].size());
    for (std::size_t row = 0; row < rows[i].size(); ++row) {
      const std::vector<std::uint8_t>& bytes = rows[i][row].reception.bytes;
      of_world[row] = py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    data[i] = std::move(of_world);
  }
  columns["rows"] = counts;
  columns["receiver"] =
      column(std::int64_t{-1}, [](const Row& row) { return static_cast<std::int64_t>(row.receiver); });
  columns["sender"] =
      column(std::int64_t{-1}, [](const Row& row) { return static_cast<std::int64_t>(row.reception.from.index()); });
  columns["tick"] =
      column(std::int64_t{-1}, [](const Row& row) { return static_cast<std::int64_t>(row.reception.tick); });
  columns["to_all"] = column(false, [](const Row& row) { return row.reception.to_all; });
  columns["rssi"] = column(kNone, [](const Row& row) { return row.reception.rssi; });
  const auto place = [&](auto part) {
    return column(kNone, [part, none = kNone](const Row& row) {
      return row.reception.place ? *row.reception.place.*part : none;
    });
  };
  columns["range"] = place(&RadioReception::Place::range);
  columns["bearing"] = place(&RadioReception::Place::bearing);
  columns["elevation"] = place(&RadioReception::Place::elevation);
  columns["data"] = data;
  return columns;
}

}  // namespace troupe::python
