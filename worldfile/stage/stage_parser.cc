#include "worldfile/stage/stage_parser.h"

#include <algorithm>
#include <optional>

#include "worldfile/stage/token_source.h"
#include "worldfile/text/file_lookup.h"
#include "worldfile/text/quote.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// The statements between the brackets of a node or a define, or of a whole file.
struct Body {
  std::vector<Property> properties;
  std::vector<WorldNode> children;
};

// A recursive descent parser. Each Parse method consumes the tokens of the construct in its name.
class Parser {
 public:
  Parser(TokenSource& source, WorldTree& tree, std::size_t max_items)
      : source_(source), tree_(tree), expander_(tree.defines, max_items), max_items_(max_items) {}

  Status ParseFile() {
    if (Status error = Advance(); !error.ok()) return error;
    Result<Body> body = ParseBody(nullptr, 0);
    if (!body.ok()) return body.error();
    tree_.world.properties = LastOfEachName(std::move(body.value().properties));
    return Status();
  }

 private:
  using Kind = TokenKind;

  Status Advance() {
    Result<Token> next = source_.Next();
    if (!next.ok()) return next.error();
    token_ = next.value();
    return Status();
  }

  Error Unexpected(const std::string& expected) const {
    return Error{token_.where(), "found " + Describe(token_) + ", expected " + expected};
  }

  Status SkipEndsOfLines() {
    while (token_.kind == Kind::kEndOfLine) {
      if (Status error = Advance(); !error.ok()) return error;
    }
    return Status();
  }

  Status CountItem(const SourceLocation& where) {
    if (++items_ <= max_items_) return Status();
    return Error{where, "found more than " + std::to_string(max_items_) + " models and properties, expected fewer"};
  }

  // Up to the closing bracket of `opener`, or to the end of the file if that is null.
  Result<Body> ParseBody(const Token* opener, int depth) {
    if (depth > kMaxNesting) {
      return Error{opener->where(),
                   "found more than " + std::to_string(kMaxNesting) + " models inside each other, expected fewer"};
    }
    Body body;
    while (true) {
      if (Status error = SkipEndsOfLines(); !error.ok()) return error.error();
      if (token_.kind == Kind::kCloseBody && opener != nullptr) break;
      if (token_.kind == Kind::kEndOfFile) {
        if (opener == nullptr) break;
        const std::string file = opener->file == token_.file ? "line " : std::string(opener->file) + ":";
        return Unexpected("')' to close " + Quoted(opener->text) + " of " + file + std::to_string(opener->line));
      }
      if (token_.kind != Kind::kWord) {
        return Unexpected(opener != nullptr ? "a property, a model or ')'" : "a property or a model");
      }
      if (Status error = ParseStatement(opener, depth, body); !error.ok()) return error.error();
    }
    WarnOfRepeats(body.properties);
    if (opener == nullptr) return body;
    if (Status error = Advance(); !error.ok()) return error.error();
    return body;
  }

  // Appends the statement to `body`, or to the tree's defines.
  Status ParseStatement(const Token* opener, int depth, Body& body) {
    const Token name = token_;
    if (Status error = Advance(); !error.ok()) return error;
    if (name.text == "include") return ParseInclude();
    if (name.text == "define") {
      if (opener == nullptr) return ParseDefine();
      return Error{name.where(), "found 'define' inside " + Quoted(opener->text) + ", expected it at the top level"};
    }
    if (Status error = CountItem(name.where()); !error.ok()) return error;
    if (StartsValue(token_.kind)) {
      Result<Property> property = ParseProperty(name);
      if (!property.ok()) return property.error();
      body.properties.push_back(std::move(property).value());
      return Status();
    }
    // Only an opening bracket may be on a later line.
    const Token after_name = token_;
    if (Status error = SkipEndsOfLines(); !error.ok()) return error;
    if (token_.kind == Kind::kOpenBody) {
      Result<WorldNode> node = ParseNode(name, depth);
      if (!node.ok()) return node.error();
      if (opener == nullptr) return AddToWorld(node.value());
      body.children.push_back(std::move(node).value());
      return Status();
    }
    token_ = after_name;
    return Unexpected("a number, a string in quotes, '[' or '(' after " + Quoted(name.text));
  }

  static bool StartsValue(Kind kind) {
    return kind == Kind::kNumber || kind == Kind::kString || kind == Kind::kOpenTuple;
  }

  Status ParseInclude() {
    if (token_.kind != Kind::kString) return Unexpected("a file name in quotes after 'include'");
    const Token name = token_;
    if (Status error = source_.Include(name); !error.ok()) return error;
    return Advance();
  }

  Result<Property> ParseProperty(const Token& name) {
    Property property;
    property.name = std::string(name.text);
    property.where = name.where();
    property.value.where = token_.where();
    if (token_.kind == Kind::kOpenTuple) {
      Result<std::vector<Value::Scalar>> tuple = ParseTuple();
      if (!tuple.ok()) return tuple.error();
      property.value.content = std::move(tuple).value();
    } else {
      Value::Scalar scalar = ScalarOf(token_);
      if (auto* number = std::get_if<Value::Number>(&scalar)) {
        property.value.content = std::move(*number);
      } else {
        property.value.content = std::move(std::get<std::string>(scalar));
      }
    }
    if (Status error = Advance(); !error.ok()) return error.error();
    return property;
  }

  static Value::Scalar ScalarOf(const Token& token) {
    if (token.kind == Kind::kString) return std::string(token.text);
    return Value::Number{token.number, std::string(token.text)};
  }

  // From '[' up to, but not over, ']'.
  Result<std::vector<Value::Scalar>> ParseTuple() {
    const Token open = token_;
    std::vector<Value::Scalar> tuple;
    while (true) {
      if (Status error = Advance(); !error.ok()) return error.error();
      if (token_.kind == Kind::kCloseTuple) return tuple;
      if (token_.kind != Kind::kNumber && token_.kind != Kind::kString) {
        return Unexpected("a number, a string in quotes, or ']' on the line of its '['");
      }
      if (Status error = CountItem(open.where()); !error.ok()) return error.error();
      tuple.push_back(ScalarOf(token_));
    }
  }

  // REQUIRES: the token is '('.
  Result<WorldNode> ParseNode(const Token& name, int depth) {
    WorldNode node;
    node.type = std::string(name.text);
    node.where = name.where();
    if (Status error = Advance(); !error.ok()) return error.error();
    Result<Body> body = ParseBody(&name, depth + 1);
    if (!body.ok()) return body.error();
    node.properties = std::move(body.value().properties);
    node.children = std::move(body.value().children);
    return node;
  }

  Status AddToWorld(const WorldNode& node) {
    Result<WorldNode> expanded = expander_.Expand(node);
    if (!expanded.ok()) return expanded.error();
    tree_.world.children.push_back(std::move(expanded).value());
    return Status();
  }

  Status ParseDefine() {
    if (token_.kind != Kind::kWord) return Unexpected("the name of a macro after 'define'");
    const Token name = token_;
    if (Status error = Advance(); !error.ok()) return error;
    if (token_.kind != Kind::kWord) return Unexpected("the model type that " + Quoted(name.text) + " is made from");
    const Token base = token_;
    if (Status error = Advance(); !error.ok()) return error;
    if (Status error = SkipEndsOfLines(); !error.ok()) return error;
    if (token_.kind != Kind::kOpenBody) return Unexpected("'(' to open the body of macro " + Quoted(name.text));
    if (Status error = Advance(); !error.ok()) return error;
    Result<Body> parsed = ParseBody(&name, 1);
    if (!parsed.ok()) return parsed.error();
    Body body = std::move(parsed).value();
    Define define{std::string(base.text), std::move(body.properties), std::move(body.children), name.where()};
    const auto [place, is_new] = tree_.defines.try_emplace(std::string(name.text), std::move(define));
    if (!is_new) {
      const SourceLocation& first = place->second.where;
      tree_.warnings.push_back({name.where(), "macro " + Quoted(name.text) + " is already defined at " + first.file +
                                                  ":" + std::to_string(first.line) + "; this definition is ignored"});
    }
    return Status();
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
  TokenSource source(options.memory_files, options.allowed);
  source.Open(text, path);
  if (Status error = Parser(source, tree, options.max_items).ParseFile(); !error.ok()) return error.error();
  tree.files = source.files();
  tree.warnings.insert(tree.warnings.end(), source.warnings().begin(), source.warnings().end());
  return tree;
}

Result<WorldTree> ParseStageWorld(const std::string& path, const AllowedPaths& allowed) {
  Result<std::string> text = ReadTextFile(path, {path}, allowed);
  if (!text.ok()) return text.error();
  ParseOptions options;
  options.allowed = allowed;
  return ParseStageText(text.value(), path, options);
}

Result<WorldNode> Instantiate(const WorldTree& tree, const std::string& name, const SourceLocation& where) {
  WorldNode written;
  written.type = name;
  written.where = where;
  return MacroExpander(tree.defines).Expand(written);
}

}  // namespace troupe
