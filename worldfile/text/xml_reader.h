// XmlDocument: the elements of an XML text, with their places. SDF, URDF, model.config and COLLADA files are read by
// it.
//
// A text may come from a stranger: its size, its depth and its elements are limited, and a document type that declares
// entities is an error, so that a few lines cannot stand for a billion. Namespaces are no concept here: "gz:policies"
// is a name. Text between the elements of a parent, which some files have by mistake, is kept as the parent's text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/result.h"
#include "worldfile/text/text_file.h"

namespace troupe {

struct XmlAttribute {
  std::string name;
  std::string value;  // with references replaced
  int line = 1;       // of the name, from 1, as the column (in bytes)
  int column = 1;
};

struct XmlElement {
  std::string name;
  int line = 1;  // of its "<"
  int column = 1;
  int text_line = 1;  // of the first character of its text that is no blank; of its end without one
  int text_column = 1;
  std::string text;  // its character data, without that of its children, with references replaced
  std::vector<XmlAttribute> attributes;
  std::vector<XmlElement> children;

  // The first child of that name; null without one.
  const XmlElement* Find(std::string_view child) const;
  // The value of the attribute; null without it.
  const std::string* FindAttribute(std::string_view attribute) const;
  // The text without blanks at its ends.
  std::string_view Trimmed() const;
};

inline constexpr std::size_t kMaxXmlElements = 300'000;
inline constexpr std::size_t kMaxXmlDepth = 100;

// The root element of a text. `path` is for messages.
Result<XmlElement> ParseXml(std::string_view text, const std::string& path);

// The place of an element, of its text, or of an attribute of it.
SourceLocation XmlPlace(const XmlElement& element, const std::string& path);
SourceLocation XmlTextPlace(const XmlElement& element, const std::string& path);
SourceLocation XmlPlace(const XmlAttribute& attribute, const std::string& path);

}  // namespace troupe
