#include "testing/cases/variation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "troupe/random.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::uint64_t kDrawStream = 0x6361'7365'7300;  // separates draws of cases from other uses of a seed
constexpr double kMaxValues = 1e9;
constexpr int kMaxNormalDraws = 1000;  // of a normal number until one is within the bounds

constexpr int kDigits = 6;  // of a random number, unless its bounds need more

// One place for a number's text: a draw is what its text says.
std::string ShortNumber(double number, int digits = kDigits) {
  return number == 0.0 ? "0" : fmt::format("{:.{}g}", number, digits);
}

}  // namespace

std::string CaseText(const TestCase& draws) {
  std::string text;
  for (const DrawnValue& draw : draws) text += (text.empty() ? "" : ",") + draw.path + "=" + draw.value;
  return text;
}

double NumberIn(const std::string& json) {
  const std::optional<LeadingNumber> number = ReadLeadingNumber(json);
  return number ? number->value : 0.0;
}

namespace {

// The end of the value that begins at text[begin]: a comma outside of texts and brackets, or the end of the text.
std::size_t EndOfValue(std::string_view text, std::size_t begin) {
  std::size_t end = begin;
  int depth = 0;
  for (bool quoted = false; end < text.size() && (quoted || depth > 0 || text[end] != ','); ++end) {
    const char c = text[end];
    if (quoted && c == '\\') {
      ++end;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && (c == '[' || c == '{')) {
      ++depth;
    } else if (!quoted && (c == ']' || c == '}')) {
      --depth;
    }
  }
  return std::min(end, text.size());
}

}  // namespace

Result<TestCase> ParseCase(std::string_view text) {
  TestCase draws;
  std::vector<ValuePath> paths;
  const auto fail = [&](std::size_t at, const std::string& message) {
    return Error{{}, fmt::format("--case: column {}: {}", at + 1, message)};
  };
  if (const std::size_t bad = FindInvalidUtf8(text); bad != std::string::npos) {
    return fail(bad, fmt::format("found the byte 0x{:02x}, expected UTF-8", static_cast<unsigned char>(text[bad])));
  }
  // A reader of JSON takes it for the end of a value.
  if (const std::size_t end = text.find('\0'); end != std::string::npos)
    return fail(end, "found the byte 0x00, expected text");
  for (std::size_t i = 0; i < text.size();) {
    std::size_t size = 0;
    Result<ValuePath> path = ValuePath::ParseBeforeEquals(text.substr(i), size);
    if (!path.ok()) return fail(i + static_cast<std::size_t>(path.error().where.column) - 1, path.error().message);
    const std::size_t equals = i + size;
    if (equals >= text.size()) return fail(i, fmt::format("found {}, expected NAME=VALUE", Quoted(text.substr(i))));
    const std::string& name = path.value().text();
    const std::size_t end = EndOfValue(text, equals + 1);
    const std::string value(text.substr(equals + 1, end - equals - 1));
    if (value.empty()) return fail(equals + 1, fmt::format("found no value of {}, expected one", Quoted(name)));
    if (nlohmann::json::accept(value)) {
      draws.push_back({name, nlohmann::json::parse(value).is_number() ? value : nlohmann::json::parse(value).dump()});
    } else if (value.find_first_of("\"[]{}\\") == std::string::npos) {
      draws.push_back({name, nlohmann::json(value).dump()});
    } else {
      return fail(equals + 1, fmt::format("found {}, expected a JSON value or a word", Quoted(value)));
    }
    if (std::find(paths.begin(), paths.end(), path.value()) != paths.end()) {
      return fail(i, fmt::format("found {} again, expected one value of it", Quoted(name)));
    }
    paths.push_back(std::move(path).value());
    i = end + 1;
  }
  return draws;
}

Result<Variation> Variation::Read(const JsonTree& tree, const JsonNode& entry, ValuePath path) {
  Variation variation(std::move(path));
  variation.where_ = tree.WhereKey(entry);
  const JsonNode* const listed = entry.is_array() ? &entry : entry.Find("values");
  const auto count = [&](const char* key) { return entry.is_object() && entry.Find(key) != nullptr ? 1 : 0; };
  const int kinds = (listed != nullptr ? 1 : 0) + count("range") + count("uniform") + count("normal");
  if (kinds != 1) {
    return tree.ErrorAt(entry, fmt::format("found {} of 'values', 'range', 'uniform' and 'normal', expected one",
                                           kinds == 0 ? "none" : "several"));
  }
  if (listed != nullptr) {
    if (listed->items.empty()) return tree.ErrorAt(*listed, "found no value, expected at least one");
    for (const JsonNode& item : listed->items) variation.values_.push_back(ToJson(item).dump());
    return variation;
  }
  const auto bounds = [&](const JsonNode& pair) -> Status {
    variation.from_ = pair.items[0].number;
    variation.to_ = pair.items[1].number;
    if (variation.from_ <= variation.to_) return {};
    return tree.ErrorAt(pair.items[1], fmt::format("found {}, expected at least {}, the number before it",
                                                   pair.items[1].text, pair.items[0].text));
  };
  const auto size = [&](const JsonNode& numbers, std::size_t least, std::size_t most, const char* form) -> Status {
    if (numbers.items.size() >= least && numbers.items.size() <= most) return {};
    return tree.ErrorAt(numbers, fmt::format("found {}, expected {}", CountText(numbers.items.size(), "number"), form));
  };
  if (const JsonNode* const within = entry.Find("within")) {
    if (entry.Find("normal") == nullptr) {
      return tree.ErrorAt(*within, "found 'within' without 'normal', expected it beside 'normal' only");
    }
  }
  if (const JsonNode* const range = entry.Find("range")) {
    variation.kind_ = Kind::kRange;
    if (Status error = size(*range, 2, 3, "[from, to] or [from, to, step]"); !error.ok()) return error.error();
    if (Status error = bounds(*range); !error.ok()) return error.error();
    if (range->items.size() == 3) variation.step_ = range->items[2].number;
    if (!(variation.step_ > 0.0)) {
      return tree.ErrorAt(range->items[2],
                          fmt::format("found the step {}, expected one above 0", range->items[2].text));
    }
    if ((variation.to_ - variation.from_) / variation.step_ >= kMaxValues) {
      return tree.ErrorAt(*range, "found a range of more than 1000000000 values, expected a greater step");
    }
  } else if (const JsonNode* const uniform = entry.Find("uniform")) {
    variation.kind_ = Kind::kUniform;
    if (Status error = size(*uniform, 2, 2, "[from, to]"); !error.ok()) return error.error();
    if (Status error = bounds(*uniform); !error.ok()) return error.error();
  } else {
    const JsonNode& normal = entry.Member("normal");
    variation.kind_ = Kind::kNormal;
    if (Status error = size(normal, 2, 2, "[mean, deviation]"); !error.ok()) return error.error();
    variation.mean_ = normal.items[0].number;
    variation.deviation_ = normal.items[1].number;
    if (!(variation.deviation_ >= 0.0)) {
      return tree.ErrorAt(normal.items[1],
                          fmt::format("found the deviation {}, expected at least 0", normal.items[1].text));
    }
    variation.from_ = variation.mean_ - 6.0 * variation.deviation_;
    variation.to_ = variation.mean_ + 6.0 * variation.deviation_;
    if (const JsonNode* const within = entry.Find("within")) {
      if (Status error = size(*within, 2, 2, "[from, to]"); !error.ok()) return error.error();
      if (Status error = bounds(*within); !error.ok()) return error.error();
    }
  }
  return variation;
}

Variation Variation::Of(ValuePath path, std::string value) {
  Variation fixed(std::move(path));
  fixed.values_ = {std::move(value)};
  return fixed;
}

std::uint64_t Variation::size() const {
  if (kind_ == Kind::kValues) return values_.size();
  if (kind_ != Kind::kRange) return 0;
  // The end is in the range although steps such as 0.1 are not exact.
  return static_cast<std::uint64_t>(std::floor((to_ - from_) / step_ + 1e-9)) + 1;
}

std::string Variation::NumberText(double number) const {
  if (kind_ != Kind::kRange) {
    // Rounding may leave the bounds; all digits of a number between them do not.
    constexpr int kAllDigits = 17;
    for (int digits = kDigits; digits < kAllDigits; ++digits) {
      std::string text = ShortNumber(number, digits);
      if (Contains(text)) return text;
    }
    return ShortNumber(number, kAllDigits);
  }
  // A range of whole numbers has whole numbers; others are rounded, so that 0.1 + 2 * 0.1 is 0.3.
  const bool whole = std::floor(from_) == from_ && std::floor(step_) == step_ && std::abs(number) < 9e15;
  return whole ? fmt::format("{}", static_cast<std::int64_t>(number)) : fmt::format("{:.12g}", number);
}

std::string Variation::At(std::uint64_t index) const {
  if (kind_ == Kind::kValues) return values_[index];
  return NumberText(from_ + static_cast<double>(index) * step_);
}

std::string Variation::Draw(std::uint64_t key, std::uint64_t counter) const {
  if (const std::uint64_t values = size(); values > 0) return At(RandomBits({kDrawStream, key, counter}) % values);
  if (kind_ == Kind::kUniform) {
    return NumberText(from_ + (to_ - from_) * RandomUniform({kDrawStream, key, counter}));
  }
  for (std::uint64_t i = 0; i < kMaxNormalDraws; ++i) {
    const double number = mean_ + deviation_ * RandomNormal({kDrawStream, key, counter, i});
    if (from_ <= number && number <= to_) return NumberText(number);
  }
  // The bounds leave almost no probability: a fixed value within them rather than an endless loop.
  return NumberText(std::clamp(mean_, from_, to_));
}

std::optional<Interval> Variation::NumberBounds() const {
  if (kind_ != Kind::kValues) {
    // Six digits of a bound may round it outwards.
    const double tolerance = kind_ == Kind::kRange ? 0.0 : 1e-5 * std::max(std::abs(from_), std::abs(to_));
    const double last = kind_ == Kind::kRange ? NumberIn(At(size() - 1)) : to_;
    return Interval{from_ - tolerance, last + tolerance};
  }
  std::optional<Interval> bounds;
  for (const std::string& value : values_) {
    const std::optional<LeadingNumber> number = ReadLeadingNumber(value);
    if (!number || !number->is_all) return std::nullopt;
    if (!bounds) bounds = {number->value, number->value};
    bounds = Interval{std::min(bounds->min, number->value), std::max(bounds->max, number->value)};
  }
  return bounds;
}

bool Variation::Contains(const std::string& value) const {
  if (kind_ == Kind::kValues) return std::find(values_.begin(), values_.end(), value) != values_.end();
  const std::optional<LeadingNumber> number = ReadLeadingNumber(value);
  if (!number || !number->is_all) return false;
  if (!(from_ <= number->value && number->value <= to_)) return false;
  if (kind_ != Kind::kRange) return true;
  const double steps = (number->value - from_) / step_;
  return std::abs(steps - std::round(steps)) < 1e-6;
}

std::vector<std::string> Variation::SimplerThan(const std::string& value) const {
  std::vector<std::string> simpler;
  const auto add = [&](std::string text) {
    if (text != value && Contains(text) && std::find(simpler.begin(), simpler.end(), text) == simpler.end()) {
      simpler.push_back(std::move(text));
    }
  };
  const double number = NumberIn(value);
  if (kind_ == Kind::kValues) {
    std::vector<std::string> before = values_;
    const auto is_number = [](const std::string& text) { return nlohmann::json::parse(text).is_number(); };
    if (std::all_of(before.begin(), before.end(), is_number)) {
      std::stable_sort(before.begin(), before.end(), [](const std::string& a, const std::string& b) {
        return std::abs(NumberIn(a)) < std::abs(NumberIn(b));
      });
    }
    for (const std::string& text : before) {
      if (text == value) break;
      add(text);
    }
  } else if (kind_ == Kind::kRange) {
    const auto index = static_cast<std::uint64_t>(std::llround((number - from_) / step_));
    add(At(0));
    // Bisection towards the lower end: a few runs instead of one for each value.
    for (std::uint64_t part = index / 2; part > 0; part /= 2) add(At(index - part));
    if (index > 0) add(At(index - 1));
  } else {
    for (const double whole : {0.0, 1.0, from_, std::round(number)}) add(NumberText(whole));
    for (int digits = 1; digits < 6; ++digits) {
      std::string rounded = fmt::format("{:.{}g}", number, digits);
      if (rounded.size() < value.size()) add(ShortNumber(NumberIn(rounded)));
    }
  }
  return simpler;
}

std::string Variation::Near(const std::string& value, double amount, std::uint64_t key, std::uint64_t counter) const {
  if (kind_ == Kind::kValues) {
    return RandomUniform({kDrawStream, key, counter, 1}) < amount ? Draw(key, counter) : value;
  }
  const double number = NumberIn(value) + amount * (to_ - from_) * RandomNormal({kDrawStream, key, counter, 2});
  if (kind_ != Kind::kRange) return NumberText(std::clamp(number, from_, to_));
  const double last = static_cast<double>(size() - 1);
  double index = std::clamp(std::round((number - from_) / step_), 0.0, last);
  std::string near = At(static_cast<std::uint64_t>(index));
  if (near != value) return near;
  index += RandomUniform({kDrawStream, key, counter, 3}) < 0.5 ? -1.0 : 1.0;
  return At(static_cast<std::uint64_t>(std::clamp(index, 0.0, last)));
}

std::string Variation::Describe() const {
  switch (kind_) {
    case Kind::kValues: {
      std::string list;
      constexpr std::size_t kMax = 8;
      for (std::size_t i = 0; i < std::min(values_.size(), kMax); ++i) list += (i > 0 ? ", " : "") + values_[i];
      if (values_.size() > kMax) list += fmt::format(", ... ({} values)", values_.size());
      return "one of " + list;
    }
    case Kind::kRange: {
      const std::string steps = step_ == 1.0 ? "" : fmt::format(" in steps of {:.12g}", step_);
      return fmt::format("{} to {}{}", At(0), At(size() - 1), steps);
    }
    case Kind::kUniform:
      return fmt::format("a number of {:.6g} to {:.6g}", from_, to_);
    case Kind::kNormal:
      return fmt::format("a number of normal distribution, mean {:.6g}, deviation {:.6g}", mean_, deviation_);
  }
  return "";
}

}  // namespace troupe
