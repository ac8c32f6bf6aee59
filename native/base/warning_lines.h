// SPDX-License-Identifier: Apache-2.0
// Warnings and notes for people, one line each: "SUBJECT: what is wrong; what to do".
#pragma once

#include <string>
#include <vector>

namespace fourdvt {

// Makes one line of those that differ in their subject alone, at the place of the first: "SUBJECT, SUBJECT: …", each
// once. What a subject has in common with the one before, up to its last "/" or blank, is not repeated:
// "walk/cam00.mp4, cam01.mp4".
std::vector<std::string> joinedWarnings(const std::vector<std::string>& warnings);

}  // namespace fourdvt
