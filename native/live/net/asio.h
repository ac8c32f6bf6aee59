// SPDX-License-Identifier: Apache-2.0
// Boost.Asio includes of live/net; its separately compiled code is in beast.cpp. Included by sources of live/net only.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <utility>  // required by Boost 1.74, which lacks the include

namespace fourdvt::live {

namespace asio = boost::asio;
using ErrorCode = boost::system::error_code;

inline std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<int64_t>(seconds * 1e3));
}

}  // namespace fourdvt::live
