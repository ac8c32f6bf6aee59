// SPDX-License-Identifier: Apache-2.0
#include "extras.h"

namespace fourdvt {
namespace {

Error absent() { return {ErrorId::Unsupported, "not in this module: use fourdvt-full.wasm"}; }

}  // namespace

Result<std::unique_ptr<render::FlowSource>> makeFlow(gpu::Device&, abi::AlignMode) { return absent(); }
Result<std::unique_ptr<render::Method>> makeMethod(gpu::Device&, std::string_view) { return absent(); }
const CameraParts* cameraPartsOfModule() { return nullptr; }

}  // namespace fourdvt
