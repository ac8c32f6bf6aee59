// SPDX-License-Identifier: Apache-2.0
#include "flow_modes.h"

namespace fourdvt {

Result<std::unique_ptr<render::FlowSource>> makeFlow(gpu::Device&, abi::AlignMode) {
  return Error{ErrorId::Unsupported, "no optical flow in this module: use fourdvt-flow.wasm"};
}

}  // namespace fourdvt
