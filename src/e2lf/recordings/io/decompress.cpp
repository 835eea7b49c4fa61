// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/decompress.h"

#include <algorithm>
#include <lz4frame.h>
#include <zlib.h>

#include "e2lf/base/contract.h"
#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"

#ifdef E2LF_HAVE_ZSTD
#include <zstd.h>
#endif

namespace e2lf::recordings {
namespace {

constexpr size_t kFirstRoom = size_t{1} << 16;
constexpr size_t kUnpackBytes = size_t{1} << 18;
/// Limit of one step, so that zlib's 32-bit counters suffice.
constexpr size_t kMaxStepBytes = size_t{1} << 20;

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

class Gzip final : public Decompressor {
 public:
  Gzip() { inflateInit2(&stream_, 16 + MAX_WBITS); }
  Gzip(const Gzip&) = delete;
  Gzip& operator=(const Gzip&) = delete;
  ~Gzip() override { inflateEnd(&stream_); }

  State step(std::span<const uint8_t>& packed, std::span<uint8_t>& room) override {
    stream_.next_in = const_cast<Bytef*>(packed.data());  // zlib only reads it
    stream_.avail_in = static_cast<uInt>(packed.size());
    stream_.next_out = room.data();
    stream_.avail_out = static_cast<uInt>(room.size());
    const int state = inflate(&stream_, Z_NO_FLUSH);
    packed = packed.last(stream_.avail_in);
    room = room.last(stream_.avail_out);
    if (state == Z_STREAM_END) {
      inflateReset(&stream_);
      return State::kBetweenParts;
    }
    return state == Z_OK || state == Z_BUF_ERROR ? State::kInside : State::kDamaged;
  }

 private:
  z_stream stream_{};
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
      return Error{ErrorCode::kFormat, "a packet cannot be decompressed; the file is damaged", ""};
    }
    used = out.size() - room.size();
    if (state == State::kBetweenParts) break;
    if (room.empty()) {
      if (out.size() >= kMaxPacketBytes) {
        return Error{ErrorCode::kUnsupported, cat("a packet unpacks to more than ", kMaxPacketBytes, " bytes"), ""};
      }
      out.resize(2 * out.size());
    } else if (packed.size() + room.size() == before) {
      return Error{ErrorCode::kTruncated, "a packet ends early; the file is damaged", ""};
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
      return Error{ErrorCode::kMissingDependency,
                   "the data are compressed by Zstandard; build with libzstd-dev installed, or unpack or record them "
                   "without it",
                   ""};
#endif
  }
  return Error{ErrorCode::kUnsupported,
               cat("compression ", static_cast<int32_t>(compression), " is unknown; the file may be damaged"), ""};
}

namespace {

bool is_gzip(std::span<const uint8_t> head) {
  constexpr uint8_t kReservedFlags = 0xE0;
  return head.size() >= kPackedMarkBytes && head[0] == 0x1F && head[1] == 0x8B && head[2] == 8 &&
         (head[3] & kReservedFlags) == 0;
}

bool is_zstd(std::span<const uint8_t> head) {
  return head.size() >= kPackedMarkBytes && load_le<uint32_t>(head.data()) == 0xFD2FB528;
}

class UnpackedSource final : public ByteSource {
 public:
  UnpackedSource(SourcePtr packed, DecompressorPtr unpacker, std::shared_ptr<DecodeSummary> losses)
      : packed_(std::move(packed)), unpacker_(std::move(unpacker)), losses_(std::move(losses)) {}

  Result<std::span<const uint8_t>> fetch(size_t wanted) override {
    while (end_ - begin_ < wanted && !has_ended_) E2LF_RETURN_IF_ERROR(unpack_more(wanted));
    return std::span<const uint8_t>(buffer_).subspan(begin_, end_ - begin_);
  }
  void consume(size_t count) override {
    E2LF_REQUIRE(count <= end_ - begin_, "more consumed than fetched");
    begin_ += count;
    position_ += count;
  }
  uint64_t position() const override { return position_; }
  Result<void> seek(uint64_t) override {
    return Error{ErrorCode::kUnsupported, "a compressed file is not seekable; unpack it first", name()};
  }
  bool seekable() const override { return false; }
  std::optional<uint64_t> size() const override { return std::nullopt; }
  std::optional<std::chrono::steady_clock::time_point> arrival() const override { return packed_->arrival(); }
  DecodeSummary left_out() const override {
    DecodeSummary all = packed_->left_out();
    all.add_losses(*losses_);
    return all;
  }
  std::string name() const override { return packed_->name(); }
  std::filesystem::path logical_path() const override {
    const std::filesystem::path path = packed_->path();
    return path.extension() == ".gz" || path.extension() == ".zst" ? path.parent_path() / path.stem() : path;
  }

 private:
  Result<void> unpack_more(size_t wanted) {
    std::copy(buffer_.begin() + static_cast<ptrdiff_t>(begin_), buffer_.begin() + static_cast<ptrdiff_t>(end_),
              buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
    // Grows in steps, because `wanted` may exceed the content.
    const size_t room = std::max(kUnpackBytes, std::min({wanted, 2 * end_, kMaxStepBytes}));
    if (buffer_.size() < end_ + room) buffer_.resize(end_ + room);
    // If the output was full, more follows without further input.
    E2LF_ASSIGN_OR_RETURN(const auto at_hand, packed_->fetch(was_full_ ? 0 : 1));
    if (at_hand.empty() && !was_full_) {
      has_ended_ = true;
      if (state_ == Decompressor::State::kInside) losses_->add(Violation::kTruncated, packed_->position());
      return {};
    }
    const auto packed = at_hand.first(std::min(at_hand.size(), kMaxStepBytes));
    if (state_ == Decompressor::State::kBetweenParts && !packed.empty() && packed[0] == 0) {
      has_ended_ = true;  // padding of the last block of a tape
      return {};
    }
    auto rest = packed;
    auto free = std::span(buffer_).subspan(end_, room);
    if (state_ == Decompressor::State::kInside || !rest.empty()) state_ = unpacker_->step(rest, free);
    was_full_ = free.empty();
    end_ += room - free.size();
    packed_->consume(packed.size() - rest.size());
    if (state_ == Decompressor::State::kDamaged) {
      has_ended_ = true;
      losses_->add(Violation::kBadRecord, packed_->position());
    }
    return {};
  }

  SourcePtr packed_;
  DecompressorPtr unpacker_;
  std::shared_ptr<DecodeSummary> losses_;
  Decompressor::State state_ = Decompressor::State::kInside;
  std::vector<uint8_t> buffer_;
  size_t begin_ = 0, end_ = 0;
  uint64_t position_ = 0;
  bool was_full_ = false, has_ended_ = false;
};

}  // namespace

bool is_packed(std::span<const uint8_t> head) {
  return is_gzip(head) || is_zstd(head);
}

Result<SourcePtr> make_unpacked_source(SourcePtr packed, std::shared_ptr<DecodeSummary> losses) {
  E2LF_ASSIGN_OR_RETURN(const auto head, packed->fetch(kPackedMarkBytes));
  DecompressorPtr unpacker = std::make_unique<Gzip>();
  if (!is_gzip(head)) {
    E2LF_ASSIGN_OR_RETURN(unpacker, make_decompressor(Compression::kZstd));
  }
  return SourcePtr(std::make_unique<UnpackedSource>(std::move(packed), std::move(unpacker), std::move(losses)));
}

Result<SourcePtr> open_file_beside(const std::filesystem::path& path) {
  std::error_code error;
  for (const char* const extension : {"", ".gz", ".zst"}) {
    std::filesystem::path candidate = path;
    candidate += extension;
    if (path.empty() || !std::filesystem::exists(candidate, error)) continue;
    E2LF_ASSIGN_OR_RETURN(auto source, open_file_source(candidate));
    E2LF_ASSIGN_OR_RETURN(const auto head, source->fetch(kPackedMarkBytes));
    return is_packed(head) ? make_unpacked_source(std::move(source), std::make_shared<DecodeSummary>())
                           : Result<SourcePtr>(std::move(source));
  }
  return SourcePtr();
}

}  // namespace e2lf::recordings
