#include "worldfile/stage/macro_expander.h"

#include <algorithm>

#include "worldfile/text/quote.h"

namespace troupe {

Status MacroExpander::Count(std::size_t items, const SourceLocation& where) {
  items_ += items;
  if (items_ <= max_items_) return Status();
  return Error{where, "found more than " + std::to_string(max_items_) +
                          " models and properties once all defines are applied, expected fewer"};
}

Result<WorldNode> MacroExpander::Expand(const WorldNode& written, int depth) {
  if (depth > kMaxNesting) {
    return Error{written.where,
                 "found more than " + std::to_string(kMaxNesting) + " models inside each other, expected fewer"};
  }
  WorldNode result;
  result.where = written.where;

  // From the macro that was written down to the base type.
  const std::size_t active_before = active_.size();
  std::vector<const Define*> chain;
  std::string name = written.type;
  for (auto found = defines_.find(name); found != defines_.end(); found = defines_.find(name)) {
    if (std::find(active_.begin(), active_.end(), name) != active_.end()) {
      return Error{written.where, "found macro " + Quoted(name) + " inside itself, expected no loop of defines"};
    }
    if (chain.size() == kMaxNesting) {
      return Error{written.where,
                   "found more than " + std::to_string(kMaxNesting) + " macros made from each other, expected fewer"};
    }
    active_.push_back(name);
    result.macros.push_back(name);
    chain.push_back(&found->second);
    name = found->second.base;
  }
  result.type = name;
  if (Status error = Count(1 + chain.size(), written.where); !error.ok()) return error.error();

  while (!chain.empty()) {
    const Define& define = *chain.back();
    Result<WorldNode> extended = WithBody(std::move(result), define.properties, define.children, depth);
    if (!extended.ok()) return extended;
    result = std::move(extended).value();
    chain.pop_back();
    active_.pop_back();  // now the bodies of the macros further out
  }
  active_.resize(active_before);
  Result<WorldNode> whole = WithBody(std::move(result), written.properties, written.children, depth);
  if (whole.ok()) whole.value().properties = LastOfEachName(std::move(whole.value().properties));
  return whole;
}

Result<WorldNode> MacroExpander::WithBody(WorldNode node, const std::vector<Property>& properties,
                                          const std::vector<WorldNode>& children, int depth) {
  if (Status error = Count(properties.size(), node.where); !error.ok()) return error.error();
  node.properties.insert(node.properties.end(), properties.begin(), properties.end());
  for (const WorldNode& child : children) {
    Result<WorldNode> expanded = Expand(child, depth + 1);
    if (!expanded.ok()) return expanded;
    node.children.push_back(std::move(expanded).value());
  }
  return node;
}

}  // namespace troupe
