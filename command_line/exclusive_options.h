// Which options of a command exclude each other: one of them would be without effect. A pair that is not in the table
// is effective. The refusal names both.
#pragma once

#include <string_view>

namespace CLI {
class App;
}  // namespace CLI

namespace troupe {

// Of the command of this name, after its options are added. REQUIRES: it has all options of its rows in the table
void ExcludeOptions(CLI::App& command, std::string_view name);

}  // namespace troupe
