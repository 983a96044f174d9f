// RandomSource: the random numbers of a seed.
#pragma once

#include <cstddef>
#include <cstdint>

#include "troupe/random.h"

namespace troupe::faults {

class RandomSource {
 public:
  RandomSource(std::uint64_t seed, std::uint64_t stream) : seed_(seed), stream_(stream) {}

  double Uniform(double min, double max) { return min + (max - min) * RandomUniform({seed_, stream_, draws_++}); }
  bool Chance(double probability) { return probability > 0.0 && Uniform(0.0, 1.0) < probability; }
  // From 0 to count - 1.
  std::size_t Index(std::size_t count) { return RandomBits({seed_, stream_, draws_++}) % count; }

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
  std::uint64_t draws_ = 0;
};

}  // namespace troupe::faults
