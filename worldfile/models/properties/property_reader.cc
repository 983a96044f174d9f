#include "worldfile/models/properties/property_reader.h"

#include <algorithm>
#include <cmath>

#include "troupe/deterministic_math.h"
#include "worldfile/text/number_text.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

std::string TextOf(const Value::Scalar& scalar) {
  if (const auto* number = std::get_if<Value::Number>(&scalar)) return number->text;
  return std::get<std::string>(scalar);
}

// A property is one or several scalars, as in Stage: a tuple of one is the same as the one.
std::vector<Value::Scalar> ScalarsOf(const Value& value) {
  if (const auto* tuple = std::get_if<std::vector<Value::Scalar>>(&value.content)) return *tuple;
  if (const auto* number = std::get_if<Value::Number>(&value.content)) return {*number};
  return {std::get<std::string>(value.content)};
}

char LowerCase(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

// Of a word for yes or no.
std::optional<bool> FlagOf(std::string text) {
  for (char& c : text) c = LowerCase(c);
  if (text == "true" || text == "yes" || text == "on") return true;
  if (text == "false" || text == "no" || text == "off") return false;
  return std::nullopt;
}

}  // namespace

bool IsWithinReach(const Pose& pose) {
  return std::max({std::fabs(pose.x), std::fabs(pose.y), std::fabs(pose.z)}) <= kMaxMagnitude;
}

bool EqualInAnyCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return LowerCase(x) == LowerCase(y); });
}

double Units::Angle(double value) const {
  return degrees ? DegreesToRadians(value) : value;
}

PropertyReader::PropertyReader(const WorldNode& node, const Units& units, Diagnostics& diagnostics)
    : node_(node), units_(units), diagnostics_(diagnostics), used_(node.properties.size()) {}

const Property* PropertyReader::Use(const std::string& name) {
  const Property* property = node_.Find(name);
  if (property != nullptr) used_[static_cast<std::size_t>(property - node_.properties.data())] = true;
  return property;
}

const SourceLocation& PropertyReader::Where(const std::string& name) const {
  const Property* property = node_.Find(name);
  return property != nullptr ? property->value.where : node_.where;
}

// Nothing after a text without a number.
std::optional<double> PropertyReader::ToNumber(const Property& property, const Value::Scalar& scalar, double limit) {
  double value = 0.0;
  if (const auto* number = std::get_if<Value::Number>(&scalar)) {
    value = number->value;
  } else {
    const std::string& text = std::get<std::string>(scalar);
    const std::optional<LeadingNumber> leading = ReadLeadingNumber(text);
    const std::optional<bool> flag = leading ? std::nullopt : FlagOf(text);
    if (!leading && !flag) return std::nullopt;
    value = leading ? leading->value : *flag ? 1.0 : 0.0;
    if (!leading || !leading->is_all) WarnOfValue(property, "string " + Quoted(text), "a number", NumberText(value));
  }
  if (std::fabs(value) <= limit) return value;
  const double nearest = std::copysign(limit, value);
  WarnOfValue(property, Quoted(TextOf(scalar)), "a number of at most " + NumberText(limit), NumberText(nearest));
  return nearest;
}

void PropertyReader::WarnOfValue(const Property& property, const std::string& found, const std::string& expected,
                                 const std::string& used) {
  diagnostics_.Warn(property.value.where, "found " + found + " for " + Quoted(property.name) + ", expected " +
                                              expected + "; " + used + " is used");
}

std::optional<std::vector<double>> PropertyReader::Numbers(const std::string& name, std::size_t count, double limit) {
  const Property* property = Use(name);
  if (property == nullptr) return std::nullopt;
  const std::vector<Value::Scalar> scalars = ScalarsOf(property->value);
  if (scalars.size() < count) {
    diagnostics_.Fail(property->value.where, "found " + CountText(scalars.size(), "value") + " for " + Quoted(name) +
                                                 ", expected " + std::to_string(count));
    return std::nullopt;
  }
  if (scalars.size() > count) {
    diagnostics_.Warn(property->value.where, "found " + CountText(scalars.size(), "value") + " for " + Quoted(name) +
                                                 ", expected " + std::to_string(count) + "; the rest is ignored");
  }
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<double> number = ToNumber(*property, scalars[i], limit);
    // Of several the text counts as 0, as in Stage, so that the others keep their meaning.
    if (!number)
      WarnOfValue(*property, "string " + Quoted(TextOf(scalars[i])), "a number", count == 1 ? "the default" : "0");
    if (!number && count == 1) return std::nullopt;
    numbers.push_back(number.value_or(0.0));
  }
  return numbers;
}

double PropertyReader::Number(const std::string& name, double otherwise, double min, double max) {
  const std::optional<std::vector<double>> numbers = Numbers(name, 1, std::max(kMaxMagnitude, max));
  if (!numbers) return otherwise;
  const double value = numbers->front();
  if (value >= min && value <= max) return value;
  // A lower limit above 0 is there because 0 makes no sense; it makes hardly more.
  const double nearest = value > max ? max : min > 0.0 ? otherwise : min;
  WarnOfValue(*node_.Find(name), NumberText(value), NumberText(min) + " to " + NumberText(max), NumberText(nearest));
  return nearest;
}

double PropertyReader::Length(const std::string& name, double otherwise) {
  const std::optional<std::vector<double>> numbers = Numbers(name, 1);
  return numbers ? numbers->front() * units_.length : otherwise;
}

std::int64_t PropertyReader::Integer(const std::string& name, std::int64_t otherwise, std::int64_t min,
                                     std::int64_t max) {
  const std::optional<std::vector<double>> numbers =
      Numbers(name, 1, std::max(kMaxMagnitude, static_cast<double>(max)));
  if (!numbers) return otherwise;
  const double whole = std::trunc(numbers->front());
  if (whole != numbers->front()) {
    diagnostics_.Warn(Where(name), "found " + NumberText(numbers->front()) + " for " + Quoted(name) +
                                       ", expected a whole number; " + NumberText(whole) + " is used");
  }
  if (whole >= static_cast<double>(min) && whole <= static_cast<double>(max)) return static_cast<std::int64_t>(whole);
  const std::int64_t nearest = whole < static_cast<double>(min) ? min : max;
  WarnOfValue(*node_.Find(name), NumberText(whole), std::to_string(min) + " to " + std::to_string(max),
              std::to_string(nearest));
  return nearest;
}

bool PropertyReader::Flag(const std::string& name, bool otherwise) {
  const std::optional<std::vector<double>> numbers = Numbers(name, 1);
  return numbers ? std::trunc(numbers->front()) != 0.0 : otherwise;
}

std::vector<std::string> PropertyReader::Texts(const std::string& name) {
  const Property* property = Use(name);
  std::vector<std::string> texts;
  if (property == nullptr) return texts;
  for (const Value::Scalar& scalar : ScalarsOf(property->value)) texts.push_back(TextOf(scalar));
  return texts;
}

std::string PropertyReader::Text(const std::string& name, const std::string& otherwise) {
  const Property* property = Use(name);
  if (property == nullptr) return otherwise;
  const std::vector<std::string> texts = Texts(name);
  if (texts.size() == 1) return texts.front();
  diagnostics_.Warn(property->value.where, "found " + CountText(texts.size(), "value") + " for " + Quoted(name) +
                                               ", expected one string; " +
                                               (texts.empty() ? "the default" : "the first") + " is used");
  return texts.empty() ? otherwise : texts.front();
}

std::string PropertyReader::Word(const std::string& name, std::span<const std::string_view> words) {
  const std::string text = Text(name, std::string(words.front()));
  const auto same = [&text](std::string_view word) { return EqualInAnyCase(word, text); };
  const auto found = std::find_if(words.begin(), words.end(), same);
  if (found != words.end() && *found == text) return text;
  const std::string_view nearest = found != words.end() ? *found : words.front();
  std::string expected;
  for (std::size_t i = 0; i < words.size(); ++i) {
    expected += (i == 0 ? "" : i + 1 < words.size() ? ", " : " or ") + ('"' + std::string(words[i]) + '"');
  }
  WarnOfValue(*node_.Find(name), Quoted(text), expected, Quoted(nearest));
  return std::string(nearest);
}

std::optional<Pose> PropertyReader::ReadPose(const std::string& name) {
  const std::optional<std::vector<double>> numbers = Numbers(name, 4);
  if (!numbers) return std::nullopt;
  const std::vector<double>& n = *numbers;
  return Pose{n[0] * units_.length, n[1] * units_.length, n[2] * units_.length, WrapAngle(units_.Angle(n[3]))};
}

std::vector<const Property*> PropertyReader::Unused() const {
  std::vector<const Property*> unused;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (!used_[i]) unused.push_back(&node_.properties[i]);
  }
  return unused;
}

}  // namespace troupe
