#include "launcher/supervise/check_outputs.h"

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace troupe {
namespace {

namespace fs = std::filesystem;

using NamedFile = std::pair<const char*, const std::string*>;

std::vector<NamedFile> OutputsOf(const RunOptions& options) {
  std::vector<NamedFile> outputs = {{"--hash-log", &options.hash_log}, {"--poses", &options.poses},
                                    {"--scans", &options.scans},       {"--summary", &options.summary},
                                    {"--record", &options.record},     {"--trace", &options.trace.file},
                                    {"--journal", &options.journal}};
  std::erase_if(outputs, [](const NamedFile& output) { return output.second->empty(); });
  return outputs;
}

Status CheckWritable(const NamedFile& output) {
  const int file = open(output.second->c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) {
    return Error{{}, std::string(output.first) + ": cannot write " + *output.second + ": " + strerror(errno)};
  }
  close(file);
  return Status();
}

// Of existing files also by another link.
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

// Two outputs in one file would be mixed up. Devices may be shared.
Status CheckDistinct(const std::vector<NamedFile>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = i + 1; j < outputs.size(); ++j) {
      const std::string& path = *outputs[i].second;
      if (IsDevice(path) || !IsSameFile(path, *outputs[j].second)) continue;
      return Error{{}, std::string(outputs[i].first) + " and " + outputs[j].first + " name the same file, " + path};
    }
  }
  return Status();
}

// The files that the run reads. Only those of the world file if that is faulty: the run reports the fault.
std::vector<std::string> InputsOf(const RunOptions& options) {
  std::vector<std::string> inputs = {options.file};
  if (options.load.controller) inputs.push_back(*options.load.controller);
  const Result<LoadedWorld> loaded = LoadWorld(options.file, options.load);
  if (!loaded.ok()) return inputs;
  inputs.insert(inputs.end(), loaded.value().files.begin(), loaded.value().files.end());
  const std::vector<std::string> libraries = LibrariesOf(loaded.value().world);
  inputs.insert(inputs.end(), libraries.begin(), libraries.end());
  return inputs;
}

Status CheckNotRead(const RunOptions& options, std::vector<NamedFile> outputs) {
  // A file that does not exist, or is empty, is no input; mostly there is no other, and the world need not be read.
  std::erase_if(outputs, [](const NamedFile& output) {
    std::error_code failure;
    return !fs::is_regular_file(*output.second, failure) || fs::file_size(*output.second, failure) == 0;
  });
  if (outputs.empty()) return Status();
  for (const std::string& input : InputsOf(options)) {
    for (const NamedFile& output : outputs) {
      if (!IsSameFile(*output.second, input)) continue;
      return Error{{},
                   std::string(output.first) + ": found " + *output.second + ", which the run reads" +
                       (input == *output.second ? "" : " as " + input) + ", expected another file"};
    }
  }
  return Status();
}

}  // namespace

Status CheckOutputs(const RunOptions& options) {
  if (!options.journal.empty() && options.record.ends_with(".mcap")) {
    return Error{{}, "found --journal and a recording (--record), expected one of them: a recording is a journal, too"};
  }
  const std::vector<NamedFile> outputs = OutputsOf(options);
  if (Status failure = CheckDistinct(outputs); !failure.ok()) return failure;
  if (Status failure = CheckNotRead(options, outputs); !failure.ok()) return failure;
  for (const NamedFile& output : outputs) {
    if (Status failure = CheckWritable(output); !failure.ok()) return failure;
  }
  return Status();
}

}  // namespace troupe
