#include "common/bitmap/pixel_runs.h"

#include <bit>

namespace troupe {

void FindRuns(std::span<const std::uint64_t> row, int width, std::vector<PixelRun>& runs) {
  runs.clear();
  bool inside = false;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const std::uint64_t word = row[i];
    if (word == (inside ? ~std::uint64_t{0} : 0)) continue;
    const int base = static_cast<int>(i * 64);
    int bit = 0;
    while (bit < 64) {
      const std::uint64_t changed = (inside ? ~word : word) >> bit;
      if (changed == 0) break;
      bit += std::countr_zero(changed);
      if (inside) {
        runs.back().x1 = base + bit;
      } else {
        runs.push_back({base + bit, width});
      }
      inside = !inside;
    }
  }
}

}  // namespace troupe
