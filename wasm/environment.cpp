// SPDX-License-Identifier: Apache-2.0
// A page has no environment. The C library's own function would bring one of Emscripten's, and its strings.
#include <cstdlib>

char* getenv(const char*) { return nullptr; }
