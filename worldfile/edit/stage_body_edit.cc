#include "worldfile/edit/stage_body_edit.h"

#include <algorithm>

#include "worldfile/edit/stage_edit.h"

namespace troupe {
namespace {

std::vector<const Statement*> BlocksOf(const Statement& holder) {
  std::vector<const Statement*> blocks;
  for (const Statement& statement : holder.statements) {
    if (statement.kind == StatementKind::kEntry && statement.name == "block") blocks.push_back(&statement);
  }
  return blocks;
}

}  // namespace

Result<const Statement*> StageBodyEdit::Find() {
  if (!syntax_) {
    Result<StageSyntax> read = ReadStageSyntax(text_, path_);
    if (!read.ok()) return read.error();
    syntax_ = std::move(read).value();
  }
  const auto chain = FindStatement(*syntax_, line_, column_);
  if (chain.empty()) return Error{{path_, line_, column_}, "found no entry or define here, expected one"};
  return chain.back();
}

// To read a text again is most of the work: an edit that changes nothing does not need it.
void StageBodyEdit::Replace(std::string text) {
  if (text == text_) return;
  text_ = std::move(text);
  syntax_.reset();
}

Status StageBodyEdit::Set(const std::string& property, const WrittenValue& value) {
  const Result<const Statement*> statement = Find();
  if (!statement.ok()) return statement.error();
  Replace(WithProperty(text_, BodyOf(*statement.value()), property, value));
  return {};
}

Status StageBodyEdit::Remove(const std::string& property) {
  const Result<const Statement*> statement = Find();
  if (!statement.ok()) return statement.error();
  Replace(WithoutProperty(text_, BodyOf(*statement.value()), property));
  return {};
}

Status StageBodyEdit::SetBlocks(const std::vector<WrittenModel>& blocks) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (Status failure = SetBlock(i, blocks[i]); !failure.ok()) return failure;
  }
  for (;;) {
    const Result<const Statement*> holder = Find();
    if (!holder.ok()) return holder.error();
    const std::vector<const Statement*> old = BlocksOf(*holder.value());
    if (old.size() <= blocks.size()) return {};
    Replace(WithoutStatement(text_, *old.back()));
  }
}

Status StageBodyEdit::SetBlock(std::size_t index, const WrittenModel& block) {
  const Result<const Statement*> holder = Find();
  if (!holder.ok()) return holder.error();
  const std::vector<const Statement*> old = BlocksOf(*holder.value());
  if (index >= old.size()) {
    Replace(WithEntry(text_, BodyOf(*holder.value()), block));
    return {};
  }
  // Corners that are too many go first.
  StageBodyEdit edit(text_, path_, old[index]->line, old[index]->column);
  for (const Statement& statement : old[index]->statements) {
    const bool is_wanted = std::any_of(block.properties.begin(), block.properties.end(),
                                       [&](const auto& property) { return property.first == statement.name; });
    if (is_wanted || !statement.name.starts_with("point[")) continue;
    if (Status failure = edit.Remove(statement.name); !failure.ok()) return failure;
  }
  for (const auto& [name, value] : block.properties) {
    if (Status failure = edit.Set(name, value); !failure.ok()) return failure;
  }
  Replace(edit.text());
  return {};
}

}  // namespace troupe
