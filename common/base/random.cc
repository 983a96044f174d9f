#include "troupe/random.h"

#include <cmath>

#include "common/base/hash.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

double ToUniform(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

}  // namespace

std::uint64_t RandomBits(std::initializer_list<std::uint64_t> key) {
  Hasher hasher;
  for (std::uint64_t word : key) hasher.Add(word);
  return hasher.value();
}

double RandomUniform(std::initializer_list<std::uint64_t> key) {
  return ToUniform(RandomBits(key));
}

double RandomNormal(std::initializer_list<std::uint64_t> key) {
  Hasher hasher;
  for (std::uint64_t word : key) hasher.Add(word);
  const double u = 1.0 - ToUniform(hasher.value());  // (0, 1], so that the logarithm exists
  hasher.Add(std::uint64_t{1});
  const double angle = 2.0 * kPi * ToUniform(hasher.value());
  return std::sqrt(-2.0 * Log(u)) * SinCos(angle).cos;
}

}  // namespace troupe
