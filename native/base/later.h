// SPDX-License-Identifier: Apache-2.0
// Calls functions that a page loads after its first picture (wasm/split.mjs), through a pointer that is opaque to the
// compiler, so that their code is never inlined into a caller. In native builds, plain calls through a pointer.
#pragma once

#include <functional>
#include <utility>

namespace fourdvt {

// Wraps a function, or a method with its object as the first argument. All of Later is in the module's second part.
template <auto Function, class Result, class... Arguments>
struct Later {
  static Result call(Arguments... arguments) { return std::invoke(Function, std::forward<Arguments>(arguments)...); }
  static inline Result (*volatile pointer)(Arguments...) = call;
};

template <auto Function, class Result, class... Arguments>
auto laterOf(Result (*)(Arguments...)) -> Later<Function, Result, Arguments...>;
template <auto Function, class Result, class Object, class... Arguments>
auto laterOf(Result (Object::*)(Arguments...)) -> Later<Function, Result, Object&, Arguments...>;
template <auto Function, class Result, class Object, class... Arguments>
auto laterOf(Result (Object::*)(Arguments...) const) -> Later<Function, Result, const Object&, Arguments...>;

// later<&Class::method>(object, arguments…), later<&function>(arguments…).
template <auto Function>
constexpr auto& later = decltype(laterOf<Function>(Function))::pointer;

}  // namespace fourdvt
