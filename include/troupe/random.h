// Counter-based random numbers: a pure function of a key, so that a draw depends neither on the process that makes it
// nor on earlier draws. The key is (seed, stream words..., counter), for instance (seed, robot, sensor, tick,
// sample).
//
// Why not a generator with a state: agents, replays and viewers measure in different orders, skip ticks and start late,
// and must draw the same numbers all the same. Each use has a stream word of its own, so that two uses with equal
// counters do not correlate. The hash of the key (SplitMix64) mixes well enough for noise and choices; it is not for
// secrets.
#pragma once

#include <cstdint>
#include <initializer_list>

namespace troupe {

// 64 random bits for the key.
std::uint64_t RandomBits(std::initializer_list<std::uint64_t> key);

// Uniform in [0, 1).
double RandomUniform(std::initializer_list<std::uint64_t> key);

// Standard normal: mean 0, variance 1 (Box and Muller 1958; both uniform numbers are drawn from the key).
double RandomNormal(std::initializer_list<std::uint64_t> key);

}  // namespace troupe
