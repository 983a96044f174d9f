// EditedPictures: the image files that the edits of a file change, as they are on disk. Their contents of before and
// after each edit are in its history (edited_file.h).
//
// Threads: one.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"
#include "viewer/editor/grey_picture.h"

namespace troupe {

using PicturePointer = std::shared_ptr<const GreyPicture>;
// By path, without links.
using PictureVersions = std::map<std::string, PicturePointer>;

class EditedPictures {
 public:
  static constexpr std::size_t kMostPictures = 32;  // each has at most kMaxGreyPixels bytes

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

}  // namespace troupe
