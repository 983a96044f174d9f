#include "common/worldfile/stage_parser.h"

#include <algorithm>
#include <optional>

#include "common/worldfile/file_lookup.h"
#include "common/worldfile/quote.h"
#include "common/worldfile/text_file.h"
#include "common/worldfile/token_source.h"

namespace troupe {
namespace {

// What stands between the brackets of an entity or a define, or in a whole file.
struct Body {
  std::vector<Property> properties;
  std::vector<Entity> children;
};

// A recursive descent parser. Its methods return an error, or nothing when they have taken in what they are named for.
class Parser {
 public:
  Parser(TokenSource& source, WorldTree& tree, std::size_t max_items)
      : source_(source), tree_(tree), expander_(tree.defines, max_items), max_items_(max_items) {}

  Status ParseFile() {
    if (Status error = Advance()) return error;
    Body body;
    if (Status error = ParseBody(nullptr, 0, body)) return error;
    KeepLastOfEachName(body.properties);
    tree_.world.properties = std::move(body.properties);
    return std::nullopt;
  }

 private:
  using Kind = TokenKind;

  Status Advance() {
    Result<Token> next = source_.Next();
    if (!next.ok()) return next.error();
    token_ = next.value();
    return std::nullopt;
  }

  Error Unexpected(const std::string& expected) const {
    return Error{token_.where(), "found " + Describe(token_) + ", expected " + expected};
  }

  Status SkipEndsOfLines() {
    while (token_.kind == Kind::kEndOfLine) {
      if (Status error = Advance()) return error;
    }
    return std::nullopt;
  }

  Status CountItem(const SourceLocation& where) {
    if (++items_ <= max_items_) return std::nullopt;
    return Error{where, "found more than " + std::to_string(max_items_) + " models and properties, expected fewer"};
  }

  // Up to the closing bracket of `opener`, or to the end of the file if that is null.
  Status ParseBody(const Token* opener, int depth, Body& body) {
    if (depth > kMaxNesting) {
      return Error{opener->where(),
                   "found more than " + std::to_string(kMaxNesting) + " models inside each other, expected fewer"};
    }
    while (true) {
      if (Status error = SkipEndsOfLines()) return error;
      if (token_.kind == Kind::kCloseEntity && opener != nullptr) break;
      if (token_.kind == Kind::kEndOfFile) {
        if (opener == nullptr) break;
        const std::string file = opener->file == token_.file ? "line " : std::string(opener->file) + ":";
        return Unexpected("')' to close " + Quoted(opener->text) + " of " + file + std::to_string(opener->line));
      }
      if (token_.kind != Kind::kWord) {
        return Unexpected(opener != nullptr ? "a property, a model or ')'" : "a property or a model");
      }
      if (Status error = ParseStatement(opener, depth, body)) return error;
    }
    WarnOfRepeats(body.properties);
    return opener != nullptr ? Advance() : std::nullopt;
  }

  Status ParseStatement(const Token* opener, int depth, Body& body) {
    const Token name = token_;
    if (Status error = Advance()) return error;
    if (name.text == "include") return ParseInclude();
    if (name.text == "define") {
      if (opener == nullptr) return ParseDefine();
      return Error{name.where(), "found 'define' inside " + Quoted(opener->text) + ", expected it at the top level"};
    }
    if (Status error = CountItem(name.where())) return error;
    if (StartsValue(token_.kind)) return ParseProperty(name, body);
    // Only an opening bracket may stand on a later line.
    const Token after_name = token_;
    if (Status error = SkipEndsOfLines()) return error;
    if (token_.kind == Kind::kOpenEntity) return ParseEntity(name, depth, opener == nullptr, body);
    token_ = after_name;
    return Unexpected("a number, a string in quotes, '[' or '(' after " + Quoted(name.text));
  }

  static bool StartsValue(Kind kind) {
    return kind == Kind::kNumber || kind == Kind::kString || kind == Kind::kOpenTuple;
  }

  Status ParseInclude() {
    if (token_.kind != Kind::kString) return Unexpected("a file name in quotes after 'include'");
    const Token name = token_;
    if (Status error = source_.Include(name)) return error;
    return Advance();
  }

  Status ParseProperty(const Token& name, Body& body) {
    Property property;
    property.name = std::string(name.text);
    property.where = name.where();
    property.value.where = token_.where();
    if (token_.kind == Kind::kOpenTuple) {
      std::vector<Value::Scalar> tuple;
      if (Status error = ParseTuple(tuple)) return error;
      property.value.content = std::move(tuple);
    } else {
      Value::Scalar scalar = ScalarOf(token_);
      if (auto* number = std::get_if<Value::Number>(&scalar)) {
        property.value.content = std::move(*number);
      } else {
        property.value.content = std::move(std::get<std::string>(scalar));
      }
    }
    body.properties.push_back(std::move(property));
    return Advance();
  }

  static Value::Scalar ScalarOf(const Token& token) {
    if (token.kind == Kind::kString) return std::string(token.text);
    return Value::Number{token.number, std::string(token.text)};
  }

  // From '[' up to, but not over, ']'.
  Status ParseTuple(std::vector<Value::Scalar>& tuple) {
    const Token open = token_;
    while (true) {
      if (Status error = Advance()) return error;
      if (token_.kind == Kind::kCloseTuple) return std::nullopt;
      if (token_.kind != Kind::kNumber && token_.kind != Kind::kString) {
        return Unexpected("a number, a string in quotes, or ']' on the line of its '['");
      }
      if (Status error = CountItem(open.where())) return error;
      tuple.push_back(ScalarOf(token_));
    }
  }

  Status ParseEntity(const Token& name, int depth, bool top_level, Body& body) {
    Entity entity;
    entity.type = std::string(name.text);
    entity.where = name.where();
    if (Status error = Advance()) return error;
    Body inner;
    if (Status error = ParseBody(&name, depth + 1, inner)) return error;
    entity.properties = std::move(inner.properties);
    entity.children = std::move(inner.children);
    if (!top_level) {
      body.children.push_back(std::move(entity));
      return std::nullopt;
    }
    Result<Entity> expanded = expander_.Expand(entity);
    if (!expanded.ok()) return expanded.error();
    tree_.world.children.push_back(std::move(expanded).value());
    return std::nullopt;
  }

  Status ParseDefine() {
    if (token_.kind != Kind::kWord) return Unexpected("the name of a macro after 'define'");
    const Token name = token_;
    if (Status error = Advance()) return error;
    if (token_.kind != Kind::kWord) return Unexpected("the model type that " + Quoted(name.text) + " is made from");
    const Token base = token_;
    if (Status error = Advance()) return error;
    if (Status error = SkipEndsOfLines()) return error;
    if (token_.kind != Kind::kOpenEntity) return Unexpected("'(' to open the body of macro " + Quoted(name.text));
    if (Status error = Advance()) return error;
    Body body;
    if (Status error = ParseBody(&name, 1, body)) return error;
    Define define{std::string(base.text), std::move(body.properties), std::move(body.children), name.where()};
    const auto [place, is_new] = tree_.defines.try_emplace(std::string(name.text), std::move(define));
    if (!is_new) {
      const SourceLocation& first = place->second.where;
      tree_.warnings.push_back({name.where(), "macro " + Quoted(name.text) + " is already defined at " + first.file +
                                                  ":" + std::to_string(first.line) + "; this definition is ignored"});
    }
    return std::nullopt;
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

  TokenSource& source_;
  WorldTree& tree_;
  MacroExpander expander_;
  std::size_t max_items_;
  std::size_t items_ = 0;
  Token token_;
};

}  // namespace

Result<WorldTree> ParseStageText(const std::string& text, const std::string& path, const ParseOptions& options) {
  WorldTree tree;
  tree.world.type = "world";
  tree.world.where = {path, 1, 1};
  tree.directory = DirectoryOf(path);
  TokenSource source(options.memory_files);
  source.Open(text, path);
  if (Status error = Parser(source, tree, options.max_items).ParseFile()) return *error;
  tree.files = source.files();
  tree.warnings.insert(tree.warnings.end(), source.warnings().begin(), source.warnings().end());
  return tree;
}

Result<WorldTree> ParseStageWorld(const std::string& path) {
  Result<std::string> text = ReadTextFile(path, {path});
  if (!text.ok()) return text.error();
  return ParseStageText(text.value(), path);
}

Result<Entity> Instantiate(const WorldTree& tree, const std::string& name, const SourceLocation& where) {
  Entity written;
  written.type = name;
  written.where = where;
  return MacroExpander(tree.defines).Expand(written);
}

}  // namespace troupe
