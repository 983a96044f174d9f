// `troupe host`: the far end of a FarMachine. Starts processes here for a launcher elsewhere, which starts this itself.
#pragma once

namespace troupe {

// Serves standard input until its end; then nothing that was started is left. Returns the exit status.
int HostCommand();

}  // namespace troupe
