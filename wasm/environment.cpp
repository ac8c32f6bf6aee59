// SPDX-License-Identifier: Apache-2.0
// Empty environment: the C library's own function would link Emscripten's, and its strings.
#include <cstdlib>

char* getenv(const char*) { return nullptr; }
