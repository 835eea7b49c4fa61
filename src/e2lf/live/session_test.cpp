// SPDX-License-Identifier: MIT
#include "e2lf/live/session.h"

#include <gtest/gtest.h>

#include "e2lf/cycles/synthesise.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/live/live_requests.h"
#include "e2lf/recordings/open/registry.h"
#include "testing/test_streams.h"

namespace e2lf::live {
namespace {

using recordings::TestFolder;

constexpr size_t kWidth = 64, kHeight = 48;

model::Model camera_model() {
  return model::read_model(*bundled_file("models/e2lf-n4-camera.safetensors")).value();
}

recon::Reconstructor reconstructor() {
  return recon::Reconstructor::create(camera_model()).value();
}

std::vector<FieldMaker> one_maker() {
  std::vector<FieldMaker> makers;
  makers.emplace_back(reconstructor());
  return makers;
}

capture::EventImages cycle_images(uint64_t number) {
  capture::EventImages images(3, kHeight, kWidth);
  for (size_t i = 0; i < images.values.size(); ++i) {
    images.values[i] = static_cast<int16_t>((i * (number + 3)) % 5) - 2;
  }
  return images;
}

/// Writes a recording of `cycles` cycles of 80 ms, with triggers.
void write_recording(const std::filesystem::path& path, uint64_t cycles, bool is_still = false) {
  cycles::SynthesisOptions options;
  options.schedule = cycles::plain_schedule(4, 20'000);
  const recordings::RecordingInfo info{.format = "evt3", .width = kWidth, .height = kHeight, .header = {}};
  auto writer = recordings::create_recording(path, "evt3", info).value();
  ASSERT_TRUE(
      synthesise_recording(*writer, cycles, options, [is_still](uint64_t number) -> Result<capture::EventImages> {
        return cycle_images(is_still ? 0 : number);
      }).ok());
  ASSERT_TRUE(writer->finish().ok());
}

std::unique_ptr<LiveReader> open_replay(const std::filesystem::path& path, const ReadingOptions& options = {}) {
  const OpenCycles open = [path, &options](const auto& on_batch) -> Result<cycles::CycleReader> {
    cycles::CycleOptions cycles;
    cycles.source = cycles::CycleSource::kTriggers;
    cycles.schedule = cycles::plain_schedule(4, 20'000);
    cycles.tracker.first_pattern = 0;
    cycles.on_batch = on_batch;
    cycles.invert_polarity = options.is_inverted;
    E2LF_ASSIGN_OR_RETURN(auto camera, recordings::open_named_recording("replay:" + path.string()));
    return cycles::CycleReader::open(std::move(camera), cycles);
  };
  return LiveReader::open(open, options).value();
}

/// Expects differences by the rounding of prepared_for(), which is -35 dB at most.
void expect_near(const lightfield::LightField& field, const lightfield::LightField& expected) {
  ASSERT_EQ(field.shape(), expected.shape());
  double difference = 0, power = 0;
  for (size_t i = 0; i < field.data().size(); ++i) {
    const double error = field.data()[i] - expected.data()[i];
    difference += error * error;
    power += expected.data()[i] * expected.data()[i];
  }
  EXPECT_LT(difference, 3e-4 * power);
}

TEST(FieldMaker, MakesTheLightFieldOfTheReconstructorInTheSameMemory) {
  // This network ends in one convolution, so that it makes single views.
  FieldMaker maker(
      recon::Reconstructor::create(model::read_model(*bundled_file("models/e2lf-n4-live.safetensors")).value())
          .value());
  lightfield::LightField field;
  const float* memory = nullptr;
  for (const uint64_t number : {0, 1}) {
    const capture::EventImages counts = cycle_images(number);
    ASSERT_TRUE(maker.make(counts, 2, {}, field).ok());
    const auto expected = maker.reconstructor().reconstruct(counts, {}, 1, 2).value();
    lightfield::LightField exact;
    ASSERT_TRUE(maker.make(counts, 2, {}, exact, /*exactly=*/true).ok());
    EXPECT_TRUE(std::ranges::equal(exact.data(), expected.data()));
    expect_near(field, expected);
    // Some views are made alone, and the others stay.
    const lightfield::LightField all = field;
    const lightfield::LightField& made = field;
    std::ranges::fill(field.data(), 7.0F);
    const std::vector<size_t> views = {3, 41};
    ASSERT_TRUE(maker.make(counts, 2, views, field).ok());
    for (size_t view = 0; view < 64; ++view) {
      const auto now = made.view(view / 8, view % 8), of_all = all.view(view / 8, view % 8);
      const bool is_asked = view == 3 || view == 41;
      EXPECT_TRUE(is_asked ? std::ranges::equal(now, of_all) : std::ranges::all_of(now, [](float value) {
        return value == 7.0F;
      })) << view;
    }
    EXPECT_TRUE(memory == nullptr || field.data().data() == memory);
    memory = field.data().data();
  }
  capture::EventImages odd(3, 13, 17);
  odd.values.assign(odd.values.size(), 1);
  const std::vector<size_t> one = {9};
  ASSERT_TRUE(maker.make(odd, 1, one, field).ok());
  const auto expected = maker.reconstructor().reconstruct(odd).value();
  for (size_t i = 0; i < field.shape().view_size(); ++i) {
    EXPECT_NEAR(field.view(1, 1)[i], expected.view(1, 1)[i], 0.02) << "pixel " << i;
  }
  EXPECT_FALSE(maker.make(capture::EventImages(2, 16, 16), 1, {}, field).ok());
}

TEST(Session, EachCycleIsShownOrCountedAndTheLastOneIsShown) {
  const TestFolder folder;
  constexpr uint64_t kCycles = 6;
  write_recording(folder / "a.raw", kCycles);
  std::vector<FieldReport> reports;
  SessionOptions options;
  options.size = PictureSize::kFull;
  options.on_field = [&](const FieldReport& report) { reports.push_back(report); };
  Session session(open_replay(folder / "a.raw"), one_maker(), options);
  session.start();
  ASSERT_TRUE(session.wait().ok());
  const Json json = session.json();
  EXPECT_EQ(json["cycles"], kCycles);
  EXPECT_EQ(json["fields"].get<uint64_t>() + json["skipped_cycles"].get<uint64_t>(), kCycles);
  ASSERT_EQ(reports.size(), json["fields"].get<size_t>());
  EXPECT_EQ(reports.back().cycle, kCycles - 1);
  for (const FieldReport& report : reports) EXPECT_GE(report.latency_s, report.reconstruct_s);
}

bool has_finding(const Json& session, const std::string& code) {
  return std::ranges::any_of(session["findings"], [&](const Json& finding) { return finding["code"] == code; });
}

TEST(Session, AnExceptionOfACheckIsAFindingAndEachCycleIsStillCounted) {
  const TestFolder folder;
  constexpr uint64_t kCycles = 3;
  write_recording(folder / "a.raw", kCycles);
  SessionOptions options;
  options.size = PictureSize::kFull;
  options.check = [](const capture::EventImages&, size_t, bool) -> diagnose::Findings { throw std::bad_alloc(); };
  Session session(open_replay(folder / "a.raw"), one_maker(), options);
  session.start();
  const Result<void> ended = session.wait();
  ASSERT_FALSE(ended.ok());
  EXPECT_EQ(ended.error().code, ErrorCode::kInternal);
  const Json json = session.json();
  EXPECT_TRUE(has_finding(json, "live-step-failed"));
  EXPECT_EQ(json["fields"].get<uint64_t>() + json["skipped_cycles"].get<uint64_t>(), kCycles);
}

TEST(Session, TellsAnUnusualGainThatItDetermines) {
  const TestFolder folder;
  write_recording(folder / "a.raw", 2);
  SessionOptions options;
  options.size = PictureSize::kFull;
  std::vector<float> judged;
  options.judge_gain = [&](float gain) {
    judged.push_back(gain);
    return diagnose::Finding{.code = "gain-unusual", .message = "m", .remedy = "r"};
  };
  for (const bool is_given : {false, true}) {
    if (is_given) options.tone.gain = 2.0F;
    judged.clear();
    Session session(open_replay(folder / "a.raw"), one_maker(), options);
    session.start();
    ASSERT_TRUE(session.wait().ok());
    EXPECT_EQ(judged.size(), is_given ? 0U : 1U);
    EXPECT_EQ(has_finding(session.json(), "gain-unusual"), !is_given);
    for (const float gain : judged) EXPECT_FLOAT_EQ(gain, session.json()["gain"].get<float>());
  }
}

/// What is found in the first three cycles may be due to a few triggers, unless there are no more.
TEST(LiveReader, NamesTheFindingsOfASourceOfTwoCyclesAtItsEnd) {
  const TestFolder folder;
  write_recording(folder / "once.raw", 2);
  const auto once = recordings::open_recording(folder / "once.raw").value();
  const recordings::EventBatch events = recordings::read_all(*once).value();
  recordings::EventBatch doubled;
  doubled.triggers = events.triggers;
  for (size_t i = 0; i < 2 * events.events.size(); ++i) doubled.events.push_back(events.events[i / 2]);
  auto writer = recordings::create_recording(folder / "a.raw", "evt2", once->info()).value();
  ASSERT_TRUE(writer->write(doubled).ok());
  ASSERT_TRUE(writer->finish().ok());
  std::vector<std::string> found;
  ReadingOptions options;
  options.on_finding = [&](const diagnose::Finding& finding) { found.push_back(finding.code); };
  const auto reader = open_replay(folder / "a.raw", options);
  LiveCycle cycle;
  EXPECT_TRUE(reader->next(cycle).value());
  EXPECT_EQ(found, std::vector<std::string>());
  while (reader->next(cycle).value()) {
  }
  EXPECT_EQ(found, std::vector<std::string>{"events-duplicate"});
}

TEST(Session, AnExceptionOfTheDisplayLeavesTheRecordingComplete) {
  const TestFolder folder;
  write_recording(folder / "a.raw", 3);
  SessionOptions options;
  options.size = PictureSize::kFull;
  options.on_field = [](const FieldReport&) { throw std::bad_alloc(); };
  auto reader = open_replay(folder / "a.raw", {folder / ".", false, 3});
  ASSERT_TRUE(reader->recorder().begin().ok());
  Session session(std::move(reader), one_maker(), options);
  session.start();
  EXPECT_FALSE(session.wait().ok());
  const Json json = session.json();
  EXPECT_TRUE(has_finding(json, "live-step-failed"));
  EXPECT_EQ(json["cycles"], 3);
}

TEST(Session, AFrozenLightFieldIsThatOfTheSequenceToTheBit) {
  const TestFolder folder;
  write_recording(folder / "a.raw", 1);
  SessionOptions options;
  options.size = PictureSize::kFull;
  Session session(open_replay(folder / "a.raw"), one_maker(), options);
  EXPECT_FALSE(session.freeze());
  session.start();
  ASSERT_TRUE(session.wait().ok());
  const auto frozen = session.freeze();
  ASSERT_TRUE(frozen);
  EXPECT_EQ(frozen->cycle.images, cycle_images(0));
  const recon::Reconstructor network = reconstructor();
  pipeline::FieldSequence sequence([&](const capture::MeasurementView& measured,
                                       const ProgressFn& progress) { return network.reconstruct(measured, progress); },
                                   {.gain = {}, .black = {}}, {});
  const pipeline::Field expected = sequence.next(capture::Measurement(cycle_images(0))).value();
  EXPECT_EQ(frozen->gain, expected.gain);
  EXPECT_EQ(frozen->black, expected.black);
  EXPECT_TRUE(std::ranges::equal(frozen->light_field.data(), expected.light_field.data()));
}

TEST(Session, AStillLookIsGivenItsViewsAloneAndANewOneTheOthers) {
  const TestFolder folder;
  write_recording(folder / "a.raw", 3);
  SessionOptions options;
  options.tone = {.gain = 1.0F, .black = 0.0F};
  options.size = PictureSize::kFull;
  Session session(open_replay(folder / "a.raw"), one_maker(), options);
  session.start();
  ASSERT_TRUE(session.wait().ok());
  const LiveField frozen = *session.freeze();
  for (const RenderSettings& settings : {RenderSettings(), RenderSettings{.x = -2, .y = 1},
                                         RenderSettings{.x = 0, .y = 0, .focus = 0.5F, .radius = 3}}) {
    const auto shown = session.picture(settings, 0, std::chrono::milliseconds(0));
    ASSERT_TRUE(shown);
    const Picture expected = render(frozen, settings);
    ASSERT_EQ(shown->picture.image.pixels.size(), expected.image.pixels.size());
    for (size_t i = 0; i < expected.image.pixels.size(); ++i) {
      ASSERT_NEAR(shown->picture.image.pixels[i], expected.image.pixels[i], 1);
    }
  }
}

TEST(LiveReader, RecordsWhatWasSentAndStopsAfterTheCyclesThatAreWanted) {
  const TestFolder folder;
  write_recording(folder / "a.raw", 3);
  for (const bool is_inverted : {false, true}) {
    const auto reader = open_replay(folder / "a.raw", {folder / ".", is_inverted, 2});
    ASSERT_TRUE(reader->recorder().begin().ok());
    LiveCycle cycle;
    EXPECT_TRUE(reader->next(cycle).value());
    EXPECT_TRUE(reader->next(cycle).value());
    EXPECT_FALSE(reader->next(cycle).value());
    ASSERT_TRUE(reader->recorder().end().ok());
    const auto recorded = recordings::open_recording(reader->recorder().json()["file"].get<std::string>()).value();
    const recordings::EventBatch got = recordings::read_all(*recorded).value();
    recordings::EventBatch sent = recordings::read_all(*recordings::open_recording(folder / "a.raw").value()).value();
    ASSERT_GT(got.events.size(), sent.events.size() / 2);
    sent.events.p.resize(got.events.size());
    EXPECT_EQ(got.events.p, sent.events.p) << "inverted: " << is_inverted;
  }
}

TEST(Session, HalfSizeTakesTheSumsOfBlocksAsFourCycles) {
  const TestFolder folder;
  write_recording(folder / "a.raw", 1);
  SessionOptions options;
  options.size = PictureSize::kHalf;
  options.tone = {.gain = 1.0F, .black = 0.0F};
  Session session(open_replay(folder / "a.raw"), one_maker(), options);
  session.start();
  ASSERT_TRUE(session.wait().ok());
  const auto frozen = session.freeze();
  capture::EventImages half;
  sum_blocks(cycle_images(0), 2, half);
  const auto expected = reconstructor().reconstruct(half, {}, 1, 4).value();
  EXPECT_TRUE(std::ranges::equal(frozen->light_field.data(), expected.data()));
}

/// Returns fused cycles whose number differs between the halves of the picture.
capture::Measurement fused_measurement() {
  recon::CycleFusion fusion(reconstructor().model().camera.value(), 4);
  for (const uint64_t number : {0, 0, 0, 1}) fusion.add(cycle_images(number));
  capture::Measurement measurement(cycle_images(1));
  measurement.fused = fusion.fused();
  for (size_t i = 0; i < measurement.fused.cycles.values.size(); ++i) {
    measurement.fused.cycles.values[i] = i % kWidth < kWidth / 2 ? 3.5F : 1.0F;
  }
  return measurement;
}

TEST(FieldMaker, MakesTheLightFieldOfFusedCycles) {
  const recon::Reconstructor network =
      recon::Reconstructor::create(camera_model(), {.precision = engine::Precision::kFloat32}).value();
  FieldMaker maker(network);
  EXPECT_TRUE(maker.takes_fused());
  const capture::Measurement measurement = fused_measurement();
  const lightfield::LightField expected = network.reconstruct(measurement).value();
  lightfield::LightField field;
  for (const size_t samples : {1, 4}) {  // prepared for other numbers in between
    ASSERT_TRUE(maker.make(cycle_images(0), samples, {}, field).ok());
    ASSERT_TRUE(maker.make(measurement, 1, {}, field).ok());
    for (size_t i = 0; i < field.data().size(); ++i) ASSERT_NEAR(field.data()[i], expected.data()[i], 1e-4);
  }
}

TEST(Session, FusesTheCyclesOfAStillSceneUnlessItIsSwitchedOff) {
  const TestFolder folder;
  constexpr uint64_t kCycles = 4;
  write_recording(folder / "a.raw", kCycles, /*is_still=*/true);
  for (const bool is_on : {true, false}) {
    for (const PictureSize size : {PictureSize::kFull, PictureSize::kHalf}) {
      FieldReport last;
      SessionOptions options;
      options.size = size;
      options.tone = {.gain = 1.0F, .black = 0.0F};
      options.on_field = [&](const FieldReport& report) { last = report; };
      Session session(open_replay(folder / "a.raw"), one_maker(), options);
      session.reader().prepare_fusion(reconstructor().model().camera.value(), 16);
      ASSERT_EQ(answer(session, true, "fuse", {{"on", is_on ? "1" : "0"}})->status, 200);
      EXPECT_EQ(session.json()["is_fusing"], is_on);
      session.start();
      ASSERT_TRUE(session.wait().ok());
      EXPECT_DOUBLE_EQ(last.fused_cycles, is_on ? kCycles : 0);
      const auto map = session.fused_cycles();
      ASSERT_EQ(map.has_value(), is_on);
      if (map) {
        EXPECT_EQ(map->pixels, std::vector<uint8_t>(kWidth * kHeight / 16, kCycles));
      }
      EXPECT_EQ(answer(session, false, "fused", {})->status, is_on ? 200 : 204);
      // The mean of equal cycles is one of them, of which the network is told the number.
      const size_t side = size == PictureSize::kHalf ? 2 : 1;
      capture::EventImages counts = cycle_images(0);
      if (side == 2) sum_blocks(cycle_images(0), 2, counts);
      for (int16_t& count : counts.values) count = static_cast<int16_t>(count * (is_on ? kCycles : 1));
      const auto expected = reconstructor().reconstruct(counts, {}, 1, side * side * (is_on ? kCycles : 1)).value();
      expect_near(session.freeze()->light_field, expected);
    }
  }
}

/// A network whose disparity is half the mean of the first count plus 1.
recon::Reconstructor depth_network() {
  model::Model model;
  model.name = "known";
  model.num_patterns = 4;
  model.input = {{model::InputKind::kCounts, 0.125F}};
  model.network = {3, {{.name = "out", .inputs = {"input"}, .out_channels = 2}}};
  model.weights = {{"out.weight", {4, 0, 0, 0, 0, 0}}, {"out.bias", {1, -3}}};
  return recon::Reconstructor::create(model).value();
}

TEST(Session, GivesDisparitiesOfTheFullSizeWhileTheyAreRequested) {
  const TestFolder folder;
  write_recording(folder / "a.raw", 4);
  Session session(open_replay(folder / "a.raw"), one_maker(), {.depth = depth_network()});
  EXPECT_EQ(session.depth(0, {}), nullptr);
  session.start();
  std::shared_ptr<const ShownDepth> shown;
  while (!session.has_ended()) {
    if (const auto next = session.depth(0, std::chrono::milliseconds(20))) shown = next;
  }
  ASSERT_TRUE(session.wait().ok());
  ASSERT_NE(shown, nullptr);
  EXPECT_EQ(shown->field.level.size, PictureSize::kHalf);
  const capture::EventImages counts = cycle_images(shown->field.cycle);
  const float sum =
      static_cast<float>(counts.values[0] + counts.values[1] + counts.values[kWidth] + counts.values[kWidth + 1]);
  EXPECT_NEAR(shown->disparity.pixels[0], 2 * (1 + sum / 8), 1e-3);
  shown = session.depth(0, {});  // the last one
  const auto answered = answer(session, false, "depth", {});
  ASSERT_TRUE(answered);
  EXPECT_EQ(answered->status, 200);
  const auto byte = [&](size_t i) { return static_cast<unsigned>(static_cast<uint8_t>(answered->body[i])); };
  const size_t numbers = 4 + byte(0) + 256 * byte(1), pixels = shown->disparity.pixels.size();
  ASSERT_EQ(answered->body.size(), numbers + 4 * pixels) << "disparities, confidence and picture";
  const auto milli = static_cast<int16_t>(byte(numbers) + 256 * byte(numbers + 1));
  EXPECT_NEAR(milli, 1000 * shown->disparity.pixels[0], 0.51);
  EXPECT_NEAR(byte(numbers + 2 * pixels), 255 * shown->confidence.pixels[0], 0.51);
}

TEST(Session, GivesTheDisparitiesOfTheLastCycleAfterTheEnd) {
  const TestFolder folder;
  write_recording(folder / "a.raw", 1);
  Session session(open_replay(folder / "a.raw"), one_maker(), {.depth = depth_network()});
  session.start();
  ASSERT_TRUE(session.wait().ok());
  const auto shown = session.depth(0, {});
  ASSERT_NE(shown, nullptr);
  EXPECT_EQ(shown->field.cycle, 0U);
  EXPECT_EQ(session.depth(shown->field.serial, {}), nullptr) << "there is nothing newer";
}

TEST(LiveRequests, GiveThePictureThatIsAskedForAndHeedCommands) {
  const TestFolder folder;
  write_recording(folder / "a.raw", 1);
  Session session(open_replay(folder / "a.raw"), one_maker(), {.size = PictureSize::kFull});
  EXPECT_EQ(answer(session, false, "picture", {})->status, 204) << "there is none yet";
  session.start();
  ASSERT_TRUE(session.wait().ok());
  for (const char* focus : {"1", "2", "nan", ""}) {
    const auto picture = answer(session, false, "picture", {{"after", "0"}, {"focus", focus}, {"row", "5"}});
    ASSERT_EQ(picture->status, 200);
    const std::string& body = picture->body;
    uint32_t length = 0;
    for (uint32_t i = 0; i < 4; ++i) length |= static_cast<uint32_t>(static_cast<unsigned char>(body[i])) << (8 * i);
    const Json header = Json::parse(body.substr(4, length));
    EXPECT_EQ(header["width"], kWidth);
    EXPECT_EQ(body.size(), 4 + length + kWidth * kHeight + 8 * kWidth);
  }
  EXPECT_EQ(answer(session, true, "average", {{"cycles", "999999"}})->status, 200);
  EXPECT_EQ(session.reader().average(), kMostCycles);
  EXPECT_EQ(answer(session, true, "size", {{"to", "half"}})->status, 200);
  EXPECT_EQ(answer(session, true, "size", {{"to", "../x"}})->status, 409);
  EXPECT_EQ(answer(session, true, "record", {{"on", "1"}})->status, 409) << "no folder";
  EXPECT_FALSE(answer(session, false, "record", {{"on", "1"}}).has_value()) << "a command is no request";
  const Json figures = statistics(session);
  EXPECT_EQ(figures["size"], "half");
  EXPECT_EQ(figures["size_choice"], "half");
  EXPECT_EQ(figures["recording"]["can_record"], false);
}

}  // namespace
}  // namespace e2lf::live
