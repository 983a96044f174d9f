#include "worldfile/stage/stage_world.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>
#include <vector>

#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxIncludeDepth = 50;
constexpr std::size_t kMaxIncludes = 5000;
constexpr std::size_t kMaxTotalBytes = 4 * kMaxTextFileBytes;

Error TooDeep(const SourceLocation& where) {
  return {where, "found more than " + std::to_string(kMaxNesting) + " models inside each other, expected fewer"};
}

// Equal for two paths to one file.
std::string Identity(const std::string& path) {
  std::error_code error;
  const std::string canonical = std::filesystem::weakly_canonical(path, error).string();
  return error ? path : canonical;
}

// Applies defines: from a node as written (its type may be a macro) to one with all properties and children of its
// macros.
class MacroExpander {
 public:
  // `defines` must outlive the expander, and may grow between calls.
  MacroExpander(const std::map<std::string, Define>& defines, std::size_t max_items)
      : defines_(defines), max_items_(max_items) {}

  Result<WorldNode> Expand(WorldNode written, int depth = 1) {
    if (depth > kMaxNesting) return TooDeep(written.where);
    WorldNode result;
    result.where = std::move(written.where);

    // From the macro that was written down to the base type.
    const std::size_t active_before = active_.size();
    std::vector<const Define*> chain;
    std::string name = std::move(written.type);
    for (auto found = defines_.find(name); found != defines_.end(); found = defines_.find(name)) {
      if (std::find(active_.begin(), active_.end(), name) != active_.end()) {
        return Error{result.where, "found macro " + Quoted(name) + " inside itself, expected no loop of defines"};
      }
      if (chain.size() == kMaxNesting) {
        return Error{result.where,
                     "found more than " + std::to_string(kMaxNesting) + " macros made from each other, expected fewer"};
      }
      active_.push_back(name);
      result.macros.push_back(name);
      chain.push_back(&found->second);
      name = found->second.base;
    }
    result.type = std::move(name);
    if (Status error = Count(1 + chain.size(), result.where); !error.ok()) return error.error();

    for (; !chain.empty(); chain.pop_back()) {
      const Define& define = *chain.back();
      if (Status error = AddBody(define.properties, define.children, depth, result); !error.ok()) return error.error();
      active_.pop_back();  // now the bodies of the macros further out
    }
    active_.resize(active_before);
    Status error = AddBody(std::move(written.properties), std::move(written.children), depth, result);
    if (!error.ok()) return error.error();
    result.properties = LastOfEachName(std::move(result.properties));
    return result;
  }

 private:
  // Adds these properties to the node, and these children expanded.
  Status AddBody(std::vector<Property> properties, std::vector<WorldNode> children, int depth, WorldNode& node) {
    if (Status error = Count(properties.size(), node.where); !error.ok()) return error;
    if (node.properties.empty()) {
      node.properties = std::move(properties);
    } else {
      std::move(properties.begin(), properties.end(), std::back_inserter(node.properties));
    }
    for (WorldNode& child : children) {
      Result<WorldNode> expanded = Expand(std::move(child), depth + 1);
      if (!expanded.ok()) return expanded.error();
      node.children.push_back(std::move(expanded).value());
    }
    return {};
  }

  Status Count(std::size_t items, const SourceLocation& where) {
    items_ += items;
    if (items_ <= max_items_) return {};
    return Error{where, "found more than " + std::to_string(max_items_) +
                            " models and properties once all defines are applied, expected fewer"};
  }

  const std::map<std::string, Define>& defines_;
  const std::size_t max_items_;
  std::size_t items_ = 0;
  std::vector<std::string> active_;  // the macros whose bodies are being applied
};

std::string FromLatin1(std::string_view text) {
  std::string utf8;
  for (const char c : text) {
    const unsigned char byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      utf8 += c;
    } else {
      utf8 += static_cast<char>(0xc0 | (byte >> 6));
      utf8 += static_cast<char>(0x80 | (byte & 0x3f));
    }
  }
  return utf8;
}

Value::Scalar ScalarOf(const StageTree& file, const TextSpan& span, double number) {
  const std::string_view text = span.Of(*file.text);
  if (text.front() == '"') {
    const std::string_view content = text.substr(1, text.size() - 2);
    return FindInvalidUtf8(content) == std::string_view::npos ? std::string(content) : FromLatin1(content);
  }
  return Value::Number{number, std::string(text)};
}

// The statements between the brackets of an entry or a define, or of a whole file, with those of includes.
struct Body {
  std::vector<Property> properties;
  std::vector<WorldNode> children;
};

// Where a body is: the name of its entry or define, and the number of entries around its statements. At the top level
// both are nothing.
struct Level {
  std::string_view opener;
  int depth = 0;
};

class WorldReader {
 public:
  WorldReader(const ParseOptions& options, WorldTree& tree)
      : options_(options), tree_(tree), expander_(tree.defines, options.max_items) {
    count_.most = options.max_items;
  }

  Status ReadTop(std::string text, const std::string& path) {
    Body body;
    if (Status error = ReadFile(std::move(text), path, {}, body); !error.ok()) return error;
    WarnOfRepeats(body.properties);
    tree_.world.properties = LastOfEachName(std::move(body.properties));
    std::move(of_syntax_.begin(), of_syntax_.end(), std::back_inserter(tree_.warnings));
    return {};
  }

 private:
  Status ReadFile(std::string text, const std::string& path, const Level& level, Body& body) {
    tree_.files.push_back(path);
    total_bytes_ += text.size();
    open_.push_back(IdentityOf(path));
    const Result<StageTree> file = ParseStage(std::move(text), path, count_);
    if (!file.ok()) return file.error();
    const std::vector<Warning>& warnings = file.value().warnings;
    of_syntax_.insert(of_syntax_.end(), warnings.begin(), warnings.end());
    Status status = ReadBody(file.value(), file.value().statements, level, body);
    open_.pop_back();
    return status;
  }

  // Appends to `body`; at the top level entries and defines go to the tree.
  Status ReadBody(const StageTree& file, const std::vector<Statement>& statements, const Level& level, Body& body) {
    for (const Statement& statement : statements) {
      Status status;
      switch (statement.kind) {
        case StatementKind::kProperty:
          body.properties.push_back({std::string(statement.name), ValueOf(file, statement), file.Where(statement)});
          break;
        case StatementKind::kEntry:
          status = ReadEntry(file, statement, level, body);
          break;
        case StatementKind::kDefine:
          status = ReadDefine(file, statement, level);
          break;
        case StatementKind::kInclude:
          status = Include(file, statement, level, body);
          break;
      }
      if (!status.ok()) return status;
    }
    return {};
  }

  // The statements of an entry or a define.
  Result<Body> ReadBracketed(const StageTree& file, const Statement& statement, int depth) {
    if (depth > kMaxNesting) return TooDeep(file.Where(statement));
    Body body;
    Status status = ReadBody(file, statement.statements, {statement.name, depth}, body);
    if (!status.ok()) return status.error();
    WarnOfRepeats(body.properties);
    return body;
  }

  Status ReadEntry(const StageTree& file, const Statement& statement, const Level& level, Body& body) {
    Result<Body> read = ReadBracketed(file, statement, level.depth + 1);
    if (!read.ok()) return read.error();
    WorldNode node{std::string(statement.name),
                   {},
                   std::move(read.value().properties),
                   std::move(read.value().children),
                   file.Where(statement)};
    if (level.depth > 0) {
      body.children.push_back(std::move(node));
      return {};
    }
    Result<WorldNode> expanded = expander_.Expand(std::move(node));
    if (!expanded.ok()) return expanded.error();
    tree_.world.children.push_back(std::move(expanded).value());
    return {};
  }

  Status ReadDefine(const StageTree& file, const Statement& statement, const Level& level) {
    if (level.depth > 0) {
      return Error{file.Where(statement, statement.span.begin),
                   "found 'define' inside " + Quoted(level.opener) + ", expected it at the top level"};
    }
    Result<Body> read = ReadBracketed(file, statement, 1);
    if (!read.ok()) return read.error();
    const SourceLocation where = file.Where(statement);
    Define define{std::string(statement.base), std::move(read.value().properties), std::move(read.value().children),
                  where};
    const auto [place, is_new] = tree_.defines.try_emplace(std::string(statement.name), std::move(define));
    if (!is_new) {
      const SourceLocation& first = place->second.where;
      tree_.warnings.push_back({where, "macro " + Quoted(statement.name) + " is already defined at " + first.file +
                                           ":" + std::to_string(first.line) + "; this definition is ignored"});
    }
    return {};
  }

  std::string IdentityOf(const std::string& path) const {
    return options_.memory_files != nullptr ? path : Identity(path);
  }

  // Reads the statements of another file in place of this one.
  Status Include(const StageTree& file, const Statement& statement, const Level& level, Body& body) {
    const SourceLocation where = file.Where(statement);
    const std::string wanted(statement.name);
    if (open_.size() > kMaxIncludeDepth) {
      return Error{
          where, "found more than " + std::to_string(kMaxIncludeDepth) + " includes inside each other, expected fewer"};
    }
    const std::string path =
        options_.memory_files != nullptr ? wanted : FindFile(wanted, DirectoryOf(tree_.files.front()), file.path);
    if (std::find(open_.begin(), open_.end(), IdentityOf(path)) != open_.end()) {
      return Error{where, "found an include of " + QuotedPath(wanted) + " inside itself, expected no include loop"};
    }
    Result<std::string> text = Load(path, where);
    if (!text.ok()) return text.error();
    if (tree_.files.size() > kMaxIncludes || total_bytes_ + text.value().size() > kMaxTotalBytes) {
      return Error{where, "found too many includes, expected at most " + std::to_string(kMaxIncludes) + " files of " +
                              std::to_string(kMaxTotalBytes) + " bytes together"};
    }
    return ReadFile(std::move(text).value(), path, level, body);
  }

  Result<std::string> Load(const std::string& path, const SourceLocation& where) const {
    if (options_.memory_files == nullptr) return ReadTextFile(path, where, options_.allowed);
    const auto found = options_.memory_files->find(path);
    if (found != options_.memory_files->end()) return found->second;
    return Error{where, "cannot read " + QuotedPath(path) + ", expected a file that exists"};
  }

  void WarnOfRepeats(const std::vector<Property>& properties) {
    if (properties.size() < 2) return;
    std::vector<const Property*> sorted;
    for (const Property& property : properties) sorted.push_back(&property);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Property* a, const Property* b) { return a->name < b->name; });
    for (std::size_t i = 1; i < sorted.size(); ++i) {
      if (sorted[i]->name != sorted[i - 1]->name) continue;
      tree_.warnings.push_back({sorted[i - 1]->where, "property " + Quoted(sorted[i]->name) +
                                                          " is given again at line " +
                                                          std::to_string(sorted[i]->where.line) + ", which counts"});
    }
  }

  const ParseOptions& options_;
  WorldTree& tree_;
  MacroExpander expander_;
  StageItemCount count_;
  std::vector<std::string> open_;  // identities of the files being read, the innermost last
  std::size_t total_bytes_ = 0;
  std::vector<Warning> of_syntax_;  // follow those of the content
};

}  // namespace

Value ValueOf(const StageTree& file, const Statement& property) {
  Value value{{}, file.Where(property, property.value.begin)};
  if ((*file.text)[property.value.begin] != '[') {
    std::visit([&](auto scalar) { value.content = std::move(scalar); },
               ScalarOf(file, property.value, property.number));
    return value;
  }
  auto& tuple = value.content.emplace<Value::Tuple>();
  tuple.reserve(property.elements.size());
  for (const StageElement& element : property.elements) {
    tuple.push_back(ScalarOf(file, element.span, element.number));
  }
  return value;
}

Result<WorldTree> ParseStageText(std::string text, const std::string& path, const ParseOptions& options) {
  WorldTree tree;
  tree.world.type = "world";
  tree.world.where = {path, 1, 1};
  tree.directory = DirectoryOf(path);
  if (Status error = WorldReader(options, tree).ReadTop(std::move(text), path); !error.ok()) return error.error();
  return tree;
}

Result<WorldTree> ParseStageWorld(const std::string& path, const AllowedPaths& allowed) {
  Result<std::string> text = ReadTextFile(path, {path}, allowed);
  if (!text.ok()) return text.error();
  ParseOptions options;
  options.allowed = allowed;
  return ParseStageText(std::move(text).value(), path, options);
}

Result<WorldNode> Instantiate(const WorldTree& tree, const std::string& name, const SourceLocation& where) {
  WorldNode written;
  written.type = name;
  written.where = where;
  return MacroExpander(tree.defines, StageItemCount().most).Expand(std::move(written));
}

}  // namespace troupe
