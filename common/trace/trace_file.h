// TraceFile: a file in Chrome's trace format, an object on each line; and the merging of several.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "troupe/ids.h"
#include "troupe/result.h"

namespace troupe {

class TraceFile {
 public:
  // `process`: its name in viewers.
  static Result<TraceFile> Create(const std::string& path, const std::string& process);

  // ns since 1970, so that the files of several hosts agree as well as their clocks. Never decreases.
  static std::int64_t Now();

  // A phase from `begin` to `end`, ns as of Now. `robot` may be empty. Writes nothing after an error.
  void Write(const char* name, std::size_t lane, std::int64_t begin, std::int64_t end, Tick tick,
             const std::string& robot);

  // The first error of a write (a full disk).
  const Status& status() const { return status_; }
  // Writes all buffered text. Returns status().
  Status Close();

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  TraceFile(std::string path, std::FILE* file) : path_(std::move(path)), file_(file) {}
  void Fail();

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
  Status status_;
};

// One file of several, with times from the first event on. Parts that do not exist, and last lines that were cut off,
// as by killed processes, are left out. Frees the space of the parts, so that the file fits even on a full disk.
Status MergeTraces(const std::vector<std::string>& parts, const std::string& output);

}  // namespace troupe
