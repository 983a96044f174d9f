// Recorded ways of people, as data sets of pedestrians have them.
//
// Two forms of text, told apart by the number of fields in the first row; a `#` begins a comment:
//
// - `frame id x y`, the form in which the recordings of ETH, Zurich (Pellegrini et al. 2009) and UCY, Cyprus (Lerner et
//   al. 2007) are usually passed on;
// - `frame id x z y vx vz vy`, the `obsmat.txt` of the former: z is the height, and velocities do not count.
//
// Fields are separated by blanks, tabs or commas. Positions are in metres, in a frame of the recording.
#pragma once

#include <string>
#include <vector>

#include "troupe/result.h"
#include "worldfile/models/people.h"

namespace troupe {

// The people by their first rows, with times in s after the first frame of the file. `rate`: frames a second. A person
// with a single row is left out, as it has no way. The error has the place in the file.
Result<std::vector<RecordedPerson>> ReadTracks(const std::string& text, const std::string& path, double rate);

}  // namespace troupe
