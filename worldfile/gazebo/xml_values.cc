#include "worldfile/gazebo/xml_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

namespace troupe {
namespace {

// A number of a word; NaN for one that is none.
double WordNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double number = 0.0;
  const std::from_chars_result read = std::from_chars(word.data(), word.data() + word.size(), number);
  if (read.ptr != word.data() + word.size() || word.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (read.ec == std::errc::result_out_of_range) {
    // Beyond the numbers of a double, as 1e400; or below, as 1e-400.
    const bool is_small = word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
    return is_small ? 0.0 : word.front() == '-' ? -1e308 : 1e308;
  }
  return read.ec == std::errc() ? number : std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string_view> WordsOf(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  std::vector<std::string_view> words;
  for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string_view::npos;
       at = text.find_first_not_of(kBlanks, at)) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

}  // namespace

std::vector<double> XmlValues::Numbers(std::string_view text, const SourceLocation& where, const std::string& what,
                                       std::size_t count, double most) const {
  const std::vector<std::string_view> words = WordsOf(text);
  std::vector<double> numbers;
  for (const std::string_view word : words) {
    const double number = WordNumber(word);
    if (!(std::fabs(number) <= most)) {
      diagnostics_.Fail(where, "found " + Quoted(word) + " in " + Quoted(what) + ", expected a number" +
                                   (std::isfinite(number) ? " up to " + NumberText(most) : ""));
      return std::vector<double>(count, 0.0);
    }
    numbers.push_back(number);
  }
  if (numbers.size() != count) {
    diagnostics_.Fail(where, "found " + CountText(numbers.size(), "number") + " in " + Quoted(what) + ", expected " +
                                 std::to_string(count));
    numbers.resize(count, 0.0);
  }
  return numbers;
}

std::vector<double> XmlValues::Numbers(const XmlElement& element, const std::vector<double>& otherwise,
                                       double most) const {
  if (element.Trimmed().empty()) return otherwise;
  return Numbers(element.text, XmlTextPlace(element, file_), element.name, otherwise.size(), most);
}

double XmlValues::Number(const XmlElement& parent, std::string_view child, double otherwise, double most) const {
  const XmlElement* const element = parent.Find(child);
  if (element == nullptr || element->Trimmed().empty()) return otherwise;
  const double number = WordNumber(element->Trimmed());
  if (!std::isnan(number)) return std::clamp(number, -most, most);
  diagnostics_.Fail(XmlTextPlace(*element, file_),
                    "found " + Quoted(element->Trimmed()) + " in " + Quoted(element->name) + ", expected a number");
  return otherwise;
}

double XmlValues::FirstNumber(const XmlElement& parent, std::initializer_list<std::string_view> names,
                              double otherwise) const {
  for (const std::string_view name : names) {
    if (parent.Find(name) != nullptr) return Number(parent, name, otherwise);
  }
  return otherwise;
}

bool XmlValues::Flag(const XmlElement& parent, std::string_view child, bool otherwise) {
  const XmlElement* const element = parent.Find(child);
  if (element == nullptr || element->Trimmed().empty()) return otherwise;
  const std::string_view text = element->Trimmed();
  return text == "1" || text == "true" || text == "True" || text == "TRUE";
}

std::string XmlValues::Text(const XmlElement& parent, std::string_view child, const std::string& otherwise) {
  const XmlElement* const element = parent.Find(child);
  return element == nullptr ? otherwise : std::string(element->Trimmed());
}

std::string XmlValues::Attribute(const XmlElement& element, std::string_view name, const std::string& otherwise) {
  const std::string* const value = element.FindAttribute(name);
  return value == nullptr ? otherwise : *value;
}

double XmlValues::Size(const XmlElement& parent, std::string_view child, double otherwise) const {
  double size = otherwise;
  SourceLocation where = At(parent);
  if (const XmlElement* const element = parent.Find(child)) {
    size = Number(parent, child, otherwise);
    where = XmlTextPlace(*element, file_);
  } else {
    for (const XmlAttribute& attribute : parent.attributes) {
      if (attribute.name != child) continue;
      where = XmlPlace(attribute, file_);
      size = Numbers(attribute.value, where, attribute.name, 1).front();
    }
  }
  if (!(size > 0.0)) {
    diagnostics_.Fail(where, "found a " + Quoted(child) + " of " + NumberText(size) + ", expected more than 0");
    return otherwise;
  }
  return size;
}

Transform3 XmlValues::Pose(const XmlElement& pose) const {
  const bool is_quaternion = Attribute(pose, "rotation_format") == "quat_xyzw";
  if (is_quaternion) {
    const std::vector<double> n = Numbers(pose, {0, 0, 0, 0, 0, 0, 1});
    return Transform3::FromQuaternion({n[0], n[1], n[2]}, n[3], n[4], n[5], n[6]);
  }
  const std::string in_degrees = Attribute(pose, "degrees");
  const double unit = in_degrees == "true" || in_degrees == "1" ? kPi / 180.0 : 1.0;
  const std::vector<double> n = Numbers(pose, {0, 0, 0, 0, 0, 0});
  return Transform3::FromRpy({n[0], n[1], n[2]}, unit * n[3], unit * n[4], unit * n[5]);
}

std::vector<double> XmlValues::AttributeNumbers(const XmlElement& element, std::string_view name,
                                                const std::vector<double>& otherwise) const {
  for (const XmlAttribute& attribute : element.attributes) {
    if (attribute.name == name) {
      return Numbers(attribute.value, XmlPlace(attribute, file_), attribute.name, otherwise.size());
    }
  }
  return otherwise;
}

Transform3 XmlValues::Origin(const XmlElement& parent) const {
  const XmlElement* const origin = parent.Find("origin");
  if (origin == nullptr) return {};
  const std::vector<double> xyz = AttributeNumbers(*origin, "xyz", {0, 0, 0});
  const std::vector<double> rpy = AttributeNumbers(*origin, "rpy", {0, 0, 0});
  return Transform3::FromRpy({xyz[0], xyz[1], xyz[2]}, rpy[0], rpy[1], rpy[2]);
}

double XmlValues::AttributeNumber(const XmlElement& element, std::string_view name, double otherwise) const {
  const std::string* const text = element.FindAttribute(name);
  const std::vector<std::string_view> words = text != nullptr ? WordsOf(*text) : std::vector<std::string_view>();
  const double number = words.size() == 1 ? WordNumber(words.front()) : std::numeric_limits<double>::quiet_NaN();
  if (!std::isnan(number)) return std::clamp(number, -kMaxMagnitude, kMaxMagnitude);
  return AttributeNumbers(element, name, {otherwise}).front();
}

}  // namespace troupe
