// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/engine/plan.h"
#include "e2lf/engine/row_pool.h"
#include "e2lf/engine/video/frame_memory.h"

namespace e2lf::engine {

/// The image a plan runs on: float32 planes [channel, height, width], row-major.
struct Image {
  std::span<const float> input;
  std::span<float> output;
  size_t height = 0;
  size_t width = 0;
};

/// Streams columns [begin, end) of an image through a plan, top to bottom. Each round is for a few more rows of the
/// output: each stage computes the rows that these will need of it, one round ahead of the stages that read them, as
/// far as its inputs allow; rows that nobody needs any more are reused. Where a stage needs all of an input first,
/// those before it and behind it go through the image a few rows at a time as well, one behind another. Columns up to
/// the plan's halo beside the range are read, so that cuts leave no trace.
class Stream {
 public:
  /// A plan that needs whole rows needs all columns at once, as does one with states, and `memory`;
  /// FrameMemory::end_frame() ends the frame.
  Stream(const Plan& plan, const Image& image, size_t begin, size_t end, FrameMemory* memory = nullptr);
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// One round; false once the last row of output is written. What a kernel throws comes through here and ends the
  /// stream.
  [[nodiscard]] bool advance();

  [[nodiscard]] size_t rows_done() const { return written_; }

  /// Memory that rows have taken so far.
  [[nodiscard]] size_t live_bytes() const { return pool_->bytes(); }

 private:
  /// Rows of a tensor: a table of all rows with those outside the image, which are zero. Null = not there.
  struct Tensor {
    std::vector<std::byte*> table;
    ptrdiff_t first = 0;  ///< row of table[0]
    size_t channels = 0, width = 0, height = 0, scale = 1;
    ElementType type = ElementType::kFloat32;
    size_t pixel_bytes = 0;
    size_t left = 0, right = 0;          ///< zero pixels beside the row
    size_t slack = 0;                    ///< pixels behind them that kernels may read, whatever they hold
    size_t distance = 0;                 ///< stages between it and the output, at most
    size_t done = 0;                     ///< rows [0, done) are computed
    size_t released = 0;                 ///< rows [0, released) are gone
    std::vector<size_t> readers;         ///< stages
    const WholeTensor* whole = nullptr;  ///< where its rows are for good, of states

    [[nodiscard]] Rows rows() const { return {table.data(), first}; }
    [[nodiscard]] size_t row_bytes() const { return (left + width + right + slack) * pixel_bytes; }
  };

  /// Work of one round: `blocks` calls in any order, after which *progress becomes `end`.
  struct Job {
    size_t blocks = 0;
    size_t end = 0;
    size_t* progress = nullptr;
    std::function<void(size_t block, std::byte* scratch)> run;
  };

  void add_margins();
  void open_memory(FrameMemory& memory);
  void give_back(Tensor& tensor, size_t y);
  void make_tables();
  void measure_distances();
  void find_readers();
  void add_rows(Tensor& tensor, size_t end);
  void release_rows(size_t tensor);
  [[nodiscard]] size_t rows_possible(size_t stage) const;
  [[nodiscard]] size_t rows_wanted(size_t tensor);
  [[nodiscard]] const std::vector<size_t>& rows_for(size_t output_rows);
  [[nodiscard]] size_t next_end(const Tensor& tensor, size_t end) const;
  void plan_input(std::vector<Job>& jobs);
  void plan_stage(size_t stage, std::vector<Job>& jobs);
  void plan_output(std::vector<Job>& jobs);
  void run_jobs(const std::vector<Job>& jobs) const;

  const Plan& plan_;
  Image image_;
  size_t begin_, end_;            ///< columns to compute
  size_t wide_begin_, wide_end_;  ///< with the halo
  std::vector<Tensor> tensors_;
  size_t round_ = 0, rounds_ahead_ = 0;  ///< the input is so many rounds ahead of the output
  size_t written_ = 0;
  bool waits_ = false;                              ///< a stage needs all of an input
  std::map<size_t, std::vector<size_t>> rows_for_;  ///< of each tensor, by the rows of output
  RowPool own_pool_;
  RowPool* pool_;  ///< its own, or that of the frames' memory
  AlignedBuffer zero_row_;
  std::vector<AlignedBuffer> scratch_;  ///< one for each thread
};

}  // namespace e2lf::engine
