// `troupe snapshot`: draws a world at one tick.
//
// The picture is drawn in this process by the library, without a display or a browser: the same pixels on every
// machine. Ticks are stepped with the robots' controllers, as in `troupe run --in-process`; of a recording the recorded
// state is drawn.
//
// A heat map adds up all ticks up to the drawn one: a run is stepped as before, and a recording is stepped through.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace troupe {

struct SnapshotOptions {
  std::string file;
  std::string output;
  std::optional<std::uint64_t> tick;  // nothing: 0; of a heat map of a recording the last one
  std::string view = "top";           // or "side"
  bool rays = false;
  std::string camera;   // "robot" or "robot/sensor": its view instead of the world; empty: the world
  bool depths = false;  // of the camera, instead of its colours

  std::string heat;            // "robots", "people" or "waits": a map of the ticks up to that one; empty: none
  std::uint64_t since = 0;     // the tick after which the map begins
  std::optional<double> cell;  // m, of the map

  // Nothing or empty: as the world file sets it, or chosen by the contents of the picture.
  std::optional<int> width;      // pixels
  std::vector<double> center;    // x and y, m
  std::optional<double> meters;  // m
  std::vector<double> heights;   // m, the least and the first one above: only models whose base is between
  std::optional<std::uint64_t> seed;
  std::optional<std::string> controller;
};

// Returns the exit status; errors are printed for the user.
int SnapshotCommand(const SnapshotOptions& options);

}  // namespace troupe
