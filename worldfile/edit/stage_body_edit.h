// StageBodyEdit: several edits of one entry or define of a Stage file, one after another. All edits are in its body, so
// that its name keeps its line and column.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "troupe/result.h"
#include "worldfile/edit/stage_syntax.h"
#include "worldfile/edit/written_model.h"

namespace troupe {

class StageBodyEdit {
 public:
  // `path` names the text in messages; `line` and `column` are those of the statement's name.
  StageBodyEdit(std::string text, std::string path, int line, int column)
      : text_(std::move(text)), path_(std::move(path)), line_(line), column_(column) {}

  // The edits of stage_edit.h. The error tells that the text has no such statement.
  Status Set(const std::string& property, const WrittenValue& value);
  Status Remove(const std::string& property);
  // These blocks in place of those of the body: as many as there are change one by one.
  Status SetBlocks(const std::vector<WrittenModel>& blocks);

  const std::string& text() const { return text_; }

 private:
  // The statement in the text as it is now.
  Result<const Statement*> Find();
  void Replace(std::string text);
  Status SetBlock(std::size_t index, const WrittenModel& block);

  std::string text_;
  std::string path_;
  int line_;
  int column_;
  std::optional<StageSyntax> syntax_;  // of the text; nothing: not read yet
};

}  // namespace troupe
