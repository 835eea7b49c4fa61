// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/decompress.h"

#include <lz4frame.h>
#include <memory>

#include "e2lf/base/text.h"

#ifdef E2LF_HAVE_ZSTD
#include <zstd.h>
#endif

namespace e2lf::recordings {
namespace {

constexpr size_t kFirstRoom = size_t{1} << 16;

enum class PacketState { kGoesOn, kEnded, kDamaged };

/// Calls step(packed, room), which advances both spans by what it used, until the packet ends. `out` grows with the
/// content.
template <typename Step>
Result<void> unpack(std::span<const uint8_t> packed, std::vector<uint8_t>& out, const Step& step) {
  out.resize(kFirstRoom);
  size_t used = 0;
  for (;;) {
    std::span<uint8_t> room = std::span(out).subspan(used);
    const size_t before = packed.size() + room.size();
    const PacketState state = step(packed, room);
    if (state == PacketState::kDamaged) {
      return fail(ErrorCode::kFormat, "", "a packet cannot be decompressed; the file is damaged");
    }
    used = out.size() - room.size();
    if (state == PacketState::kEnded) break;
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

Result<void> unpack_lz4(std::span<const uint8_t> packed, std::vector<uint8_t>& out) {
  LZ4F_dctx* context = nullptr;
  LZ4F_createDecompressionContext(&context, LZ4F_VERSION);
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(context,
                                                                                   &LZ4F_freeDecompressionContext);
  return unpack(packed, out, [context](std::span<const uint8_t>& in, std::span<uint8_t>& room) {
    size_t read = in.size(), written = room.size();
    const size_t hint = LZ4F_decompress(context, room.data(), &written, in.data(), &read, nullptr);
    if (LZ4F_isError(hint)) return PacketState::kDamaged;
    in = in.subspan(read);
    room = room.subspan(written);
    return hint == 0 ? PacketState::kEnded : PacketState::kGoesOn;
  });
}

#ifdef E2LF_HAVE_ZSTD
Result<void> unpack_zstd(std::span<const uint8_t> packed, std::vector<uint8_t>& out) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, 27);
  return unpack(packed, out, [&context](std::span<const uint8_t>& packed_left, std::span<uint8_t>& room) {
    ZSTD_inBuffer in = {packed_left.data(), packed_left.size(), 0};
    ZSTD_outBuffer to = {room.data(), room.size(), 0};
    const size_t hint = ZSTD_decompressStream(context.get(), &to, &in);
    if (ZSTD_isError(hint)) return PacketState::kDamaged;
    packed_left = packed_left.subspan(in.pos);
    room = room.subspan(to.pos);
    return hint == 0 ? PacketState::kEnded : PacketState::kGoesOn;
  });
}
#endif

}  // namespace

Result<void> check_compression(Compression compression) {
  switch (compression) {
    case Compression::kNone:
    case Compression::kLz4:
    case Compression::kLz4High:
      return {};
    case Compression::kZstd:
    case Compression::kZstdHigh:
#ifdef E2LF_HAVE_ZSTD
      return {};
#else
      return fail(ErrorCode::kMissingDependency, "",
                  "the data are compressed by Zstandard; build with libzstd-dev installed, or unpack or record them "
                  "without it");
#endif
  }
  return fail(ErrorCode::kUnsupported, "", "compression ", static_cast<int32_t>(compression),
              " is unknown; the file may be damaged");
}

Result<void> decompress(Compression compression, std::span<const uint8_t> packed, std::vector<uint8_t>& out) {
  E2LF_RETURN_IF_ERROR(check_compression(compression));
  if (compression == Compression::kNone) {
    out.assign(packed.begin(), packed.end());
    return {};
  }
#ifdef E2LF_HAVE_ZSTD
  if (compression == Compression::kZstd || compression == Compression::kZstdHigh) return unpack_zstd(packed, out);
#endif
  return unpack_lz4(packed, out);
}

}  // namespace e2lf::recordings
