// TokenSource: the tokens of a world file with those of its includes spliced in, as one stream.
#pragma once

#include <list>
#include <map>
#include <string>
#include <vector>

#include "common/base/allowed_paths.h"
#include "troupe/result.h"
#include "worldfile/stage/stage_lexer.h"

namespace troupe {

class TokenSource {
 public:
  // `memory_files`: if not null, the only files that includes find, by name; else they are looked up on disk, among
  // the `allowed` ones, which must outlive this.
  TokenSource(const std::map<std::string, std::string>* memory_files, const AllowedPaths& allowed)
      : memory_files_(memory_files), allowed_(allowed) {}

  // Starts with this text. REQUIRES: called once, before anything else.
  void Open(std::string text, const std::string& path);

  // The next token; an included file ends with a kEndOfLine.
  Result<Token> Next();

  // Continues with the file named by `name`, the token after the word `include`. Skips the rest of its line.
  Status Include(const Token& name);

  // Every file that was opened, in order.
  const std::vector<std::string>& files() const { return files_; }
  std::vector<Warning>& warnings() { return warnings_; }

 private:
  struct File {
    std::string path;
    std::string identity;  // equal for two paths to one file
    std::string text;
  };

  Result<std::string> Load(const std::string& path, const SourceLocation& where) const;
  void Push(std::string path, std::string text);

  const std::map<std::string, std::string>* memory_files_;
  const AllowedPaths& allowed_;
  std::list<File> opened_;          // all of them: tokens point into their texts
  std::vector<const File*> open_;   // the files being read, the innermost last
  std::vector<StageLexer> lexers_;  // of those
  std::vector<std::string> files_;
  std::vector<Warning> warnings_;
  std::size_t total_bytes_ = 0;
};

}  // namespace troupe
