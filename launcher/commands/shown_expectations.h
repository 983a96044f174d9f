// The expectations of the scenario of a run, for the rows under the timeline of the viewer's page.
//
// Those of a running run are read from its file and not sent by the run: an expectation observes, so a run with and
// without them is the same. A file that is gone or has none means no rows; only an explicit request makes it an error.
// A recording has its own, as they were when the run began.
#pragma once

#include <string>

#include "recording/recording.h"
#include "troupe/result.h"
#include "viewer/gateway/expectation_rows.h"

namespace troupe {

// Of a test or of a scenario with `expect`. The error is any other file.
Result<ShownExpectations> ReadExpectations(const std::string& file);

// Of the file of a run, which may be a recording that it continues. None: it has none that could be read.
ShownExpectations ExpectationsOfRun(const std::string& file);

// Those in the recording.
ShownExpectations ExpectationsOf(const Recording& recording);

}  // namespace troupe
