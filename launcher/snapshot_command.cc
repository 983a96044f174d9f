#include "launcher/snapshot_command.h"

namespace troupe {

void AddSnapshotCommand(CLI::App& app, int& exit_status) {
  (void)app;
  (void)exit_status;
}

}  // namespace troupe
