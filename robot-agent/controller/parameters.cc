#include "troupe/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/base/json.h"
#include "common/base/text.h"
#include "robot-agent/controller/built_in.h"

namespace troupe {
namespace {

using nlohmann::json;

// A value for a message: one line of at most 40 characters.
std::string Shown(const json& value) {
  if (value.is_structured()) return value.is_object() ? "an object" : "a list";
  std::string text = JsonText(value, {.ascii = true});
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

struct Parameters::Content {
  // Null if the key is missing.
  const json* Find(const char* key) {
    known.emplace_back(key);
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
  }

  std::string place;
  json object = json::object();
  std::vector<std::string> known = {};  // keys that were read
  std::optional<std::string> error = {};
};

Parameters::Parameters(std::string place, const std::string& text)
    : content_(std::make_unique<Content>(Content{std::move(place)})) {
  json parsed = json::parse(text, nullptr, false);
  if (parsed.is_discarded()) {
    Fail("the parameters are not JSON");
  } else if (!parsed.is_object()) {
    Fail(fmt::format("found {} as parameters, expected a JSON object", Shown(parsed)));
  } else {
    content_->object = std::move(parsed);
  }
}

Parameters::Parameters(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Parameters::~Parameters() = default;

std::optional<double> Parameters::ReadNumber(const char* key, const Interval& allowed) {
  return ReadNumberOrName(key, allowed, {});
}

std::optional<double> Parameters::ReadNumberOrName(const char* key, const Interval& allowed,
                                                   const std::vector<NamedNumber>& names) {
  const json* found = content_->Find(key);
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
  const json* found = content_->Find(key);
  if (found == nullptr) return std::nullopt;
  if (found->is_boolean()) return found->get<bool>();
  Fail(fmt::format("'{}' is {}, expected true or false", key, Shown(*found)));
  return std::nullopt;
}

std::optional<std::string> Parameters::ReadText(const char* key) {
  const json* found = content_->Find(key);
  if (found == nullptr) return std::nullopt;
  if (found->is_string()) return found->get<std::string>();
  Fail(fmt::format("'{}' is {}, expected a text", key, Shown(*found)));
  return std::nullopt;
}

void Parameters::Fail(const std::string& message) {
  if (!content_->error) content_->error = content_->place + ": " + message;
}

Status Parameters::status() const {
  return content_->error ? Status(Error{{}, *content_->error}) : Status();
}

Status Parameters::Finish() {
  std::vector<std::string>& known = content_->known;
  for (const auto& [key, value] : content_->object.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::sort(known.begin(), known.end());
    Fail(fmt::format("unknown parameter {}, expected {}{}", Shown(json(key)),
                     known.empty() ? "none" : fmt::format("one of: {}", fmt::join(known, ", ")),
                     DidYouMean(key, known)));
  }
  return status();
}

NestedParameters::NestedParameters(std::string place, const json& object)
    : Parameters(std::make_unique<Content>(Content{std::move(place)})) {
  if (object.is_object()) {
    content_->object = object;
  } else {
    Fail(fmt::format("found {}, expected a JSON object", Shown(object)));
  }
}

std::vector<json> NestedParameters::ReadArray(const char* key) {
  const json* found = content_->Find(key);
  if (found == nullptr) return {};
  if (found->is_array()) return *found;
  Fail(fmt::format("'{}' is {}, expected a list", key, Shown(*found)));
  return {};
}

std::vector<std::pair<std::string, json>> NestedParameters::ReadObject(const char* key) {
  const json* found = content_->Find(key);
  if (found == nullptr) return {};
  std::vector<std::pair<std::string, json>> members;
  if (!found->is_object()) {
    Fail(fmt::format("'{}' is {}, expected an object", key, Shown(*found)));
    return members;
  }
  for (const auto& [name, value] : found->items()) members.emplace_back(name, value);
  return members;
}

std::optional<json> NestedParameters::ReadAny(const char* key) {
  const json* found = content_->Find(key);
  return found != nullptr ? std::optional<json>(*found) : std::nullopt;
}

}  // namespace troupe
