// SPDX-License-Identifier: Apache-2.0
// Unwraps a bench's results; prints an error with the bench's name and exits.
#pragma once

#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include "base/result.h"

namespace fourdvt::testing {

inline void orStop(const Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "%s: %s\n", program_invocation_short_name, status.error().message.c_str());
  std::exit(1);
}

template <class T>
T orStop(Result<T> result) {
  if (!result.ok()) orStop(Status(result.error()));
  return result.take();
}

}  // namespace fourdvt::testing
