#include "common/base/json_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/base/text.h"

namespace troupe {
namespace {

std::string NumberIn(double min, double max) {
  const double infinity = std::numeric_limits<double>::infinity();
  if (min == -infinity && max == infinity) return "a number";
  if (max == infinity) return fmt::format("a number of at least {}", min);
  return fmt::format("a number between {} and {}", min, max);
}

}  // namespace

JsonReader::JsonReader(JsonTree tree, std::string subject)
    : shared_(std::make_shared<Shared>(Shared{std::move(tree), std::move(subject)})), node_(&shared_->tree.root()) {}

JsonReader JsonReader::OfText(std::string_view text, std::string subject, const JsonLimits& limits) {
  Result<JsonTree> tree = JsonTree::Parse(text, "", limits);
  if (tree.ok()) return JsonReader(std::move(tree).value(), std::move(subject));
  const Error& error = tree.error();
  JsonReader reader(JsonTree::Null(), std::move(subject));
  reader.FailWith(fmt::format("{}:{}: {}", error.where.line, error.where.column, error.message));
  return reader;
}

std::string JsonReader::AsPath(const char* preposition) const {
  std::string path;
  const JsonNode* around = nullptr;
  for (const JsonNode* const step : shared_->tree.PathTo(node_->span.begin)) {
    if (around != nullptr && around->is_array()) {
      path += fmt::format("[{}]", step - around->items.data());
    } else if (around != nullptr) {
      path += (path.empty() ? "" : ".") + step->key;
    }
    if (step == node_) break;
    around = step;
  }
  return path.empty() ? "" : fmt::format(" {} {}", preposition, Quoted(path, 100));
}

bool JsonReader::FailAt(const SourceLocation& where, const std::string& message) const {
  if (!ok()) return false;
  shared_->error = Error{where.file.empty() ? SourceLocation() : where,
                         shared_->subject.empty() ? message : shared_->subject + ": " + message};
  return false;
}

bool JsonReader::Fail(const std::string& expected) const {
  return FailWith("found " + Describe(*node_) + AsPath("as") + ", expected " + expected);
}

bool JsonReader::FailWith(const std::string& message) const {
  return FailAt(where(), message);
}

bool JsonReader::FailAtKey(const std::string& message) const {
  return FailAt(shared_->tree.WhereKey(*node_), message);
}

bool JsonReader::FailWithout(std::string_view key, const std::string& expected) const {
  return FailWith("found no " + Quoted(key) + AsPath("in") + ", expected " + expected);
}

std::optional<JsonReader> JsonReader::Find(std::string_view key) const {
  if (!node_->is_object()) {
    Fail("an object");
    return std::nullopt;
  }
  shared_->asked[node_->span.begin].emplace_back(key);
  const JsonNode* const found = node_->Find(key);
  return found != nullptr ? std::optional(JsonReader(shared_, *found)) : std::nullopt;
}

std::vector<JsonReader> JsonReader::Items(std::size_t most) const {
  std::vector<JsonReader> items;
  if (!node_->is_array()) {
    Fail("a list");
  } else if (node_->items.size() > most) {
    Fail(fmt::format("a list of at most {}", most));
  } else {
    for (const JsonNode& item : node_->items) items.push_back(JsonReader(shared_, item));
  }
  return items;
}

std::vector<JsonReader> JsonReader::Members() const {
  std::vector<JsonReader> members;
  if (!node_->is_object()) Fail("an object");
  if (!node_->is_object()) return members;
  for (const JsonNode& member : node_->items) {
    shared_->asked[node_->span.begin].push_back(member.key);
    members.push_back(JsonReader(shared_, member));
  }
  return members;
}

void JsonReader::RefuseOthers() const {
  if (!ok()) return;
  if (!node_->is_object()) return void(Fail("an object"));
  const std::vector<std::string>& asked = shared_->asked[node_->span.begin];
  for (const JsonNode& member : node_->items) {
    if (std::find(asked.begin(), asked.end(), member.key) != asked.end()) continue;
    FailAt(shared_->tree.WhereKey(member), UnknownKeyText(member.key, asked, AsPath("in")));
    return;
  }
}

std::optional<double> JsonReader::Number(double min, double max, const std::vector<NamedNumber>& names) const {
  std::vector<std::string> expected;
  if (min <= max) expected.push_back(NumberIn(min, max));
  for (const NamedNumber& named : names) {
    if (node_->is_string() && node_->text == named.name) return named.value;
    expected.push_back(fmt::format("\"{}\"", named.name));
  }
  if (node_->is_number() && node_->number >= min && node_->number <= max) return node_->number;
  Fail(fmt::format("{}", fmt::join(expected, " or ")));
  return std::nullopt;
}

bool JsonReader::ReadHash(std::string_view key, std::uint64_t& hash) const {
  const std::optional<JsonReader> member = Find(key);
  if (!member) return false;
  const std::string& digits = member->node().text;
  const char* const end = digits.data() + digits.size();
  const auto read = std::from_chars(digits.data(), end, hash, 16);
  if (member->node().is_string() && read.ec == std::errc() && read.ptr == end) return true;
  return member->Fail("a hash in hexadecimal digits");
}

std::optional<std::vector<double>> JsonReader::Numbers(std::size_t count, double most) const {
  std::vector<double> numbers;
  if (node_->is_array() && node_->items.size() == count) {
    for (const JsonNode& item : node_->items) {
      if (item.is_number() && std::fabs(item.number) <= most) numbers.push_back(item.number);
    }
  }
  if (numbers.size() == count) return numbers;
  Fail(fmt::format("a list of {} numbers from -{:g} to {:g}", count, most, most));
  return std::nullopt;
}

std::string UnknownKeyText(std::string_view key, std::vector<std::string> known, const std::string& place) {
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  const std::string list = known.empty() ? "none" : fmt::format("one of {}", fmt::join(known, ", "));
  return "found the key " + Quoted(key) + place + ", expected " + list + DidYouMean(key, known);
}

}  // namespace troupe
