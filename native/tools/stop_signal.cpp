// SPDX-License-Identifier: Apache-2.0
#include "tools/stop_signal.h"

#include <unistd.h>

#include <csignal>

#include "tools/args.h"

namespace fourdvt::tools {
namespace {

std::atomic<bool> g_stop{false};

void onSignal(int) {
  if (g_stop.exchange(true)) _exit(kInterrupted);
}

}  // namespace

const std::atomic<bool>* listenForStop() {
  struct sigaction action {};
  action.sa_handler = onSignal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return &g_stop;
}

}  // namespace fourdvt::tools
