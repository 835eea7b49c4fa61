// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "e2lf/recordings/io/bytes.h"

/// A source for tests and fuzzing that provides bytes in pieces, as a live source would.
namespace e2lf::recordings {

/// The pieces end at the given positions (ascending), and then every `step` bytes. Each fetch sees at most the pieces
/// that it needs.
class ChunkedSource final : public ByteSource {
 public:
  ChunkedSource(std::vector<uint8_t> bytes, std::vector<size_t> cuts, size_t step)
      : bytes_(std::move(bytes)), cuts_(std::move(cuts)), step_(std::max<size_t>(step, 1)) {}

  Result<std::span<const uint8_t>> fetch(size_t wanted) override {
    while (arrived_ - position_ < wanted && arrived_ < bytes_.size()) {
      const auto cut = std::upper_bound(cuts_.begin(), cuts_.end(), arrived_);
      const size_t next = cut != cuts_.end() ? *cut : arrived_ + step_;
      arrived_ = std::min(next, bytes_.size());
    }
    // The copy has exactly these bytes, so that the address sanitizer detects reads beyond them.
    piece_.assign(bytes_.begin() + static_cast<ptrdiff_t>(position_),
                  bytes_.begin() + static_cast<ptrdiff_t>(arrived_));
    return std::span<const uint8_t>(piece_);
  }
  void consume(size_t count) override { position_ += count; }
  uint64_t position() const override { return position_; }
  Result<void> seek(uint64_t) override { return Error{ErrorCode::kUnsupported, "a live source cannot be sought", ""}; }
  bool seekable() const override { return false; }
  std::optional<uint64_t> size() const override { return std::nullopt; }
  std::string name() const override { return "chunks"; }

 private:
  std::vector<uint8_t> bytes_;
  std::vector<size_t> cuts_;
  size_t step_;
  size_t position_ = 0;
  size_t arrived_ = 0;
  std::vector<uint8_t> piece_;
};

/// Returns a source of pieces of `step` bytes.
inline SourcePtr chunked(std::vector<uint8_t> bytes, size_t step) {
  return std::make_unique<ChunkedSource>(std::move(bytes), std::vector<size_t>(), step);
}

}  // namespace e2lf::recordings
