// XmlText: text inside an attribute or an element of Cyclone's configuration.
#pragma once

#include <string>

namespace troupe::dds {

// Cyclone expands ${...} in values, which a name from the command line never means.
std::string XmlText(const std::string& text);

}  // namespace troupe::dds
