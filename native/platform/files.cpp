// SPDX-License-Identifier: Apache-2.0
#include "platform/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "platform/process.h"

namespace fourdvt::platform {
namespace {

class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() { close(); }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int get() const { return fd_; }
  bool close() {
    const int fd = fd_;
    fd_ = -1;
    return fd < 0 || ::close(fd) == 0;
  }

 private:
  int fd_;
};

Error readError(const std::string& path) {
  const int code = errno;
  const bool missing = code == ENOENT || code == ENOTDIR;
  return {missing ? ErrorId::FileMissing : ErrorId::FileUnreadable,
          path + ": " + std::strerror(code) + (missing ? "; check the path" : "; check the file and its permissions")};
}

Error writeError(const std::string& path, int code) {
  const char* remedy = code == ENOSPC || code == EDQUOT ? "free disk space or choose another folder"
                                                        : "choose a folder that exists and is writable";
  return {ErrorId::WriteFailed, path + ": " + std::strerror(code) + "; " + remedy};
}

bool writeAll(int fd, std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  return true;
}

Result<std::vector<uint8_t>> readSpan(const std::string& path, uint64_t offset, uint64_t bytes, bool whole) {
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat info {};
  if (file.get() < 0 || ::fstat(file.get(), &info) != 0) return readError(path);
  if (!S_ISREG(info.st_mode)) return Error{ErrorId::FileUnreadable, path + ": not a file; check the path"};
  const auto size = static_cast<uint64_t>(info.st_size);
  if (whole) bytes = size;
  if (offset > size || bytes > size - offset) {
    return Error{ErrorId::FileUnreadable, path + ": shorter than expected (" + std::to_string(size) +
                                              " bytes); the file is truncated, copy or bake it again"};
  }
  std::vector<uint8_t> data(bytes);
  uint64_t done = 0;
  while (done < bytes) {
    const ssize_t n = ::pread(file.get(), data.data() + done, bytes - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return readError(path);
    if (n == 0) return Error{ErrorId::FileUnreadable, path + ": shrank while it was read; try again"};
    done += static_cast<uint64_t>(n);
  }
  return data;
}

// JSON pointers escape "~" and "/" (RFC 6901).
std::string escaped(const std::string& key) {
  std::string out;
  for (char c : key) {
    if (c == '~')
      out += "~0";
    else if (c == '/')
      out += "~1";
    else
      out += c;
  }
  return out;
}

constexpr int kMaxDepth = 64;

// Adds the tree below `node` to `out`. Returns false if it exceeds the depth limit.
bool flatten(const nlohmann::json& node, const std::string& pointer, FlatJson& out, int depth = 0) {
  if (depth > kMaxDepth) return false;
  if (node.is_object()) {
    for (const auto& [key, child] : node.items()) {
      if (!flatten(child, pointer + "/" + escaped(key), out, depth + 1)) return false;
    }
  } else if (node.is_array()) {
    for (size_t i = 0; i < node.size(); ++i) {
      if (!flatten(node[i], pointer + "/" + std::to_string(i), out, depth + 1)) return false;
    }
  } else if (node.is_number()) {
    out.set(pointer, node.get<double>());
  } else if (node.is_string()) {
    out.set(pointer, node.get<std::string>());
  } else if (node.is_boolean()) {
    out.set(pointer, node.get<bool>());
  }
  return true;
}

cv::Mat toRgb8(const cv::Mat& decoded) {
  cv::Mat eight = decoded, out;
  if (decoded.depth() == CV_16U) decoded.convertTo(eight, CV_8U, 1.0 / 257.0);
  const int conversion = eight.channels() == 1   ? cv::COLOR_GRAY2RGB
                         : eight.channels() == 4 ? cv::COLOR_BGRA2RGBA
                                                 : cv::COLOR_BGR2RGB;
  cv::cvtColor(eight, out, conversion);
  return out;
}

}  // namespace

Result<std::vector<uint8_t>> readFile(const std::string& path) { return readSpan(path, 0, 0, true); }

Result<std::string> readText(const std::string& path) {
  FOURDVT_ASSIGN(const auto bytes, readFile(path));
  return std::string(bytes.begin(), bytes.end());
}

Result<std::vector<uint8_t>> readFileRange(const std::string& path, uint64_t offset, uint64_t bytes) {
  return readSpan(path, offset, bytes, false);
}

Status writeFileAtomic(const std::string& path, std::span<const uint8_t> bytes) {
  const std::string temporary = path + ".tmp" + ownSuffix();
  FileDescriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (file.get() < 0) return writeError(path, errno);
  const bool written = writeAll(file.get(), bytes) && ::fsync(file.get()) == 0 && file.close() &&
                       ::rename(temporary.c_str(), path.c_str()) == 0;
  if (written) return {};
  const int code = errno;
  ::unlink(temporary.c_str());
  return writeError(path, code);
}

Status writeFileAtomic(const std::string& path, const std::string& text) {
  return writeFileAtomic(path, std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

uint64_t fileBytes(const std::string& path) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  return error ? 0 : bytes;
}

Result<FlatJson> readJsonFlat(const std::string& path) {
  FOURDVT_ASSIGN(auto bytes, readFile(path));
  const auto json = nlohmann::json::parse(bytes.begin(), bytes.end(), nullptr, false);
  FlatJson flat;
  if (json.is_discarded() || !flatten(json, "", flat)) {
    return Error{ErrorId::ManifestInvalid, path + ": not valid JSON; bake the character again"};
  }
  return flat;
}

Result<Image> readImage(const std::string& path) {
  FOURDVT_ASSIGN(auto bytes, readFile(path));
  const Error bad{ErrorId::FileUnreadable, path + ": not a readable PNG, JPEG or WebP picture; export it again"};
  if (bytes.empty()) return bad;
  try {
    const cv::Mat decoded = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    if (decoded.empty() || (decoded.depth() != CV_8U && decoded.depth() != CV_16U)) return bad;
    const cv::Mat rgb = toRgb8(decoded);
    Image image(rgb.cols, rgb.rows, rgb.channels());
    std::memcpy(image.pixels.data(), rgb.data, image.pixels.size());  // cvtColor's output is continuous
    return image;
  } catch (const cv::Exception&) {
    return bad;
  }
}

Result<std::vector<uint8_t>> encodeImage(const Image& image, const std::string& extension, int quality) {
  std::vector<uint8_t> encoded;
  try {
    const cv::Mat rgb(image.height, image.width, CV_8UC(image.channels), const_cast<uint8_t*>(image.pixels.data()));
    cv::Mat bgr;  // a copy: the caller's pixels are const
    if (image.channels == 1)
      bgr = rgb;
    else
      cv::cvtColor(rgb, bgr, image.channels == 4 ? cv::COLOR_RGBA2BGRA : cv::COLOR_RGB2BGR);
    const int flag = extension == ".webp" ? cv::IMWRITE_WEBP_QUALITY : cv::IMWRITE_JPEG_QUALITY;
    if (cv::imencode(extension, bgr, encoded, {flag, quality})) return encoded;
  } catch (const cv::Exception&) {  // unsupported extension
  }
  return Error{ErrorId::Internal, "OpenCV cannot encode " + extension + " pictures; install a build with it"};
}

Status writeImage(const std::string& path, const Image& image, int quality) {
  if (image.empty() || (image.channels != 1 && image.channels != 3 && image.channels != 4)) {
    return Error{ErrorId::InvalidArgument, path + ": a picture to write has 1, 3 or 4 channels and is not empty"};
  }
  const auto encoded = encodeImage(image, std::filesystem::path(path).extension().string(), quality);
  if (!encoded) return Error{ErrorId::WriteFailed, path + ": no encoder for this name; use .png, .jpg or .webp"};
  return writeFileAtomic(path, encoded.value());
}

namespace {

namespace fs = std::filesystem;

Error writeError(const std::string& path, const std::error_code& why) {
  return {ErrorId::WriteFailed,
          path + ": cannot write: " + why.message() + "; free disk space or choose another output folder"};
}

}  // namespace

Status makeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  return error ? Status(writeError(path, error)) : Status();
}

void removeFolder(const std::string& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

void removeFolder(const std::string& path, const std::string& last) {
  removeEntries(path, [&](const std::string& name) { return name != last; });
  removeFolder(path);
}

void removeEntries(const std::string& folder, const std::function<bool(const std::string& name)>& chosen) {
  std::error_code failed, ignored;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed))
    if (chosen(entry->path().filename().string())) found.push_back(entry->path());
  for (const fs::path& path : found) fs::remove_all(path, ignored);
}

void removeIfEmpty(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) fs::remove(path, error);
}

Status replaceFolder(const std::string& from, const std::string& to, const std::string& previous) {
  std::error_code error;
  if (!fs::exists(from, error)) return writeError(to, std::make_error_code(std::errc::no_such_file_or_directory));
  removeFolder(previous);
  const bool exists = fs::exists(to, error);
  if (exists) fs::rename(to, previous, error);
  if (error) return writeError(to, error);
  fs::rename(from, to, error);
  if (!error) return {};
  std::error_code ignored;
  if (exists) fs::rename(previous, to, ignored);
  return writeError(to, error);
}

}  // namespace fourdvt::platform
