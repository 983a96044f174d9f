// The Stage worldfile language: `.world` and `.inc` files to a WorldTree. docs/world-files.md describes it.
//
// Includes are followed and defines applied here, in the order of the text, as Stage does it: an entry sees the defines
// in front of it only. A macro is applied once and its children are shared by all nodes made from it (ChildNodes), so
// that time and memory go with the file, not with the expansion; the counts in ParseOptions bound the expansion all the
// same, because later steps visit every node.
//
// Functions of the files' contents (and of STAGEPATH), callable by any thread. An error is placed in the file of its
// cause, which may be an include.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "worldfile/stage/stage_tree.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

struct ParseOptions {
  // If not null: the only files that includes find, by name. The disk is not touched.
  const std::map<std::string, std::string>* memory_files = nullptr;
  AllowedPaths allowed = AllowedPaths::All();  // files that includes may open
  // Statements of all files, and models and properties of the world after all defines are applied, without properties
  // that nodes share: a few lines can expand to any number.
  std::size_t max_items = StageItemCount().most;
};

// Reads `path` and all that it includes, if allowed.
Result<WorldTree> ParseStageWorld(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());

// The same from text; `path` names it in messages; relative includes start at its folder.
Result<WorldTree> ParseStageText(std::string text, const std::string& path, const ParseOptions& options = {});

// The value of a statement. REQUIRES: it is a property.
Value ValueOf(const StageTree& file, const Statement& property);

// A node of type or macro `name` with nothing in its body, as `name ( )` in the file would give.
Result<WorldNode> Instantiate(const WorldTree& tree, const std::string& name, const SourceLocation& where);

}  // namespace troupe
