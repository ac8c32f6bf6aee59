// SPDX-License-Identifier: Apache-2.0
// One connection of the server until it becomes a WebSocket: TLS, sequential requests, answers with files in pieces.
// Access is decided by the handler.
#pragma once

#include <memory>

#include "live/net/pump.h"
#include "live/net/server_core.h"

namespace fourdvt::live {

// is_full: every request is answered with 503.
void startHttpSession(std::shared_ptr<ServerCore> core, std::shared_ptr<Wire> wire, bool is_full);

}  // namespace fourdvt::live
