// Statistics of the metrics of many cases.
#pragma once

#include <cstdint>

namespace troupe {

// Mean, extremes and spread of numbers that are added one by one (Welford 1962). The same numbers in the same order
// give the same bits.
// One pass without the numbers, and without the cancellation that a sum of squares would have for a large mean and
// small spread.
class Statistics {
 public:
  void Add(double number);

  std::uint64_t count() const { return count_; }
  double mean() const { return mean_; }  // 0 without a number
  double min() const { return min_; }
  double max() const { return max_; }
  double deviation() const;  // of the sample; 0 of fewer than two numbers
  // Half the width of the interval that has the mean of all with 95 percent confidence, by Student's t; 0 of fewer than
  // two numbers.
  double confidence() const;

 private:
  std::uint64_t count_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;  // sum of the squared distances from the mean
  double min_ = 0.0;
  double max_ = 0.0;
};

}  // namespace troupe
