// SPDX-License-Identifier: MIT
#include "recording_checks.h"

#include <algorithm>
#include <optional>
#include <unistd.h>

#include "e2lf/base/isa.h"
#include "e2lf/base/text.h"
#include "e2lf/formats/formats.h"
#include "e2lf/recordings/io/decompress.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/recordings/recording.h"
#include "require.h"
#include "testing/chunked_source.h"

namespace e2lf::fuzz {
namespace {

using namespace recordings;
using Bytes = std::span<const uint8_t>;

/// Compressed formats hold millions of events in a few bytes: the rest of such an input says nothing new.
constexpr size_t kMaxEvents = size_t{1} << 20;
/// A RAW file has a time word for every 4 ms, HDF5 an index entry for every 2 ms: longer recordings are valid and slow.
constexpr int64_t kMaxSpanUs = int64_t{1} << 30;
/// EVT2 counts the loops of its clock before a late first event, a million words for today in microseconds.
constexpr int64_t kMaxFirstUs = int64_t{1} << 45;
constexpr int64_t kFilledUs = 10'000'000;

struct Decoded {
  RecordingInfo info;
  EventBatch all;
  DecodeSummary summary;
  bool is_whole = true;
};

uint32_t hash_of(Bytes bytes) {
  uint32_t hash = 2166136261U;
  for (const uint8_t byte : bytes) hash = (hash ^ byte) * 16777619U;
  return hash;
}

bool is_raw(const std::string& format) {
  return format.starts_with("evt") || format == "raw";
}

/// The HDF5 library reads whole files only. What is damaged at the beginning of an MCAP file, its end may still tell.
bool can_be_streamed(const std::string& format) {
  return format != "hdf5" && format != "dsec" && format != "mcap";
}

void check_batch(const EventBatch& batch, const EventBatch& before, const RecordingInfo& info, size_t max_events) {
  const EventColumns& events = batch.events;
  require(events.size() <= max_events && batch.triggers.size() <= max_events, "a batch is as small as asked for");
  require(events.x.size() == events.size() && events.y.size() == events.size() && events.p.size() == events.size(),
          "columns have one length");
  int64_t last_us = before.events.empty() ? INT64_MIN : before.events.t.back();
  for (size_t i = 0; i < events.size(); ++i) {
    require(events.t[i] >= last_us, "events are sorted by time");
    require(events.p[i] <= 1, "a polarity is 0 or 1");
    require(info.width == 0 || events.x[i] < info.width, "x lies inside the sensor");
    require(info.height == 0 || events.y[i] < info.height, "y lies inside the sensor");
    last_us = events.t[i];
  }
  last_us = before.triggers.empty() ? INT64_MIN : before.triggers.back().t;
  for (const Trigger& trigger : batch.triggers) {
    require(trigger.t >= last_us && trigger.p <= 1, "triggers are sorted by time");
    last_us = trigger.t;
  }
}

std::optional<Decoded> decode(SourcePtr source, const OpenOptions& options, size_t max_events) {
  auto reader = open_recording(std::move(source), options);
  if (!reader) {
    require(!reader.error().message.empty(), "an error says what is wrong");
    return std::nullopt;
  }
  Decoded decoded;
  decoded.info = (*reader)->info();
  EventBatch batch;
  for (;;) {
    const auto more = (*reader)->read(batch, max_events);
    if (!more) return std::nullopt;
    if (!*more) break;
    check_batch(batch, decoded.all, decoded.info, max_events);
    decoded.all.events.append(batch.events);
    decoded.all.triggers.insert(decoded.all.triggers.end(), batch.triggers.begin(), batch.triggers.end());
    if (decoded.all.events.size() > kMaxEvents) {
      decoded.is_whole = false;
      break;
    }
  }
  decoded.summary = (*reader)->summary();
  require(decoded.summary.events() == decoded.all.events.size(), "the summary counts the events");
  require(decoded.summary.triggers == decoded.all.triggers.size(), "the summary counts the triggers");
  return decoded;
}

void check_kernels(const Decoded& decoded, const OpenOptions& options, Bytes bytes) {
  if (!is_raw(options.format)) return;
  require(set_max_isa("scalar").ok(), "there is always a scalar kernel");
  const auto scalar = decode(make_memory_source(bytes), options, 4096);
  require(set_max_isa("").ok(), "the cap can be lifted");
  require(scalar && scalar->all == decoded.all, "scalar and vector kernels agree");
}

void check_live(const Decoded& decoded, const OpenOptions& options, Bytes bytes, uint32_t choice) {
  if (!can_be_streamed(options.format)) return;
  // A size that is found from the whole file must be given for a stream.
  const auto is_size = [](const Assumption& assumption) { return assumption.option == "sensor_width"; };
  if (std::any_of(decoded.info.assumptions.begin(), decoded.info.assumptions.end(), is_size)) return;
  const size_t step = 1 + choice % 300;
  const std::vector<size_t> cuts = {1 + choice / 300 % (bytes.size() + 1)};
  const auto live = decode(
      std::make_unique<ChunkedSource>(std::vector<uint8_t>(bytes.begin(), bytes.end()), cuts, step), options, 64);
  require(live && live->all == decoded.all, "a live source gives the same events");
  require(live->summary.num_violations() == decoded.summary.num_violations(), "a live source counts the same damage");
}

void check_from_zero(const Decoded& decoded, const OpenOptions& options, Bytes bytes) {
  OpenOptions from_zero = options;
  from_zero.time = TimeOrigin::kZero;
  const auto shifted = decode(make_memory_source(bytes), from_zero, 4096);
  require(shifted && shifted->all.events.x == decoded.all.events.x, "times from zero change times only");
  for (size_t i = 0; i < decoded.all.events.size(); ++i) {
    require(shifted->all.events.t[i] - shifted->all.events.t[0] == decoded.all.events.t[i] - decoded.all.events.t[0],
            "times from zero differ by one constant");
  }
}

void check_strict(const Decoded& decoded, const OpenOptions& options, Bytes bytes) {
  OpenOptions strict = options;
  strict.policy = DecodePolicy::kStrict;
  const bool is_clean = decode(make_memory_source(bytes), strict, 4096).has_value();
  require(is_clean == losses(decoded.summary).empty(), "the strict policy fails where something was left out");
}

void check_seek(const Decoded& decoded, const OpenOptions& options, Bytes bytes, uint32_t hash) {
  const EventColumns& events = decoded.all.events;
  // Where times are damaged, a search may lead elsewhere.
  if (events.empty() || decoded.summary.num_violations() > 0) return;
  auto reader = open_recording(make_memory_source(bytes), options);
  EventBatch batch;
  require((*reader)->read(batch, 64).ok(), "what was read can be read again");
  const int64_t t_us = events.t[hash % events.size()];
  require((*reader)->seek(t_us).ok(), "memory can be sought");
  const auto rest = read_all(**reader);
  require(rest.ok(), "reading goes on after a seek");
  const auto begin = std::lower_bound(events.t.begin(), events.t.end(), t_us) - events.t.begin();
  EventColumns expected;
  expected.append(events, static_cast<size_t>(begin), events.size());
  require(rest->events == expected, "a seek gives the rest of the recording");
}

/// More of EVT2's first word (OFF at the first pixel at a multiple of 64 us) than this in a row is taken for missing
/// data by its decoders.
bool looks_like_no_data(const EventColumns& events) {
  constexpr size_t kMaxRepeats = 7;
  size_t repeats = 0;
  for (size_t i = 0; i < events.size(); ++i) {
    const bool is_zero = events.x[i] == 0 && events.y[i] == 0 && events.p[i] == 0 && events.t[i] % 64 == 0;
    repeats = is_zero ? repeats + 1 : 0;
    if (repeats > kMaxRepeats) return true;
  }
  return false;
}

/// Writes what was decoded and reads it back. A format may refuse what it cannot hold, but never change it.
void check_round_trip(Decoded decoded, const std::string& format) {
  const EventBatch& all = decoded.all;
  const bool has_clock = is_raw(format) || format == "hdf5";
  if (has_clock && !all.events.empty() && all.events.t.back() - all.events.t.front() > kMaxSpanUs) return;
  if (has_clock && !all.triggers.empty() && all.triggers.back().t - all.triggers.front().t > kMaxSpanUs) return;
  if (is_raw(format)) {
    if (looks_like_no_data(all.events)) return;
    if (!all.events.empty() && all.events.t.front() > kMaxFirstUs) return;
    if (!all.triggers.empty() && all.triggers.front().t > kMaxFirstUs) return;
    if (decoded.info.width == 0) decoded.info.width = 2048;
    if (decoded.info.height == 0) decoded.info.height = 2048;
    decoded.info.format = format;
  }
  // Tables refuse coordinates that exceed any sensor whose size is unknown.
  const auto most_of = [](const auto& column) {
    return column.empty() ? 0 : *std::max_element(column.begin(), column.end());
  };
  const bool is_table = format == "csv" || format == "npz";
  if (is_table && (decoded.info.width == 0 || decoded.info.height == 0) &&
      std::max(most_of(all.events.x), most_of(all.events.y)) >= 8192)
    return;
  // Nor are such times taken for microseconds by tables.
  constexpr int64_t kLatestUs = 100'000'000'000'000'000;
  if (is_table && !all.events.empty() && all.events.t.back() >= kLatestUs) return;
  const Codec& codec = **find_codec(format);
  if (codec.create == nullptr && codec.create_file == nullptr) return;
  std::vector<uint8_t> written;
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / cat("e2lf_fuzz_", ::getpid(), codec.extensions.empty() ? "" : ".bin");
  const bool in_memory = codec.create != nullptr;
  auto writer = in_memory ? create_recording(make_memory_sink(written), format, decoded.info)
                          : create_recording(path, format, decoded.info);
  if (!writer || !(*writer)->write(all)) return;
  require((*writer)->finish().ok(), "what was accepted can be finished in", format.c_str());

  // EVT2's clock is not written all through a long pause, which reads as data that is missing.
  const bool is_long = is_raw(format) && !all.events.empty() && all.events.t.back() - all.events.t.front() > kFilledUs;
  OpenOptions options{.format = format, .policy = is_long ? DecodePolicy::kSkip : DecodePolicy::kStrict};
  auto source = in_memory ? make_memory_source(std::span<const uint8_t>(written)) : *open_file_source(path);
  const auto back = decode(std::move(source), options, 4096);
  if (!in_memory) std::filesystem::remove(path);
  require(back.has_value(), "what was written can be read without damage from", format.c_str());
  require(back->all.events == all.events, "events come back as written in", format.c_str());
  if (!(*writer)->holds_triggers()) return;
  require(back->all.triggers == all.triggers, "triggers come back as written in", format.c_str());
}

void check_round_trips(const Decoded& decoded, const std::string& format, uint32_t choice) {
  if (decoded.all.empty()) return;
  constexpr const char* kOthers[] = {"evt2", "evt2.1", "evt3", "npz", "csv", "dat"};
  const auto own = find_codec(format);
  // Files are slow, and HDF5's are large: not each time.
  const bool in_memory = own && (*own)->create != nullptr;
  const bool in_file = own && (*own)->create_file != nullptr && choice % 16 == 0;
  if ((in_memory && choice % 2 == 0) || in_file) return check_round_trip(decoded, format);
  check_round_trip(decoded, kOthers[choice / 2 % std::size(kOthers)]);
}

}  // namespace

void check_recording(const std::string& format, Bytes bytes) {
  formats::add_formats();
  const OpenOptions options{.format = format, .policy = DecodePolicy::kSkip};
  const uint32_t hash = hash_of(bytes);
  const auto decoded = decode(make_memory_source(bytes), options, 64 + hash % 5000);
  if (!decoded || !decoded->is_whole) return;
  // One of the checks for each input, so that more inputs are tried.
  const uint32_t choice = hash / 8;
  switch (hash % 8) {
    case 0:
      return check_kernels(*decoded, options, bytes);
    case 1:
      return check_live(*decoded, options, bytes, choice);
    case 2:
      return check_from_zero(*decoded, options, bytes);
    case 3:
      return check_strict(*decoded, options, bytes);
    case 4:
      return check_seek(*decoded, options, bytes, choice);
    default:
      return check_round_trips(*decoded, format, choice);
  }
}

}  // namespace e2lf::fuzz
