// SPDX-License-Identifier: MIT
#include "e2lf/files/sha256.h"

#include <algorithm>
#include <bit>
#include <fstream>
#include <vector>

#if defined(__x86_64__)
#include <cpuid.h>
#include <immintrin.h>
#endif

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"

namespace e2lf::sha256 {
namespace {

/// The constants of FIPS 180-4, section 4.2.2.
alignas(16) constexpr std::array<uint32_t, 64> kRound = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

void add_block(HashState& state, const uint8_t* block) {
  std::array<uint32_t, 64> word;
  for (size_t t = 0; t < 16; ++t) word[t] = __builtin_bswap32(load_le<uint32_t>(block + 4 * t));
  for (size_t t = 16; t < 64; ++t) {
    const uint32_t near = word[t - 2], far = word[t - 15];
    word[t] = (std::rotr(near, 17) ^ std::rotr(near, 19) ^ near >> 10) + word[t - 7] +
              (std::rotr(far, 7) ^ std::rotr(far, 18) ^ far >> 3) + word[t - 16];
  }
  auto [a, b, c, d, e, f, g, h] = state;
  for (size_t t = 0; t < 64; ++t) {
    const uint32_t first =
        h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) + ((e & f) ^ (~e & g)) + kRound[t] + word[t];
    const uint32_t second = (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + first, d = c, c = b, b = a, a = first + second;
  }
  const HashState added = {a, b, c, d, e, f, g, h};
  for (size_t i = 0; i < state.size(); ++i) state[i] += added[i];
}

}  // namespace

void add_blocks_scalar(HashState& state, const uint8_t* data, size_t blocks) {
  for (size_t i = 0; i < blocks; ++i) add_block(state, data + i * kBlockBytes);
}

#if defined(__x86_64__)

bool has_sha_instructions() {
  constexpr unsigned int kSha = 1U << 29;  // EBX of leaf 7
  unsigned int eax = 0, ebx = 0, ecx = 0, edx = 0;
  return __builtin_cpu_supports("sse4.1") && __get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx) != 0 && (ebx & kSha) != 0;
}

__attribute__((target("sha,sse4.1"))) void add_blocks_with_sha_instructions(HashState& state, const uint8_t* data,
                                                                            size_t blocks) {
  const __m128i swap_bytes = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  auto* const words = reinterpret_cast<__m128i*>(state.data());
  // The instructions take a, b, e, f in one register and c, d, g, h in the other, from the highest part on.
  const __m128i cdab = _mm_shuffle_epi32(_mm_loadu_si128(words), 0xB1);
  const __m128i efgh = _mm_shuffle_epi32(_mm_loadu_si128(words + 1), 0x1B);
  __m128i abef = _mm_alignr_epi8(cdab, efgh, 8), cdgh = _mm_blend_epi16(efgh, cdab, 0xF0);
  for (; blocks > 0; --blocks, data += kBlockBytes) {
    const __m128i abef_before = abef, cdgh_before = cdgh;
    __m128i word[4];
    for (int i = 0; i < 4; ++i) {
      word[i] = _mm_shuffle_epi8(_mm_loadu_si128(reinterpret_cast<const __m128i*>(data) + i), swap_bytes);
    }
#pragma GCC unroll 16
    for (int i = 0; i < 16; ++i) {  // four rounds each
      __m128i& now = word[i % 4];
      const __m128i& last = word[(i + 3) % 4];
      __m128i sum = _mm_add_epi32(now, _mm_load_si128(reinterpret_cast<const __m128i*>(kRound.data()) + i));
      cdgh = _mm_sha256rnds2_epu32(cdgh, abef, sum);
      sum = _mm_shuffle_epi32(sum, 0x0E);
      abef = _mm_sha256rnds2_epu32(abef, cdgh, sum);
      const __m128i seventh = _mm_alignr_epi8(last, word[(i + 2) % 4], 4);
      now = _mm_sha256msg2_epu32(_mm_add_epi32(_mm_sha256msg1_epu32(now, word[(i + 1) % 4]), seventh), last);
    }
    abef = _mm_add_epi32(abef, abef_before);
    cdgh = _mm_add_epi32(cdgh, cdgh_before);
  }
  const __m128i feba = _mm_shuffle_epi32(abef, 0x1B), dchg = _mm_shuffle_epi32(cdgh, 0xB1);
  _mm_storeu_si128(words, _mm_blend_epi16(feba, dchg, 0xF0));
  _mm_storeu_si128(words + 1, _mm_alignr_epi8(dchg, feba, 8));
}

#else

bool has_sha_instructions() {
  return false;
}

void add_blocks_with_sha_instructions(HashState& state, const uint8_t* data, size_t blocks) {
  add_blocks_scalar(state, data, blocks);
}

#endif

}  // namespace e2lf::sha256

namespace e2lf {
namespace fs = std::filesystem;
namespace {

class Sha256 {
 public:
  void add(std::span<const uint8_t> bytes) {
    bytes_ += bytes.size();
    if (!rest_.empty()) {
      const size_t missing = std::min(bytes.size(), sha256::kBlockBytes - rest_.size());
      rest_.insert(rest_.end(), bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(missing));
      bytes = bytes.subspan(missing);
      if (rest_.size() < sha256::kBlockBytes) return;
      add_blocks(rest_);
      rest_.clear();
    }
    const size_t whole = bytes.size() / sha256::kBlockBytes * sha256::kBlockBytes;
    add_blocks(bytes.first(whole));
    rest_.assign(bytes.begin() + static_cast<ptrdiff_t>(whole), bytes.end());
  }

  /// Returns the hash in hexadecimal; nothing may be added afterwards.
  std::string hex() {
    const uint64_t bits = 8 * bytes_;
    rest_.push_back(0x80);
    while (rest_.size() % sha256::kBlockBytes != sha256::kBlockBytes - sizeof bits) rest_.push_back(0);
    for (int shift = 56; shift >= 0; shift -= 8) rest_.push_back(static_cast<uint8_t>(bits >> shift));
    add_blocks(rest_);
    std::string text;
    for (const uint32_t word : state_) text += formatted("%08x", word);
    return text;
  }

 private:
  void add_blocks(std::span<const uint8_t> bytes) {
    static const auto add =
        sha256::has_sha_instructions() ? sha256::add_blocks_with_sha_instructions : sha256::add_blocks_scalar;
    add(state_, bytes.data(), bytes.size() / sha256::kBlockBytes);
  }

  sha256::HashState state_ = sha256::kInitial;
  std::vector<uint8_t> rest_;  ///< less than a block
  uint64_t bytes_ = 0;
};

Result<std::string> sha256_of_file(const fs::path& path, const ProgressFn& progress) {
  std::ifstream file(path, std::ios::binary);
  std::error_code ignored;
  const size_t bytes = fs::file_size(path, ignored);
  size_t done = 0;
  Sha256 sha256;
  std::vector<uint8_t> chunk(size_t{1} << 20);
  do {
    file.read(reinterpret_cast<char*>(chunk.data()), static_cast<std::streamsize>(chunk.size()));
    sha256.add(std::span(chunk).first(static_cast<size_t>(file.gcount())));
    done += static_cast<size_t>(file.gcount());
    if (progress) progress(done, bytes);
  } while (file);
  if (!file.eof()) {
    return fail(ErrorCode::kIo, path, "cannot read the input again for its hash; check the disk");
  }
  return sha256.hex();
}

}  // namespace

std::string sha256_of_bytes(std::span<const uint8_t> bytes) {
  Sha256 sha256;
  sha256.add(bytes);
  return sha256.hex();
}

std::string sha256_of_text(const std::string& text) {
  return sha256_of_bytes({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

Result<std::string> sha256_of(const fs::path& path, const ProgressFn& progress) {
  std::error_code error;
  if (!is_folder(path)) return sha256_of_file(path, progress);
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) files.push_back(entry->path());
  }
  std::ranges::sort(files);
  std::string listing;
  size_t done = 0;
  for (const fs::path& file : files) {
    E2LF_ASSIGN_OR_RETURN(const std::string hash, sha256_of_file(file, {}));
    listing += hash + "  " + file.lexically_relative(path).string() + "\n";
    if (progress) progress(++done, files.size());
  }
  return sha256_of_text(listing);
}

}  // namespace e2lf
