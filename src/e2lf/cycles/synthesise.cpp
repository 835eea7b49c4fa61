// SPDX-License-Identifier: MIT
#include "e2lf/cycles/synthesise.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/base/rng.h"

namespace e2lf::cycles {
namespace {

constexpr int64_t kLatencyUs = 150;  ///< time from a change of pattern to its first events
constexpr double kDecayUs = 2000;    ///< time constant of the event rate after a change
constexpr int64_t kBurstUs = 9500;   ///< the latest event of a burst after the change

/// A sequence of draws from its own stream.
class Draws {
 public:
  Draws(uint64_t seed, uint64_t stream) : rng_(seed, stream) {}
  float uniform() { return rng_.uniform(next_++); }
  uint32_t below(uint32_t bound) { return rng_.below(next_++, bound); }

 private:
  CounterRng rng_;
  uint64_t next_ = 0;
};

class SpreadCycle {
 public:
  SpreadCycle(const capture::EventImages& images, uint64_t number, const SynthesisOptions& options)
      : images_(images),
        options_(options),
        number_(number),
        draws_(options.seed, number),
        begin_us_(options.begin_us + static_cast<int64_t>(number) * options.schedule.cycle_us()) {}

  SynthesisedCycle make() {
    const Schedule& schedule = options_.schedule;
    const size_t first = schedule.first_of_cycle();
    int64_t t_us = begin_us_;
    for (size_t i = 0; i < first; ++i) {
      if (number_ == 0) add_pattern(schedule.patterns[i], t_us, /*is_used=*/false);
      t_us += schedule.patterns[i].interval_us();
    }
    if (number_ > 0) begin_us_ = t_us;
    for (size_t i = 0; i < schedule.size(); ++i) {
      const ScheduledPattern& pattern = schedule.patterns[(first + i) % schedule.size()];
      add_pattern(pattern, t_us, pattern.image.has_value());
      t_us += pattern.interval_us();
    }
    add_noise(t_us);
    sort_events();
    return std::move(result_);
  }

 private:
  void add_pattern(const ScheduledPattern& pattern, int64_t t_us, bool is_used) {
    const int64_t start_us = t_us + jitter();
    result_.starts_us.push_back(start_us);
    if (is_used) {
      add_burst(images_.image(*pattern.image), start_us);
    } else {
      add_unused_burst(pattern.sign, start_us);
    }
    add_pulse(start_us, options_.trigger_channel, options_.trigger_width_us, result_.batch.triggers);
  }

  int64_t jitter() {
    if (options_.jitter_us == 0) return 0;
    return static_cast<int64_t>(draws_.below(static_cast<uint32_t>(2 * options_.jitter_us + 1))) - options_.jitter_us;
  }

  void add_event(size_t pixel, bool is_on, int64_t t_us) {
    events_.push_back({static_cast<uint16_t>(pixel % images_.width), static_cast<uint16_t>(pixel / images_.width),
                       static_cast<uint8_t>(is_on), t_us});
  }

  /// Draws a time after a change of pattern from an exponential distribution that is truncated at the end of the burst.
  int64_t delay_us() {
    const double span_us = static_cast<double>(kBurstUs - kLatencyUs);
    const double reach = 1 - std::exp(-span_us / kDecayUs);
    const double delay = -kDecayUs * std::log(1 - reach * static_cast<double>(draws_.uniform()));
    return kLatencyUs + static_cast<int64_t>(std::min(delay, span_us - 1));
  }

  void add_burst(std::span<const int16_t> image, int64_t start_us) {
    for (size_t pixel = 0; pixel < image.size(); ++pixel) {
      for (int i = 0; i < std::abs(image[pixel]); ++i) add_event(pixel, image[pixel] > 0, start_us + delay_us());
    }
  }

  void add_unused_burst(BurstSign sign, int64_t start_us) {
    const std::span<const int16_t> model = images_.image(0);
    for (size_t pixel = 0; pixel < model.size(); ++pixel) {
      const bool is_on = sign == BurstSign::kAny ? (pixel / 3) % 2 == 0 : sign == BurstSign::kOn;
      draws_.uniform();  // Unused, but without this draw the recording of a seed would change.
      for (int i = 0; i < std::abs(model[pixel]); ++i) add_event(pixel, is_on, start_us + delay_us());
    }
  }

  void add_noise(int64_t end_us) {
    if (options_.noise_hz <= 0) return;
    const double seconds = static_cast<double>(end_us - begin_us_) * 1e-6;
    const double mean = options_.noise_hz * seconds * static_cast<double>(images_.image_size());
    const auto count = static_cast<size_t>(mean + static_cast<double>(draws_.uniform()));
    for (size_t i = 0; i < count; ++i) {
      const auto t_us = static_cast<int64_t>(draws_.uniform() * static_cast<float>(end_us - begin_us_));
      add_event(draws_.below(static_cast<uint32_t>(images_.image_size())), draws_.below(2) != 0, begin_us_ + t_us);
    }
  }

  void sort_events() {
    std::stable_sort(events_.begin(), events_.end(),
                     [](const recordings::Event& a, const recordings::Event& b) { return a.t < b.t; });
    result_.batch.events.reserve(events_.size());
    for (const recordings::Event& event : events_) result_.batch.events.push_back(event);
  }

  const capture::EventImages& images_;
  const SynthesisOptions& options_;
  uint64_t number_;
  Draws draws_;
  int64_t begin_us_;
  std::vector<recordings::Event> events_;
  SynthesisedCycle result_;
};

}  // namespace

void add_pulse(int64_t t_us, std::optional<uint16_t> channel, int64_t width_us,
               std::vector<recordings::Trigger>& triggers) {
  if (!channel) return;
  triggers.push_back({t_us, *channel, 1});
  if (width_us > 0) triggers.push_back({t_us + width_us, *channel, 0});
}

SynthesisedCycle synthesise_cycle(const capture::EventImages& images, uint64_t number,
                                  const SynthesisOptions& options) {
  E2LF_REQUIRE(images.count == options.schedule.num_images(), "one image for each used pattern");
  E2LF_REQUIRE(kLatencyUs >= options.jitter_us, "events may not come before their cycle");
  for (const ScheduledPattern& pattern : options.schedule.patterns) {
    E2LF_REQUIRE(kBurstUs + 2 * options.jitter_us <= pattern.interval_us(), "a burst is longer than a pattern");
  }
  return SpreadCycle(images, number, options).make();
}

Result<void> synthesise_recording(recordings::RecordingWriter& writer, uint64_t cycles, const SynthesisOptions& options,
                                  const std::function<Result<capture::EventImages>(uint64_t number)>& images_of) {
  for (uint64_t number = 0; number < cycles && !(number > 0 && stop_requested()); ++number) {
    E2LF_ASSIGN_OR_RETURN(const capture::EventImages images, images_of(number));
    E2LF_RETURN_IF_ERROR(writer.write(synthesise_cycle(images, number, options).batch));
  }
  return {};
}

}  // namespace e2lf::cycles
