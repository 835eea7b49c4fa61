// SPDX-License-Identifier: MIT
#include "e2lf/engine/stream.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"
#include "e2lf/engine/conv.h"

namespace e2lf::engine {
namespace {

// The number of output rows per round. More rows load the weights less often; fewer rows stay in the cache.
constexpr size_t kRowsPerRound = 4;

// The number of rows that a stage may advance in a round, a multiple of kTileSize. Without this limit, all rows that
// became possible at once, as after a stage of low resolution, would pass through all later stages together. Fewer rows
// load the weights of stages of low resolution more often.
constexpr size_t kMostRowsPerRound = 16;

// Threads take at most the remaining work divided by this and by the number of threads at a time.
constexpr size_t kRunsPerThread = 4;

/// Returns the first input row that output rows from `y` on need.
size_t first_needed(const Reach& reach, size_t y) {
  const size_t row = y * reach.down / reach.up;
  return row > reach.before ? row - reach.before : 0;
}

// The number of pixels transposed at a time, such that a line of the row's channels and a line of each plane fit into
// the first-level cache together.
constexpr size_t kBlock = 64;

/// Interleaves a row of planes: pixel x of channel c, at from[c * plane + x], is copied to element x * padded channels
/// + c of `row`. The padding channels become zero.
template <typename T>
void read_planes(const float* from, size_t plane, size_t channels, size_t width, T* row) {
  const size_t step = padded_channels(channels);
  std::fill_n(row, width * step, T{});
  for (size_t c = 0; c < channels; ++c) {
    for (size_t x = 0; x < width; ++x) assign(from[c * plane + x], row[x * step + c]);
  }
}

/// Does the inverse: element x * padded channels + c of `row` is copied to to[planes[c] * plane + x], or, if `planes`
/// is empty, to to[c * plane + x].
template <typename T>
void write_planes(const T* row, size_t channels, size_t width, float* to, size_t plane,
                  std::span<const size_t> planes) {
  const size_t step = padded_channels(channels);
  for (size_t begin = 0; begin < width; begin += kBlock) {
    const size_t end = std::min(width, begin + kBlock);
    for (size_t c = 0; c < channels; ++c) {
      float* const line = to + (planes.empty() ? c : planes[c]) * plane;
      for (size_t x = begin; x < end; ++x) line[x] = to_float(row[x * step + c]);
    }
  }
}

}  // namespace

Stream::Stream(const Plan& plan, const Image& image, size_t begin, size_t end, FrameState& memory)
    : plan_(plan),
      image_(image),
      begin_(begin),
      end_(end),
      wide_begin_(begin > plan.halo ? begin - plan.halo : 0),
      wide_end_(std::min(image.width, end + plan.halo)),
      memory_(memory) {
  for (const TensorSpec& spec : plan.tensors) {
    Tensor tensor{spec};
    tensor.width = (wide_end_ - wide_begin_) / spec.scale;
    tensor.height = image.height / spec.scale;
    tensor.pixel_bytes = padded_channels(spec.channels) * element_size(spec.type);
    tensors_.push_back(std::move(tensor));
  }
  add_margins();
  E2LF_REQUIRE((plan.states.empty() && !plan.needs_whole_rows) || (begin == 0 && end == image.width),
               "this network requires whole images");
  if (!plan.states.empty()) open_states();
  make_tables();
  find_readers();
  size_t scratch_bytes = 0;
  for (const Stage& stage : plan.stages) scratch_bytes = std::max(scratch_bytes, stage.kernel->scratch_bytes());
  memory_.scratch.resize(static_cast<size_t>(num_threads()));
  for (AlignedBuffer& scratch : memory_.scratch) {
    if (scratch.size() < scratch_bytes) scratch = AlignedBuffer(scratch_bytes);
  }
}

void Stream::add_margins() {
  for (const Stage& stage : plan_.stages) {
    const Reach reach = stage.kernel->reach();
    for (size_t i = 0; i < stage.inputs.size(); ++i) {
      if (stage.kernel->needs_all(i)) continue;
      Tensor& tensor = tensors_[stage.inputs[i]];
      tensor.left = std::max(tensor.left, reach.before);
      tensor.right = std::max(tensor.right, reach.after + kTileSize - 1);
      tensor.slack = std::max(tensor.slack, kReadAhead * reach.down);
    }
  }
}

/// Uses the memory of the previous frame, or creates it with zeros for the first frame.
void Stream::open_states() {
  const size_t states = plan_.states.size();
  const bool is_new = memory_.before.empty();
  if (is_new) {
    memory_.before.resize(states);
    memory_.now.resize(states);
    memory_.height = image_.height;
    memory_.width = image_.width;
  }
  E2LF_REQUIRE(memory_.before.size() == states && memory_.height == image_.height && memory_.width == image_.width,
               "the memory belongs to another network or image size");
  for (size_t i = 0; i < states; ++i) {
    Tensor &recalled = tensors_[plan_.states[i].recalled], &kept = tensors_[plan_.states[i].kept];
    recalled.left = kept.left = std::max(recalled.left, kept.left);
    recalled.right = kept.right = std::max(recalled.right, kept.right);
    recalled.slack = kept.slack = std::max(recalled.slack, kept.slack);
    const size_t stride = spread_stride(kept.row_bytes());
    for (auto& tensors : {&memory_.before, &memory_.now}) {
      if (is_new) (*tensors)[i] = {AlignedBuffer(kept.height * stride), stride};
    }
    recalled.whole = &memory_.before[i];
    kept.whole = &memory_.now[i];
  }
}

void Stream::make_tables() {
  size_t row_bytes = 0;
  for (const Tensor& tensor : tensors_) row_bytes = std::max(row_bytes, tensor.row_bytes());
  zero_row_ = AlignedBuffer(row_bytes);
  for (Tensor& tensor : tensors_) {
    tensor.table.assign(tensor.left + tensor.height + tensor.right, nullptr);
    std::byte* zero = zero_row_.data() + tensor.left * tensor.pixel_bytes;
    std::fill_n(tensor.table.begin(), tensor.left, zero);
    std::fill_n(tensor.table.end() - static_cast<ptrdiff_t>(tensor.right), tensor.right, zero);
  }
}

/// Finds the readers of each tensor, and its distance from the output.
void Stream::find_readers() {
  for (size_t i = plan_.stages.size(); i-- > 0;) {
    const Stage& stage = plan_.stages[i];
    for (const size_t read : stage.reads()) {
      Tensor& tensor = tensors_[read];
      if (tensor.readers.empty() || tensor.readers.back() != i) tensor.readers.push_back(i);
      tensor.distance = std::max(tensor.distance, tensors_[i + 1].distance + 1);
    }
  }
}

size_t Stream::rows_wanted(size_t index) {
  // A tensor is one round ahead of those that are computed from it.
  const size_t output_rows = tensors_.back().done + (1 + tensors_[index].distance) * kRowsPerRound;
  return rows_for(std::min(output_rows, round_up(image_.height, kRowsPerRound)))[index];
}

/// Returns the number of rows of each tensor that the first rows of the output depend on.
const std::vector<size_t>& Stream::rows_for(size_t output_rows) {
  std::vector<size_t>& rows = rows_for_[output_rows];
  if (!rows.empty()) return rows;
  rows.resize(tensors_.size(), 0);
  rows.back() = output_rows;
  // The next frame may need rows of a state on which the output of this frame does not depend.
  for (const RecurrentState& state : plan_.states) {
    if (output_rows >= image_.height) rows[state.kept] = tensors_[state.kept].height;
  }
  for (size_t i = tensors_.size(); i-- > 0;) {
    rows[i] = std::min(tensors_[i].height, round_up(rows[i], kTileSize));
    if (i == 0 || rows[i] == 0) continue;
    const Stage& stage = plan_.stages[i - 1];
    const Reach reach = stage.kernel->reach();
    for (size_t input = 0; input < stage.inputs.size(); ++input) {
      size_t& needed = rows[stage.inputs[input]];
      const size_t last = (rows[i] * reach.down + reach.up - 1) / reach.up + reach.after;
      needed = stage.kernel->needs_all(input) ? image_.height : std::max(needed, last);
    }
    if (stage.residual) rows[*stage.residual] = std::max(rows[*stage.residual], rows[i]);
  }
  return rows;
}

/// Returns whether the output of a stage is so much smaller than what it reads that it does not wait until it is
/// wanted, so that its inputs need not be kept.
bool Stream::frees_memory(size_t index) const {
  constexpr size_t kMuchSmaller = 4;
  const auto bytes = [](const Tensor& tensor) { return tensor.row_bytes() * tensor.height; };
  const Stage& stage = plan_.stages[index];
  size_t read = 0;
  for (const size_t input : stage.inputs) read += bytes(tensors_[input]);
  return !stage.residual && kMuchSmaller * bytes(tensors_[index + 1]) <= read;
}

void Stream::add_rows(Tensor& tensor, size_t end) {
  for (size_t y = tensor.done; y < end; ++y) {
    std::byte* memory = tensor.whole != nullptr ? tensor.whole->row(y) : memory_.rows.take(tensor.row_bytes());
    std::byte* row = memory + tensor.left * tensor.pixel_bytes;
    std::memset(memory, 0, tensor.left * tensor.pixel_bytes);
    std::memset(row + tensor.width * tensor.pixel_bytes, 0, tensor.right * tensor.pixel_bytes);
    tensor.table[tensor.left + y] = row;
  }
}

void Stream::release_rows(size_t index) {
  Tensor& tensor = tensors_[index];
  size_t needed = index + 1 == tensors_.size() ? written_ : tensor.done;
  for (const size_t i : tensor.readers) {
    const Stage& stage = plan_.stages[i];
    const size_t next = tensors_[i + 1].done;
    if (next == tensors_[i + 1].height) continue;
    for (size_t input = 0; input < stage.inputs.size(); ++input) {
      if (stage.inputs[input] != index) continue;
      needed = stage.kernel->needs_all(input) ? 0 : std::min(needed, first_needed(stage.kernel->reach(), next));
    }
    if (stage.residual == index) needed = std::min(needed, next);
  }
  for (; tensor.released < needed; ++tensor.released) give_back(tensor, tensor.released);
}

void Stream::give_back(Tensor& tensor, size_t y) {
  std::byte*& row = tensor.table[tensor.left + y];
  if (row != nullptr && tensor.whole == nullptr) {
    memory_.rows.give_back(row - tensor.left * tensor.pixel_bytes, tensor.row_bytes());
  }
  row = nullptr;
}

/// Returns the rows to the pool, from which the next frame takes its own.
Stream::~Stream() {
  for (Tensor& tensor : tensors_) {
    for (size_t y = tensor.released; y < tensor.height; ++y) give_back(tensor, y);
  }
}

size_t Stream::rows_possible(size_t index) const {
  const Stage& stage = plan_.stages[index];
  const Reach reach = stage.kernel->reach();
  const Tensor& output = tensors_[index + 1];
  size_t end = output.height;
  for (size_t input = 0; input < stage.inputs.size(); ++input) {
    const Tensor& tensor = tensors_[stage.inputs[input]];
    if (tensor.done == tensor.height) continue;
    if (stage.kernel->needs_all(input)) return 0;
    const size_t usable = tensor.done > reach.after ? tensor.done - reach.after : 0;
    end = std::min(end, usable * reach.up / reach.down);
  }
  if (stage.residual) end = std::min(end, tensors_[*stage.residual].done);
  return end == output.height ? end : end / kTileSize * kTileSize;
}

/// Returns how far a tensor that could be computed up to row `end` advances in this round.
size_t Stream::next_end(const Tensor& tensor, size_t end) const {
  return std::min(end, tensor.done + kMostRowsPerRound);
}

void Stream::plan_input(std::vector<Job>& jobs) {
  Tensor& tensor = tensors_.front();
  if (tensor.done == tensor.height) return;
  const size_t begin = tensor.done, end = next_end(tensor, rows_wanted(0));
  if (end <= begin) return;
  add_rows(tensor, end);
  jobs.push_back({end - begin, end, &tensor.done, [this, begin](size_t block, std::byte* /*scratch*/) {
                    const Tensor& input = tensors_.front();
                    const size_t y = begin + block, plane = image_.height * image_.width;
                    const float* const from = image_.input.data() + y * image_.width + wide_begin_;
                    with_element(input.type, [&](auto element) {
                      auto* const row = reinterpret_cast<decltype(element)*>(input.table[input.left + y]);
                      read_planes(from, plane, input.channels, input.width, row);
                    });
                  }});
}

void Stream::plan_stage(size_t index, std::vector<Job>& jobs) {
  Tensor& output = tensors_[index + 1];
  if (output.done == output.height) return;
  const size_t wanted = frees_memory(index) ? output.height : rows_wanted(index + 1);
  const size_t end = next_end(output, std::min(rows_possible(index), wanted));
  if (end <= output.done) return;
  add_rows(output, end);
  const Stage& stage = plan_.stages[index];
  Strip strip;
  for (const size_t input : stage.inputs) strip.inputs.push_back(tensors_[input].rows());
  if (stage.residual) strip.residual = tensors_[*stage.residual].rows();
  strip.output = output.rows();
  strip.begin = output.done;
  strip.end = end;
  strip.width = output.width;
  strip.height = output.height;
  const size_t blocks = stage.kernel->num_blocks(strip);
  jobs.push_back({blocks, end, &output.done, [&stage, strip](size_t block, std::byte* scratch) {
                    stage.kernel->run_block(strip, block, scratch);
                  }});
}

void Stream::plan_output(std::vector<Job>& jobs) {
  const size_t begin = written_;
  const size_t end = tensors_.back().done;
  jobs.push_back({end - begin, end, &written_, [this, begin](size_t block, std::byte* /*scratch*/) {
                    const Tensor& output = tensors_.back();
                    const size_t y = begin + block, plane = image_.height * image_.width;
                    const std::byte* const from =
                        output.table[output.left + y] + (begin_ - wide_begin_) * output.pixel_bytes;
                    float* const to = image_.output.data() + y * image_.width + begin_;
                    with_element(output.type, [&](auto element) {
                      const auto* const row = reinterpret_cast<const decltype(element)*>(from);
                      write_planes(row, output.channels, end_ - begin_, to, plane, image_.planes);
                    });
                  }});
}

bool Stream::advance() {
  // The inputs of the jobs of a round were complete before it, so the jobs may run in any order.
  std::vector<Job> jobs;
  for (size_t stage = 0; stage < plan_.stages.size(); ++stage) plan_stage(stage, jobs);
  plan_output(jobs);
  plan_input(jobs);
  run_jobs(jobs);
  for (const Job& job : jobs) *job.progress = job.end;
  for (size_t tensor = 0; tensor < tensors_.size(); ++tensor) release_rows(tensor);
  return written_ < image_.height;
}

void Stream::run_jobs(const std::vector<Job>& jobs) const {
  std::vector<std::pair<const Job*, size_t>> blocks;
  for (const Job& job : jobs) {
    for (size_t block = 0; block < job.blocks; ++block) blocks.emplace_back(&job, block);
  }
  // Threads take runs of blocks, so that each loads the weights of few layers. The runs get shorter towards the end of
  // the round, so that no thread waits long for another.
  const size_t threads = memory_.scratch.size();
  std::atomic<size_t> next = 0;
  // parallel_for() is not used, because each thread keeps its own scratch memory from round to round, in its cache.
  run_team(threads, [&](size_t member) {
    std::byte* const scratch = memory_.scratch[member].data();
    size_t begin = next;
    while (begin < blocks.size()) {
      const size_t end = begin + std::max<size_t>(1, (blocks.size() - begin) / (kRunsPerThread * threads));
      if (!next.compare_exchange_weak(begin, end)) continue;
      for (size_t i = begin; i < end; ++i) blocks[i].first->run(blocks[i].second, scratch);
      begin = next;
    }
  });
}

}  // namespace e2lf::engine
