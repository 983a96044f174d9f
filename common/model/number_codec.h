// The numbers of a plain value, one after another, and the value from its numbers: the form in which the parameters of
// a sensor are hashed, checked and sent. A struct lists its parts by a static VisitFields(self, visit), which calls
// visit(name, part) for each; a list is its length and its elements.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "troupe/color.h"
#include "troupe/interval.h"
#include "troupe/pose.h"
#include "troupe/vec2.h"

namespace troupe {

class NumberWriter {
 public:
  void Write(double value) { numbers_.push_back(value); }
  void Write(bool value) { Write(value ? 1.0 : 0.0); }
  void Write(std::uint32_t value) { Write(static_cast<double>(value)); }
  void Write(std::int32_t value) { Write(static_cast<double>(value)); }
  void Write(const Vec2& p) { WriteAll(p.x(), p.y()); }
  void Write(const Pose& pose) { WriteAll(pose.x, pose.y, pose.z, pose.heading); }
  void Write(const Interval& interval) { WriteAll(interval.min, interval.max); }
  void Write(const Color& color) { WriteAll(color.r, color.g, color.b, color.a); }
  template <typename T>
  void Write(const std::vector<T>& list) {
    Write(static_cast<std::uint32_t>(list.size()));
    for (const T& element : list) Write(element);
  }
  template <typename T>
  requires std::is_class_v<T>
  void Write(const T& value) {
    T::VisitFields(value, [this](std::string_view, const auto& part) { this->Write(part); });
  }

  std::vector<double> TakeNumbers() { return std::move(numbers_); }

 private:
  template <typename... Numbers>
  void WriteAll(Numbers... numbers) {
    (numbers_.push_back(numbers), ...);
  }
  std::vector<double> numbers_;
};

// Reads what NumberWriter wrote. After the first number that is missing or does not fit, ok() is false.
class NumberReader {
 public:
  explicit NumberReader(std::span<const double> numbers) : numbers_(numbers) {}

  bool ok() const { return ok_; }
  bool at_end() const { return next_ == numbers_.size(); }

  void Read(double& value) {
    ok_ = ok_ && next_ < numbers_.size();
    if (ok_) value = numbers_[next_++];
  }
  void Read(bool& value) { value = ReadWhole(0.0, 1.0) != 0.0; }
  void Read(std::uint32_t& value) {
    value = static_cast<std::uint32_t>(ReadWhole(0.0, std::numeric_limits<std::uint32_t>::max()));
  }
  void Read(std::int32_t& value) {
    value = static_cast<std::int32_t>(
        ReadWhole(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()));
  }
  void Read(Vec2& p) { ReadAll(p.x(), p.y()); }
  void Read(Pose& pose) { ReadAll(pose.x, pose.y, pose.z, pose.heading); }
  void Read(Interval& interval) { ReadAll(interval.min, interval.max); }
  void Read(Color& color) { ReadAll(color.r, color.g, color.b, color.a); }
  template <typename T>
  void Read(std::vector<T>& list) {
    std::uint32_t count = 0;
    Read(count);
    // Every element has at least one number: a wrong length cannot exhaust the memory.
    ok_ = ok_ && count <= numbers_.size() - next_;
    if (!ok_) return;
    list.resize(count);
    for (T& element : list) Read(element);
  }
  template <typename T>
  requires std::is_class_v<T>
  void Read(T& value) {
    T::VisitFields(value, [this](std::string_view, auto& part) { this->Read(part); });
  }

 private:
  template <typename... Numbers>
  void ReadAll(Numbers&... numbers) {
    (Read(numbers), ...);
  }
  double ReadWhole(double min, double max) {
    double value = 0.0;
    Read(value);
    ok_ = ok_ && value >= min && value <= max && std::trunc(value) == value;
    return ok_ ? value : 0.0;
  }

  std::span<const double> numbers_;
  std::size_t next_ = 0;
  bool ok_ = true;
};

}  // namespace troupe
