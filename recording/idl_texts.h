// The texts of IDL files, embedded by the build. Each has the types that it uses.
#pragma once

#include <cstddef>

namespace troupe {

struct IdlText {
  const char* file;  // in idl/
  const char* text;
};

extern const IdlText kIdlTexts[];
extern const std::size_t kIdlTextCount;

}  // namespace troupe
