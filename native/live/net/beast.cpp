// SPDX-License-Identifier: Apache-2.0
// The code of Asio and Beast that does not depend on how they are used.
#include <boost/asio/impl/src.hpp>
#include <boost/asio/ssl/impl/src.hpp>
#include <boost/beast/src.hpp>
