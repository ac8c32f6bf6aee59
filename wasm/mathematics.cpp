// SPDX-License-Identifier: Apache-2.0
// Trigonometric functions and powers from the browser, in place of the C library's, whose tables hardly compress.
// Compiled without link-time optimisation, which would take these for the library's.
#include <emscripten.h>
#include <math.h>

namespace {

EM_JS(double, fdvt_sin, (double x), { return Math.sin(x); });
EM_JS(double, fdvt_cos, (double x), { return Math.cos(x); });
EM_JS(double, fdvt_tan, (double x), { return Math.tan(x); });
EM_JS(double, fdvt_exp, (double x), { return Math.exp(x); });
EM_JS(double, fdvt_exp2, (double x), { return Math.pow(2, x); });

}  // namespace

extern "C" {

double sin(double x) { return fdvt_sin(x); }
double cos(double x) { return fdvt_cos(x); }
double tan(double x) { return fdvt_tan(x); }
double exp(double x) { return fdvt_exp(x); }
double exp2(double x) { return fdvt_exp2(x); }
float sinf(float x) { return static_cast<float>(fdvt_sin(x)); }
float cosf(float x) { return static_cast<float>(fdvt_cos(x)); }
float expf(float x) { return static_cast<float>(fdvt_exp(x)); }

}  // extern "C"
