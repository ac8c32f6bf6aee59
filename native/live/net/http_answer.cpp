// SPDX-License-Identifier: Apache-2.0
#include "live/net/http_answer.h"

#include <strings.h>
#include <sys/stat.h>

#include "base/text.h"
#include "live/net/http_text.h"

namespace fourdvt::live {
namespace {

struct OpenedFile {
  FileHandle handle;
  uint64_t bytes = 0;
  std::string tag;
};

OpenedFile openFile(const std::string& path) {
  OpenedFile out;
  out.handle.reset(std::fopen(path.c_str(), "rbe"));
  struct stat about {};
  if (!out.handle || fstat(fileno(out.handle.get()), &about) != 0 || !S_ISREG(about.st_mode)) return {};
  out.bytes = static_cast<uint64_t>(about.st_size);
  out.tag = printed("\"%llx-%llx-%lx\"", static_cast<unsigned long long>(about.st_size),
                    static_cast<unsigned long long>(about.st_mtim.tv_sec), about.st_mtim.tv_nsec);
  return out;
}

void addField(std::string& head, const char* name, const std::string& value) {
  head += name;
  head += ": " + value + "\r\n";
}

std::string beginHead(int status, bool is_last) {
  std::string head = "HTTP/1.1 " + std::to_string(status) + " " + statusText(status) + "\r\n";
  addField(head, "Connection", is_last ? "close" : "keep-alive");
  addField(head, "X-Content-Type-Options", "nosniff");
  return head;
}

OpenedAnswer openText(const HttpAnswer& answer, bool is_last) {
  OpenedAnswer out;
  out.head = beginHead(answer.status, is_last);
  addField(out.head, "Cache-Control", "no-store");
  if (!answer.location.empty()) addField(out.head, "Location", answer.location);
  if (!answer.allow_origin.empty()) {
    addField(out.head, "Access-Control-Allow-Origin", answer.allow_origin);
    addField(out.head, "Vary", "Origin");
  } else {
    addField(out.head, "Cross-Origin-Resource-Policy", "same-origin");  // no picture in a page from elsewhere
  }
  if (answer.status == 405) addField(out.head, "Allow", "GET, HEAD");
  addField(out.head, "Content-Type", answer.type);
  addField(out.head, "Content-Length", std::to_string(answer.body.size()));
  out.head += "\r\n";
  out.body = answer.body;
  return out;
}

}  // namespace

std::string statusText(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 206:
      return "Partial Content";
    case 302:
      return "Found";
    case 304:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 416:
      return "Range Not Satisfiable";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    default:
      return "Answer";
  }
}

OpenedAnswer openAnswer(const HttpAnswer& answer, const FileConditions& conditions, bool is_last) {
  if (answer.file.empty()) return openText(answer, is_last);
  OpenedFile file = openFile(answer.file);
  if (!file.handle) {
    HttpAnswer missing;
    missing.status = 404;
    missing.body = "there is no such file";
    return openText(missing, is_last);
  }
  OpenedAnswer out;
  RangeAnswer range = parseRange(conditions.range, file.bytes);
  if (conditions.none_match == file.tag) range = {304, 0, 0};
  if (range.bytes > 0 && fseeko(file.handle.get(), static_cast<off_t>(range.first), SEEK_SET) != 0) range = {416, 0, 0};
  out.head = beginHead(range.status, is_last);
  addField(out.head, "Cache-Control", "no-cache");
  addField(out.head, "ETag", file.tag);
  addField(out.head, "Accept-Ranges", "bytes");
  const std::string all = "/" + std::to_string(file.bytes);
  if (range.status == 206)
    addField(out.head, "Content-Range",
             "bytes " + std::to_string(range.first) + "-" + std::to_string(range.first + range.bytes - 1) + all);
  if (range.status == 416) addField(out.head, "Content-Range", "bytes *" + all);
  addField(out.head, "Content-Type", answer.type);
  if (range.status != 304) addField(out.head, "Content-Length", std::to_string(range.bytes));
  out.head += "\r\n";
  out.file = std::move(file.handle);
  out.file_bytes = range.bytes;
  return out;
}

std::string bearerToken(const std::string& authorization) {
  constexpr const char* kScheme = "Bearer ";
  constexpr size_t kLength = 7;
  if (strncasecmp(authorization.c_str(), kScheme, kLength) != 0) return {};
  return authorization.substr(kLength);
}

}  // namespace fourdvt::live
