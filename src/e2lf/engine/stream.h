// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/engine/plan.h"
#include "e2lf/engine/row_memory.h"

namespace e2lf::engine {

/// The image on which a plan runs: float32 planes [channel, height, width], row-major.
struct Image {
  std::span<const float> input;
  std::span<float> output;
  size_t height = 0;
  size_t width = 0;
  std::span<const size_t> planes = {};  ///< the plane of `output` of each channel; empty = in order
};

/// Streams columns [begin, end) of an image through a plan, from top to bottom. In each round, each stage computes a
/// few more rows, one round ahead of the stages that read them, as far as its inputs allow. If the output has to wait,
/// the stages before it wait, too, so that few rows are kept, except for those whose rows are much smaller than what
/// they read. Rows that are no longer needed are reused. Columns beside
/// the range are read up to the halo of the plan, so that cuts leave no trace.
class Stream {
 public:
  /// A plan that needs whole rows must get all columns at once. So must a plan with states, for which
  /// FrameState::end_frame() ends the frame.
  Stream(const Plan& plan, const Image& image, size_t begin, size_t end, FrameState& memory);
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Runs one round. Returns false once the last row of the output is written. Exceptions thrown by a kernel are passed
  /// on and end the stream.
  [[nodiscard]] bool advance();

  [[nodiscard]] size_t rows_done() const { return written_; }

 private:
  /// The rows of a tensor: a table of all rows, including those outside of the image, which are zero. Rows that do not
  /// exist are null.
  struct Tensor : TensorSpec {
    std::vector<std::byte*> table = {};
    size_t width = 0, height = 0;
    size_t pixel_bytes = 0;
    size_t left = 0, right = 0;          ///< zero pixels beside each row
    size_t slack = 0;                    ///< pixels after them that kernels may read, with any values
    size_t distance = 0;                 ///< largest number of stages between it and the output
    size_t done = 0;                     ///< rows [0, done) are computed
    size_t released = 0;                 ///< rows [0, released) are released
    std::vector<size_t> readers = {};    ///< stages
    const WholeTensor* whole = nullptr;  ///< permanent memory of its rows, if it is a state

    /// The margins above and below are the same as those to the left and right.
    [[nodiscard]] Rows rows() const { return {table.data(), -static_cast<ptrdiff_t>(left)}; }
    [[nodiscard]] size_t row_bytes() const { return (left + width + right + slack) * pixel_bytes; }
  };

  /// The work of one round: `blocks` calls in any order, after which *progress becomes `end`.
  struct Job {
    size_t blocks = 0;
    size_t end = 0;
    size_t* progress = nullptr;
    std::function<void(size_t block, std::byte* scratch)> run;
  };

  void add_margins();
  void open_states();
  void give_back(Tensor& tensor, size_t y);
  void make_tables();
  void find_readers();
  void add_rows(Tensor& tensor, size_t end);
  void release_rows(size_t tensor);
  [[nodiscard]] size_t rows_possible(size_t stage) const;
  [[nodiscard]] size_t rows_wanted(size_t tensor);
  [[nodiscard]] bool frees_memory(size_t stage) const;
  [[nodiscard]] const std::vector<size_t>& rows_for(size_t output_rows);
  [[nodiscard]] size_t next_end(const Tensor& tensor, size_t end) const;
  void plan_input(std::vector<Job>& jobs);
  void plan_stage(size_t stage, std::vector<Job>& jobs);
  void plan_output(std::vector<Job>& jobs);
  void run_jobs(const std::vector<Job>& jobs) const;

  const Plan& plan_;
  Image image_;
  size_t begin_, end_;            ///< columns to compute
  size_t wide_begin_, wide_end_;  ///< including the halo
  std::vector<Tensor> tensors_;
  size_t written_ = 0;
  std::map<size_t, std::vector<size_t>> rows_for_;  ///< rows of each tensor, by the number of output rows
  FrameState& memory_;
  AlignedBuffer zero_row_;
};

}  // namespace e2lf::engine
