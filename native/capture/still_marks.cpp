// SPDX-License-Identifier: Apache-2.0
#include "capture/still_marks.h"

#include <lcms2.h>
#include <zlib.h>

#include <array>
#include <cstdlib>
#include <map>
#include <memory>

namespace fourdvt::capture {
namespace {

constexpr size_t kMaxProfileBytes = 4 << 20;
constexpr std::string_view kExif("Exif\0\0", 6), kIcc("ICC_PROFILE\0", 12), kPng("\x89PNG\r\n\x1a\n", 8);

// Unsigned integer of `bytes` bytes at `at`; 0 beyond the end.
uint32_t number(std::string_view data, size_t at, int bytes, bool big_endian) {
  if (at > data.size() || data.size() - at < size_t(bytes)) return 0;
  uint32_t out = 0;
  for (int i = 0; i < bytes; ++i) {
    const auto byte = static_cast<uint8_t>(data[at + size_t(big_endian ? i : bytes - 1 - i)]);
    out = out << 8 | byte;
  }
  return out;
}

// Marks by EXIF orientation, 1 to 8.
PictureMarks marksOfOrientation(uint32_t orientation) {
  constexpr std::array<PictureMarks, 8> kMarks{
      {{false, 0}, {true, 0}, {false, 2}, {true, 2}, {true, 3}, {false, 1}, {true, 1}, {false, 3}}};
  return orientation >= 1 && orientation <= 8 ? kMarks[orientation - 1] : PictureMarks();
}

// Marks of EXIF data, a TIFF file of tags: the first list has the orientation, tag 0x112, as 16 bits.
PictureMarks marksOfExif(std::string_view tiff) {
  const bool big = tiff.starts_with("MM");
  if (!big && !tiff.starts_with("II")) return {};
  const size_t list = number(tiff, 4, 4, big);
  const uint32_t entries = number(tiff, list, 2, big);
  for (uint32_t i = 0; i < entries; ++i) {
    const size_t entry = list + 2 + size_t(12) * i;
    if (entry >= tiff.size()) return {};
    if (number(tiff, entry, 2, big) == 0x112) return marksOfOrientation(number(tiff, entry + 8, 2, big));
  }
  return {};
}

StillMarks marksOfJpeg(std::string_view file) {
  StillMarks out;
  std::map<uint32_t, std::string_view> parts;  // index → part of the profile
  size_t at = 2;
  while (at + 4 <= file.size() && file[at] == '\xff') {
    const auto marker = static_cast<uint8_t>(file[at + 1]);
    const size_t length = number(file, at + 2, 2, true);
    if (marker == 0xda || marker == 0xd9 || length < 2 || length > file.size() - at - 2) break;  // pixels follow
    const std::string_view data = file.substr(at + 4, length - 2);
    if (marker == 0xe1 && data.starts_with(kExif)) out.marks = marksOfExif(data.substr(kExif.size()));
    if (marker == 0xe2 && data.starts_with(kIcc) && data.size() > kIcc.size() + 2)
      parts[static_cast<uint8_t>(data[kIcc.size()])] = data.substr(kIcc.size() + 2);
    at += 2 + length;
  }
  for (const auto& [part, bytes] : parts) out.profile += bytes;
  return out;
}

// Inflates a PNG's profile: its name, a zero, the method (0), and the deflated bytes.
std::string inflatedProfile(std::string_view chunk) {
  const size_t name = chunk.find('\0');
  if (name == std::string_view::npos || chunk.size() < name + 2) return {};
  const std::string_view packed = chunk.substr(name + 2);
  std::string out;
  uLongf bytes = 0;
  int done = Z_BUF_ERROR;
  for (size_t room = 1 << 14; done == Z_BUF_ERROR && room <= kMaxProfileBytes; room *= 4) {
    out.resize(room);
    bytes = room;
    done = uncompress(reinterpret_cast<Bytef*>(out.data()), &bytes, reinterpret_cast<const Bytef*>(packed.data()),
                      packed.size());
  }
  out.resize(done == Z_OK ? bytes : 0);
  return out;
}

StillMarks marksOfPng(std::string_view file) {
  StillMarks out;
  size_t at = kPng.size();
  while (at + 12 <= file.size()) {
    const size_t length = number(file, at, 4, true);
    const std::string_view kind = file.substr(at + 4, 4);
    if (length > file.size() - at - 12) break;
    const std::string_view data = file.substr(at + 8, length);
    if (kind == "eXIf") out.marks = marksOfExif(data);
    if (kind == "iCCP") out.profile = inflatedProfile(data);
    if (kind == "IEND") break;
    at += 12 + length;
  }
  return out;
}

struct LcmsDeleter {
  void operator()(void* transform) const { cmsDeleteTransform(transform); }
};
struct ProfileDeleter {
  void operator()(void* profile) const { cmsCloseProfile(profile); }
};
using Profile = std::unique_ptr<void, ProfileDeleter>;
using Transform = std::unique_ptr<void, LcmsDeleter>;

Profile openProfile(const std::string& bytes) {
  Profile out(bytes.empty() ? nullptr
                            : cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())));
  if (out && cmsGetColorSpace(out.get()) != cmsSigRgbData) out.reset();
  return out;
}

Transform transformOf(const Profile& from, int channels) {
  if (!from) return nullptr;
  const Profile srgb(cmsCreate_sRGBProfile());
  const cmsUInt32Number type = channels == 4 ? TYPE_RGBA_8 : TYPE_RGB_8;
  return Transform(cmsCreateTransform(from.get(), type, srgb.get(), type, INTENT_RELATIVE_COLORIMETRIC,
                                      cmsFLAGS_NOCACHE | cmsFLAGS_COPY_ALPHA));
}

// Maximum change of a colour over a grid.
int largestChange(const Transform& transform) {
  constexpr int kSteps = 9;
  std::array<uint8_t, kSteps * kSteps * kSteps * 3> in{}, out{};
  for (int i = 0; i < kSteps * kSteps * kSteps; ++i)
    for (int c = 0, rest = i; c < 3; ++c, rest /= kSteps)
      in[size_t(3 * i + c)] = static_cast<uint8_t>(rest % kSteps * 255 / (kSteps - 1));
  cmsDoTransform(transform.get(), in.data(), out.data(), static_cast<cmsUInt32Number>(in.size() / 3));
  int largest = 0;
  for (size_t i = 0; i < in.size(); ++i) largest = std::max(largest, std::abs(in[i] - out[i]));
  return largest;
}

}  // namespace

StillMarks stillMarks(std::string_view file) {
  if (file.starts_with("\xff\xd8")) return marksOfJpeg(file);
  if (file.starts_with(kPng)) return marksOfPng(file);
  return {};
}

void toSrgb(const std::string& profile, Image& colour) {
  const Profile from = openProfile(profile);
  Transform transform = transformOf(from, 3);
  if (!transform || largestChange(transform) <= kSrgbTolerance) return;
  if (colour.channels == 4) transform = transformOf(from, 4);
  cmsDoTransform(transform.get(), colour.pixels.data(), colour.pixels.data(),
                 static_cast<cmsUInt32Number>(colour.pixels.size() / size_t(colour.channels)));
}

bool changesColours(const std::string& profile, std::string* name) {
  const Profile from = openProfile(profile);
  const Transform transform = transformOf(from, 3);
  if (!transform || largestChange(transform) <= kSrgbTolerance) return false;
  char text[128] = "";
  cmsGetProfileInfoASCII(from.get(), cmsInfoDescription, "en", "US", text, sizeof text);
  if (name) *name = text;
  return true;
}

}  // namespace fourdvt::capture
