// SPDX-License-Identifier: MIT
#include "e2lf/cycles/cycle_reader.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <sys/resource.h>

#include "e2lf/capture/measurement/hot_pixels.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cycles/synthesise.h"
#include "e2lf/recordings/event_blocks.h"
#include "testing/chunked_source.h"

namespace e2lf::cycles {
namespace {

constexpr size_t kWidth = 24, kHeight = 16;

/// Event images of a scene that changes a little from cycle to cycle; the first image is ON, as black comes before it.
capture::EventImages images_of(uint64_t number, size_t transitions = 3) {
  capture::EventImages images(transitions, kHeight, kWidth);
  std::mt19937 random(static_cast<uint32_t>(number + 1));
  for (size_t k = 0; k < transitions; ++k) {
    // Of the paper's whole cycle the change to white is ON, too; those from white and to black are OFF.
    const bool is_whole = transitions == 8, is_on = k == 0 || (is_whole && k == 3);
    const bool is_off = is_whole && (k == 4 || k == 7);
    for (int16_t& count : images.image(k)) {
      const int any = static_cast<int>(random() % (is_on || is_off ? 5 : 7));
      count = static_cast<int16_t>(is_on ? any : is_off ? -any : any - 3);
    }
  }
  return images;
}

/// What may be done to each cycle before it is read.
using Change = std::function<void(uint64_t number, SynthesisedCycle& cycle)>;

/// A recording made while it is read.
class SynthesisedBlocks final : public recordings::EventBlocks {
 public:
  SynthesisedBlocks(uint64_t cycles, SynthesisOptions options, Change change)
      : cycles_(cycles), options_(std::move(options)), change_(std::move(change)) {}

  Result<bool> next(recordings::EventBatch& block, recordings::DecodeSummary&) override {
    block.clear();
    if (number_ == cycles_) return false;
    SynthesisedCycle cycle = synthesise_cycle(images_of(number_, options_.schedule.num_images()), number_, options_);
    if (change_) change_(number_, cycle);
    block = std::move(cycle.batch);
    ++number_;
    return true;
  }

  Result<void> seek_before(int64_t) override {
    number_ = 0;
    return {};
  }

 private:
  uint64_t cycles_;
  SynthesisOptions options_;
  Change change_;
  uint64_t number_ = 0;
};

struct Outcome {
  std::vector<Cycle> cycles;
  CycleReport report;
};

/// The number a cycle has in the synthesis, from its time.
uint64_t true_number(const Cycle& cycle, const SynthesisOptions& options) {
  int64_t begin_us = options.begin_us;
  for (size_t i = 0; i < options.schedule.first_of_cycle(); ++i) begin_us += options.schedule.patterns[i].interval_us();
  const double since_us = static_cast<double>(cycle.begin_us - begin_us);
  return static_cast<uint64_t>(since_us / static_cast<double>(options.schedule.cycle_us()) + 0.5);
}

Outcome cut(uint64_t cycles, const SynthesisOptions& synthesis, const CycleOptions& options, const Change& change = {},
            bool keep_images = true) {
  recordings::RecordingInfo info;
  info.width = kWidth;
  info.height = kHeight;
  auto reader = CycleReader::open(
      std::make_unique<recordings::RecordingReader>(std::make_unique<SynthesisedBlocks>(cycles, synthesis, change),
                                                    info, "synthesis", recordings::OpenOptions()),
      options);
  EXPECT_TRUE(reader.ok()) << reader.error().text();
  Outcome outcome;
  for (;;) {
    auto cycle = reader->next();
    EXPECT_TRUE(cycle.ok());
    if (!cycle.ok() || !*cycle) break;
    if (!keep_images) (*cycle)->images = {};
    outcome.cycles.push_back(std::move(**cycle));
  }
  outcome.report = reader->report();
  return outcome;
}

/// Expects the cycles of the synthesis without those in `dropped`, each with exactly its images.
void expect_exact(const Outcome& outcome, uint64_t cycles, const SynthesisOptions& synthesis,
                  const std::set<uint64_t>& dropped = {}) {
  std::vector<uint64_t> found, expected;
  for (const Cycle& cycle : outcome.cycles) found.push_back(true_number(cycle, synthesis));
  for (uint64_t i = 0; i < cycles; ++i) {
    if (!dropped.contains(i)) expected.push_back(i);
  }
  ASSERT_EQ(found, expected);
  size_t wrong = 0;
  for (const Cycle& cycle : outcome.cycles) {
    wrong += cycle.images != images_of(true_number(cycle, synthesis), synthesis.schedule.num_images());
  }
  EXPECT_EQ(wrong, 0u) << "cycles with other images than were synthesised";
}

CycleOptions by_triggers() {
  CycleOptions options;
  options.source = CycleSource::kTriggers;
  options.channel = 0;
  options.tracker.first_pattern = 0;
  return options;
}

TEST(CycleReader, TriggersCutEveryCycle) {
  SynthesisOptions synthesis;
  synthesis.jitter_us = 100;
  const Outcome outcome = cut(50, synthesis, by_triggers());
  expect_exact(outcome, 50, synthesis);
  EXPECT_EQ(outcome.report.complete, 50u);
  EXPECT_EQ(outcome.report.marks, 400u);
  ASSERT_EQ(outcome.cycles[7].slices.size(), 3u);
  EXPECT_EQ(outcome.cycles[7].number, 7u);
  EXPECT_GT(outcome.cycles[7].confidence, 0.7F);
}

TEST(CycleReader, MissingTriggersDropExactlyTheirCycles) {
  SynthesisOptions synthesis;
  synthesis.jitter_us = 50;
  std::set<uint64_t> affected;
  std::mt19937 random(4);
  const Outcome outcome = cut(1000, synthesis, by_triggers(), [&](uint64_t number, SynthesisedCycle& cycle) {
    // The very first trigger tells which pattern comes first; it stays.
    std::erase_if(cycle.batch.triggers, [&](const recordings::Trigger& trigger) {
      const bool is_removed = trigger.p == 1 && random() % 100 == 0 && trigger.t != 100000 && number > 0;
      if (is_removed) affected.insert(number);
      return is_removed;
    });
  });
  EXPECT_GT(affected.size(), 50u);
  expect_exact(outcome, 1000, synthesis, affected);
  EXPECT_EQ(outcome.report.dropped[static_cast<size_t>(CycleFault::kMissing)], affected.size());
  ASSERT_EQ(outcome.report.drops.size(), affected.size());
  EXPECT_EQ(outcome.report.drops[0].number, *affected.begin());
}

TEST(CycleReader, DoubledTriggersDropExactlyTheirCycles) {
  SynthesisOptions synthesis;
  const std::set<uint64_t> affected = {3, 11, 12};
  const Outcome outcome = cut(20, synthesis, by_triggers(), [&](uint64_t number, SynthesisedCycle& cycle) {
    if (!affected.contains(number)) return;
    std::vector<recordings::Trigger>& triggers = cycle.batch.triggers;
    const size_t place = 2 * (number % 8);
    recordings::Trigger twice = triggers[place];
    twice.t += 3000;
    triggers.insert(triggers.begin() + static_cast<ptrdiff_t>(place) + 2, twice);
  });
  expect_exact(outcome, 20, synthesis, affected);
  EXPECT_EQ(outcome.report.dropped[static_cast<size_t>(CycleFault::kDoubled)], 3u);
}

TEST(CycleReader, BouncesOfTriggersAreIgnored) {
  SynthesisOptions synthesis;
  const Outcome outcome = cut(20, synthesis, by_triggers(), [&](uint64_t, SynthesisedCycle& cycle) {
    std::vector<recordings::Trigger> bouncing;
    for (const recordings::Trigger& trigger : cycle.batch.triggers) {
      for (const int64_t after_us : {0, 0, 40, 400}) {
        bouncing.push_back(trigger);
        bouncing.back().t += after_us;
      }
    }
    cycle.batch.triggers = std::move(bouncing);
  });
  expect_exact(outcome, 20, synthesis);
}

TEST(CycleReader, PhaseOfTriggersIsFoundFromUnequalIntervals) {
  SynthesisOptions synthesis;
  synthesis.schedule.patterns[0].duration_us = 10000;  // the only one of 15 ms is then a1
  CycleOptions options = by_triggers();
  options.schedule = synthesis.schedule;
  options.tracker.first_pattern.reset();
  expect_exact(cut(20, synthesis, options), 20, synthesis);
}

TEST(CycleReader, PatternOfTriggersIsFoundAgainFromTheSignsOfTheirEvents) {
  const SynthesisOptions synthesis;
  // Half a cycle of triggers is lost with a stretch of the recording; the intervals alone fit either half.
  const auto lose = [](uint64_t number, SynthesisedCycle& cycle) {
    if (number < 5 || number > 9) return;
    std::erase_if(cycle.batch.triggers, [](const recordings::Trigger&) { return true; });
  };
  const Outcome outcome = cut(30, synthesis, by_triggers(), lose);
  EXPECT_GE(outcome.cycles.size(), 20u);
  for (const Cycle& cycle : outcome.cycles) {
    const uint64_t number = true_number(cycle, synthesis);
    EXPECT_EQ(cycle.images, images_of(number)) << number;
  }
}

TEST(CycleReader, FirstPatternOfTriggersNeedNotBeGiven) {
  const SynthesisOptions synthesis;
  CycleOptions options = by_triggers();
  options.tracker.first_pattern = {};
  // The recording begins with the fourth pattern of its first cycle.
  const Outcome outcome = cut(12, synthesis, options, [](uint64_t number, SynthesisedCycle& cycle) {
    if (number > 0) return;
    const int64_t begin_us = cycle.batch.triggers[6].t;
    std::erase_if(cycle.batch.triggers, [&](const recordings::Trigger& trigger) { return trigger.t < begin_us; });
    recordings::EventColumns rest;
    for (size_t i = 0; i < cycle.batch.events.size(); ++i) {
      if (cycle.batch.events.t[i] >= begin_us) rest.push_back(cycle.batch.events[i]);
    }
    cycle.batch.events = rest;
  });
  EXPECT_GE(outcome.cycles.size(), 10u);
  for (const Cycle& cycle : outcome.cycles) {
    EXPECT_EQ(cycle.images, images_of(true_number(cycle, synthesis)));
  }
}

TEST(CycleReader, PatternOfTriggersThatNothingTellsIsAssumed) {
  SynthesisOptions synthesis;
  synthesis.schedule = plain_schedule(2, 10000);
  CycleOptions options = by_triggers();
  options.schedule = synthesis.schedule;
  options.tracker.first_pattern.reset();
  const Outcome outcome = cut(10, synthesis, options);
  expect_exact(outcome, 10, synthesis);
  EXPECT_TRUE(outcome.report.has_assumed_first);
  options.tracker.likely_first_pattern.reset();
  EXPECT_TRUE(cut(10, synthesis, options).cycles.empty());
  // The paper's sequence is told by its signs: nothing is assumed.
  CycleOptions paper = by_triggers();
  paper.tracker.first_pattern.reset();
  EXPECT_FALSE(cut(10, SynthesisOptions(), paper).report.has_assumed_first);
}

TEST(CycleReader, RecordingOfOneCycleIsEnough) {
  SynthesisOptions synthesis;
  CycleOptions triggers = by_triggers();
  triggers.tracker.first_pattern.reset();
  for (const CycleOptions& options : {by_triggers(), triggers, CycleOptions()}) {
    expect_exact(cut(1, synthesis, options), 1, synthesis);
  }
}

TEST(CycleReader, TriggersAreTakenWhereThereAreSomeAtTheBeginning) {
  SynthesisOptions synthesis;
  CycleOptions options;
  options.source = CycleSource::kAuto;
  const auto source_of = [&](const Change& change) {
    recordings::RecordingInfo info;
    info.width = kWidth;
    info.height = kHeight;
    auto blocks = std::make_unique<SynthesisedBlocks>(5, synthesis, change);
    auto reader = CycleReader::open(
        std::make_unique<recordings::RecordingReader>(std::move(blocks), info, "synthesis", recordings::OpenOptions()),
        options);
    EXPECT_TRUE(reader.ok());
    return reader->source();
  };
  EXPECT_EQ(source_of({}), CycleSource::kTriggers);
  expect_exact(cut(20, synthesis, options), 20, synthesis);
  const auto other_channel = [](uint64_t, SynthesisedCycle& cycle) {
    for (recordings::Trigger& trigger : cycle.batch.triggers) trigger.id = 3;
  };
  options.channel = 0;
  // A wrong channel is not hidden by bursts.
  EXPECT_EQ(source_of(other_channel), CycleSource::kTriggers);
  EXPECT_TRUE(cut(20, synthesis, options, other_channel).cycles.empty());
}

TEST(CycleReader, OneTriggerForEachCycleIsEnough) {
  SynthesisOptions synthesis;
  CycleOptions options = by_triggers();
  options.one_trigger_per_cycle = true;
  options.tracker.first_pattern.reset();
  const auto only_first = [](uint64_t, SynthesisedCycle& cycle) { cycle.batch.triggers.resize(2); };
  expect_exact(cut(30, synthesis, options, only_first), 30, synthesis);
}

/// A RAW recording of the synthesis in memory, whose cycles are read with one of `whole_every` as a whole.
Outcome cut_raw(uint64_t cycles, const SynthesisOptions& synthesis, uint64_t whole_every, uint64_t& events_read) {
  recordings::RecordingInfo info;
  info.format = "evt3";
  info.width = kWidth;
  info.height = kHeight;
  std::vector<uint8_t> bytes;
  auto writer = recordings::create_recording(recordings::make_memory_sink(bytes), "evt3", info);
  EXPECT_TRUE(writer.ok());
  for (uint64_t number = 0; number < cycles; ++number) {
    EXPECT_TRUE((*writer)->write(synthesise_cycle(images_of(number), number, synthesis).batch));
  }
  EXPECT_TRUE((*writer)->finish());
  // Pieces as a camera sends them: what is decoded in advance is not left out.
  constexpr size_t kPieceBytes = 512;
  auto recording = recordings::open_recording(
      std::make_unique<recordings::ChunkedSource>(std::move(bytes), std::vector<size_t>(), kPieceBytes), {});
  EXPECT_TRUE(recording.ok()) << recording.error().text();
  auto reader = CycleReader::open(std::move(*recording), by_triggers());
  EXPECT_TRUE(reader.ok()) << reader.error().text();
  reader->read_whole_every(whole_every);
  Outcome outcome;
  for (auto cycle = reader->next(); cycle && *cycle; cycle = reader->next())
    outcome.cycles.push_back(std::move(**cycle));
  outcome.report = reader->report();
  events_read = reader->summary().events();
  return outcome;
}

TEST(CycleReader, EventsThatNoImageNeedsAreLeftOutOfMostCycles) {
  SynthesisOptions synthesis;
  synthesis.jitter_us = 100;
  uint64_t all_events = 0, some_events = 0;
  const Outcome all = cut_raw(60, synthesis, 1, all_events), some = cut_raw(60, synthesis, 20, some_events);
  expect_exact(all, 60, synthesis);
  expect_exact(some, 60, synthesis);
  ASSERT_EQ(all.cycles.size(), some.cycles.size());
  for (size_t i = 0; i < all.cycles.size(); ++i) {
    EXPECT_EQ(some.cycles[i].events, all.cycles[i].events);
    EXPECT_EQ(some.cycles[i].begin_us, all.cycles[i].begin_us);
    EXPECT_TRUE(all.cycles[i].confidence == 0 || some.cycles[i].confidence > 0.5F) << i;
  }
  EXPECT_LT(static_cast<double>(some_events), 0.8 * static_cast<double>(all_events));
}

TEST(CycleReader, OtherChannelsAndEdgesAreIgnored) {
  SynthesisOptions synthesis;
  const auto add_others = [](uint64_t, SynthesisedCycle& cycle) {
    std::vector<recordings::Trigger> all;
    for (const recordings::Trigger& trigger : cycle.batch.triggers) {
      all.push_back(trigger);
      all.push_back({trigger.t + 100, 6, trigger.p});
    }
    cycle.batch.triggers = all;
  };
  expect_exact(cut(20, synthesis, by_triggers(), add_others), 20, synthesis);
}

TEST(CycleReader, ScheduleAndOneTimeAreEnough) {
  SynthesisOptions synthesis;
  synthesis.trigger_channel.reset();
  CycleOptions options;
  options.source = CycleSource::kSchedule;
  for (const int64_t cycles_away : {0, -1000000, 7}) {
    options.origin_us = synthesis.begin_us + cycles_away * synthesis.schedule.cycle_us();
    // The first event comes after the first cycle began, and before its event images begin.
    expect_exact(cut(20, synthesis, options), 20, synthesis);
  }
}

TEST(CycleReader, EventsConfirmWhatTheScheduleClaims) {
  SynthesisOptions synthesis;
  synthesis.trigger_channel.reset();
  synthesis.noise_hz = 5;
  CycleOptions options;
  options.source = CycleSource::kSchedule;
  const auto confidence_at = [&](int64_t offset_us) {
    options.origin_us = synthesis.begin_us + offset_us;
    const Outcome outcome = cut(10, synthesis, options);
    EXPECT_GE(outcome.cycles.size(), 8u);
    float least = 1.0F, most = 0.0F;
    for (const Cycle& cycle : outcome.cycles) {
      least = std::min(least, cycle.confidence);
      most = std::max(most, cycle.confidence);
    }
    return std::pair(least, most);
  };
  EXPECT_GT(confidence_at(0).first, 0.5F);
  // Half a cycle off the intervals are the same, and the signs the opposite.
  const int64_t half_us = synthesis.schedule.cycle_us() / 2;
  for (const int64_t offset_us : {half_us, half_us - 2600, int64_t{-4000}, int64_t{3000}, int64_t{10592}}) {
    EXPECT_LT(confidence_at(offset_us).second, 0.05F) << offset_us;
  }
}

TEST(CycleReader, EventsConfirmWhatTriggersClaim) {
  SynthesisOptions synthesis;
  const Outcome right = cut(10, synthesis, by_triggers());
  for (const Cycle& cycle : right.cycles) EXPECT_GT(cycle.confidence, 0.5F);
  CycleOptions options = by_triggers();
  options.tracker.first_pattern = 4;
  const Outcome wrong = cut(10, synthesis, options);
  ASSERT_FALSE(wrong.cycles.empty());
  for (const Cycle& cycle : wrong.cycles) EXPECT_LT(cycle.confidence, 0.05F);
}

TEST(CycleReader, AllTransitionsOfWholeCyclesComeBack) {
  SynthesisOptions synthesis;
  synthesis.jitter_us = 50;
  for (Schedule shown : {paper_schedule(4), plain_schedule(3, 12000), paper_schedule(2)}) {
    synthesis.schedule = with_all_transitions(shown);
    ASSERT_EQ(synthesis.schedule.num_images(), shown.size());
    CycleOptions options = by_triggers();
    options.schedule = synthesis.schedule;
    expect_exact(cut(20, synthesis, options), 20, synthesis);
  }
}

TEST(CycleReader, WholeCyclesAreFoundFromSignsBurstsTimesAndOneTriggerEach) {
  SynthesisOptions synthesis;
  synthesis.schedule = with_all_transitions(paper_schedule());
  CycleOptions options;
  options.schedule = synthesis.schedule;
  for (const CycleSource source : {CycleSource::kTriggers, CycleSource::kBursts, CycleSource::kSchedule}) {
    options.source = source;
    options.origin_us = synthesis.begin_us - synthesis.schedule.cycle_us();
    const Outcome outcome = cut(10, synthesis, options);
    expect_exact(outcome, 10, synthesis);
    // The display's first half cycle is no whole one.
    EXPECT_EQ(outcome.report.dropped[static_cast<size_t>(CycleFault::kPartial)],
              source == CycleSource::kSchedule ? 0 : 1);
    for (const Cycle& cycle : outcome.cycles) EXPECT_GT(cycle.confidence, 0.3F);
  }
  options.source = CycleSource::kTriggers;
  options.one_trigger_per_cycle = true;
  const int64_t cycle_us = synthesis.schedule.cycle_us();
  const Outcome outcome = cut(10, synthesis, options, [&](uint64_t, SynthesisedCycle& cycle) {
    std::erase_if(cycle.batch.triggers, [&](const recordings::Trigger& trigger) {
      return trigger.p == 0 || (trigger.t - synthesis.begin_us) % cycle_us != 0;
    });
  });
  // Nothing says how long the last repetition takes; it counts as long as those before.
  expect_exact(outcome, 10, synthesis);
}

TEST(CycleReader, LitAndAllTransitionsOfOneRecordingAgree) {
  SynthesisOptions synthesis;
  synthesis.schedule = with_all_transitions(paper_schedule());
  CycleOptions all = by_triggers(), lit = by_triggers();
  all.schedule = synthesis.schedule;
  const Outcome whole = cut(6, synthesis, all), half = cut(6, synthesis, lit);
  // The last repetition of the display ends with a1.
  ASSERT_EQ(half.cycles.size(), whole.cycles.size());
  for (size_t i = 0; i < half.cycles.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      const auto image = half.cycles[i].images.image(k), same = whole.cycles[i].images.image(k);
      EXPECT_TRUE(std::equal(image.begin(), image.end(), same.begin())) << i << " " << k;
    }
  }
}

TEST(CycleReader, BurstsAloneCutEveryCycle) {
  SynthesisOptions synthesis;
  synthesis.trigger_channel.reset();
  synthesis.jitter_us = 100;
  const Outcome outcome = cut(100, synthesis, CycleOptions());
  expect_exact(outcome, 100, synthesis);
  EXPECT_EQ(outcome.report.marks, 800u);
  EXPECT_EQ(outcome.report.unassigned_marks, 0u);
  for (const Cycle& cycle : outcome.cycles) EXPECT_GT(cycle.confidence, 0.3F);
}

TEST(CycleReader, BurstsInNoiseAreFoundAndOnlyNoiseIsAdded) {
  SynthesisOptions synthesis;
  synthesis.trigger_channel.reset();
  synthesis.noise_hz = 5;
  const Outcome outcome = cut(100, synthesis, CycleOptions());
  ASSERT_EQ(outcome.cycles.size(), 100u);
  for (const Cycle& cycle : outcome.cycles) {
    const capture::EventImages truth = images_of(true_number(cycle, synthesis));
    int difference = 0;
    for (size_t i = 0; i < truth.values.size(); ++i) difference += std::abs(truth.values[i] - cycle.images.values[i]);
    // 5 events per pixel and second in 31.8 ms, and few of a burst on the wrong side.
    const double noise = 5 * 0.0318 * kWidth * kHeight;
    EXPECT_LT(difference, 1.6 * noise);
  }
}

TEST(CycleReader, MissingBurstsDropExactlyTheirCycles) {
  SynthesisOptions synthesis;
  synthesis.trigger_channel.reset();
  const std::set<uint64_t> affected = {5, 6, 40};
  const Outcome outcome = cut(60, synthesis, CycleOptions(), [&](uint64_t number, SynthesisedCycle& cycle) {
    if (!affected.contains(number)) return;
    const int64_t begin_us = cycle.starts_us[number % 8], end_us = begin_us + 9600;
    recordings::EventColumns kept;
    for (size_t i = 0; i < cycle.batch.events.size(); ++i) {
      const recordings::Event event = cycle.batch.events[i];
      if (event.t < begin_us || event.t >= end_us) kept.push_back(event);
    }
    cycle.batch.events = kept;
  });
  expect_exact(outcome, 60, synthesis, affected);
  EXPECT_EQ(outcome.report.dropped[static_cast<size_t>(CycleFault::kMissing)], 3u);
}

TEST(CycleReader, RecordingThatBeginsWithinACycleLosesOnlyThat) {
  SynthesisOptions synthesis;
  synthesis.trigger_channel.reset();
  const Outcome outcome = cut(20, synthesis, CycleOptions(), [&](uint64_t number, SynthesisedCycle& cycle) {
    if (number > 0) return;
    recordings::EventColumns kept;
    for (size_t i = 0; i < cycle.batch.events.size(); ++i) {
      if (cycle.batch.events.t[i] > cycle.starts_us[3]) kept.push_back(cycle.batch.events[i]);
    }
    cycle.batch.events = kept;
  });
  expect_exact(outcome, 20, synthesis, {0});
  EXPECT_EQ(outcome.report.dropped[static_cast<size_t>(CycleFault::kPartial)], 1u);
}

TEST(CycleReader, PauseLosesOnlyTheCycleItCuts) {
  SynthesisOptions synthesis;
  synthesis.trigger_channel.reset();
  const Outcome outcome = cut(40, synthesis, CycleOptions(), [](uint64_t number, SynthesisedCycle& cycle) {
    if (number >= 20 && number < 30) cycle.batch.clear();
  });
  std::set<uint64_t> silent;
  for (uint64_t i = 20; i < 30; ++i) silent.insert(i);
  expect_exact(outcome, 40, synthesis, silent);
}

TEST(CycleReader, HotPixelsGetTheEventsOfTheirNeighboursAndFlickerDoesNoHarm) {
  SynthesisOptions synthesis;
  const auto add_loud = [&](uint64_t, SynthesisedCycle& cycle) {
    std::vector<recordings::Event> all;
    for (size_t i = 0; i < cycle.batch.events.size(); ++i) all.push_back(cycle.batch.events[i]);
    for (int64_t t = cycle.starts_us[0]; t < cycle.starts_us[0] + synthesis.schedule.cycle_us(); t += 500) {
      all.push_back({7, 5, 1, t});
      all.push_back({9, 6, static_cast<uint8_t>(t / 500 % 2), t});
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const recordings::Event& a, const recordings::Event& b) { return a.t < b.t; });
    cycle.batch.events.clear();
    for (const recordings::Event& event : all) cycle.batch.events.push_back(event);
  };
  CycleOptions options = by_triggers();
  options.filters_pixels = true;
  const Outcome outcome = cut(30, synthesis, options, add_loud);
  ASSERT_EQ(outcome.cycles.size(), 30u);
  EXPECT_EQ(outcome.report.hot_pixels, 1u);
  capture::EventImages last = outcome.cycles.back().images;
  for (size_t k = 0; k < 3; ++k) {
    // ON and OFF events alternate, so that at most one of them is left.
    int16_t& flickering = last.image(k)[6 * kWidth + 9];
    EXPECT_NEAR(flickering, images_of(29).image(k)[6 * kWidth + 9], 1) << k;
    flickering = images_of(29).image(k)[6 * kWidth + 9];
  }
  capture::EventImages expected = images_of(29);
  capture::replace_by_neighbours({5 * kWidth + 7}, expected);
  EXPECT_EQ(last, expected);
}

TEST(CycleReader, FilterThatFindsTooManyHotPixelsIsRefusedWithTheirShare) {
  SynthesisOptions synthesis;
  const auto add_loud = [&](uint64_t, SynthesisedCycle& cycle) {
    std::vector<recordings::Event> all;
    for (size_t i = 0; i < cycle.batch.events.size(); ++i) all.push_back(cycle.batch.events[i]);
    for (uint16_t place = 0; place < kWidth * kHeight; place += 16) {
      for (int64_t t = cycle.starts_us[0]; t < cycle.starts_us[0] + synthesis.schedule.cycle_us(); t += 200) {
        all.push_back({static_cast<uint16_t>(place % kWidth), static_cast<uint16_t>(place / kWidth), 1, t});
      }
    }
    std::ranges::stable_sort(all, {}, &recordings::Event::t);
    cycle.batch.events.clear();
    for (const recordings::Event& event : all) cycle.batch.events.push_back(event);
  };
  CycleOptions options = by_triggers();
  options.filters_pixels = true;
  recordings::RecordingInfo info;
  info.width = kWidth;
  info.height = kHeight;
  auto reader = CycleReader::open(
      std::make_unique<recordings::RecordingReader>(std::make_unique<SynthesisedBlocks>(3, synthesis, add_loud), info,
                                                    "synthesis", recordings::OpenOptions()),
      options);
  ASSERT_TRUE(reader.ok());
  const auto cycle = reader->next();
  ASSERT_FALSE(cycle.ok());
  EXPECT_EQ(cycle.error().code, ErrorCode::kInvalidValue);
  EXPECT_NE(cycle.error().message.find(" %"), std::string::npos) << cycle.error().message;
}

TEST(CycleReader, MemoryDoesNotGrowWithTheRecording) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps freed memory";
#endif
  const auto peak_kb = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  for (const CycleOptions& options : {by_triggers(), CycleOptions()}) {
    EXPECT_EQ(cut(100, SynthesisOptions(), options, {}, /*keep_images=*/false).cycles.size(), 100u);
    const long after_100_kb = peak_kb();
    EXPECT_EQ(cut(1000, SynthesisOptions(), options, {}, /*keep_images=*/false).cycles.size(), 1000u);
    EXPECT_LT(peak_kb() - after_100_kb, 2000);
  }
}

/// The time of a recording without events is INT64_MIN, and nothing comes before it. Sanitizers see the overflow.
TEST(CycleReader, RecordingWithoutEventsHasNoCyclesWhateverTheDelay) {
  for (const int64_t delay_us : {-100'000, -1, 0, 100'000}) {
    CycleOptions options = by_triggers();
    options.trigger_delay_us = delay_us;
    const Outcome outcome = cut(0, SynthesisOptions(), options);
    EXPECT_TRUE(outcome.cycles.empty()) << delay_us;
    EXPECT_EQ(outcome.report.marks, 0u) << delay_us;
  }
}

TEST(CycleReader, SensorOfUnknownSizeIsRefused) {
  auto reader = CycleReader::open(std::make_unique<recordings::RecordingReader>(
                                      std::make_unique<SynthesisedBlocks>(1, SynthesisOptions(), Change()),
                                      recordings::RecordingInfo(), "synthesis", recordings::OpenOptions()),
                                  {});
  ASSERT_FALSE(reader.ok());
  EXPECT_EQ(reader.error().code, ErrorCode::kInvalidValue);
}

TEST(Schedule, PaperSequenceLastsAsInThePaper) {
  const Schedule schedule = paper_schedule();
  EXPECT_EQ(schedule.size(), 8u);
  EXPECT_EQ(schedule.num_images(), 3u);
  EXPECT_NEAR(static_cast<double>(schedule.cycle_us()), 94738, 5);
  EXPECT_FALSE(schedule.patterns[4].image.has_value());
  EXPECT_EQ(schedule.patterns[5].image, 0u);
}

TEST(Schedule, AllTransitionsBeginAtBlack) {
  const Schedule schedule = with_all_transitions(paper_schedule());
  EXPECT_EQ(schedule.num_images(), 8u);
  EXPECT_EQ(schedule.first_of_cycle(), 5u);
  EXPECT_EQ(schedule.patterns[5].image, 0u);  // a1 to a2
  EXPECT_EQ(schedule.patterns[0].image, 3u);  // a4 to white
  EXPECT_EQ(schedule.patterns[4].image, 7u);  // the inverse of a4 to black
  EXPECT_EQ(with_all_transitions(schedule), schedule);
  EXPECT_EQ(paper_schedule().first_of_cycle(), 0u);
}

TEST(Schedule, CodesOfAllTransitionsBeginAndEndWithTheFirst) {
  const capture::Codes codes = capture::default_codes(), inverses = capture::complement(codes);
  const capture::Codes whole = capture::whole_cycle(codes);
  ASSERT_EQ(whole.num_patterns, 9u);
  const auto equal = [](std::span<const float> a, std::span<const float> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  };
  for (size_t n = 0; n < 4; ++n) {
    EXPECT_TRUE(equal(whole.pattern(n), codes.pattern(n)));
    EXPECT_TRUE(equal(whole.pattern(4 + n), inverses.pattern(n)));
  }
  EXPECT_TRUE(equal(whole.pattern(8), codes.pattern(0)));
  EXPECT_EQ(capture::codes_of_whole_cycle(whole), codes);
  EXPECT_EQ(capture::codes_of_whole_cycle(codes), std::nullopt);
  const Schedule lit = paper_schedule(), all = with_all_transitions(paper_schedule());
  for (const capture::Codes& told : {codes, whole}) {
    EXPECT_EQ(codes_of_images(told, lit), codes);
    EXPECT_EQ(codes_of_images(told, all), whole);
  }
  EXPECT_EQ(paper_schedule_of(codes), lit);
  EXPECT_EQ(paper_schedule_of(whole), all);
  // Without inverses the cycle goes from a4 to a1.
  const auto plain = codes_of_images(codes, with_all_transitions(plain_schedule(4, 10000)));
  ASSERT_TRUE(plain.has_value());
  EXPECT_EQ(plain->num_patterns, 5u);
  EXPECT_TRUE(equal(plain->pattern(3), codes.pattern(3)));
  EXPECT_TRUE(equal(plain->pattern(4), codes.pattern(0)));
  Schedule unnamed = all;
  unnamed.patterns[2].name = "flush";
  EXPECT_EQ(codes_of_images(codes, unnamed), std::nullopt);
}

TEST(Schedule, JsonComesBack) {
  for (const Schedule& schedule :
       {paper_schedule(4), paper_schedule(8), plain_schedule(4, 3000), with_all_transitions(paper_schedule())}) {
    auto back = parse_schedule(schedule_text(schedule), "schedule.json");
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(*back, schedule);
  }
}

TEST(Schedule, WrongOnesAreRefusedWithTheirPlace) {
  const auto error = [](const std::string& text) {
    auto parsed = parse_schedule(text, "s.json");
    return parsed.ok() ? std::string() : parsed.error().text();
  };
  EXPECT_THAT(error(R"({"patterns": []})"), testing::HasSubstr("pattern's events"));
  EXPECT_THAT(error(R"({"patterns": [{"durations_us": 3, "image": 0}]})"), testing::HasSubstr("patterns[0]"));
  EXPECT_THAT(error(R"({"patterns": [{"image": 1}]})"), testing::HasSubstr("numbered"));
  EXPECT_THAT(error(R"({"patterns": [{"image": 0, "duration_us": 0}]})"), testing::HasSubstr("positive"));
  EXPECT_THAT(error(R"({"patterns": [{"image": 0, "duration_us": 9223372036854775807}]})"), testing::HasSubstr("hour"));
  EXPECT_THAT(error(R"({"patterns": [{"image": 0, "sign": "up"}]})"), testing::HasSubstr("sign"));
}

}  // namespace
}  // namespace e2lf::cycles
