// SPDX-License-Identifier: MIT
// The vendor's camera, with the simulated HAL of testing/hal.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>
#include <stand_in_hal.h>
#include <thread>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/open/registry.h"
#include "testing/test_log.h"
#include "testing/test_streams.h"

namespace e2lf::cameras {
namespace {

constexpr char kName[] = "camera://metavision";

class MetavisionCamera : public testing::Test {
 protected:
  MetavisionCamera() {
    stream_ = random_stream({.events = 40'000, .width = 1280, .height = 720, .trigger_every = 100});
    constexpr uint16_t kInputs[] = {0, 6, 7};
    for (Trigger& trigger : stream_.triggers) trigger.id = kInputs[trigger.id % 3];
    write_recording(folder_ / "sent.raw", stream_, {.width = 1280, .height = 720});
    words_ = words_of(read_file(folder_ / "sent.raw").value());
  }
  ~MetavisionCamera() override {
    ::unsetenv("E2LF_STAND_IN");
    request_stop(0);
  }

  void simulate(const std::string& scenario) const {
    const std::string text = cat("serial=A1,B2;file=", (folder_ / "sent.raw").string(), ";", scenario);
    ::setenv("E2LF_STAND_IN", text.c_str(), 1);
  }

  static std::vector<uint8_t> words_of(const std::vector<uint8_t>& bytes) {
    constexpr std::string_view kEnd = "% end\n";
    const auto header = std::search(bytes.begin(), bytes.end(), kEnd.begin(), kEnd.end());
    return {header + kEnd.size(), bytes.end()};
  }

  /// All bytes of a source, header and words.
  static std::vector<uint8_t> take_all(ByteSource& source) { return read_rest(source).value(); }

  TestFolder folder_;
  EventBatch stream_;
  std::vector<uint8_t> words_;
};

TEST_F(MetavisionCamera, ItsTriggersAreOnUnlessOthersAreNamed) {
  simulate("period_us=0;end_at=80000");
  const auto triggers = [](const std::vector<std::string>& channels) {
    const TestLog log;
    auto reader = open_named_recording(kName, {.camera = {.trigger_channels = channels}}).value();
    EventBatch all = read_all(*reader).value();
    return std::pair(all.triggers.size(), *reader->info().find("trigger_channels"));
  };
  EXPECT_GT(triggers({}).first, 50u);
  EXPECT_EQ(triggers({}).second, "main=0, aux=6");
  EXPECT_EQ(triggers({"main"}).second, "main=0");
  EXPECT_EQ(triggers({"0"}).first, triggers({"main"}).first);
  EXPECT_EQ(triggers({"none"}), (std::pair<size_t, std::string>(0, "none")));
  const auto unknown = open_named_recording(kName, {.camera = {.trigger_channels = {"3"}}});
  ASSERT_FALSE(unknown.ok());
  EXPECT_NE(unknown.error().message.find("main=0, aux=6"), std::string::npos) << unknown.error().text();
}

TEST_F(MetavisionCamera, ItsSettingsChangeWhileItRunsWithinTheRangesThatItStates) {
  simulate("period_us=0;end_at=80000");
  const auto running = std::make_shared<RunningCamera>();
  EXPECT_EQ(running->change("roi", "all").error().code, ErrorCode::kNotFound) << "none has started";
  auto source = open_live_bytes(kName, {.running = running});
  ASSERT_TRUE(source.ok()) << source.error().text();
  const auto control = [&](const std::string& name) {
    for (const CameraControl& found : running->controls()) {
      if (found.name == name) return found;
    }
    return CameraControl{};
  };
  EXPECT_EQ(control("bias_diff_on").least, -80);
  EXPECT_EQ(control("bias_diff_on").most, 140);
  EXPECT_TRUE(running->change("bias_diff_on", "12").ok());
  EXPECT_EQ(control("bias_diff_on").value, "12");
  for (const char* refused : {"141", "-81", "x", ""}) {
    EXPECT_EQ(running->change("bias_diff_on", refused).error().code, ErrorCode::kInvalidValue) << refused;
  }
  EXPECT_EQ(control("bias_diff_on").value, "12");
  EXPECT_EQ(running->change("bias_of_nobody", "1").error().code, ErrorCode::kUnsupported);
  EXPECT_TRUE(running->change("max-event-rate", "5000000").ok());
  EXPECT_EQ(control("max-event-rate").value, "5000000");
  EXPECT_TRUE(running->change("max-event-rate", "0").ok());
  EXPECT_EQ(control("max-event-rate").value, "0");
  EXPECT_TRUE(running->change("roi", "0,0,8,4 10,10,5,5").ok());
  EXPECT_EQ(control("roi").value, "0,0,8,4 10,10,5,5");
  EXPECT_EQ(running->change("roi", "0,0,9999,4").error().code, ErrorCode::kInvalidValue) << "outside of the sensor";
  EXPECT_TRUE(running->change("roi", "all").ok());
  EXPECT_EQ(control("roi").value, "all");
  *source = nullptr;
  EXPECT_EQ(running->change("roi", "all").error().code, ErrorCode::kNotFound) << "the camera ends with its input";
}

TEST_F(MetavisionCamera, ItsIdentityAndItsSettingsAsReadBackAreInTheHeader) {
  simulate("period_us=0;end_at=4096");
  ASSERT_TRUE(write_file(folder_ / "low.bias", std::string("-20 % bias_diff_off\n30 % bias_diff_on\n")).ok());
  const TestLog log;
  const CameraSetup setup{.trigger_channels = {},
                          .biases = folder_ / "low.bias",
                          .max_events_per_s = 5'000'000,
                          .regions = {{100, 50, 640, 480}},
                          .encoding = "evt3"};
  auto source = open_live_bytes(kName, setup).value();
  EXPECT_NE(source->bias_file_text().find("30 % bias_diff_on"), std::string::npos);
  const auto reader = open_recording(SourcePtr(std::move(source))).value();
  const RecordingInfo& info = reader->info();
  EXPECT_EQ(info.width, 1280u);
  EXPECT_EQ(info.find("serial_number"), "A1");
  EXPECT_EQ(info.find("sensor_name"), "IMX636");
  EXPECT_EQ(info.find("biases"), "bias_diff_off=-20, bias_diff_on=30, bias_fo=0, bias_hpf=0");
  EXPECT_EQ(info.find("max_events_per_s"), "5000000");
  EXPECT_EQ(info.find("regions"), "100,50,640,480");
  EXPECT_EQ(info.find("anti_flicker"), "off");
  EXPECT_NE(log.text().find("stand-in camera A1 opened"), std::string::npos) << "the HAL's messages go to our log";
}

TEST_F(MetavisionCamera, SettingsThatItDoesNotTakeAreRefused) {
  simulate("");
  const TestLog log;
  ASSERT_TRUE(write_file(folder_ / "other.bias", std::string("1 % bias_nobody\n")).ok());
  const auto refusal = [](const CameraSetup& setup) {
    const auto source = open_live_bytes(kName, setup);
    return source.ok() ? "taken" : source.error().text();
  };
  const auto expect_said = [&](const CameraSetup& setup, const std::string& said) {
    EXPECT_NE(refusal(setup).find(said), std::string::npos) << refusal(setup);
  };
  expect_said({.biases = folder_ / "nowhere.bias"}, "no such file of biases");
  expect_said({.biases = folder_ / "other.bias"}, "unknown bias: 1 % bias_nobody); give a file made for it");
  expect_said({.max_events_per_s = 4'000'000'000}, "its controller takes 0 to 160000000");
  expect_said({.regions = {{1000, 0, 640, 480}}}, "within its sensor");
  expect_said({.encoding = "evt2"}, "it offers EVT3, EVT21");
}

TEST_F(MetavisionCamera, AnInputThatNobodyAskedForMayBeRefused) {
  simulate("period_us=0;end_at=4096;refuse_aux");
  const TestLog log;
  const auto reader = open_named_recording(kName).value();
  EXPECT_EQ(reader->info().find("trigger_channels"), "main=0");
  EXPECT_NE(log.text().find("trigger input"), std::string::npos) << log.text();
  const auto refused = open_named_recording(kName, {.camera = {.trigger_channels = {"aux"}}});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidValue);
}

TEST_F(MetavisionCamera, ItsFiltersAreSwitchedOffOnRequest) {
  simulate("period_us=0;end_at=4096;filters");
  const TestLog log;
  for (const bool switches_off : {false, true}) {
    const auto reader = open_named_recording(kName, {.camera = {.switches_filters_off = switches_off}}).value();
    EXPECT_EQ(reader->info().find("anti_flicker"), switches_off ? "off" : "on");
    EXPECT_EQ(reader->info().find("event_trail_filter"), switches_off ? "off" : "on");
  }
}

TEST_F(MetavisionCamera, AnEncodingThatIsNotReadIsRefused) {
  simulate("format=EVT4");
  const TestLog log;
  const auto source = open_live_bytes(kName);
  ASSERT_FALSE(source.ok());
  EXPECT_EQ(source.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(source.error().message.find("sends EVT4, which e2lf cannot read"), std::string::npos)
      << source.error().text();
}

TEST_F(MetavisionCamera, NoneBusyAndASecondOpenerAreToldApart) {
  const TestLog log;
  ::setenv("E2LF_STAND_IN", "", 1);
  EXPECT_EQ(open_live_bytes(kName).error().code, ErrorCode::kNotFound);
  simulate("busy");
  EXPECT_NE(open_live_bytes(kName).error().message.find("busy"), std::string::npos);
  simulate(cat("lock=", (folder_ / "lock").string()));
  EXPECT_NE(open_live_bytes(cat(kName, "/C3")).error().message.find("those connected are"), std::string::npos);
  const auto first = open_live_bytes(cat(kName, "/B2"));
  ASSERT_TRUE(first.ok());
  const auto second = open_live_bytes(cat(kName, "/B2"));
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().code, ErrorCode::kIo);
  EXPECT_NE(second.error().message.find("busy"), std::string::npos) << second.error().text();
}

TEST_F(MetavisionCamera, TwoHundredUnplugsLoseNothingThatTheDriverDelivered) {
  std::mt19937 random(31);
  const TestLog log;
  for (int trial = 0; trial < 200; ++trial) {
    const size_t unplug_at = std::uniform_int_distribution<size_t>(2, words_.size() - 1)(random);
    const size_t buffer = std::uniform_int_distribution<size_t>(1, 4000)(random);
    simulate(cat("unplug_at=", unplug_at, ";buffer=", buffer, ";period_us=", trial % 2 == 0 ? 0 : 20));
    auto source = open_live_bytes(kName, {.trigger_channels = {"main", "aux", "loopback"}}).value();
    const std::vector<uint8_t> kept = words_of(take_all(*source));
    ASSERT_EQ(kept.size(), unplug_at) << "trial " << trial;
    ASSERT_TRUE(std::equal(kept.begin(), kept.end(), words_.begin())) << "trial " << trial;
    ASSERT_NE(source->left_out().live.failure.find("the connection to the camera is lost (Error 101001"),
              std::string::npos)
        << source->left_out().live.failure;
  }
}

TEST_F(MetavisionCamera, AStreamThatEndsByItselfIsAFailure) {
  simulate("period_us=0;end_at=20000");
  const TestLog log;
  auto source = open_live_bytes(kName).value();
  take_all(*source);
  EXPECT_NE(source->left_out().live.failure.find("ended by itself"), std::string::npos);
}

TEST_F(MetavisionCamera, AStopDrainsWhatHadCome) {
  const TestLog log;
  for (int trial = 0; trial < 20; ++trial) {
    simulate("buffer=512;period_us=0;loop");
    request_stop(0);
    auto source = open_live_bytes(kName).value();
    while (stand_in::bytes_sent() < 512U * static_cast<unsigned>(trial)) std::this_thread::yield();
    const uint64_t sent = stand_in::bytes_sent();
    request_stop(SIGINT);
    const std::vector<uint8_t> kept = words_of(take_all(*source));
    EXPECT_GE(kept.size(), sent);
    EXPECT_EQ(kept.size(), stand_in::bytes_taken());
    EXPECT_EQ(source->left_out().live.failure, "");
  }
}

TEST_F(MetavisionCamera, ASlowReaderHasBoundedMemoryAndWhatIsDroppedIsCounted) {
  simulate("buffer=100000;period_us=2000;loop");
  const TestLog log;
  auto source = open_live_bytes(kName).value();
  uint64_t kept = 0;
  for (int i = 0; i < 3; ++i) {
    const uint64_t dropped = source->left_out().live.dropped_bytes;
    while (source->left_out().live.dropped_bytes < dropped + 1'000'000) std::this_thread::yield();
    const auto bytes = source->fetch(1).value();
    EXPECT_LE(bytes.size(), kMaxWaitingBytes + 200'000);
    kept += bytes.size();
    source->consume(bytes.size());
  }
  source->end_at(std::chrono::steady_clock::now());
  for (;;) {
    const size_t count = source->fetch(1).value().size();
    kept += count;
    source->consume(count);
    if (count == 0 && !source->pass_break()) break;
  }
  EXPECT_LE(stand_in::most_bytes_queued(), 120'000'000u) << "the HAL's own queue has no bound";
  const LiveBacklog live = source->left_out().live;
  EXPECT_GT(live.dropped_bytes, 0u);
  uint64_t in_gaps = 0;
  for (const LiveGap& gap : live.gaps) in_gaps += gap.dropped_bytes;
  EXPECT_EQ(in_gaps, live.dropped_bytes);
  EXPECT_EQ(live.gaps.size(), live.num_gaps);
  EXPECT_GT(live.gaps.front().byte, 0u);
  EXPECT_LE(live.gaps.back().byte, kept);
  EXPECT_GE(kept + source->left_out().live.dropped_bytes, stand_in::bytes_taken());
  EXPECT_LE(kept + source->left_out().live.dropped_bytes, stand_in::bytes_taken() + 4096) << "and a header";
}

}  // namespace
}  // namespace e2lf::cameras
