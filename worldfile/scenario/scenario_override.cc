#include "worldfile/scenario/scenario_override.h"

#include <algorithm>
#include <set>

#include "worldfile/stage/world_tree.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

class Overrider {
 public:
  explicit Overrider(const OverrideEntry& rule) : rule_(rule) {}

  // Changes the nodes below `parent` that the rule matches.
  void Visit(WorldNode& parent, const std::string& parent_name) {
    const std::vector<std::string> names = ChildNames(parent);
    for (std::size_t i = 0; i < parent.children.size(); ++i) {
      WorldNode& child = parent.children[i];
      if (child.type == "block" || child.type == "window") continue;
      const std::string name = names[i].empty() ? "" : FullName(parent_name, names[i]);
      if (!name.empty()) names_.push_back(name);
      types_.insert(child.type);
      types_.insert(child.macros.begin(), child.macros.end());
      if (Matches(child, name)) {
        ++matches_;
        for (const Property& property : rule_.properties) child.Set(property);
      }
      Visit(child, name);
    }
  }

  Status Outcome() const {
    if (matches_ > 0) return Status();
    std::string wanted;
    if (rule_.name) wanted += " with the name " + Quoted(*rule_.name);
    if (rule_.type) wanted += std::string(rule_.name ? " and" : " with") + " the type " + Quoted(*rule_.type);
    return Error{rule_.where, "found no model" + wanted + ", expected one of the names " + List(names_) +
                                  " or of the types " + List({types_.begin(), types_.end()})};
  }

 private:
  bool Matches(const WorldNode& node, const std::string& name) const {
    if (rule_.name && (name.empty() || !MatchesGlob(*rule_.name, name))) return false;
    if (!rule_.type || MatchesGlob(*rule_.type, node.type)) return true;
    return std::any_of(node.macros.begin(), node.macros.end(),
                       [this](const std::string& macro) { return MatchesGlob(*rule_.type, macro); });
  }

  static std::string List(const std::vector<std::string>& words) {
    constexpr std::size_t kMost = 12;
    if (words.empty()) return "(there are none)";
    std::string list;
    for (std::size_t i = 0; i < words.size() && i < kMost; ++i) list += (i > 0 ? ", " : "") + Quoted(words[i]);
    if (words.size() > kMost) list += " and " + std::to_string(words.size() - kMost) + " more";
    return list;
  }

  const OverrideEntry& rule_;
  int matches_ = 0;
  std::vector<std::string> names_;
  std::set<std::string> types_;
};

}  // namespace

bool MatchesGlob(const std::string& pattern, const std::string& text) {
  // Greedy: on a mismatch the last star matches one character more.
  std::size_t p = 0;
  std::size_t t = 0;
  std::size_t star = std::string::npos;
  std::size_t star_text = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_text = t;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
      ++p;
      ++t;
    } else if (star != std::string::npos) {
      p = star + 1;
      t = ++star_text;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

Result<WorldNode> ApplyOverride(const OverrideEntry& rule, WorldNode world) {
  Overrider overrider(rule);
  overrider.Visit(world, "");
  if (Status error = overrider.Outcome(); !error.ok()) return error.error();
  return world;
}

}  // namespace troupe
