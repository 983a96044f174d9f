#include "worldfile/gazebo/xacro_expand.h"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "worldfile/gazebo/expression.h"
#include "worldfile/gazebo/xacro_parameters.h"
#include "worldfile/gazebo/xacro_scope.h"
#include "worldfile/gazebo/xml_values.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxEvaluations = 100'000;
constexpr int kMaxMacroDepth = 60;  // macros, includes and elements inside each other
constexpr std::size_t kMaxValueBytes = 1'000'000;

struct XacroMacro {
  std::vector<XacroParameter> parameters;
  const XmlElement* body = nullptr;
  std::string file;
  XacroScope* space = nullptr;  // that it was defined in; null: none
};

class XacroExpander {
 public:
  XacroExpander(const std::string& path, ModelFiles& files) : path_(path), files_(files) {}

  Result<XmlElement> Run(const XmlElement& root) {
    XmlElement result = Shell(root, path_);
    XacroScope global;
    ExpandChildren(root, path_, global, 1, result);
    for (XmlAttribute attribute : root.attributes) {
      attribute.value = Text(attribute.value, root, path_, global);
      result.attributes.push_back(std::move(attribute));
    }
    if (error_) return *error_;
    return result;
  }

 private:
  void Fail(const XmlElement& element, const std::string& file, const std::string& message) {
    if (!error_) error_ = Error{XmlPlace(element, file), message};
  }

  // The element without its content, placed in its file.
  XmlElement Shell(const XmlElement& element, const std::string& file) const {
    XmlElement shell;
    shell.name = element.name;
    if (file != path_) {
      shell.line = shell.column = shell.text_line = shell.text_column = 0;
    } else {
      shell.line = element.line;
      shell.column = element.column;
      shell.text_line = element.text_line;
      shell.text_column = element.text_column;
    }
    return shell;
  }

  void ExpandChildren(const XmlElement& element, const std::string& file, XacroScope& scope, int depth,
                      XmlElement& into) {
    for (const XmlElement& child : element.children) {
      if (error_) return;
      Expand(child, file, scope, depth, into);
    }
  }

  // Appends what the element stands for.
  void Expand(const XmlElement& element, const std::string& file, XacroScope& scope, int depth, XmlElement& into) {
    if (depth > kMaxMacroDepth)
      Fail(element, file, "found macros or includes too deep inside each other, expected fewer");
    if (++elements_ > kMaxXmlElements) Fail(element, file, "found too many elements of macros, expected fewer");
    if (error_) return;
    if (!element.name.starts_with("xacro:")) {
      XmlElement copy = Shell(element, file);
      copy.text = Text(element.text, element, file, scope);
      for (const XmlAttribute& attribute : element.attributes) {
        copy.attributes.push_back(attribute);
        copy.attributes.back().value = Text(attribute.value, element, file, scope);
        if (file != path_) copy.attributes.back().line = copy.attributes.back().column = 0;
      }
      ExpandChildren(element, file, scope, depth + 1, copy);
      into.children.push_back(std::move(copy));
      return;
    }
    const std::string word = element.name.substr(6);
    const auto attribute = [&](const char* name) { return XmlValues::Attribute(element, name); };
    if (word == "property") {
      SetProperty(element, file, scope);
    } else if (word == "arg") {
      arguments_.emplace(attribute("name"), Text(attribute("default"), element, file, scope));
    } else if (word == "macro") {
      XacroMacro macro;
      for (const std::string& parameter : ParameterWords(attribute("params")))
        macro.parameters.push_back(ParameterOf(parameter));
      macro.body = &element;
      macro.file = file;
      macro.space = SpaceOf(scope);
      std::string name = attribute("name");
      if (name.starts_with("xacro:")) name.erase(0, 6);
      macros_[(macro.space ? macro.space->prefix : "") + name] = std::move(macro);
    } else if (word == "include") {
      Include(element, file, scope, depth, into);
    } else if (word == "if" || word == "unless") {
      const std::string text = Text(attribute("value"), element, file, scope);
      const ExpressionValue value = ValueOfText(text);
      if (std::holds_alternative<std::string>(value) && !error_) {
        Fail(element, file, "found " + Quoted(text) + " as a condition, expected true or false");
      }
      if (!error_ && IsTrue(value) == (word == "if")) ExpandChildren(element, file, scope, depth + 1, into);
    } else if (word == "insert_block") {
      const std::string name = Text(attribute("name"), element, file, scope);
      for (XacroScope* at = &scope; at != nullptr; at = at->outer) {
        const auto found = at->blocks.find(name);
        if (found == at->blocks.end()) continue;
        elements_ += found->second.size();
        into.children.insert(into.children.end(), found->second.begin(), found->second.end());
        return;
      }
      Fail(element, file, "found the block " + Quoted(name) + ", expected one that is a parameter or a property");
    } else if (const XacroMacro* const macro = FindMacro(word, scope)) {
      Call(element, *macro, file, scope, depth, into);
    } else {
      Fail(element, file,
           "found " + Quoted(element.name) +
               ", expected a macro of the file: others, and what else "
               "xacro has, are known to the program 'xacro' only");
    }
  }

  // Sought in the name space of the scope, then in those around it.
  const XacroMacro* FindMacro(const std::string& name, XacroScope& scope) const {
    const XacroScope* const space = SpaceOf(scope);
    std::string prefix = space ? space->prefix : "";
    while (true) {
      if (const auto found = macros_.find(prefix + name); found != macros_.end()) return &found->second;
      if (prefix.empty()) return nullptr;
      prefix.pop_back();
      const std::size_t dot = prefix.rfind('.');
      prefix.resize(dot == std::string::npos ? 0 : dot + 1);
    }
  }

  void SetProperty(const XmlElement& element, const std::string& file, XacroScope& scope) {
    const std::string name = Text(XmlValues::Attribute(element, "name"), element, file, scope);
    XacroScope* target = &scope;
    const std::string where = XmlValues::Attribute(element, "scope");
    if (where == "parent" && scope.outer != nullptr) target = scope.outer;
    while (where == "global" && target->outer != nullptr) target = target->outer;
    if (XmlValues::Attribute(element, "remove") == "true") {
      target->texts.erase(name);
      target->blocks.erase(name);
      return;
    }
    const std::string* value = element.FindAttribute("value");
    const std::string* const otherwise = element.FindAttribute("default");
    if (value == nullptr && otherwise != nullptr) {
      if (FindProperty(name, scope).first != nullptr) return;
      value = otherwise;
    }
    if (value == nullptr) {
      XmlElement content;
      ExpandChildren(element, file, scope, 1, content);
      target->blocks[name] = std::move(content.children);
    } else if (where.empty() && XmlValues::Attribute(element, "lazy_eval") != "false") {
      // As it is: names in it may get other values before its first use.
      target->texts[name] = *value;
    } else {
      target->texts[name] = Literal(Text(*value, element, file, scope));
    }
  }

  void Include(const XmlElement& element, const std::string& file, XacroScope& scope, int depth, XmlElement& into) {
    const std::string name = Text(XmlValues::Attribute(element, "filename"), element, file, scope);
    if (error_) return;
    const SourceLocation where = XmlPlace(element, file);
    const Result<std::string> found = files_.Find(name, file, where);
    const auto root = found.ok() ? files_.ReadXml(found.value(), where) : found.error();
    if (!root.ok()) {
      if (XmlValues::Attribute(element, "optional") != "true" && !error_) error_ = root.error();
      return;
    }
    kept_.push_back(root.value());
    const std::string name_space = XmlValues::Attribute(element, "ns");
    if (name_space.empty()) {
      ExpandChildren(*root.value(), found.value(), scope, depth + 1, into);
      return;
    }
    XacroScope*& space = scope.spaces[name_space];
    if (space == nullptr) space = &spaces_.emplace_back();
    const XacroScope* const around = SpaceOf(scope);
    space->prefix = (around ? around->prefix : "") + name_space + ".";
    space->outer = &scope;
    ExpandChildren(*root.value(), found.value(), *space, depth + 1, into);
    // Of a call the scope ends, but its macros stay.
    while (space->outer->outer != nullptr) space->outer = space->outer->outer;
  }

  void Call(const XmlElement& call, const XacroMacro& macro, const std::string& file, XacroScope& scope, int depth,
            XmlElement& into) {
    XacroScope own;
    own.outer = &scope;
    own.space = macro.space;
    XmlElement blocks;
    ExpandChildren(call, file, scope, depth + 1, blocks);
    std::size_t next = 0;
    for (const XacroParameter& parameter : macro.parameters) {
      if (error_) return;
      if (parameter.stars > 0) {
        if (next == blocks.children.size()) {
          Fail(call, file, "found no block " + Quoted(parameter.name) + ", expected an element for it");
          return;
        }
        XmlElement& block = blocks.children[next++];
        if (parameter.stars == 1) {
          own.blocks[parameter.name] = {std::move(block)};
        } else {
          own.blocks[parameter.name] = std::move(block.children);
        }
        continue;
      }
      if (const std::string* const value = call.FindAttribute(parameter.name)) {
        own.texts[parameter.name] = Literal(Text(*value, call, file, scope));
      } else if (parameter.inherits && FindProperty(parameter.name, scope).first != nullptr) {
        own.texts[parameter.name] = Literal(Text("${" + parameter.name + "}", call, file, scope));
      } else if (parameter.otherwise) {
        own.texts[parameter.name] = Literal(Text(*parameter.otherwise, call, file, own));
      } else {
        Fail(call, file, "found no value for " + Quoted(parameter.name) + ", expected the attribute");
      }
    }
    ExpandChildren(*macro.body, macro.file, own, depth + 1, into);
  }

  // A text that stands for itself when it is evaluated.
  static std::string Literal(const std::string& text) {
    std::string literal;
    for (std::size_t i = 0; i < text.size(); ++i) {
      literal += text[i];
      if (text[i] == '$' && i + 1 < text.size() && (text[i + 1] == '{' || text[i + 1] == '(')) literal += '$';
    }
    return literal;
  }

  std::string Text(const std::string& text, const XmlElement& element, const std::string& file, XacroScope& scope) {
    if (error_ || text.find('$') == std::string::npos) return text;
    const Result<ExpressionValue> value = Substitute(text, file, scope, 0);
    if (!value.ok()) {
      if (!error_) error_ = Error{XmlPlace(element, file), value.error().message};
      return "";
    }
    return ToText(value.value());
  }

  // A text with its expressions and commands replaced; a lone expression keeps its type.
  Result<ExpressionValue> Substitute(const std::string& text, const std::string& file, XacroScope& scope, int depth) {
    if (depth > kMaxMacroDepth) return Error{{}, "found properties that refer to each other, expected no circle"};
    if (++evaluations_ > kMaxEvaluations) return Error{{}, "found too many expressions, expected fewer"};
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t sign = std::min(text.find('$', at), text.size());
      out += text.substr(at, sign - at);
      at = sign;
      if (at >= text.size()) break;
      const char open = at + 1 < text.size() ? text[at + 1] : ' ';
      if (open == '$' && at + 2 < text.size() && (text[at + 2] == '{' || text[at + 2] == '(')) {
        // "$${" is a literal "${".
        out += text.substr(at, 1);
        out += text[at + 2];
        at += 3;
        continue;
      }
      if (open != '{' && open != '(') {
        out += text[at++];
        continue;
      }
      const char close = open == '{' ? '}' : ')';
      int level = 0;
      std::size_t end = at + 1;
      for (; end < text.size(); ++end) {
        level += text[end] == open ? 1 : text[end] == close ? -1 : 0;
        if (level == 0) break;
      }
      if (end >= text.size()) return Error{{}, "found " + Quoted(text.substr(at)) + " without its end"};
      const std::string inner = text.substr(at + 2, end - at - 2);
      Result<ExpressionValue> value =
          open == '{' ? Expression(inner, file, scope, depth) : Command(inner, file, scope, depth);
      if (!value.ok()) return value;
      if (at == 0 && end + 1 == text.size()) return value;
      out += ToText(value.value());
      if (out.size() > kMaxValueBytes) return Error{{}, "found a text that is too long, expected a shorter one"};
      at = end + 1;
    }
    return ExpressionValue(std::move(out));
  }

  // Commands in an expression are replaced before it is evaluated: ${'$(arg sim)' == 'gazebo'}.
  Result<ExpressionValue> Expression(const std::string& written, const std::string& file, XacroScope& scope,
                                     int depth) {
    std::string text = written;
    if (text.find('$') != std::string::npos) {
      Result<ExpressionValue> replaced = Substitute(written, file, scope, depth + 1);
      if (!replaced.ok()) return replaced;
      text = ToText(replaced.value());
    }
    return Evaluate(text, [&](const std::string& name) -> Result<std::optional<ExpressionValue>> {
      const auto [raw, at] = FindProperty(name, scope);
      if (raw == nullptr) return std::optional<ExpressionValue>();
      const bool is_first_use = raw->find('$') != std::string::npos;
      Result<ExpressionValue> value = Substitute(*raw, file, *at, depth + 1);
      if (!value.ok()) return value.error();
      if (is_first_use) *raw = Literal(ToText(value.value()));
      // A property that looks like a number is one.
      const auto* const found = std::get_if<std::string>(&value.value());
      return std::optional(found != nullptr ? ValueOfText(*found) : std::move(value).value());
    });
  }

  Result<ExpressionValue> Command(const std::string& inner, const std::string& file, XacroScope& scope, int depth) {
    Result<ExpressionValue> replaced = Substitute(inner, file, scope, depth + 1);
    if (!replaced.ok()) return replaced;
    const std::vector<std::string> words = ParameterWords(ToText(replaced.value()));
    const std::string word = words.empty() ? "" : words[0];
    const std::string name = words.size() > 1 ? words[1] : "";
    if (word == "arg") {
      const auto found = arguments_.find(name);
      if (found != arguments_.end()) return ExpressionValue(found->second);
      return Error{{}, "found the argument " + Quoted(name) + " without a default, expected one: xacro:arg"};
    }
    if (word == "find") {
      Result<std::string> folder = files_.Find("package://" + name, file, {});
      if (!folder.ok()) return Error{{}, folder.error().message};
      return ExpressionValue(std::move(folder).value());
    }
    if (word == "env" || word == "optenv") {
      const char* const value = std::getenv(name.c_str());
      if (value != nullptr) return ExpressionValue(std::string(value));
      if (word == "env") return Error{{}, "found the variable " + Quoted(name) + ", which is not set"};
      std::string otherwise;
      for (std::size_t i = 2; i < words.size(); ++i) otherwise += (i > 2 ? " " : "") + words[i];
      return ExpressionValue(otherwise);
    }
    if (word == "eval") return Expression(inner.substr(inner.find("eval") + 4), file, scope, depth + 1);
    if (word == "dirname" || word == "cwd") return ExpressionValue(DirectoryOf(file));
    return Error{{}, "found " + Quoted("$(" + inner + ")") + ", expected arg, find, env, optenv, eval or dirname"};
  }

  const std::string path_;
  ModelFiles& files_;
  std::map<std::string, XacroMacro> macros_;
  std::map<std::string, std::string> arguments_;
  std::deque<std::shared_ptr<const XmlElement>> kept_;  // the files of macros
  std::deque<XacroScope> spaces_;                       // of macros
  std::size_t elements_ = 0;
  std::size_t evaluations_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Result<XmlElement> ExpandXacro(const XmlElement& root, const std::string& path, ModelFiles& files) {
  return XacroExpander(path, files).Run(root);
}

bool HasXacro(const XmlElement& root) {
  return std::any_of(root.children.begin(), root.children.end(),
                     [](const XmlElement& child) { return child.name.starts_with("xacro:"); });
}

}  // namespace troupe
