// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/decompress.h"

#include <algorithm>
#include <lz4frame.h>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"

#ifdef E2LF_HAVE_ZSTD
#include <zstd.h>
#endif

namespace e2lf::recordings {
namespace {

constexpr size_t kFirstRoom = size_t{1} << 16;

class Stored final : public Decompressor {
 public:
  State step(std::span<const uint8_t>& packed, std::span<uint8_t>& room) override {
    const size_t count = std::min(packed.size(), room.size());
    std::copy_n(packed.begin(), count, room.begin());
    packed = packed.subspan(count);
    room = room.subspan(count);
    return packed.empty() ? State::kBetweenParts : State::kInside;
  }
};

class Lz4 final : public Decompressor {
 public:
  Lz4() { LZ4F_createDecompressionContext(&context_, LZ4F_VERSION); }
  Lz4(const Lz4&) = delete;
  Lz4& operator=(const Lz4&) = delete;
  ~Lz4() override { LZ4F_freeDecompressionContext(context_); }

  void reset() override { LZ4F_resetDecompressionContext(context_); }
  State step(std::span<const uint8_t>& packed, std::span<uint8_t>& room) override {
    size_t read = packed.size(), written = room.size();
    const size_t hint = LZ4F_decompress(context_, room.data(), &written, packed.data(), &read, nullptr);
    if (LZ4F_isError(hint)) return State::kDamaged;
    packed = packed.subspan(read);
    room = room.subspan(written);
    return hint == 0 ? State::kBetweenParts : State::kInside;
  }

 private:
  LZ4F_dctx* context_ = nullptr;
};

#ifdef E2LF_HAVE_ZSTD
class Zstd final : public Decompressor {
 public:
  Zstd() { ZSTD_DCtx_setParameter(context_.get(), ZSTD_d_windowLogMax, 27); }

  void reset() override {
    ZSTD_DCtx_reset(context_.get(), ZSTD_reset_session_only);
    wanted_ = kFirstBytes;
  }
  /// Provides the bytes of one block at a time: if one of several is damaged, the library returns none of them.
  State step(std::span<const uint8_t>& packed, std::span<uint8_t>& room) override {
    do {
      ZSTD_inBuffer in = {packed.data(), std::min(packed.size(), wanted_), 0};
      ZSTD_outBuffer out = {room.data(), room.size(), 0};
      const size_t hint = ZSTD_decompressStream(context_.get(), &out, &in);
      packed = packed.subspan(in.pos);
      room = room.subspan(out.pos);
      if (ZSTD_isError(hint)) return State::kDamaged;
      wanted_ = hint == 0 ? kFirstBytes : hint;
      if (hint == 0) return State::kBetweenParts;
    } while (!packed.empty() && !room.empty());
    return State::kInside;
  }

 private:
  static constexpr size_t kFirstBytes = 5;  ///< of a frame, which determine the size of its header
  size_t wanted_ = kFirstBytes;
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context_{ZSTD_createDCtx(), &ZSTD_freeDCtx};
};
#endif

}  // namespace

Result<void> Decompressor::unpack(std::span<const uint8_t> packed, std::vector<uint8_t>& out) {
  reset();
  out.resize(kFirstRoom);
  size_t used = 0;
  for (;;) {
    std::span<uint8_t> room = std::span(out).subspan(used);
    const size_t before = packed.size() + room.size();
    const State state = step(packed, room);
    if (state == State::kDamaged) {
      return fail(ErrorCode::kFormat, "", "a packet cannot be decompressed; the file is damaged");
    }
    used = out.size() - room.size();
    if (state == State::kBetweenParts) break;
    if (room.empty()) {
      if (out.size() >= kMaxPacketBytes) {
        return fail(ErrorCode::kUnsupported, "", "a packet unpacks to more than ", kMaxPacketBytes, " bytes");
      }
      out.resize(2 * out.size());
    } else if (packed.size() + room.size() == before) {
      return fail(ErrorCode::kTruncated, "", "a packet ends early; the file is damaged");
    }
  }
  out.resize(used);
  return {};
}

Result<DecompressorPtr> make_decompressor(Compression compression) {
  switch (compression) {
    case Compression::kNone:
      return DecompressorPtr(std::make_unique<Stored>());
    case Compression::kLz4:
    case Compression::kLz4High:
      return DecompressorPtr(std::make_unique<Lz4>());
    case Compression::kZstd:
    case Compression::kZstdHigh:
#ifdef E2LF_HAVE_ZSTD
      return DecompressorPtr(std::make_unique<Zstd>());
#else
      return fail(ErrorCode::kMissingDependency, "",
                  "the data are compressed by Zstandard; build with libzstd-dev installed, or unpack or record them "
                  "without it");
#endif
  }
  return fail(ErrorCode::kUnsupported, "", "compression ", static_cast<int32_t>(compression),
              " is unknown; the file may be damaged");
}

}  // namespace e2lf::recordings
