// EditedFile: the text of a file that is edited, its history, and its saving. The file on disk is only ever replaced as
// a whole, by a file that is written completely.
//
// Threads: one.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace troupe {

class EditedFile {
 public:
  static constexpr std::size_t kMostStates = 500;               // of the history
  static constexpr std::size_t kMostHistoryBytes = 64'000'000;  // of their texts

  // A file that does not exist yet begins with `initial`. The error names a folder that does not exist, or a file that
  // cannot be read.
  static Result<EditedFile> Open(const std::string& path, const std::string& initial);

  const std::string& path() const { return path_; }
  const std::string& text() const { return states_[at_].text; }
  bool is_modified() const { return !on_disk_ || *on_disk_ != text(); }

  // `label`: what the edit does, "the move of r0".
  void Change(std::string text, std::string label);
  // The label of the edit that would be undone or redone; nothing: there is none.
  std::optional<std::string> undo_label() const;
  std::optional<std::string> redo_label() const;
  // REQUIRES: there is one.
  void Undo() { --at_; }
  void Redo() { ++at_; }

  // The error's code is kNoRoom if the file has changed on disk since it was read or saved, unless `overwrite`.
  Status Save(bool overwrite);
  // Reads the file again, as an edit.
  Status Reload();

 private:
  struct State {
    std::string text;
    std::string label;  // of the edit that made it
  };

  EditedFile(std::string path, std::string text, std::optional<std::string> on_disk)
      : path_(std::move(path)), on_disk_(std::move(on_disk)), states_{{std::move(text), ""}} {}

  std::string path_;
  std::optional<std::string> on_disk_;  // as read or saved; nothing: there was no file
  std::vector<State> states_;
  std::size_t at_ = 0;
};

// Replaces the file at `path`, or creates it. On an error the file is as before. The content is on the disk when it
// returns.
Status ReplaceFile(const std::string& path, const std::string& text);

}  // namespace troupe
