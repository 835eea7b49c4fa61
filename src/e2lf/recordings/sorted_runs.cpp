// SPDX-License-Identifier: MIT
#include "e2lf/recordings/sorted_runs.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <functional>
#include <unistd.h>

#include "e2lf/base/text.h"

namespace e2lf::recordings {
namespace {

constexpr size_t kBufferedEvents = size_t{1} << 22;  // for all runs together during the merge
constexpr size_t kLeastBuffer = 256;                 // for one run

std::filesystem::path temporary_folder() {
  std::error_code error;
  const auto folder = std::filesystem::temp_directory_path(error);
  return error ? std::filesystem::path("/tmp") : folder;
}

Error io_error(const char* action) {
  return {ErrorCode::kIo,
          cat("cannot ", action, " the temporary file that sorts the events by time (", std::strerror(errno),
              "); free space there, or set TMPDIR to a folder with 16 bytes for each event"),
          temporary_folder().string()};
}

std::vector<Event> sorted_records(const EventColumns& events) {
  std::vector<Event> records(events.size());
  for (size_t i = 0; i < events.size(); ++i) records[i] = events[i];
  std::stable_sort(records.begin(), records.end(), [](const Event& a, const Event& b) { return a.t < b.t; });
  return records;
}

}  // namespace

void sort_by_time(EventColumns& events) {
  const std::vector<Event> records = sorted_records(events);
  for (size_t i = 0; i < records.size(); ++i) {
    events.x[i] = records[i].x;
    events.y[i] = records[i].y;
    events.p[i] = records[i].p;
    events.t[i] = records[i].t;
  }
}

SortedRuns::~SortedRuns() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> SortedRuns::open_file() {
  std::string name = (temporary_folder() / "e2lf_sort_XXXXXX").string();
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) return io_error("make");
  ::unlink(name.c_str());
  return {};
}

Result<void> SortedRuns::add(EventColumns& events) {
  if (descriptor_ < 0) E2LF_RETURN_IF_ERROR(open_file());
  const std::vector<Event> records = sorted_records(events);
  const auto* next = reinterpret_cast<const uint8_t*>(records.data());
  auto offset = static_cast<off_t>(begins_.back() * sizeof(Event));
  for (size_t left = records.size() * sizeof(Event); left > 0;) {
    const ssize_t written = ::pwrite(descriptor_, next, left, offset);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return io_error("write");
    next += written;
    offset += written;
    left -= static_cast<size_t>(written);
  }
  begins_.push_back(begins_.back() + records.size());
  return {};
}

void SortedRuns::rewind() {
  is_merging_ = false;
}

/// Reads the next events of a run into memory; returns false at its end.
Result<bool> SortedRuns::refill(Run& run) {
  const size_t share = std::max(kLeastBuffer, kBufferedEvents / runs_.size());
  const auto count = static_cast<size_t>(std::min<uint64_t>(share, run.end - run.next));
  run.buffer.resize(count);
  run.place = 0;
  auto* next = reinterpret_cast<uint8_t*>(run.buffer.data());
  auto offset = static_cast<off_t>(run.next * sizeof(Event));
  for (size_t left = count * sizeof(Event); left > 0;) {
    const ssize_t got = ::pread(descriptor_, next, left, offset);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return io_error("read");
    next += got;
    offset += got;
    left -= static_cast<size_t>(got);
  }
  run.next += count;
  return count > 0;
}

Result<void> SortedRuns::begin_merge() {
  runs_.assign(begins_.size() - 1, Run());
  heads_.clear();
  for (size_t i = 0; i < runs_.size(); ++i) {
    runs_[i].next = begins_[i];
    runs_[i].end = begins_[i + 1];
    E2LF_ASSIGN_OR_RETURN(const bool more, refill(runs_[i]));
    if (more) heads_.push_back({runs_[i].buffer.front().t, i});
  }
  std::make_heap(heads_.begin(), heads_.end(), std::greater<>());
  is_merging_ = true;
  return {};
}

Result<bool> SortedRuns::next(EventColumns& events, size_t max_events) {
  if (!is_merging_) E2LF_RETURN_IF_ERROR(begin_merge());
  events.clear();
  while (events.size() < max_events && !heads_.empty()) {
    std::pop_heap(heads_.begin(), heads_.end(), std::greater<>());
    Head& head = heads_.back();
    Run& run = runs_[head.run];
    events.push_back(run.buffer[run.place++]);
    bool more = run.place < run.buffer.size();
    if (!more) {
      E2LF_ASSIGN_OR_RETURN(more, refill(run));
    }
    if (!more) {
      heads_.pop_back();
      continue;
    }
    head.t_us = run.buffer[run.place].t;
    std::push_heap(heads_.begin(), heads_.end(), std::greater<>());
  }
  return !events.empty();
}

}  // namespace e2lf::recordings
