// The values of the simulation as records of Python (troupe/records.py), and back. Arrays are views of the memory of
// the value, which they keep alive, and can only be read: a state is immutable, so that no copy is needed.
//
// All functions need the interpreter's lock. They throw pybind11's exceptions: a TypeError or ValueError that names the
// value found and the one expected. Records are plain tuples made by Python's own classes, whose order of fields this
// code knows: records.py and this folder change together.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "troupe/controller.h"
#include "troupe/sensor.h"

namespace troupe::python {

namespace py = pybind11;

// The type of that name in troupe.records.
const py::object& Record(const char* name);

// A view of `data`, which lies in the memory of `owner`. Strides are in bytes; none: an array in one piece.
template <typename Value, typename Owner>
py::array View(const std::shared_ptr<const Owner>& owner, const Value* data, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides = {}) {
  auto kept = std::make_unique<std::shared_ptr<const void>>(owner);
  py::capsule base(kept.get(), [](void* pointer) { delete static_cast<std::shared_ptr<const void>*>(pointer); });
  (void)kept.release();
  static const Value kNone{};
  py::array view(py::dtype::of<Value>(), std::move(shape), std::move(strides), data == nullptr ? &kNone : data, base);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

py::object ToRecord(const Pose& pose);
py::object ToRecord(const Twist& twist);
// None if it is empty.
py::object ToRecord(const std::shared_ptr<const SensorReading>& reading);
py::object ToRecord(const RobotInfo& info);
py::object ToRecord(const Observation& observation);

// A Command, a pair (vx, wz), a triple (vx, vy, wz), or None.
Command ToCommand(py::handle value);

// The array of a caller to write into: of float32 or float64, writable, in one piece, and of that shape.
py::array OutputArray(const py::object& out, const std::vector<py::ssize_t>& shape, const char* what);

// A new array, or `out`, which must be of that type and shape, writable and in one piece.
template <typename Value>
py::array_t<Value> ArrayOf(const py::object& out, const std::vector<py::ssize_t>& shape, const char* type) {
  if (out.is_none()) return py::array_t<Value>(shape);
  using Array = py::array_t<Value, py::array::c_style>;
  if (!Array::check_(out)) throw py::type_error(std::string("out: expected an array of ") + type + " in one piece");
  auto array = py::reinterpret_borrow<Array>(out);
  if (!array.writeable() || std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim()) != shape) {
    throw py::value_error("out: expected a writable array of the shape of the result");
  }
  return array;
}

// `what` starts the message of the error.
double ToNumber(py::handle value, const char* what);
std::size_t ToIndex(py::handle value, const char* what);
// A whole number of Python or numpy, 0 to 2^64 - 1.
std::uint64_t ToSeed(py::handle value, const char* what);

// Fails if a number is not finite.
void CheckFinite(const py::array_t<double>& numbers, const char* what);

}  // namespace troupe::python
