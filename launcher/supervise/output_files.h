// The output files of a run: their check before it begins, the parts that its processes write, and the errors that
// these report.
//
// Outputs are checked before any process starts: a run of an hour must not end with the message that its file cannot be
// written, and must never overwrite its own world file. Each agent writes a part of its own, because processes that
// append to one file would mix their lines; the parts are merged by tick in the order of robots, so the file is equal
// to that of a run in one process.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/base/output_file.h"
#include "launcher/hosts/host.h"
#include "launcher/supervise/run_options.h"
#include "troupe/result.h"

namespace troupe {

// Files for the parts of one output, written by child processes. They have no name in any folder, so nothing is left of
// them however this process ends; other processes open them through /proc during its lifetime.
class OutputParts {
 public:
  // The parts are in the file system of `output`, the file into which they are merged, or in that of temporary files if
  // `output` is a device. `option`: for error messages.
  OutputParts(const std::string& output, const std::string& option);
  ~OutputParts();
  OutputParts(const OutputParts&) = delete;
  OutputParts& operator=(const OutputParts&) = delete;

  // Adds an empty file and returns its path.
  Result<std::string> Add();

 private:
  std::string folder_;
  std::string option_;
  std::vector<int> descriptors_;
};

// The error of a line "PATH: error: MESSAGE", whatever text precedes the path, with the user's name `output` in place
// of the path; nothing if the line is another one. The code is kFailure.
std::optional<Error> OutputFailure(const std::string& line, const std::string& path, const std::string& output);

// Merges files of JSON lines, each in the order of ticks, into `output`: by tick, and within a tick in the order of
// `parts`. Omitted are: a last line without its end, as left by a killed agent; a part that does not exist; and the
// second scan of a tick, as written by a restarted agent. With kFree the output fits even on a disk that the parts have
// filled. REQUIRES: parts are in the order of their robots.
Status MergeScans(const std::vector<std::string>& parts, const std::string& output, LineFile::Space space);

// Fails if two outputs are one file, by whatever paths; if an output is a file that the run reads (its world or
// scenario, an included file, an image, a controller library); or if one cannot be written. Changes no file, and leaves
// none that was not there.
Status CheckOutputs(const RunOptions& options);

// One kind of output file (scans, traces), of which each agent writes a part.
class AgentOutput {
 public:
  // `option`: its command-line option. `output`: the file that the parts are merged into; empty: the option is not set,
  // and there are no parts.
  AgentOutput(const std::string& option, const std::string& output);

  // Adds `count` parts if the option is set.
  Status AddParts(std::size_t count);

  bool empty() const { return files_.empty(); }
  const std::string& option() const { return option_; }
  // The parts on this host, in the order of AddParts.
  const std::vector<std::string>& files() const { return files_; }
  // The path that an agent on `host` writes its part to.
  std::string PathOn(const Host& host, std::size_t part) const;
  // The error about the user's file that a line reports which was printed on `host`; nothing for another line.
  std::optional<Error> FailureIn(const std::string& line, const Host& host) const;
  // Copies a part from the host into its file here; does nothing for this host.
  Status Fetch(Host& host, std::size_t part, const FetchProgress& progress) const;

 private:
  const std::string option_;
  const std::string output_;
  OutputParts parts_;
  std::vector<std::string> files_;
};

}  // namespace troupe
