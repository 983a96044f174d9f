// Edits of a Stage file's text. Each returns the changed text; all bytes that the edit does not concern stay.
//
// stage_body_edit.h applies several to one body. REQUIRES, of all: `text` is the one that the syntax was read from.
#pragma once

#include <string>

#include "worldfile/edit/stage_syntax.h"
#include "worldfile/edit/written_model.h"

namespace troupe {

// Changes the property that counts, or adds it after the others. Of a tuple of as many elements only those change that
// have another value.
std::string WithProperty(const std::string& text, const StageBody& body, const std::string& name,
                         const WrittenValue& value);
// Without every property of that name.
std::string WithoutProperty(const std::string& text, const StageBody& body, const std::string& name);

std::string WithoutStatement(const std::string& text, const Statement& statement);

// With the entry behind all that is in the body.
std::string WithEntry(const std::string& text, const StageBody& body, const WrittenModel& model);
// With a define before the first entry of the file, which may use it, or at the end.
std::string WithDefine(const std::string& text, const StageSyntax& syntax, const std::string& name,
                       const WrittenModel& model);

}  // namespace troupe
