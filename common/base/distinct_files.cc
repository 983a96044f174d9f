#include "common/base/distinct_files.h"

#include <algorithm>
#include <filesystem>

namespace troupe {
namespace {

namespace fs = std::filesystem;

Status CheckDistinctOutputs(const std::vector<OutputName>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = i + 1; j < outputs.size(); ++j) {
      const std::string& path = outputs[i].path;
      if (IsDevice(path) || !IsSameFile(path, outputs[j].path)) continue;
      return Error{{}, outputs[i].option + " and " + outputs[j].option + " name the same file, " + path};
    }
  }
  return {};
}

}  // namespace

bool IsSameFile(const std::string& a, const std::string& b) {
  std::error_code failure;
  if (fs::equivalent(a, b, failure)) return true;
  const fs::path resolved_a = fs::weakly_canonical(fs::absolute(a, failure), failure);
  const fs::path resolved_b = fs::weakly_canonical(fs::absolute(b, failure), failure);
  return !resolved_a.empty() && resolved_a == resolved_b;
}

bool IsDevice(const std::string& path) {
  std::error_code failure;
  return fs::exists(path, failure) && !fs::is_regular_file(path, failure);
}

Status CheckDistinct(const std::vector<OutputName>& names, const std::function<std::vector<std::string>()>& inputs) {
  std::vector<OutputName> outputs = names;
  std::erase_if(outputs, [](const OutputName& output) { return output.path.empty(); });
  if (Status failure = CheckDistinctOutputs(outputs); !failure.ok()) return failure;
  // A file that does not exist, or is empty, is no input.
  std::erase_if(outputs, [](const OutputName& output) {
    std::error_code failure;
    return !fs::is_regular_file(output.path, failure) || fs::file_size(output.path, failure) == 0;
  });
  if (outputs.empty()) return {};
  for (const std::string& input : inputs()) {
    for (const OutputName& output : outputs) {
      if (!IsSameFile(output.path, input)) continue;
      return Error{{},
                   output.option + ": found " + output.path + ", which the command reads" +
                       (input == output.path ? "" : " as " + input) + ", expected another file"};
    }
  }
  return {};
}

}  // namespace troupe
