// SPDX-License-Identifier: Apache-2.0
#include <EGL/egl.h>
#include <gtest/gtest.h>

#include <string>

#include "platform/egl_context.h"

namespace fourdvt::platform {
namespace {

TEST(PlatformEgl, MakesAnEs3ContextCurrent) {
  auto context = EglContext::create();
  ASSERT_TRUE(context.ok()) << context.error().message;
  ASSERT_NE(eglGetCurrentContext(), EGL_NO_CONTEXT);
  auto get_string = reinterpret_cast<const unsigned char* (*)(unsigned)>(eglGetProcAddress("glGetString"));
  ASSERT_NE(get_string, nullptr);
  const std::string version(reinterpret_cast<const char*>(get_string(0x1F02)));  // GL_VERSION
  EXPECT_EQ(version.find("OpenGL ES 3"), 0u) << version;
}

TEST(PlatformEgl, ContextsComeAndGo) {
  {
    auto first = EglContext::create();
    ASSERT_TRUE(first.ok());
    auto second = EglContext::create();
    ASSERT_TRUE(second.ok());
    first = Error{};  // the other context stays current
    EXPECT_NE(eglGetCurrentContext(), EGL_NO_CONTEXT);
  }
  EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT);
  EXPECT_TRUE(EglContext::create().ok());
}

}  // namespace
}  // namespace fourdvt::platform
