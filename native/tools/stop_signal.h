// SPDX-License-Identifier: Apache-2.0
// Catches Ctrl-C and SIGTERM for commands that keep what they have finished.
#pragma once

#include <atomic>

namespace fourdvt::tools {

// From now on the first signal sets the flag; a second one ends the process at once with kInterrupted.
const std::atomic<bool>* listenForStop();

}  // namespace fourdvt::tools
