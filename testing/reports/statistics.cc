#include "testing/reports/statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace troupe {
namespace {

constexpr double kCoverage = 0.95;  // of the interval around the mean

// The probability that a number of Student's distribution has a magnitude below tan(angle) * sqrt(freedom): Abramowitz
// and Stegun 1964, 26.7.3 and 26.7.4, a finite sum of powers of the cosine.
double Coverage(double angle, std::uint64_t freedom) {
  const double sine = std::sin(angle);
  const double cosine = std::cos(angle);
  const bool is_odd = freedom % 2 == 1;
  double term = is_odd ? cosine : 1.0;
  double sum = 0.0;
  for (std::uint64_t k = is_odd ? 1 : 0; k + 1 < freedom; k += 2) {
    sum += term;
    term *= cosine * cosine * static_cast<double>(k + 1) / static_cast<double>(k + 2);
  }
  return is_odd ? (angle + sine * sum) * 2.0 / std::numbers::pi : sine * sum;
}

// The quantile 0.975 of Student's distribution.
double StudentQuantile(std::uint64_t freedom) {
  // The expansion around the normal quantile (same, 26.7.5) has an error below 1e-10 from here on, and the sum many
  // terms.
  constexpr std::uint64_t kMaxSummed = 300;
  const auto n = static_cast<double>(freedom);
  if (freedom > kMaxSummed) {
    constexpr double z = 1.959963984540054;
    constexpr double z3 = z * z * z;
    constexpr double z5 = z3 * z * z;
    constexpr double z7 = z5 * z * z;
    constexpr double z9 = z7 * z * z;
    return z + (z3 + z) / (4.0 * n) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * n * n) +
           (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * n * n * n) +
           (79.0 * z9 + 776.0 * z7 + 1482.0 * z5 - 1920.0 * z3 - 945.0 * z) / (92160.0 * n * n * n * n);
  }
  double low = 0.0;
  double high = std::numbers::pi / 2.0;
  for (;;) {
    const double middle = (low + high) / 2.0;
    if (middle <= low || middle >= high) return std::tan(low) * std::sqrt(n);
    (Coverage(middle, freedom) < kCoverage ? low : high) = middle;
  }
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
