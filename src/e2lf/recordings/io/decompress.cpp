// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/decompress.h"

#include <algorithm>
#include <lz4frame.h>

#include "e2lf/base/text.h"
#ifdef E2LF_HAVE_ZSTD
#include <zstd.h>
#endif

namespace e2lf::recordings {
namespace {

constexpr size_t kFirstRoom = size_t{1} << 16;

Error damaged(const char* why) {
  return {ErrorCode::kFormat, cat("a packet cannot be decompressed (", why, "); the file is damaged"), ""};
}

Error cut() {
  return {ErrorCode::kTruncated, "a packet ends early; the file is damaged", ""};
}

Error too_large() {
  return {ErrorCode::kUnsupported, cat("a packet unpacks to more than ", kMaxPacketBytes, " bytes"), ""};
}

class Stored final : public Decompressor {
 public:
  Result<void> unpack(std::span<const uint8_t> packed, std::vector<uint8_t>& out) override {
    out.assign(packed.begin(), packed.end());
    return {};
  }
};

/// Calls step(input, output, done) with growing output until it sets done; step advances both spans by what it used.
template <typename Step>
Result<void> unpack_stepwise(std::span<const uint8_t> packed, std::vector<uint8_t>& out, const Step& step) {
  out.resize(kFirstRoom);
  size_t used = 0;
  for (;;) {
    std::span<uint8_t> room = std::span(out).subspan(used);
    bool done = false;
    const size_t before = packed.size() + room.size();
    E2LF_RETURN_IF_ERROR(step(packed, room, done));
    used = out.size() - room.size();
    if (done) break;
    if (room.empty()) {
      if (out.size() >= kMaxPacketBytes) return too_large();
      out.resize(2 * out.size());
    } else if (packed.size() + room.size() == before) {
      return cut();
    }
  }
  out.resize(used);
  return {};
}

class Lz4 final : public Decompressor {
 public:
  Lz4() { LZ4F_createDecompressionContext(&context_, LZ4F_VERSION); }
  Lz4(const Lz4&) = delete;
  Lz4& operator=(const Lz4&) = delete;
  ~Lz4() override { LZ4F_freeDecompressionContext(context_); }

  Result<void> unpack(std::span<const uint8_t> packed, std::vector<uint8_t>& out) override {
    LZ4F_resetDecompressionContext(context_);
    return unpack_stepwise(packed, out, [&](auto& input, auto& room, bool& done) -> Result<void> {
      size_t read = input.size(), written = room.size();
      const size_t hint = LZ4F_decompress(context_, room.data(), &written, input.data(), &read, nullptr);
      if (LZ4F_isError(hint)) return damaged(LZ4F_getErrorName(hint));
      input = input.subspan(read);
      room = room.subspan(written);
      done = hint == 0;
      return {};
    });
  }

 private:
  LZ4F_dctx* context_ = nullptr;
};

#ifdef E2LF_HAVE_ZSTD
class ZstdPackets final : public Decompressor {
 public:
  ZstdPackets() { ZSTD_DCtx_setParameter(context_.get(), ZSTD_d_windowLogMax, 26); }

  Result<void> unpack(std::span<const uint8_t> packed, std::vector<uint8_t>& out) override {
    ZSTD_DCtx_reset(context_.get(), ZSTD_reset_session_only);
    return unpack_stepwise(packed, out, [&](auto& input, auto& room, bool& done) -> Result<void> {
      ZSTD_inBuffer in = {input.data(), input.size(), 0};
      ZSTD_outBuffer written = {room.data(), room.size(), 0};
      const size_t hint = ZSTD_decompressStream(context_.get(), &written, &in);
      if (ZSTD_isError(hint)) return damaged(ZSTD_getErrorName(hint));
      input = input.subspan(in.pos);
      room = room.subspan(written.pos);
      done = hint == 0;
      return {};
    });
  }

 private:
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context_{ZSTD_createDCtx(), &ZSTD_freeDCtx};
};
#endif

}  // namespace

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
      return DecompressorPtr(std::make_unique<ZstdPackets>());
#else
      return Error{ErrorCode::kMissingDependency,
                   "the packets are compressed by Zstd; build with libzstd-dev installed, or record with LZ4", ""};
#endif
  }
  return Error{ErrorCode::kUnsupported,
               cat("compression ", static_cast<int32_t>(compression), " is unknown; the file may be damaged"), ""};
}

}  // namespace e2lf::recordings
