// Edits of the texts of users' files, Stage worlds and JSON, that leave every other byte as it is.
//
// Functions of texts, not of trees: a writer that printed the tree again would lose comments, blanks, units and the
// order of a file that somebody keeps under version control; a one-value edit must be a one-line difference. So an edit
// takes the text with its parsed tree, and returns a text; after an edit the tree is out of date, and the next edit
// parses again (StageBodyEdit does that). Cost: the length of the text per edit.
//
// An added line takes the indentation and the line ending of its neighbours (LF or CRLF). Values that are equal as
// numbers are not rewritten: "1.50" stays "1.50".
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/json_tree.h"
#include "troupe/result.h"
#include "worldfile/edit/written_model.h"
#include "worldfile/stage/stage_tree.h"
#include "worldfile/text/text_file.h"

namespace troupe {

// Edits of a Stage file's text. Each returns the changed text; all bytes that the edit does not concern stay.
//
// REQUIRES, of all functions: `text` is the text of the tree.

// Changes the property that counts, or adds it after the others. Of a tuple of as many elements only elements with
// another value change.
std::string WithProperty(const std::string& text, const StageBody& body, const std::string& name, const Value& value);
// Without every property of that name.
std::string WithoutProperty(const std::string& text, const StageBody& body, const std::string& name);

std::string WithoutStatement(const std::string& text, const Statement& statement);

// With the entry behind all that is in the body.
std::string WithEntry(const std::string& text, const StageBody& body, const WrittenModel& model);
// With `entry`, the text of one, behind a statement of the body.
std::string WithCopy(const std::string& text, const StageBody& body, const Statement& statement,
                     const std::string& entry);
// With the lines `written` before the first entry of the file and its comments, or at the end.
std::string WithBeforeEntries(const std::string& text, const StageTree& tree, const std::string& written);
// With a define before the first entry of the file, which may use it, or at the end.
std::string WithDefine(const std::string& text, const StageTree& tree, const std::string& name,
                       const WrittenModel& model);

// Several edits of one entry or define, one after another. All are in its body, so that its name keeps its line and
// column.
class StageBodyEdit {
 public:
  // `path` names the text in messages; `line` and `column`: of the statement's name.
  StageBodyEdit(std::string text, std::string path, int line, int column)
      : text_(std::move(text)), path_(std::move(path)), line_(line), column_(column) {}

  // The edits above. The error tells that the text has no such statement.
  Status Set(const std::string& property, const Value& value);
  Status Remove(const std::string& property);
  // Replaces the blocks of the body: the first ones change in place, the rest is added or removed.
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
  std::optional<StageTree> tree_;  // of the text; nothing: not parsed yet
};

// Changes of a text that leave every other byte as it is.

struct TextChange {
  TextSpan span;
  std::string replacement;
};

// REQUIRES: the spans are within the text and do not overlap.
std::string ApplyChanges(std::string_view text, std::vector<TextChange> changes);

// The start of the line that `offset` is on, and its end, before the line's end characters.
std::size_t LineStart(std::string_view text, std::size_t offset);
std::size_t LineEnd(std::string_view text, std::size_t offset);

// The blanks at the start of the line that `offset` is on.
std::string IndentOf(std::string_view text, std::size_t offset);

// The characters that end the text's lines.
std::string EndOfLineIn(std::string_view text);

// The span with what its removal leaves behind: the whole lines if they hold nothing else, else the blanks before it.
TextSpan WithSurroundings(std::string_view text, TextSpan span);

// A number in the form of both languages, without exponent: at most `decimals` digits after the point.
std::string PlainNumber(double value, int decimals = 4);

// Edits of JSON text. Each returns the changed text, in which all bytes that the edit does not concern stay. REQUIRES,
// of all: the nodes are the nodes of the text.

// Changes or adds a member. Of an array of as many plain values only items with another value change.
std::string WithMember(const std::string& text, const JsonNode& object, const std::string& key,
                       const std::string& value);
std::string WithElement(const std::string& text, const JsonNode& array, const std::string& value);
// `index`: of an item of the holder.
std::string WithoutItem(const std::string& text, const JsonNode& holder, std::size_t index);
// Without the member of that name, if there is one.
std::string WithoutMember(const std::string& text, const JsonNode& object, const std::string& key);

// The way to a value: keys of objects and indices of arrays.
using JsonPath = std::vector<std::variant<std::string, std::size_t>>;

// With the value, JSON, at the path from `node` on, or without it. Objects and arrays that are missing are made; the
// index behind the last element adds one. The error names a step that leads nowhere.
Result<std::string> WithValueAt(const std::string& text, const JsonNode& node, const JsonPath& path,
                                const std::optional<std::string>& value);

}  // namespace troupe
