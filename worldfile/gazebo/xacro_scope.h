// The names of xacro: properties and blocks by scope, and name spaces.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "worldfile/text/xml_reader.h"

namespace troupe {

// Names of properties and blocks; what is not here is sought in the scope around. Of a call that is the scope of its
// caller.
struct XacroScope {
  XacroScope* outer = nullptr;
  XacroScope* space = nullptr;  // in which names are sought first: the name space of a macro that is called
  std::string prefix = {};      // of macros that are defined here: "a.b." in the name space b of a
  std::map<std::string, std::string> texts = {};  // evaluated at the first use
  std::map<std::string, std::vector<XmlElement>> blocks = {};
  std::map<std::string, XacroScope*> spaces = {};  // name spaces of includes, kept by the expander
};

// The name space that the scope is in, or null.
XacroScope* SpaceOf(XacroScope& scope);

// The text of a property, and its scope; null without one. Behind a dot it is one of a name space.
std::pair<std::string*, XacroScope*> FindProperty(const std::string& name, XacroScope& scope);

}  // namespace troupe
