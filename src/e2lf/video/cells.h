// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/engine/kernel.h"

namespace e2lf::video {

// The operations of recurrent cells between their convolutions (Op::kConvGru, Op::kConvLstm), pixel by pixel. One
// block is one row. The states of a cell and the sums of its convolutions are float32, because small changes would be
// lost in bfloat16. The inputs of its convolutions have the type in which these compute.

/// Makes the kernel x, h' -> [x, h'] with the output type `type`, which is also that of x.
[[nodiscard]] std::unique_ptr<engine::Kernel> make_cell_join(size_t in_channels, size_t channels,
                                                             engine::ElementType type);

/// Makes the kernel x, h', (u, r) before their sigmoid -> [x, sigmoid(r) h'] with the output type `type`, which is also
/// that of x.
[[nodiscard]] std::unique_ptr<engine::Kernel> make_gru_reset(size_t in_channels, size_t channels,
                                                             engine::ElementType type);

/// Makes the kernel o before its tanh, h', (u, r) before their sigmoid -> h = h' + sigmoid(u) (tanh(o) - h').
[[nodiscard]] std::unique_ptr<engine::Kernel> make_gru_blend(size_t channels);

/// Makes the kernel (i, f, o, g) before their sigmoid and tanh, c' -> c = sigmoid(f) c' + sigmoid(i) tanh(g).
[[nodiscard]] std::unique_ptr<engine::Kernel> make_lstm_memory(size_t channels);

/// Makes the kernel (i, f, o, g) as above, c -> h = sigmoid(o) tanh(c).
[[nodiscard]] std::unique_ptr<engine::Kernel> make_lstm_output(size_t channels);

/// Makes the kernel that converts float32 to `type`.
[[nodiscard]] std::unique_ptr<engine::Kernel> make_cell_output(size_t channels, engine::ElementType type);

/// Makes the kernel tanh(x), whose input and output have the same type.
[[nodiscard]] std::unique_ptr<engine::Kernel> make_tanh(size_t channels, engine::ElementType type);

}  // namespace e2lf::video
