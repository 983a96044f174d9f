#pragma once

#include <string>

namespace troupe {

// Text for XML and HTML: & < > " ' are escaped; characters that XML forbids are question marks or spaces.
std::string XmlText(const std::string& text);

}  // namespace troupe
