#include "worldfile/models/properties/model_names.h"

#include "worldfile/text/quote.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxNameLength = 1000;

}  // namespace

void ModelNames::Add(const WorldNode& node, const std::string& name, Diagnostics& diagnostics) {
  const Property* given = node.Find("name");
  const SourceLocation& where = given != nullptr ? given->value.where : node.where;
  if (given != nullptr && !std::holds_alternative<std::string>(given->value.content)) {
    diagnostics.Fail(where, "found a name that is not a string, expected it in quotes");
  } else if (name.empty() || name.back() == '.') {
    diagnostics.Fail(where, "found an empty name, expected at least one character");
  } else if (name.size() > kMaxNameLength) {
    diagnostics.Fail(where, "found a name of " + std::to_string(name.size()) + " bytes, expected at most " +
                                std::to_string(kMaxNameLength));
  } else if (const auto [first, is_new] = places_.emplace(name, where); !is_new) {
    diagnostics.Fail(where, "found name " + Quoted(name) + " twice, expected each name once (first at " +
                                first->second.file + ":" + std::to_string(first->second.line) + ")");
  }
}

}  // namespace troupe
