#include "transport/dds/convert/sensor_numbers.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "troupe/fields.h"
#include "troupe/shared.h"
#include "troupe/vec2.h"

namespace troupe::dds {
namespace {

// Gives each number to `take`.
template <typename Take>
class NumberWriter {
 public:
  explicit NumberWriter(Take take) : take_(std::move(take)) {}

  void Write(double value) { take_(value); }
  void Write(bool value) { Write(value ? 1.0 : 0.0); }
  void Write(std::uint32_t value) { Write(static_cast<double>(value)); }
  void Write(std::int32_t value) { Write(static_cast<double>(value)); }
  void Write(const Vec2& p) { WriteAll(p.x(), p.y()); }
  template <typename T>
  void Write(const std::vector<T>& list) {
    Write(static_cast<std::uint32_t>(list.size()));
    for (const T& element : list) Write(element);
  }
  template <typename T>
  void Write(const Shared<T>& value) {
    Write(*value);
  }
  template <typename T>
  requires HasFields<T>
  void Write(const T& value) {
    ForEachField<T>([&](const auto& field) { Write(field.Of(value)); });
  }

 private:
  template <typename... Numbers>
  void WriteAll(Numbers... numbers) {
    (take_(numbers), ...);
  }
  Take take_;
};

// Reads the numbers of NumberWriter. After the first number that is missing or does not fit, ok() is false.
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
  void Read(Shared<T>& value) {
    T own;
    Read(own);
    value = std::move(own);
  }
  template <typename T>
  requires HasFields<T>
  void Read(T& value) {
    ForEachField<T>([&](const auto& field) { Read(field.Of(value)); });
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

}  // namespace

std::vector<NamedNumbers> NumbersOf(const SensorParameters& parameters) {
  std::vector<NamedNumbers> fields;
  std::visit(
      [&]<typename Kind>(const Kind& kind) {
        ForEachField<Kind>([&](const auto& field) {
          NamedNumbers& named = fields.emplace_back(NamedNumbers{std::string(field.name), {}});
          NumberWriter([&](double number) { named.numbers.push_back(number); }).Write(field.Of(kind));
        });
      },
      parameters);
  return fields;
}

Result<SensorParameters> ParametersFrom(std::string_view type, const std::vector<NamedNumbers>& fields) {
  std::optional<SensorParameters> parameters = DefaultParameters(type);
  if (!parameters) return Error{{}, "found a sensor of type '" + std::string(type) + "', expected a known one"};
  std::size_t next = 0;
  std::string wrong;
  const auto read = [&](const auto& field, auto& kind) {
    if (!wrong.empty()) return;
    if (next < fields.size() && fields[next].name == field.name) {
      NumberReader reader(fields[next].numbers);
      reader.Read(field.Of(kind));
      if (reader.ok() && reader.at_end()) {
        ++next;
        return;
      }
    }
    wrong = field.name;
  };
  std::visit([&]<typename Kind>(Kind& kind) { ForEachField<Kind>([&](const auto& field) { read(field, kind); }); },
             *parameters);
  if (wrong.empty() && next < fields.size()) wrong = fields[next].name;
  if (wrong.empty()) return *std::move(parameters);
  return Error{{}, "found a " + std::string(type) + " with a wrong field '" + wrong + "'"};
}

}  // namespace troupe::dds
