// SPDX-License-Identifier: MIT
// The AMX instructions, for which Highway and some compilers have no functions. They have no results that the compiler
// knows of; it keeps their order, and no other code uses tiles.
#pragma once

#include <cstddef>
#include <cstdint>

namespace e2lf::engine {

inline constexpr size_t kTileRows = 16;   ///< also the columns of a tile of float32 sums
inline constexpr size_t kTileDepth = 32;  ///< bfloat16 numbers in a row of a tile
inline constexpr size_t kTileRowBytes = 64;

/// The operand of LDTILECFG: the number of rows and of bytes per row of each of the eight tiles.
struct alignas(64) TileShapes {
  uint8_t palette = 1;
  uint8_t start_row = 0;
  uint8_t reserved[14] = {};
  uint16_t row_bytes[16] = {};
  uint8_t rows[16] = {};
};

inline void load_tile_shapes(const TileShapes& shapes) {
  asm volatile("ldtilecfg %0" : : "m"(shapes));
}

/// Releases the tiles, which makes switching to another thread cheaper.
inline void release_tiles() {
  asm volatile("tilerelease");
}

}  // namespace e2lf::engine

#define E2LF_TILE_ZERO(tile) asm volatile("tilezero %%tmm" #tile : :)
#define E2LF_TILE_LOAD(tile, from, row_step_bytes) \
  asm volatile("tileloadd (%0,%1,1), %%tmm" #tile : : "r"(from), "r"(row_step_bytes) : "memory")
#define E2LF_TILE_STORE(tile, to, row_step_bytes) \
  asm volatile("tilestored %%tmm" #tile ", (%0,%1,1)" : : "r"(to), "r"(row_step_bytes) : "memory")
/// Adds the bfloat16 product rows x columns to `sums`. A row of `columns` holds two elements of the depth per column.
#define E2LF_TILE_MULTIPLY(sums, rows, columns) \
  asm volatile("tdpbf16ps %%tmm" #columns ", %%tmm" #rows ", %%tmm" #sums : :)
