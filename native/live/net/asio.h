// SPDX-License-Identifier: Apache-2.0
// Boost.Asio as the folder's sources include it; its own code is compiled once, in beast.cpp. Included by sources of
// live/net only.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <utility>  // which Boost 1.74 uses, but does not include

namespace fourdvt::live {

namespace asio = boost::asio;
using ErrorCode = boost::system::error_code;

inline std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<int64_t>(seconds * 1e3));
}

}  // namespace fourdvt::live
