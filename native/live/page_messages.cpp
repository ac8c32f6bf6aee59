// SPDX-License-Identifier: Apache-2.0
#include "live/page_messages.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace fourdvt::live {
namespace {

Error refused(const char* what) {
  return {ErrorId::StreamInvalid, std::string("live page: ") + what + "; use the page of the server's version"};
}

// Keys of a message, with a count of those that were read.
class Fields {
 public:
  explicit Fields(const nlohmann::json& json) : json_(json) {}
  std::optional<double> number(const char* name, double low, double high) {
    const auto at = json_.find(name);
    if (at == json_.end()) return std::nullopt;
    ++read_;
    const double value = at->is_number() ? at->get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!(value >= low && value <= high)) is_wrong_ = true;
    return value;
  }
  bool isPing() {
    const auto at = json_.find("type");
    if (at == json_.end()) return false;
    ++read_;
    if (*at != "ping") is_wrong_ = true;
    return true;
  }
  bool areAllRight() const { return !is_wrong_ && read_ == json_.size() && read_ > 0; }

 private:
  const nlohmann::json& json_;
  size_t read_ = 0;
  bool is_wrong_ = false;
};

}  // namespace

Result<PageMessage> readPageMessage(std::span<const uint8_t> bytes, bool is_console) {
  if (bytes.size() > kMaxPageMessageBytes) return refused("message too long");
  const nlohmann::json json = nlohmann::json::parse(bytes.begin(), bytes.end(), nullptr, false);
  if (!json.is_object()) return refused("message is no JSON object");
  PageMessage message;
  Fields fields(json);
  if (fields.isPing()) {
    message.ping_t = fields.number("t", -1e300, 1e300);
    if (!message.ping_t) return refused("ping without a number");
  } else if (is_console) {
    message.tolerance_px = fields.number("tolerance_px", 0, 64);
    const auto crf = fields.number("crf", 0, 51);
    if (crf && *crf != std::floor(*crf)) return refused("crf is no whole number");
    if (crf && fields.areAllRight()) message.crf = static_cast<int>(*crf);
  }
  if (!fields.areAllRight()) return refused("unknown message, or a number out of range");
  return message;
}

std::string pongJson(double ping_t, int64_t server_us) {
  return nlohmann::json{{"type", "pong"}, {"t", ping_t}, {"now", server_us}}.dump();
}

}  // namespace fourdvt::live
