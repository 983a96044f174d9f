// RequestedText: the text of a request as a file, which the readers of worlds expect. Deleted with the last copy.
#pragma once

#include <memory>
#include <string>

#include "troupe/result.h"

namespace troupe {

class RequestedText {
 public:
  // A scenario begins with a brace; any other text is a Stage world.
  static Result<std::shared_ptr<const RequestedText>> Write(const std::string& text);
  ~RequestedText();
  RequestedText(const RequestedText&) = delete;
  RequestedText& operator=(const RequestedText&) = delete;

  const std::string& path() const { return path_; }

 private:
  explicit RequestedText(std::string folder) : folder_(std::move(folder)) {}

  std::string folder_;
  std::string path_;
};

}  // namespace troupe
