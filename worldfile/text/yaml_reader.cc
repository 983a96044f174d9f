#include "worldfile/text/yaml_reader.h"

#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

namespace troupe {
namespace {

const YamlNode kMissing;

// What a value is, for messages.
std::string Found(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kScalar:
      return Quoted(node.text);
    case YamlNode::Kind::kList:
      return "a list";
    case YamlNode::Kind::kMap:
      return "a map";
    case YamlNode::Kind::kMissing:
    case YamlNode::Kind::kNull:
      break;
  }
  return "nothing";
}

// A fault that is none of the language's.
struct RefusedYaml : YAML::ParserException {
  using YAML::ParserException::ParserException;
};

// Makes the nodes of a document. Throws RefusedYaml.
class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(std::deque<YamlNode>& nodes) : nodes_(nodes) {}

  const YamlNode& root() const { return *root_; }
  // The keys that a map has again.
  const std::vector<const YamlNode*>& repeated() const { return repeated_; }

  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    AddScalar(YamlNode::Kind::kNull, mark, anchor, "");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                const std::string& text) override {
    AddScalar(YamlNode::Kind::kScalar, mark, anchor, text);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    // An anchor is known when its value is closed: an alias inside its own value finds none.
    if (found == anchors_.end()) throw RefusedYaml(mark, "found a value that contains itself, expected an end of it");
    // The alias costs no memory, but every visit of a reader costs time: the "billion laughs" text of nine lines must
    // fail here.
    Count(found->second.size, mark);
    Attach(*found->second.node);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    Open(YamlNode::Kind::kList, mark, anchor);
  }
  void OnSequenceEnd() override { Close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    Open(YamlNode::Kind::kMap, mark, anchor);
  }
  void OnMapEnd() override {
    DropRepeatedKeys(*open_.back().node);
    Close();
  }

 private:
  // Of a value with all that it has inside, aliases as copies.
  struct Size {
    std::size_t values = 0;
    std::size_t bytes = 0;
  };
  struct Anchor {
    const YamlNode* node = nullptr;
    Size size;
  };
  struct OpenNode {
    YamlNode* node = nullptr;
    YAML::anchor_t anchor = 0;
    Size before;  // the size of all values before it
  };

  void Count(const Size& size, const YAML::Mark& mark) {
    size_.values += size.values;
    size_.bytes += size.bytes;
    if (size_.values > YamlReader::kMaxValues) {
      throw RefusedYaml(mark, "found more values, with those that aliases repeat, expected at most " +
                                  std::to_string(YamlReader::kMaxValues));
    }
    if (size_.bytes > YamlReader::kMaxBytes) {
      throw RefusedYaml(mark, "found more text, with that which aliases repeat, expected at most " +
                                  std::to_string(YamlReader::kMaxBytes) + " bytes");
    }
  }

  YamlNode& Make(YamlNode::Kind kind, const YAML::Mark& mark) {
    YamlNode& node = nodes_.emplace_back();
    node.kind = kind;
    node.line = mark.line + 1;
    node.column = mark.column + 1;
    return node;
  }
  void Attach(const YamlNode& node) {
    if (open_.empty()) {
      root_ = &node;
    } else {
      open_.back().node->items.push_back(&node);
    }
  }
  void AddScalar(YamlNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor, const std::string& text) {
    const Size size{1, text.size()};
    Count(size, mark);
    YamlNode& node = Make(kind, mark);
    node.text = text;
    if (anchor != 0) anchors_[anchor] = {&node, size};
    Attach(node);
  }
  void Open(YamlNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    open_.push_back({&Make(kind, mark), anchor, size_});
    Count({1, 0}, mark);
  }
  void Close() {
    const OpenNode closed = open_.back();
    open_.pop_back();
    const Size size{size_.values - closed.before.values, size_.bytes - closed.before.bytes};
    if (closed.anchor != 0) anchors_[closed.anchor] = {closed.node, size};
    Attach(*closed.node);
  }

  void DropRepeatedKeys(YamlNode& map) {
    std::set<std::string_view> keys;
    std::size_t kept = 0;
    for (std::size_t i = 0; i + 1 < map.items.size(); i += 2) {
      const YamlNode& key = *map.items[i];
      // YAML allows lists and maps as keys; no format of this folder has them.
      if (!key.is_scalar()) {
        throw RefusedYaml(MarkOf(key), "found " + Found(key) + " as a key, expected a word");
      }
      if (!keys.insert(key.text).second) {
        repeated_.push_back(&key);
        continue;
      }
      map.items[kept++] = map.items[i];
      map.items[kept++] = map.items[i + 1];
    }
    map.items.resize(kept);
  }
  static YAML::Mark MarkOf(const YamlNode& node) {
    YAML::Mark mark;
    mark.line = node.line - 1;
    mark.column = node.column - 1;
    return mark;
  }

  std::deque<YamlNode>& nodes_;
  const YamlNode* root_ = &kMissing;
  std::map<YAML::anchor_t, Anchor> anchors_;
  std::vector<OpenNode> open_;  // from the outermost to the innermost
  std::vector<const YamlNode*> repeated_;
  Size size_;  // of all values so far
};

// The truth that a word of YAML means: y, yes, true, on and their opposites, in lower or upper case or capitalized.
std::optional<bool> FlagOf(const std::string& text) {
  std::string lower = text;
  std::size_t capitals = 0;
  for (char& c : lower) {
    if (c < 'A' || c > 'Z') continue;
    c = static_cast<char>(c - 'A' + 'a');
    ++capitals;
  }
  // "YES", "Yes" and "yes", but not "yEs": the forms of YAML 1.1.
  if (capitals != 0 && capitals != text.size() && (capitals != 1 || text[0] == lower[0])) return std::nullopt;
  for (const char* word : {"y", "yes", "true", "on", "1"}) {
    if (lower == word) return true;
  }
  for (const char* word : {"n", "no", "false", "off", "0"}) {
    if (lower == word) return false;
  }
  return std::nullopt;
}

}  // namespace

const YamlNode& YamlNode::operator[](std::size_t index) const {
  return index < size() ? *items[index] : kMissing;
}

const YamlNode& YamlReader::Read(std::string_view text, const char* key) {
  const auto fail = [&](const SourceLocation& where, const std::string& message) -> const YamlNode& {
    diagnostics_.Fail(where, message);
    return kMissing;
  };
  const auto at = [&](const YAML::Mark& mark) {
    return mark.is_null() ? SourceLocation{path_, 1, 1} : SourceLocation{path_, mark.line + 1, mark.column + 1};
  };
  const std::string keys = "expected keys such as " + Quoted(key);
  if (text.size() > kMaxBytes) {
    return fail({path_},
                "found " + std::to_string(text.size()) + " bytes, expected at most " + std::to_string(kMaxBytes));
  }
  // yaml-cpp would end the text at a NUL silently, and the rest of the file would be ignored.
  if (const std::size_t nul = text.find('\0'); nul != std::string_view::npos) {
    return fail(TextLines(text).Where(path_, nul), "found a byte that is not text, expected YAML");
  }
  TreeBuilder builder(nodes_);
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser(stream).HandleNextDocument(builder);
    // The parser of the library is recursive and limits its depth by this exception.
  } catch (const YAML::DeepRecursion& exception) {
    return fail(at(exception.mark), "found text nested too deeply, " + keys);
  } catch (const RefusedYaml& exception) {
    return fail(at(exception.mark), exception.msg);
  } catch (const YAML::Exception& exception) {
    return fail(at(exception.mark), "found text that is not YAML (" + exception.msg + "), expected YAML");
  }
  if (!builder.root().is_map()) return fail(At(builder.root()), "found no YAML map, " + keys);
  for (const YamlNode* const repeated : builder.repeated()) {
    Warn(*repeated, "found key " + Quoted(repeated->text) + " twice, expected it once; the first one counts");
  }
  if (const std::size_t odd = FindInvalidUtf8(text); odd != std::string_view::npos) {  // in a comment, mostly
    diagnostics_.Warn(TextLines(text).Where(path_, odd),
                      "found a byte that is not UTF-8, expected UTF-8 text; it is left out");
  }
  return builder.root();
}

const YamlNode& YamlReader::Find(const YamlNode& map, std::string_view key) {
  for (std::size_t i = 0; map.is_map() && i < map.items.size(); i += 2) {
    if (map.items[i]->text == key) return *map.items[i + 1];
  }
  return kMissing;
}

const YamlNode& YamlReader::Require(const YamlNode& map, const char* key, const std::string& of) {
  const YamlNode& found = Find(map, key);
  if (!found) Fail(map, "found no key " + Quoted(key) + " in " + of + ", expected it");
  return found;
}

const YamlNode& YamlReader::Parameter(const YamlNode& map, std::string_view key) {
  const YamlNode& found = Find(map, key);
  return found.size() == 2 ? found[1] : found;
}

void YamlReader::ForEachItem(const YamlNode& list, const std::string& what,
                             const std::function<void(const YamlNode&)>& visit) {
  if (list.is_missing_or_null()) return;
  if (!list.is_list()) return Fail(list, "found " + Found(list) + " for " + what + ", expected a list");
  for (const YamlNode* const item : list.items) {
    if (failed()) return;
    visit(*item);
  }
}

void YamlReader::ForEachEntry(const YamlNode& map, const std::string& what,
                              const std::function<void(const std::string& key, const YamlNode& value)>& visit) {
  if (map.is_missing_or_null()) return;
  if (!map.is_map()) return Fail(map, "found " + Found(map) + " for " + what + ", expected a map");
  for (std::size_t i = 0; i < map.items.size() && !failed(); i += 2) {
    visit(Text(*map.items[i], "a key of " + what), *map.items[i + 1]);
  }
}

bool YamlReader::HasItems(const YamlNode& list, std::size_t least, const std::string& what) {
  if (list.is_list() && list.size() >= least) return true;
  Fail(list, "found " + (list.is_list() ? CountText(list.size(), "value") : Found(list)) + " for " + what +
                 ", expected a list of at least " + std::to_string(least));
  return false;
}

double YamlReader::Number(const YamlNode& node, const std::string& what, double otherwise, double min, double max) {
  if (node.is_missing_or_null()) return otherwise;
  const std::optional<LeadingNumber> number = node.is_scalar() ? ReadLeadingNumber(node.text) : std::nullopt;
  if (!number || !number->is_all) {
    Fail(node, "found " + Found(node) + " for " + what + ", expected a number");
    return otherwise;
  }
  if (number->value >= min && number->value <= max) return number->value;
  Fail(node, "found " + NumberText(number->value) + " for " + what + ", expected " + NumberText(min) + " to " +
                 NumberText(max));
  return otherwise;
}

std::size_t YamlReader::Index(const YamlNode& node, const std::string& what, std::size_t count) {
  const double number = Number(node, what, -1.0);
  if (failed()) return 0;
  if (number >= 0.0 && number < static_cast<double>(count) && number == std::floor(number)) {
    return static_cast<std::size_t>(number);
  }
  Fail(node, "found " + Found(node) + " for " + what + ", expected " +
                 (count == 0 ? "none: there are none" : "a number from 0 to " + std::to_string(count - 1)));
  return 0;
}

bool YamlReader::Flag(const YamlNode& node, const std::string& what, bool otherwise) {
  if (node.is_missing_or_null()) return otherwise;
  const std::optional<bool> flag = node.is_scalar() ? FlagOf(node.text) : std::nullopt;
  if (!flag) Fail(node, "found " + Found(node) + " for " + what + ", expected true or false");
  return flag.value_or(otherwise);
}

std::string YamlReader::Text(const YamlNode& node, const std::string& what, const std::string& otherwise) {
  if (node.is_missing_or_null()) return otherwise;
  if (!node.is_scalar()) {
    Fail(node, "found " + Found(node) + " for " + what + ", expected a text");
    return otherwise;
  }
  if (IsPlainLine(node.text)) return node.text;
  Fail(node, "found a control character or a byte that is not UTF-8 in " + what + ", expected a line of text");
  return otherwise;
}

void YamlReader::WarnOfUnknownKeys(const YamlNode& map, const std::string& what, const std::set<std::string>& known) {
  for (std::size_t i = 0; map.is_map() && i < map.items.size(); i += 2) {
    const YamlNode& key = *map.items[i];
    if (known.contains(key.text) || !warned_.insert(what + key.text).second) continue;
    Warn(key, "key " + Quoted(key.text) + " of " + what + " has no effect");
  }
}

}  // namespace troupe
