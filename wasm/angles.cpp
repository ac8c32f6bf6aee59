// SPDX-License-Identifier: Apache-2.0
// Takes the place of a function of Emscripten's C library (musl), by which sin, cos and tan reduce angles of more than
// 2^20 quarter turns exactly: 3 KB of every page's download. Here such an angle counts as 0: no camera has one.
extern "C" {

int __rem_pio2_large(double* x, double* y, int exponent, int count, int precision);
int __rem_pio2_large(double*, double* y, int, int, int precision) {
  y[0] = 0;
  if (precision > 0) y[1] = 0;  // a float's angle is reduced to one number
  return 0;
}

}  // extern "C"
