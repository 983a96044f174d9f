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

Error TooLong(const SourceLocation& where) {
  return {where, "found more than " + std::to_string(kMaxNesting) + " macros made from each other, expected fewer"};
}

// Equal for two paths to one file.
std::string Identity(const std::string& path) {
  std::error_code error;
  const std::string canonical = std::filesystem::weakly_canonical(path, error).string();
  return error ? path : canonical;
}

// Applies defines: from a node as written (its type may be a macro) to one with all properties and children of its
// macros. A macro is applied once: the nodes made from it share its children.
class MacroExpander {
 public:
  // `defines` must outlive the expander, and may grow between calls.
  MacroExpander(const std::map<std::string, Define>& defines, std::size_t max_items)
      : defines_(defines), max_items_(max_items) {}

  // `depth`: of the node, 1 at the top level.
  Result<WorldNode> Expand(const WorldNode& written, int depth = 1) {
    if (depth > kMaxNesting) return TooDeep(written.where);
    deepest_ = std::max(deepest_, depth);
    WorldNode result;
    if (defines_.contains(written.type)) {
      Result<const Applied*> applied = Apply(written.type, written.where, depth, 1);
      if (!applied.ok()) return applied.error();
      result = applied.value()->node;
    } else {
      result.type = written.type;
    }
    result.where = written.where;
    ++nodes_;
    if (Status error = Count(1, result.where); !error.ok()) return error.error();
    if (Status error = AddBody(written, depth, result); !error.ok()) return error.error();
    return result;
  }

 private:
  // A node made from a macro, with nothing in its body.
  struct Applied {
    WorldNode node;
    std::size_t below = 0;  // nodes
    int levels = 0;         // of nodes inside each other, below this one
  };

  // The macro `name`, of a node at `where`, or of the macro that is made from it: `length` of them so far.
  Result<const Applied*> Apply(const std::string& name, const SourceLocation& where, int depth, std::size_t length) {
    // Defines are only added, never changed: the count tells whether an applied macro is still up to date.
    if (known_ != defines_.size()) applied_.clear();  // a base may be a macro by now
    known_ = defines_.size();
    if (std::find(active_.begin(), active_.end(), name) != active_.end()) {
      return Error{where, "found macro " + Quoted(name) + " inside itself, expected no loop of defines"};
    }
    if (const auto found = applied_.find(name); found != applied_.end()) {
      const Applied& applied = found->second;
      // The limits of an applied macro are checked again: it may now be deeper in the tree than where it was first
      // applied.
      if (length + applied.node.macros.size() > kMaxNesting + 1) return TooLong(where);
      if (depth + applied.levels > kMaxNesting) return TooDeep(where);
      deepest_ = std::max(deepest_, depth + applied.levels);
      nodes_ += applied.below;
      const std::size_t items = applied.below + applied.node.properties.size();
      if (Status error = Count(items, where); !error.ok()) return error.error();
      return &applied;
    }
    if (length > kMaxNesting) return TooLong(where);
    const std::size_t nodes_before = nodes_;
    // The depth below this macro alone is wanted, so that it can be added to the depth of each later use.
    const int deepest_before = std::exchange(deepest_, depth);
    active_.push_back(name);
    const Define& define = defines_.at(name);
    Applied applied;
    if (defines_.contains(define.base)) {
      Result<const Applied*> base = Apply(define.base, where, depth, length + 1);
      if (!base.ok()) return base;
      applied.node = base.value()->node;
    } else {
      applied.node.type = define.base;
    }
    applied.node.macros.insert(applied.node.macros.begin(), name);
    applied.node.where = where;
    if (define.draft != nullptr) applied.node.draft = define.draft;
    if (Status error = AddBody(define, depth, applied.node); !error.ok()) return error.error();
    active_.pop_back();
    applied.below = nodes_ - nodes_before;
    applied.levels = deepest_ - depth;
    deepest_ = std::max(deepest_, deepest_before);
    return &applied_.insert_or_assign(name, std::move(applied)).first->second;
  }

  // Adds the properties of this node or define to the node, and its children expanded.
  template <typename NodeOrDefine>
  Status AddBody(const NodeOrDefine& body, int depth, WorldNode& node) {
    if (Status error = Count(body.properties.size(), node.where); !error.ok()) return error;
    node.properties.insert(node.properties.end(), body.properties.begin(), body.properties.end());
    node.properties = LastOfEachName(std::move(node.properties));
    for (const WorldNode& child : body.children) {
      Result<WorldNode> expanded = Expand(child, depth + 1);
      if (!expanded.ok()) return expanded.error();
      node.children.Add(std::move(expanded).value());
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
  std::size_t items_ = 0;  // nodes, and properties that are not shared
  std::size_t nodes_ = 0;
  int deepest_ = 0;                         // node since the macro that is being applied began
  std::vector<std::string> active_;         // the macros whose bodies are being applied
  std::map<std::string, Applied> applied_;  // with the defines known so far
  std::size_t known_ = 0;                   // defines
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

// The statements between the brackets of an entry or a define, or of a whole file, with the statements of its includes.
struct Body {
  std::vector<Property> properties;
  ChildNodes children;
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
      body.children.Add(std::move(node));
      return {};
    }
    Result<WorldNode> expanded = expander_.Expand(node);
    if (!expanded.ok()) return expanded.error();
    tree_.world.children.Add(std::move(expanded).value());
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
    // Only files that are open count: one include file may be read twice side by side, as in Stage.
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
  std::vector<Warning> of_syntax_;  // follow the warnings of the content
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
  return MacroExpander(tree.defines, StageItemCount().most).Expand(written);
}

}  // namespace troupe
