#include "robot-agent/controller/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace troupe {
namespace {

using nlohmann::json;

// A value for a message: one line of at most 40 characters.
std::string Shown(const json& value) {
  if (value.is_structured()) return value.is_object() ? "an object" : "a list";
  std::string text = value.dump(-1, ' ', true, json::error_handler_t::replace);
  if (text.size() > 40) text = text.substr(0, 37) + "...";
  return text;
}

std::string Expected(const Interval& allowed) {
  const double infinity = std::numeric_limits<double>::infinity();
  if (allowed.min == -infinity && allowed.max == infinity) return "a number";
  if (allowed.max == infinity) return fmt::format("a number of at least {}", allowed.min);
  return fmt::format("a number between {} and {}", allowed.min, allowed.max);
}

}  // namespace

Parameters::Parameters(std::string place, const std::string& text)
    : place_(std::move(place)), object_(std::make_unique<json>(json::parse(text, nullptr, false))) {
  if (object_->is_discarded()) {
    *object_ = json::object();
    Fail("the parameters are not JSON");
  } else if (!object_->is_object()) {
    const std::string found = Shown(*object_);
    *object_ = json::object();
    Fail(fmt::format("found {} as parameters, expected a JSON object", found));
  }
}

Parameters::Parameters(std::string place, const json& object)
    : place_(std::move(place)), object_(std::make_unique<json>(object)) {
  if (!object.is_object()) {
    *object_ = json::object();
    Fail(fmt::format("found {}, expected a JSON object", Shown(object)));
  }
}

Parameters::~Parameters() = default;

std::optional<double> Parameters::ReadNumber(const char* key, const Interval& allowed) {
  return ReadNumberOrName(key, allowed, {});
}

std::optional<double> Parameters::ReadNumberOrName(const char* key, const Interval& allowed,
                                                   const std::vector<NamedNumber>& names) {
  const json* found = Find(key);
  if (found == nullptr) return std::nullopt;
  std::vector<std::string> expected;
  if (allowed.min <= allowed.max) expected.push_back(Expected(allowed));
  for (const NamedNumber& named : names) {
    if (found->is_string() && *found == named.name) return named.value;
    expected.push_back(fmt::format("\"{}\"", named.name));
  }
  const double number = found->is_number() ? found->get<double>() : std::nan("");
  if (std::isfinite(number) && number >= allowed.min && number <= allowed.max) return number;
  Fail(fmt::format("'{}' is {}, expected {}", key, Shown(*found), fmt::join(expected, " or ")));
  return std::nullopt;
}

std::optional<bool> Parameters::ReadBool(const char* key) {
  const json* found = Find(key);
  if (found == nullptr) return std::nullopt;
  if (found->is_boolean()) return found->get<bool>();
  Fail(fmt::format("'{}' is {}, expected true or false", key, Shown(*found)));
  return std::nullopt;
}

std::vector<json> Parameters::ReadArray(const char* key) {
  const json* found = Find(key);
  if (found == nullptr) return {};
  if (found->is_array()) return *found;
  Fail(fmt::format("'{}' is {}, expected a list", key, Shown(*found)));
  return {};
}

std::vector<std::pair<std::string, json>> Parameters::ReadObject(const char* key) {
  const json* found = Find(key);
  if (found == nullptr) return {};
  std::vector<std::pair<std::string, json>> members;
  if (!found->is_object()) {
    Fail(fmt::format("'{}' is {}, expected an object", key, Shown(*found)));
    return members;
  }
  for (const auto& [name, value] : found->items()) members.emplace_back(name, value);
  return members;
}

void Parameters::Fail(const std::string& message) {
  if (!error_) error_ = place_ + ": " + message;
}

Status Parameters::Finish() {
  for (const auto& [key, value] : object_->items()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    std::sort(known_.begin(), known_.end());
    Fail(fmt::format("unknown parameter {}, expected {}", Shown(json(key)),
                     known_.empty() ? "none" : fmt::format("one of: {}", fmt::join(known_, ", "))));
  }
  return status();
}

const json* Parameters::Find(const char* key) {
  known_.emplace_back(key);
  const auto found = object_->find(key);
  return found == object_->end() ? nullptr : &*found;
}

}  // namespace troupe
