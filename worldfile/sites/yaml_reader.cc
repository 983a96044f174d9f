#include "worldfile/sites/yaml_reader.h"

#include <yaml-cpp/depthguard.h>

#include <cmath>

namespace troupe {
namespace {

SourceLocation Place(const std::string& path, const YAML::Mark& mark) {
  if (mark.is_null()) return {path, 1, 1};
  return {path, mark.line + 1, mark.column + 1};
}

// What a value is, for messages.
std::string Found(const YAML::Node& node) {
  if (!node) return "nothing";
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      return Quoted(node.Scalar());
    case YAML::NodeType::Sequence:
      return "a list";
    case YAML::NodeType::Map:
      return "a map";
    default:
      return "nothing";
  }
}

}  // namespace

void YamlReader::Read(const std::string& text, const std::function<void(const YAML::Node& root)>& read) {
  try {
    const YAML::Node root = YAML::Load(text);
    if (!root.IsMap()) {
      diagnostics_.Fail(Place(path_, root.Mark()), "found no YAML map, expected keys such as 'levels'");
      return;
    }
    read(root);
  } catch (const YAML::DeepRecursion& exception) {
    diagnostics_.Fail(Place(path_, exception.mark), "found text nested too deeply, expected keys such as 'levels'");
  } catch (const YAML::Exception& exception) {
    diagnostics_.Fail(Place(path_, exception.mark),
                      "found text that is not YAML (" + exception.msg + "), expected YAML");
  }
}

SourceLocation YamlReader::At(const YAML::Node& node) const {
  return node ? Place(path_, node.Mark()) : SourceLocation{path_, 1, 1};
}

void YamlReader::Fail(const YAML::Node& node, const std::string& message) {
  diagnostics_.Fail(At(node), message);
}

void YamlReader::Warn(const YAML::Node& node, const std::string& message) {
  diagnostics_.Warn(At(node), message);
}

YAML::Node YamlReader::Find(const YAML::Node& map, const char* key) {
  if (!map || !map.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
  const YAML::Node found = map[key];
  return found ? found : YAML::Node(YAML::NodeType::Undefined);
}

YAML::Node YamlReader::Require(const YAML::Node& map, const char* key, const std::string& of) {
  const YAML::Node found = Find(map, key);
  if (!found) Fail(map, "found no key " + Quoted(key) + " in " + of + ", expected it");
  return found;
}

YAML::Node YamlReader::Parameter(const YAML::Node& map, const char* key) {
  const YAML::Node found = Find(map, key);
  if (!found || !found.IsSequence() || found.size() != 2) return found;
  return found[1];
}

void YamlReader::ForEachItem(const YAML::Node& list, const std::string& what,
                             const std::function<void(const YAML::Node&)>& visit) {
  if (!list || list.IsNull()) return;
  if (!list.IsSequence()) return Fail(list, "found " + Found(list) + " for " + what + ", expected a list");
  for (const YAML::Node& item : list) {
    if (failed()) return;
    visit(item);
  }
}

void YamlReader::ForEachEntry(const YAML::Node& map, const std::string& what,
                              const std::function<void(const std::string& key, const YAML::Node& value)>& visit) {
  if (!map || map.IsNull()) return;
  if (!map.IsMap()) return Fail(map, "found " + Found(map) + " for " + what + ", expected a map");
  for (const auto& entry : map) {
    if (failed()) return;
    visit(Text(entry.first, "a key of " + what), entry.second);
  }
}

bool YamlReader::HasItems(const YAML::Node& list, std::size_t least, const std::string& what) {
  if (list && list.IsSequence() && list.size() >= least) return true;
  const bool is_list = list && list.IsSequence();
  Fail(list, "found " + (is_list ? CountText(list.size(), "value") : Found(list)) + " for " + what +
                 ", expected a list of at least " + std::to_string(least));
  return false;
}

double YamlReader::Number(const YAML::Node& node, const std::string& what, double otherwise, double min, double max) {
  if (!node || node.IsNull()) return otherwise;
  const std::optional<LeadingNumber> number =
      node.IsScalar() ? ReadLeadingNumber(node.Scalar()) : std::optional<LeadingNumber>();
  if (!number || !number->is_all) {
    Fail(node, "found " + Found(node) + " for " + what + ", expected a number");
    return otherwise;
  }
  if (number->value >= min && number->value <= max) return number->value;
  Fail(node, "found " + NumberText(number->value) + " for " + what + ", expected " + NumberText(min) + " to " +
                 NumberText(max));
  return otherwise;
}

std::size_t YamlReader::Index(const YAML::Node& node, const std::string& what, std::size_t count) {
  const double number = Number(node, what, -1.0);
  if (failed()) return 0;
  if (number >= 0.0 && number < static_cast<double>(count) && number == std::floor(number)) {
    return static_cast<std::size_t>(number);
  }
  Fail(node, "found " + Found(node) + " for " + what + ", expected " +
                 (count == 0 ? "none: there are none" : "a number from 0 to " + std::to_string(count - 1)));
  return 0;
}

bool YamlReader::Flag(const YAML::Node& node, const std::string& what, bool otherwise) {
  if (!node || node.IsNull()) return otherwise;
  bool flag = false;
  if (node.IsScalar() && YAML::convert<bool>::decode(node, flag)) return flag;
  if (node.IsScalar() && (node.Scalar() == "0" || node.Scalar() == "1")) return node.Scalar() == "1";
  Fail(node, "found " + Found(node) + " for " + what + ", expected true or false");
  return otherwise;
}

std::string YamlReader::Text(const YAML::Node& node, const std::string& what, const std::string& otherwise) {
  if (!node || node.IsNull()) return otherwise;
  if (!node.IsScalar()) {
    Fail(node, "found " + Found(node) + " for " + what + ", expected a text");
    return otherwise;
  }
  if (IsPlainLine(node.Scalar())) return node.Scalar();
  Fail(node, "found a control character or a byte that is not UTF-8 in " + what + ", expected a line of text");
  return otherwise;
}

void YamlReader::WarnOfUnknownKeys(const YAML::Node& map, const std::string& what, const std::set<std::string>& known) {
  if (!map || !map.IsMap()) return;
  for (const auto& entry : map) {
    if (!entry.first.IsScalar() || known.contains(entry.first.Scalar())) continue;
    if (!warned_.insert(what + entry.first.Scalar()).second) continue;
    Warn(entry.first, "key " + Quoted(entry.first.Scalar()) + " of " + what + " has no effect");
  }
}

}  // namespace troupe
