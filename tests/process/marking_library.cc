// A hostile library: code that runs as soon as it is opened writes the file that an environment variable names.
#include <cstdlib>
#include <fstream>

namespace {

[[gnu::constructor]] void Mark() {
  if (const char* file = std::getenv("TROUPE_TEST_MARK")) std::ofstream(file) << "opened";
}

}  // namespace
