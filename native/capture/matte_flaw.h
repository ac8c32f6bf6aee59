// SPDX-License-Identifier: Apache-2.0
// Mattes that cannot be meant: white and black are swapped, everything is the object, or a label picture. Judged by one
// matte; does NOT read files.
#pragma once

#include <string>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt::capture {

// A matte that keeps most of the picture and nearly all of its border, as it does where a plate does not fit.
bool keepsTheBorder(const Image& matte);

enum class MatteFlaw {
  None,
  Covered,  // all of the picture is kept, or all but specks: there is no outline
  Swapped,  // keeps the border all round and leaves out what lies within: object and background are swapped
  Labels,   // a label picture: a few values, all of them dark, as 0 and 1
};

// None for a matte that keeps nothing, too.
MatteFlaw flawOf(const Image& matte);

// FileUnreadable; the message names the file and the remedy.
Error flawedMattes(MatteFlaw flaw, const std::string& path, const std::string& camera);

}  // namespace fourdvt::capture
