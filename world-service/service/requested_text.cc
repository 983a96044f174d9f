#include "world-service/service/requested_text.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace troupe {

Result<std::shared_ptr<const RequestedText>> RequestedText::Write(const std::string& text) {
  std::error_code no_folder;
  std::string folder = (std::filesystem::temp_directory_path(no_folder) / "troupe-text-XXXXXX").string();
  if (no_folder || mkdtemp(folder.data()) == nullptr) {
    return Failure(std::string("cannot make a folder for the text: ") + std::strerror(errno));
  }
  std::shared_ptr<RequestedText> file(new RequestedText(folder));
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool is_scenario = first != std::string::npos && text[first] == '{';
  file->path_ = folder + (is_scenario ? "/text.json" : "/text.world");
  std::ofstream out(file->path_, std::ios::binary);
  out << text;
  out.close();
  if (!out) return Failure("cannot write the text to " + file->path_);
  return std::shared_ptr<const RequestedText>(std::move(file));
}

RequestedText::~RequestedText() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

}  // namespace troupe
