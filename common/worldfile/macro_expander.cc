#include "common/worldfile/macro_expander.h"

#include <algorithm>

#include "common/worldfile/quote.h"

namespace troupe {

Status MacroExpander::Count(std::size_t items, const SourceLocation& where) {
  items_ += items;
  if (items_ <= max_items_) return std::nullopt;
  return Error{where, "found more than " + std::to_string(max_items_) +
                          " models and properties once all defines are applied, expected fewer"};
}

Result<Entity> MacroExpander::Expand(const Entity& written, int depth) {
  if (depth > kMaxNesting) {
    return Error{written.where,
                 "found more than " + std::to_string(kMaxNesting) + " models inside each other, expected fewer"};
  }
  Entity result;
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
  if (Status error = Count(1 + chain.size(), written.where)) return *error;

  while (!chain.empty()) {
    const Define& define = *chain.back();
    if (Status error = ExpandBody(define.properties, define.children, depth, result)) return *error;
    chain.pop_back();
    active_.pop_back();  // now the bodies of the macros further out
  }
  active_.resize(active_before);
  if (Status error = ExpandBody(written.properties, written.children, depth, result)) return *error;
  KeepLastOfEachName(result.properties);
  return result;
}

Status MacroExpander::ExpandBody(const std::vector<Property>& properties, const std::vector<Entity>& children,
                                 int depth, Entity& result) {
  if (Status error = Count(properties.size(), result.where)) return error;
  result.properties.insert(result.properties.end(), properties.begin(), properties.end());
  for (const Entity& child : children) {
    Result<Entity> expanded = Expand(child, depth + 1);
    if (!expanded.ok()) return expanded.error();
    result.children.push_back(std::move(expanded).value());
  }
  return std::nullopt;
}

}  // namespace troupe
