#include "testing/reports/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace troupe {
namespace {

// The quantile 0.975 of Student's distribution, by degrees of freedom from 1.
constexpr std::array<double, 30> kStudent = {12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060,
                                             2.2622,  2.2281, 2.2010, 2.1788, 2.1604, 2.1448, 2.1314, 2.1199,
                                             2.1098,  2.1009, 2.0930, 2.0860, 2.0796, 2.0739, 2.0687, 2.0639,
                                             2.0595,  2.0555, 2.0518, 2.0484, 2.0452, 2.0423};

// Beyond the table the first term of the expansion around the normal quantile: within 0.001.
double StudentQuantile(std::uint64_t freedom) {
  if (freedom <= kStudent.size()) return kStudent[freedom - 1];
  constexpr double kNormal = 1.959964;
  return kNormal + (kNormal * kNormal * kNormal + kNormal) / (4.0 * static_cast<double>(freedom));
}

}  // namespace

void Statistics::Add(double number) {
  min_ = count_ == 0 ? number : std::min(min_, number);
  max_ = count_ == 0 ? number : std::max(max_, number);
  ++count_;
  const double distance = number - mean_;
  mean_ += distance / static_cast<double>(count_);
  squares_ += distance * (number - mean_);
}

double Statistics::deviation() const {
  return count_ < 2 ? 0.0 : std::sqrt(squares_ / static_cast<double>(count_ - 1));
}

double Statistics::confidence() const {
  return count_ < 2 ? 0.0 : StudentQuantile(count_ - 1) * deviation() / std::sqrt(static_cast<double>(count_));
}

}  // namespace troupe
