#include "worldfile/text/xml_reader.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>

namespace troupe {
namespace {

constexpr std::string_view kXmlBlanks = " \t\r\n";

bool IsXmlBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

// Letters, digits and the signs of names; all bytes of other alphabets.
bool IsXmlNameByte(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == ':' ||
         c == '-' || c == '.' || static_cast<unsigned char>(c) >= 0x80;
}

void AppendUtf8(std::uint32_t code, std::string& text) {
  const auto byte = [&](std::uint32_t value) { text += static_cast<char>(value); };
  if (code < 0x80) {
    byte(code);
  } else if (code < 0x800) {
    byte(0xc0 | code >> 6);
    byte(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    byte(0xe0 | code >> 12);
    byte(0x80 | (code >> 6 & 0x3f));
    byte(0x80 | (code & 0x3f));
  } else {
    byte(0xf0 | code >> 18);
    byte(0x80 | (code >> 12 & 0x3f));
    byte(0x80 | (code >> 6 & 0x3f));
    byte(0x80 | (code & 0x3f));
  }
}

// Reads one text from its beginning; the first fault ends it.
class XmlParser {
 public:
  XmlParser(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  Result<XmlElement> Parse() {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
    if (const std::size_t nul = text_.find('\0'); nul != std::string_view::npos) {
      Advance(nul);
      return Fault("found a NUL byte, expected text");
    }
    SkipMisc();
    if (error_) return *error_;
    if (!StartsWith("<")) return Fault("found " + Here() + ", expected an XML element");
    XmlElement root = Element(1);
    if (error_) return *error_;
    SkipMisc();
    if (error_) return *error_;
    if (at_ < text_.size()) return Fault("found " + Here() + " after the root element, expected the end of the file");
    return root;
  }

 private:
  bool StartsWith(std::string_view word) const { return text_.substr(at_).starts_with(word); }

  // Moves to byte `to`, counting lines.
  void Advance(std::size_t to) {
    for (; at_ < to; ++at_) {
      if (text_[at_] != '\n') continue;
      ++line_;
      line_begin_ = at_ + 1;
    }
  }

  int Column() const { return static_cast<int>(at_ - line_begin_) + 1; }

  // The next characters, for messages.
  std::string Here() const {
    if (at_ >= text_.size()) return "the end of the file";
    const std::string_view rest = text_.substr(at_, 24);
    return Quoted(std::string(rest.substr(0, rest.find_first_of("\r\n"))));
  }

  Error Fault(const std::string& message) {
    if (!error_) error_ = Error{{path_, line_, Column()}, message};
    return *error_;
  }

  void SkipBlanks() {
    std::size_t to = at_;
    while (to < text_.size() && IsXmlBlank(text_[to])) ++to;
    Advance(to);
  }

  // Moves behind the next `end`. False: there is none.
  bool SkipBehind(std::string_view end, const char* what) {
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) {
      Fault(std::string("found ") + what + " without its end, expected " + Quoted(std::string(end)));
      return false;
    }
    Advance(found + end.size());
    return true;
  }

  // A document type says nothing that is needed here, and its entities could stand for any amount of text.
  void SkipDocumentType() {
    const std::size_t end = text_.find('>', at_);
    const std::size_t subset = text_.find('[', at_);
    if (subset == std::string_view::npos || subset > end) {
      SkipBehind(">", "a document type");
      return;
    }
    const std::size_t closed = text_.find(']', subset);
    const std::size_t entity = text_.find("<!ENTITY", subset);
    if (entity != std::string_view::npos && entity < closed) {
      Advance(entity);
      Fault("found a declaration of an entity, expected none: entities are not read");
      return;
    }
    if (SkipBehind("]", "a document type")) SkipBehind(">", "a document type");
  }

  // Blanks, comments, instructions and a document type around the root.
  void SkipMisc() {
    while (!error_) {
      SkipBlanks();
      if (StartsWith("<?")) {
        SkipBehind("?>", "an instruction");
      } else if (StartsWith("<!--")) {
        SkipBehind("-->", "a comment");
      } else if (StartsWith("<!DOCTYPE")) {
        SkipDocumentType();
      } else {
        return;
      }
    }
  }

  std::string Name(const char* what) {
    std::size_t to = at_;
    while (to < text_.size() && IsXmlNameByte(text_[to])) ++to;
    if (to == at_) Fault("found " + Here() + ", expected " + what);
    std::string name(text_.substr(at_, to - at_));
    Advance(to);
    return name;
  }

  // Appends the text up to byte `to`, with its references replaced.
  void Decode(std::size_t to, std::string& out) {
    while (at_ < to && !error_) {
      // Within the text: a search to the end of the file for each element would be quadratic.
      const std::size_t reference = at_ + std::min(text_.substr(at_, to - at_).find('&'), to - at_);
      out += text_.substr(at_, reference - at_);
      Advance(reference);
      if (reference < to) Reference(to, out);
    }
  }

  void Reference(std::size_t to, std::string& out) {
    // No reference that is known is longer than "&#x10ffff;".
    const std::size_t length = text_.substr(at_, std::min<std::size_t>(to - at_, 11)).find(';');
    const std::size_t semicolon = at_ + length;
    if (length == std::string_view::npos) {
      // Addresses in plugins have bare ampersands: their authors mean the character.
      out += '&';
      Advance(at_ + 1);
      return;
    }
    const std::string_view name = text_.substr(at_ + 1, semicolon - at_ - 1);
    static constexpr std::pair<std::string_view, char> kKnown[] = {
        {"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}};
    for (const auto& [known, character] : kKnown) {
      if (name != known) continue;
      out += character;
      Advance(semicolon + 1);
      return;
    }
    if (name.starts_with('#')) {
      const bool is_hex = name.starts_with("#x");
      std::uint32_t code = 0;
      const char* const begin = name.data() + (is_hex ? 2 : 1);
      const char* const end = name.data() + name.size();
      const std::from_chars_result read = std::from_chars(begin, end, code, is_hex ? 16 : 10);
      if (read.ec == std::errc() && read.ptr == end && code > 0 && code <= 0x10ffff &&
          (code < 0xd800 || code > 0xdfff)) {
        AppendUtf8(code, out);
        Advance(semicolon + 1);
        return;
      }
    }
    Fault("found the reference " + Quoted("&" + std::string(name) + ";") +
          ", expected one of XML's own: lt, gt, amp, quot, apos, or the number of a character");
  }

  void Attributes(XmlElement& element) {
    while (!error_) {
      SkipBlanks();
      if (StartsWith(">") || StartsWith("/>")) return;
      XmlAttribute attribute;
      attribute.line = line_;
      attribute.column = Column();
      attribute.name = Name("an attribute or '>'");
      SkipBlanks();
      if (!error_ && !StartsWith("=")) Fault("found " + Here() + ", expected '=' and a value in quotes");
      if (error_) return;
      Advance(at_ + 1);
      SkipBlanks();
      const char quote = at_ < text_.size() ? text_[at_] : ' ';
      if (quote != '"' && quote != '\'') {
        Fault("found " + Here() + ", expected a value in quotes");
        return;
      }
      const std::size_t end = text_.find(quote, at_ + 1);
      if (end == std::string_view::npos) {
        Fault("found a value without its closing quote, expected one");
        return;
      }
      Advance(at_ + 1);
      Decode(end, attribute.value);
      if (error_) return;
      Advance(end + 1);
      Count();
      element.attributes.push_back(std::move(attribute));
    }
  }

  void Count() {
    if (++count_ > kMaxXmlElements) {
      Fault("found more than " + std::to_string(kMaxXmlElements) + " elements and attributes, expected fewer");
    }
  }

  // REQUIRES: the text continues with "<".
  XmlElement Element(std::size_t depth) {
    XmlElement element;
    element.line = line_;
    element.column = Column();
    Count();
    if (depth > kMaxXmlDepth) {
      Fault("found more than " + std::to_string(kMaxXmlDepth) + " elements inside each other, expected fewer");
    }
    if (error_) return element;
    Advance(at_ + 1);
    element.name = Name("the name of an element");
    Attributes(element);
    if (error_) return element;
    if (StartsWith("/>")) {
      element.text_line = line_;
      element.text_column = Column();
      Advance(at_ + 2);
      return element;
    }
    Advance(at_ + 1);
    Content(depth, element);
    return element;
  }

  void Content(std::size_t depth, XmlElement& element) {
    bool has_text = false;
    const auto mark_text = [&](std::size_t to) {
      const std::size_t first = text_.find_first_not_of(kXmlBlanks, at_);
      if (has_text || first == std::string_view::npos || first >= to) return;
      Decode(first, element.text);
      has_text = true;
      element.text_line = line_;
      element.text_column = Column();
    };
    while (!error_) {
      const std::size_t next = text_.find('<', at_);
      if (next == std::string_view::npos) {
        Advance(text_.size());
        Fault("found the end of the file in element " + Quoted(element.name) + " of line " +
              std::to_string(element.line) + ", expected " + Quoted("</" + element.name + ">"));
        return;
      }
      mark_text(next);
      Decode(next, element.text);
      if (error_) return;
      if (StartsWith("<!--")) {
        SkipBehind("-->", "a comment");
      } else if (StartsWith("<![CDATA[")) {
        Advance(at_ + 9);
        const std::size_t end = text_.find("]]>", at_);
        if (end == std::string_view::npos) {
          Fault("found text without its end, expected \"]]>\"");
          return;
        }
        element.text += text_.substr(at_, end - at_);
        Advance(end + 3);
      } else if (StartsWith("<?")) {
        SkipBehind("?>", "an instruction");
      } else if (StartsWith("</")) {
        if (!has_text) {
          element.text_line = line_;
          element.text_column = Column();
        }
        Close(element);
        return;
      } else {
        element.children.push_back(Element(depth + 1));
      }
    }
  }

  void Close(const XmlElement& element) {
    const std::size_t begin = at_ + 2;
    std::size_t end = begin;
    while (end < text_.size() && IsXmlNameByte(text_[end])) ++end;
    if (text_.substr(begin, end - begin) != element.name) {
      Fault("found " + Here() + ", expected " + Quoted("</" + element.name + ">") + " for the element of line " +
            std::to_string(element.line));
      return;
    }
    Advance(end);
    SkipBlanks();
    if (!StartsWith(">")) {
      Fault("found " + Here() + ", expected '>'");
      return;
    }
    Advance(at_ + 1);
  }

  std::string_view text_;
  const std::string& path_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::size_t line_begin_ = 0;  // byte
  std::size_t count_ = 0;       // elements and attributes
  std::optional<Error> error_;
};

}  // namespace

const XmlElement* XmlElement::Find(std::string_view child) const {
  for (const XmlElement& each : children) {
    if (each.name == child) return &each;
  }
  return nullptr;
}

const std::string* XmlElement::FindAttribute(std::string_view attribute) const {
  for (const XmlAttribute& each : attributes) {
    if (each.name == attribute) return &each.value;
  }
  return nullptr;
}

std::string_view XmlElement::Trimmed() const {
  const std::size_t begin = text.find_first_not_of(kXmlBlanks);
  if (begin == std::string::npos) return {};
  return std::string_view(text).substr(begin, text.find_last_not_of(kXmlBlanks) - begin + 1);
}

Result<XmlElement> ParseXml(std::string_view text, const std::string& path) {
  return XmlParser(text, path).Parse();
}

SourceLocation XmlPlace(const XmlElement& element, const std::string& path) {
  return {path, element.line, element.column};
}

SourceLocation XmlTextPlace(const XmlElement& element, const std::string& path) {
  return {path, element.text_line, element.text_column};
}

SourceLocation XmlPlace(const XmlAttribute& attribute, const std::string& path) {
  return {path, attribute.line, attribute.column};
}

}  // namespace troupe
