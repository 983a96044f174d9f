// Applies defines: from a node as written (its type may be a macro) to one with all properties and children of its
// macros.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "troupe/result.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// Nodes inside each other, and macros made from each other.
inline constexpr int kMaxNesting = 200;
// Nodes and properties of a whole world, after all defines were applied: a few lines can expand to any number.
inline constexpr std::size_t kMaxItems = 4'000'000;

class MacroExpander {
 public:
  // `defines` must outlive the expander, and may grow between calls.
  explicit MacroExpander(const std::map<std::string, Define>& defines, std::size_t max_items = kMaxItems)
      : defines_(defines), max_items_(max_items) {}

  Result<WorldNode> Expand(const WorldNode& written) { return Expand(written, 1); }

 private:
  Result<WorldNode> Expand(const WorldNode& written, int depth);
  // `node` with these properties, and with these children expanded.
  Result<WorldNode> WithBody(WorldNode node, const std::vector<Property>& properties,
                             const std::vector<WorldNode>& children, int depth);
  Status Count(std::size_t items, const SourceLocation& where);

  const std::map<std::string, Define>& defines_;
  std::size_t max_items_;
  std::size_t items_ = 0;
  std::vector<std::string> active_;  // the macros whose bodies are being applied
};

}  // namespace troupe
