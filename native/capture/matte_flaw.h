// SPDX-License-Identifier: Apache-2.0
// Detects mattes that are wrong as a whole: white and black swapped, everything kept, or a label picture. Judged by one
// matte in memory.
#pragma once

#include <string>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt::capture {

// Returns true for a matte that keeps most of the picture and nearly all of its border, as with a plate that does not
// fit.
bool keepsTheBorder(const Image& matte);

enum class MatteFlaw {
  None,
  Covered,  // keeps all of the picture, or all but specks: no outline
  Swapped,  // keeps the border all round and removes the inside: object and background are swapped
  Labels,   // a label picture: a few values, all of them dark, such as 0 and 1
};

// Returns None also for a matte that keeps nothing.
MatteFlaw flawOf(const Image& matte);

// Error FileUnreadable; the message names the file and the remedy.
Error flawedMattes(MatteFlaw flaw, const std::string& path, const std::string& camera);

}  // namespace fourdvt::capture
