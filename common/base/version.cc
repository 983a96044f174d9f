#include "troupe/version.h"

namespace troupe {

const char* VersionText() {
  return TROUPE_VERSION;
}

}  // namespace troupe
