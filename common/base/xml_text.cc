#include "common/base/xml_text.h"

#include "common/base/text.h"

namespace troupe {

std::string XmlText(const std::string& text) {
  std::string escaped;
  for (const char c : PlainLine(text)) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace troupe
