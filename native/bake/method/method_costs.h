// SPDX-License-Identifier: Apache-2.0
// How long a new frame takes by each method against FVVR's on the same surface. A stated table (method_costs.inc), so
// that the same capture gives the same character on every machine; `bench_method_costs` measures it again.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fourdvt::bake {

// Between the table's sizes linear in their logarithm, beyond them as at the last; at least 1, so that nothing is taken
// for being cheaper than FVVR. Infinite for a method that the table has not.
double methodCost(std::string_view method, size_t faces);

// Returns true for methods that move points along the view's rays to where the cameras agree: with cameras that lie a
// pixel or two off it finds agreement elsewhere, and what it draws is sharp in the wrong place.
bool trustsCalibration(std::string_view method);

// Methods that a capture may be given, by cost: those that were the best of all, or within .05 dB of it, under some
// condition of site/measured/methods.md, but for blurs, which win by PSNR alone where nothing fits.
std::vector<std::string> methodCandidates();

}  // namespace fourdvt::bake
