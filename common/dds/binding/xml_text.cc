#include "common/dds/binding/xml_text.h"

namespace troupe::dds {

std::string XmlText(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else if (c == '$') {
      escaped += "\\$";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

}  // namespace troupe::dds
