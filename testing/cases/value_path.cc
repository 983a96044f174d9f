#include "testing/cases/value_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "troupe/world_description.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

Error PathError(std::string_view text, std::size_t offset, const std::string& found, const std::string& expected) {
  return {{"", 1, static_cast<int>(offset) + 1},
          fmt::format("found {} in the path {}, expected {}", found, Quoted(text), expected)};
}

// For a message: the character at the offset.
std::string Found(std::string_view text, std::size_t offset) {
  return offset < text.size() ? Quoted(text.substr(offset, 1)) : "the end";
}

// Replaces spans of a text.
class TextEdits {
 public:
  void Replace(const TextSpan& span, std::string text) { edits_.emplace_back(span, std::move(text)); }

  std::string Apply(const std::string& text) {
    // Edits are spans of the original text: applied in one pass from front to back, no offset has to be moved.
    std::stable_sort(edits_.begin(), edits_.end(),
                     [](const auto& a, const auto& b) { return a.first.begin < b.first.begin; });
    std::string edited;
    std::size_t done = 0;
    for (const auto& [span, replacement] : edits_) {
      edited.append(text, done, span.begin - done).append(replacement);
      done = span.end;
    }
    return edited.append(text, done);
  }

 private:
  std::vector<std::pair<TextSpan, std::string>> edits_;
};

}  // namespace

Status ValuePath::ParseName(std::string_view text, Step::Kind kind, const char* ends, std::size_t& i) {
  Step step{kind, {}};
  std::size_t end = std::min(text.find_first_of(ends, i), text.size());
  const bool is_quoted = i < text.size() && text[i] == '"';
  if (is_quoted) {
    for (end = i + 1; end < text.size() && text[end] != '"'; ++end) end += text[end] == '\\' ? 1 : 0;
    end = std::min(end + 1, text.size());
    const nlohmann::json name = nlohmann::json::parse(text.substr(i, end - i), nullptr, false);
    if (!name.is_string()) return PathError(text, i, Quoted(text.substr(i, end - i)), "a JSON string");
    step.name = name.get<std::string>();
  } else {
    step.name = text.substr(i, end - i);
  }
  const std::string_view written = text.substr(i, end - i);
  const bool has_equals = kind == Step::Kind::kKey && !is_quoted && written.find('=') != std::string_view::npos;
  text_ +=
      has_equals ? nlohmann::json(step.name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) : written;
  if (kind == Step::Kind::kName && !is_quoted) {
    const auto number = std::from_chars(written.data(), written.data() + written.size(), step.index);
    if (number.ec == std::errc() && number.ptr == written.data() + written.size()) step.kind = Step::Kind::kIndex;
  }
  steps_.push_back(std::move(step));
  i = end;
  return {};
}

Result<ValuePath> ValuePath::ParseUpTo(std::string_view text, const char* ends_of_keys, std::size_t& size) {
  ValuePath path;
  std::size_t i = 0;
  while (i < text.size() || path.steps_.empty()) {
    if (path.steps_.empty() || text[i] == '.') {
      if (!path.steps_.empty()) path.text_ += text[i++];
      if (text.find_first_of(ends_of_keys, i) == i || i >= text.size()) {
        return PathError(text, i, Found(text, i), "a key, as in spawn[0].count");
      }
      if (const Status error = path.ParseName(text, Step::Kind::kKey, ends_of_keys, i); !error.ok())
        return error.error();
    } else if (text[i] == '[') {
      path.text_ += text[i++];
      if (i < text.size() && text[i] == ']') {
        return PathError(text, i, "']'", "a number from 0, or the name of an object");
      }
      if (const Status error = path.ParseName(text, Step::Kind::kName, "]", i); !error.ok()) return error.error();
      if (i >= text.size() || text[i] != ']') return PathError(text, i, Found(text, i), "']'");
      path.text_ += text[i++];
    } else if (std::string_view(ends_of_keys).find(text[i]) != std::string_view::npos) {
      break;
    } else {
      return PathError(text, i, Found(text, i), "'.' or '['");
    }
  }
  size = i;
  return path;
}

Result<ValuePath> ValuePath::Parse(std::string_view text) {
  std::size_t size = 0;
  return ParseUpTo(text, ".[", size);
}

Result<ValuePath> ValuePath::ParseBeforeEquals(std::string_view text, std::size_t& size) {
  return ParseUpTo(text, ".[=", size);
}

bool ValuePath::Overlaps(const ValuePath& other) const {
  const std::size_t common = std::min(steps_.size(), other.steps_.size());
  return std::equal(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(common), other.steps_.begin());
}

Result<ScenarioText> ScenarioText::Parse(std::string text, const std::string& file) {
  Result<JsonTree> tree = JsonTree::Parse(text, file);
  if (!tree.ok()) return tree.error();
  if (!tree.value().root().is_object()) {
    return tree.value().ErrorAt(tree.value().root(), "found " + Describe(tree.value().root()) + ", expected an object");
  }
  return ScenarioText(std::move(text), std::move(tree).value());
}

// Only the last key may be missing: With adds a member to an object, but makes no objects around it. A message names
// the part of the path that was found, because a typing error is right behind it.
Result<ScenarioText::Place> ScenarioText::Locate(const ValuePath& path) const {
  const JsonNode* node = &tree_.root();
  std::string passed;  // the path so far
  for (std::size_t i = 0; i < path.steps_.size(); ++i) {
    const ValuePath::Step& step = path.steps_[i];
    const auto fail = [&](const std::string& message) {
      return Error{{}, fmt::format("found the path {}, but {}", Quoted(path.text(), 200), message)};
    };
    const std::string here = passed.empty() ? "the scenario" : Quoted(passed, 200);
    if (step.kind == ValuePath::Step::Kind::kKey) {
      if (!node->is_object()) return fail(fmt::format("{} is {}, expected an object", here, Describe(*node)));
      const JsonNode* const next = node->Find(step.name);
      if (next == nullptr && i + 1 == path.steps_.size()) return Place{nullptr, node};
      if (next == nullptr) {
        std::vector<std::string> keys;
        for (const JsonNode& member : node->items) keys.push_back(member.key);
        return fail(fmt::format("{} has no key {}, expected one that it has{}", here, Quoted(step.name),
                                DidYouMean(step.name, keys)));
      }
      passed += (passed.empty() ? "" : ".") + step.name;
      node = next;
      continue;
    }
    if (!node->is_array()) return fail(fmt::format("{} is {}, expected an array", here, Describe(*node)));
    const JsonNode* next = nullptr;
    if (step.kind == ValuePath::Step::Kind::kIndex) {
      if (step.index < node->items.size()) next = &node->items[step.index];
      if (next == nullptr)
        return fail(fmt::format("{} has {}, expected the number of one, from 0", here,
                                CountText(node->items.size(), "element")));
    } else {
      std::vector<std::string> names;
      for (const JsonNode& item : node->items) {
        const JsonNode* const name = item.is_object() ? item.Find("name") : nullptr;
        if (name == nullptr || !name->is_string()) continue;
        names.push_back(name->text);
        if (name->text == step.name) next = &item;
      }
      if (next == nullptr) {
        return fail(fmt::format("{} has no object with the name {}, expected that of one{}", here, Quoted(step.name),
                                DidYouMean(step.name, names)));
      }
    }
    passed += step.kind == ValuePath::Step::Kind::kIndex ? fmt::format("[{}]", step.index) : "[" + step.name + "]";
    node = next;
  }
  return Place{node, nullptr};
}

Result<const JsonNode*> ScenarioText::Find(const ValuePath& path) const {
  const Result<Place> place = Locate(path);
  if (!place.ok()) return place.error();
  return place.value().value;
}

Result<std::string> ScenarioText::With(const std::vector<DrawnValue>& draws) const {
  TextEdits edits;
  std::map<const JsonNode*, std::string> added;  // members of objects, each with a comma behind it
  for (const DrawnValue& draw : draws) {
    const Result<ValuePath> path = ValuePath::Parse(draw.path);
    if (!path.ok()) return path.error();
    const Result<Place> place = Locate(path.value());
    if (!place.ok()) return place.error();
    if (place.value().value != nullptr) {
      edits.Replace(place.value().value->span, draw.value);
    } else {
      const std::string key = nlohmann::json(path.value().steps_.back().name).dump();
      added[place.value().parent] += key + ": " + draw.value + ", ";
    }
  }
  for (auto& [object, members] : added) {
    const std::size_t inside = object->span.begin + 1;
    // JSON has no comma behind the last member.
    if (object->items.empty()) members.resize(members.size() - 2);
    edits.Replace({inside, inside}, members);
  }
  return edits.Apply(text_);
}

// Each kind of file as a load looks for it: libraries, bitmaps, the world and the scenario beside the text, maps and
// includes also in the other folders of FindFile.
std::string ScenarioText::WithAbsolutePaths(const std::string& path) const {
  const std::string directory = DirectoryOf(path);
  const auto beside = [&](const std::string& name) {
    return (std::filesystem::path(directory) / name).lexically_normal().string();  // `name` itself if it is absolute
  };
  const JsonNode& root = tree_.root();
  const JsonNode* const world = root.Find("world");
  const std::string directory_of_world = world != nullptr ? DirectoryOf(beside(world->text)) : directory;
  const auto found = [&](const std::string& name) { return FindFile(name, directory_of_world, path); };
  TextEdits edits;
  const auto replace = [&](const JsonNode& name, const std::string& file) {
    std::error_code ignored;
    const std::string absolute = std::filesystem::absolute(file, ignored).lexically_normal().string();
    if (absolute != name.text) edits.Replace(name.span, nlohmann::json(absolute).dump());
  };
  const auto controller = [&](const JsonNode& name) {
    if (NamesLibrary(name.text)) replace(name, beside(name.text));
  };
  const auto properties = [&](const JsonNode& object) {
    const JsonNode* const bitmap = object.is_object() ? object.Find("bitmap") : nullptr;
    if (bitmap != nullptr && bitmap->is_string()) replace(*bitmap, beside(bitmap->text));
    const JsonNode* const map = object.is_object() ? object.Find("map_yaml") : nullptr;
    if (map != nullptr && map->is_string()) replace(*map, found(map->text));
  };
  const std::function<void(const JsonNode&)> visit = [&](const JsonNode& node) {
    for (const JsonNode& item : node.items) {
      if (item.key == "controller") {
        if (item.is_string()) controller(item);
        if (const JsonNode* const name = item.is_object() ? item.Find("name") : nullptr) controller(*name);
      } else if (item.key == "properties") {
        properties(item);
      } else {
        visit(item);
      }
    }
  };
  visit(root);
  for (const char* key : {"world", "scenario"}) {
    if (const JsonNode* const file = root.Find(key)) replace(*file, beside(file->text));
  }
  for (const JsonNode& include : root.ItemsOf("include")) {
    replace(include, FindFile(include.text, directory, path));
  }
  return edits.Apply(text_);
}

}  // namespace troupe
