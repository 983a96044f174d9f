// EditedFile: the text of a file that is edited and the images that belong to it, their history, and their saving. The
// files on disk are only ever replaced as a whole, by files that are written completely.
//
// The history has whole texts, not differences: texts are small, and undoing is then assigning. Images share tiles
// between versions (grey_picture.h). Both are bounded, in number and bytes; the oldest states are dropped first.
//
// Another program may change a file meanwhile: saving compares with what was read, and overwrites only on request.
//
// Threads: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "troupe/result.h"
#include "viewer/editor/grey_picture.h"

namespace troupe {

using PicturePointer = std::shared_ptr<const GreyPicture>;
// The version of each picture, by its path without links.
using PictureVersions = std::map<std::string, PicturePointer>;

// The image files that the edits of a file change, as they are on disk. Their contents of before and after each edit
// are in its history.
class EditedPictures {
 public:
  static constexpr std::size_t kMaxPictures = 32;  // each has at most kMaxGreyPixels bytes

  // Reads a PNG file that is to be edited, or knows it already. The error names one of another format.
  Status Open(const std::string& path);
  // A file that does not exist yet. The error names one that does.
  Status Create(const std::string& path);

  // The content of `versions`, or else the one that was opened; null: the file is not known, or new.
  PicturePointer Find(const PictureVersions& versions, const std::string& path) const;
  // The paths whose content is another one than on disk.
  std::vector<std::string> Modified(const PictureVersions& versions) const;

  // The error tells that another program has changed the file, with the code kNoRoom.
  Status CheckUnchanged(const std::string& path) const;
  // After it is written with these bytes.
  void SetSaved(const std::string& path, PicturePointer content, const std::string& bytes);
  // Reads all again, into `versions`; a file that cannot be read stays as it is there.
  void Reload(PictureVersions& versions);

 private:
  struct OnDisk {
    PicturePointer opened;               // null: there was no file
    PicturePointer saved;                // as read or saved last; null: there is no file
    std::optional<std::uint64_t> bytes;  // hash of its bytes then
  };

  std::map<std::string, OnDisk> files_;
};

class EditedFile {
 public:
  static constexpr std::size_t kMaxStates = 500;               // of the history
  static constexpr std::size_t kMaxHistoryBytes = 64'000'000;  // of their texts and pixels

  // A file that does not exist yet begins with `initial`. The error names a folder that does not exist, or a file that
  // cannot be read.
  static Result<EditedFile> Open(const std::string& path, const std::string& initial);

  const std::string& path() const { return path_; }
  const std::string& text() const { return Now().text; }
  // `named`: the images that the text names; others are not written.
  bool is_modified(const std::set<std::string>& named) const;
  // The same, but that a new file which has only its initial text holds no edit that could be lost.
  bool has_unsaved_edits(const std::set<std::string>& named) const;

  // The images that are edited. To open one or to create it is no edit.
  EditedPictures& pictures() { return pictures_; }
  const EditedPictures& pictures() const { return pictures_; }
  const PictureVersions& versions() const { return Now().versions; }
  // As edited; null: the file on disk counts, or there is none.
  PicturePointer Picture(const std::string& path) const { return pictures_.Find(versions(), path); }

  // `label`: what the edit does, "the move of r0".
  void Change(std::string text, std::string label) { Change(std::move(text), versions(), std::move(label)); }
  void Change(std::string text, PictureVersions versions, std::string label);
  // The changes from here on are one edit, which EndJoined makes; CancelJoined returns to the state before them.
  void BeginJoined() { joined_ = states_[at_]; }
  void EndJoined(std::string label);
  void CancelJoined() { joined_.reset(); }
  // The label of the edit that would be undone or redone; nothing: there is none.
  std::optional<std::string> undo_label() const;
  std::optional<std::string> redo_label() const;
  // REQUIRES: there is one.
  void Undo() { --at_; }
  void Redo() { ++at_; }

  // Writes the text, and the changed ones of the `named` images. No file is replaced before all are written. The
  // error's code is kNoRoom if one has changed on disk since it was read or saved, unless `overwrite`.
  Status Save(bool overwrite, const std::set<std::string>& named);
  // Reads the file and the edited images again, as an edit.
  Status Reload();

 private:
  struct State {
    std::string text;
    PictureVersions versions;
    std::string label;      // of the edit that made it
    std::size_t bytes = 0;  // that it does not share with the one before
  };

  EditedFile(std::string path, std::string text, std::optional<std::string> on_disk)
      : path_(std::move(path)), on_disk_(std::move(on_disk)), initial_(text), states_{{std::move(text), {}, "", 0}} {}

  const State& Now() const { return joined_ ? *joined_ : states_[at_]; }
  std::size_t BytesOf(const State& state, const State* before) const;
  bool HasModifiedPictures(const std::set<std::string>& named) const;

  std::string path_;
  std::optional<std::string> on_disk_;  // as read or saved; nothing: there was no file
  std::string initial_;                 // the text when it was opened
  EditedPictures pictures_;
  std::vector<State> states_;
  std::size_t at_ = 0;
  std::optional<State> joined_;  // of several changes that are not an edit yet
};

}  // namespace troupe
