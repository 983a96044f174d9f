// Applies defines: from an entity as written (its type may be a macro) to one with everything that its macros say.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/worldfile/world_tree.h"

namespace troupe {

// Entities inside each other, and macros made from each other.
inline constexpr int kMaxNesting = 200;
// Entities and properties of a whole world, after all defines were applied: a few lines can ask for any number.
inline constexpr std::size_t kMaxItems = 4'000'000;

class MacroExpander {
 public:
  // `defines` must outlive the expander, and may grow between calls.
  explicit MacroExpander(const std::map<std::string, Define>& defines, std::size_t max_items = kMaxItems)
      : defines_(defines), max_items_(max_items) {}

  Result<Entity> Expand(const Entity& written) { return Expand(written, 1); }

 private:
  Result<Entity> Expand(const Entity& written, int depth);
  Status ExpandBody(const std::vector<Property>& properties, const std::vector<Entity>& children, int depth,
                    Entity& result);
  Status Count(std::size_t items, const SourceLocation& where);

  const std::map<std::string, Define>& defines_;
  std::size_t max_items_;
  std::size_t items_ = 0;
  std::vector<std::string> active_;  // the macros whose bodies are being applied
};

}  // namespace troupe
