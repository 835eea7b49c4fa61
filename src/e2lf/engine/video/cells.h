// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

// What recurrent cells do between their convolutions (model::Op::kConvGru, kConvLstm), pixel by pixel; one block is one
// row. What a cell remembers, and its convolutions' sums, are float32, since a memory in bfloat16 would lose every
// small change. What its convolutions read is of the type they compute in.

/// Inputs x, h' -> [x, h'] of `type`, which x is of too.
[[nodiscard]] std::unique_ptr<Kernel> make_cell_join(size_t in_channels, size_t channels, ElementType type);

/// Inputs x, h', (u, r) before their sigmoid -> [x, sigmoid(r) h'] of `type`, which x is of too.
[[nodiscard]] std::unique_ptr<Kernel> make_gru_reset(size_t in_channels, size_t channels, ElementType type);

/// Inputs o before its tanh, h', (u, r) before their sigmoid -> h = h' + sigmoid(u) (tanh(o) - h').
[[nodiscard]] std::unique_ptr<Kernel> make_gru_blend(size_t channels);

/// Inputs (i, f, o, g) before their sigmoid and tanh, c' -> c = sigmoid(f) c' + sigmoid(i) tanh(g).
[[nodiscard]] std::unique_ptr<Kernel> make_lstm_memory(size_t channels);

/// Inputs (i, f, o, g) as above, c -> h = sigmoid(o) tanh(c).
[[nodiscard]] std::unique_ptr<Kernel> make_lstm_output(size_t channels);

/// float32 -> `type`.
[[nodiscard]] std::unique_ptr<Kernel> make_cell_output(size_t channels, ElementType type);

/// sigmoid(x), tanh(x), of one type.
[[nodiscard]] std::unique_ptr<Kernel> make_sigmoid(size_t channels, ElementType type);
[[nodiscard]] std::unique_ptr<Kernel> make_tanh(size_t channels, ElementType type);

/// The kernel of a tensor that is there before anything is computed: it computes nothing.
[[nodiscard]] std::unique_ptr<Kernel> make_recall();

}  // namespace e2lf::engine
