#include "worldfile/stage/token_source.h"

#include <algorithm>
#include <filesystem>

#include "worldfile/text/file_lookup.h"
#include "worldfile/text/quote.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxIncludeDepth = 50;
constexpr std::size_t kMaxIncludes = 5000;
constexpr std::size_t kMaxTotalBytes = 4 * kMaxTextFileBytes;

std::string Identity(const std::string& path) {
  std::error_code error;
  const std::string canonical = std::filesystem::weakly_canonical(path, error).string();
  return error ? path : canonical;
}

}  // namespace

void TokenSource::Open(std::string text, const std::string& path) {
  Push(path, std::move(text));
}

void TokenSource::Push(std::string path, std::string text) {
  files_.push_back(path);
  total_bytes_ += text.size();
  std::string identity = memory_files_ != nullptr ? path : Identity(path);
  opened_.push_back({std::move(path), std::move(identity), std::move(text)});
  open_.push_back(&opened_.back());
  lexers_.emplace_back(opened_.back().text, opened_.back().path);
}

Result<Token> TokenSource::Next() {
  Result<Token> token = lexers_.back().Next();
  if (!token.ok() || token.value().kind != TokenKind::kEndOfFile) return token;
  if (const std::optional<SourceLocation> odd = lexers_.back().PopOddComment()) {
    warnings_.push_back({*odd, "a comment is not UTF-8"});
  }
  if (lexers_.size() > 1) {
    lexers_.pop_back();
    open_.pop_back();
    token.value().kind = TokenKind::kEndOfLine;
  }
  return token;
}

Status TokenSource::Include(const Token& name) {
  const SourceLocation where = name.where();
  const std::string wanted(name.text);
  if (lexers_.back().SkipLine()) {
    warnings_.push_back({where, "the text after an include on its line is ignored"});
  }
  if (lexers_.size() > kMaxIncludeDepth) {
    return Error{where,
                 "found more than " + std::to_string(kMaxIncludeDepth) + " includes inside each other, expected fewer"};
  }
  const std::string path =
      memory_files_ != nullptr ? wanted : FindFile(wanted, DirectoryOf(files_.front()), where.file);
  const std::string identity = memory_files_ != nullptr ? path : Identity(path);
  for (const File* file : open_) {
    if (file->identity == identity) {
      return Error{where, "found an include of " + QuotedPath(wanted) + " inside itself, expected no include loop"};
    }
  }
  Result<std::string> text = Load(path, where);
  if (!text.ok()) return text.error();
  if (files_.size() > kMaxIncludes || total_bytes_ + text.value().size() > kMaxTotalBytes) {
    return Error{where, "found too many includes, expected at most " + std::to_string(kMaxIncludes) + " files of " +
                            std::to_string(kMaxTotalBytes) + " bytes together"};
  }
  Push(path, std::move(text).value());
  return Status();
}

Result<std::string> TokenSource::Load(const std::string& path, const SourceLocation& where) const {
  if (memory_files_ == nullptr) return ReadTextFile(path, where, allowed_);
  const auto found = memory_files_->find(path);
  if (found == memory_files_->end())
    return Error{where, "cannot read " + QuotedPath(path) + ", expected a file that exists"};
  return found->second;
}

}  // namespace troupe
