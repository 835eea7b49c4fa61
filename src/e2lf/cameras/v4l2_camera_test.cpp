// SPDX-License-Identifier: MIT
// Cameras of Linux drivers, with a driver that is simulated.
#include <algorithm>
#include <cerrno>
#include <deque>
#include <fstream>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <map>

#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/files/file.h"
#include "testing/test_log.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

constexpr uint32_t kBufferBytes = 4096, kPlaneOffset = 16;
constexpr uint32_t kEvt3 = v4l2_fourcc('P', 'S', 'E', '3'), kGrey = v4l2_fourcc('G', 'R', 'E', 'Y');

struct Frame {
  std::vector<uint8_t> bytes;
  uint32_t sequence = 0, flags = 0;
};

/// A driver with one device, whose buffers have one plane that begins at kPlaneOffset, or no planes.
class Driver final : public V4l2System {
 public:
  bool is_multi = false;
  std::vector<uint32_t> formats = {kEvt3};
  uint32_t format = kEvt3;
  std::map<unsigned long, int> failures;  ///< errno of a request
  int open_error = 0;
  std::deque<Frame> frames;
  bool is_unplugged_at_end = false;
  int open_count = 0, mapped = 0;

  int open(const std::string& path) override {
    errno = path.ends_with("video0") ? open_error : ENOENT;
    if (errno != 0) return -1;
    ++open_count;
    return 7;
  }
  int close(int) override { return --open_count, 0; }
  void* map(size_t length, int, off_t offset) override {
    EXPECT_EQ(length, kBufferBytes);
    ++mapped;
    return memory_[static_cast<size_t>(offset) / kBufferBytes].data();
  }
  void unmap(void*, size_t) override { --mapped; }
  int wait(int, int) override { return !frames.empty() ? 1 : is_unplugged_at_end ? -1 : 0; }

  int control(int, unsigned long request, void* argument) override {
    if (const auto found = failures.find(request); found != failures.end()) {
      errno = found->second;
      return -1;
    }
    errno = EINVAL;
    if (request == VIDIOC_QUERYCAP) return describe(*static_cast<v4l2_capability*>(argument));
    if (request == VIDIOC_ENUM_FMT) {
      auto& known = *static_cast<v4l2_fmtdesc*>(argument);
      if (known.index >= formats.size()) return -1;
      known.pixelformat = formats[known.index];
      return 0;
    }
    if (request == VIDIOC_G_FMT || request == VIDIOC_S_FMT) {
      return set_format(*static_cast<v4l2_format*>(argument), request == VIDIOC_S_FMT);
    }
    if (request == VIDIOC_REQBUFS) {
      static_cast<v4l2_requestbuffers*>(argument)->count = 4;
      memory_.assign(4, std::vector<uint8_t>(kBufferBytes, 0xEE));
      return 0;
    }
    if (request == VIDIOC_STREAMON || request == VIDIOC_STREAMOFF) return 0;
    return exchange(request, *static_cast<v4l2_buffer*>(argument));
  }

 private:
  int describe(v4l2_capability& capability) const {
    std::copy_n("sensor", 7, capability.card);
    std::copy_n("driver", 7, capability.driver);
    capability.capabilities = V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    capability.device_caps = V4L2_CAP_STREAMING | (is_multi ? V4L2_CAP_VIDEO_CAPTURE_MPLANE : V4L2_CAP_VIDEO_CAPTURE);
    return 0;
  }

  int set_format(v4l2_format& known, bool is_set) {
    EXPECT_EQ(known.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE, is_multi);
    if (is_multi) {
      if (is_set) format = known.fmt.pix_mp.pixelformat;
      known.fmt.pix_mp.pixelformat = format;
      known.fmt.pix_mp.width = 1280;
      known.fmt.pix_mp.height = 720;
      known.fmt.pix_mp.num_planes = 1;
    } else {
      if (is_set) format = known.fmt.pix.pixelformat;
      known.fmt.pix.pixelformat = format;
      known.fmt.pix.width = 1280;
      known.fmt.pix.height = 720;
    }
    return 0;
  }

  int exchange(unsigned long request, v4l2_buffer& buffer) {
    if (request == VIDIOC_QUERYBUF) {
      buffer.length = is_multi ? 1 : kBufferBytes;
      if (is_multi) buffer.m.planes[0].length = kBufferBytes;
      (is_multi ? buffer.m.planes[0].m.mem_offset : buffer.m.offset) = buffer.index * kBufferBytes;
      return 0;
    }
    if (request == VIDIOC_QBUF) return queued_.push_back(buffer.index), 0;
    EXPECT_EQ(request, static_cast<unsigned long>(VIDIOC_DQBUF));
    errno = is_unplugged_at_end && frames.empty() ? ENODEV : EAGAIN;
    if (frames.empty() || queued_.empty()) return -1;
    const Frame frame = frames.front();
    frames.pop_front();
    buffer.index = queued_.front();
    queued_.pop_front();
    buffer.sequence = frame.sequence;
    buffer.flags = frame.flags;
    const uint32_t begin = is_multi ? kPlaneOffset : 0, end = begin + static_cast<uint32_t>(frame.bytes.size());
    std::copy(frame.bytes.begin(), frame.bytes.end(), memory_[buffer.index].begin() + begin);
    if (is_multi) buffer.m.planes[0].data_offset = begin;
    (is_multi ? buffer.m.planes[0].bytesused : buffer.bytesused) = end;
    return 0;
  }

  std::vector<std::vector<uint8_t>> memory_;
  std::deque<uint32_t> queued_;
};

class V4l2 : public testing::Test {
 protected:
  V4l2() {
    stream_ = random_stream({.events = 3000, .width = 1280, .height = 720, .trigger_every = 100});
    const std::vector<uint8_t> bytes = encoded(stream_, "evt3", {.width = 1280, .height = 720});
    constexpr std::string_view kEnd = "% end\n";
    words_.assign(std::search(bytes.begin(), bytes.end(), kEnd.begin(), kEnd.end()) + kEnd.size(), bytes.end());
  }

  /// The words in frames of 1000 bytes.
  void fill(Driver& driver) const {
    for (size_t begin = 0; begin < words_.size(); begin += 1000) {
      const auto end = words_.begin() + static_cast<ptrdiff_t>(std::min(begin + 1000, words_.size()));
      driver.frames.push_back(
          {{words_.begin() + static_cast<ptrdiff_t>(begin), end}, static_cast<uint32_t>(driver.frames.size())});
    }
  }

  static Result<std::unique_ptr<LiveSource>> open(Driver& driver, const CameraSetup& setup = {}) {
    return start_camera_source(make_v4l2_camera(driver, "/dev", "video0"), "camera://v4l2", setup);
  }

  static std::string refusal(Driver& driver, const CameraSetup& setup = {}, const std::string& address = "video0") {
    const auto source = start_camera_source(make_v4l2_camera(driver, "/dev", address), "camera://v4l2", setup);
    return source.ok() ? "opened" : source.error().text();
  }

  EventBatch stream_;
  std::vector<uint8_t> words_;
};

TEST_F(V4l2, EventsComeFromBuffersWithPlanesAndWithout) {
  for (const bool is_multi : {false, true}) {
    const TestLog log;
    Driver driver;
    driver.is_multi = is_multi;
    driver.is_unplugged_at_end = true;
    fill(driver);
    auto source = open(driver).value();
    const auto reader = open_recording(SourcePtr(std::move(source))).value();
    EXPECT_EQ(reader->info().width, 1280u);
    EXPECT_EQ(reader->info().find("sensor_name"), "sensor");
    EXPECT_EQ(read_all(*reader).value(), stream_) << "what came before it was unplugged is kept";
    EXPECT_NE(reader->summary().live.failure.find("connection"), std::string::npos);
    EXPECT_EQ(reader->summary().live.num_gaps, 0u);
  }
}

TEST_F(V4l2, TheFormatSaysHowEventsAreEncoded) {
  const auto header_of = [](uint32_t format, const std::string& encoding) {
    Driver driver;
    driver.formats = {kGrey, v4l2_fourcc('P', 'S', 'E', 'E'), v4l2_fourcc('P', 'S', 'E', '1'),
                      v4l2_fourcc('P', 'S', 'E', '2'), kEvt3};
    driver.format = format;
    auto source = open(driver, {.encoding = encoding}).value();
    source->end_at({});
    const std::vector<uint8_t> bytes = read_rest(*source).value();
    return std::string(bytes.begin(), bytes.end());
  };
  const auto expect_header = [&](uint32_t format, const std::string& encoding, const std::string& line) {
    const std::string header = header_of(format, encoding);
    EXPECT_NE(header.find("\n% " + line), std::string::npos) << header;
  };
  expect_header(kEvt3, "", "evt 3.0\n");
  expect_header(v4l2_fourcc('P', 'S', 'E', 'E'), "", "evt 2.0\n");
  expect_header(v4l2_fourcc('P', 'S', 'E', '1'), "", "format EVT21;endianness=legacy;height=720;width=1280\n");
  expect_header(v4l2_fourcc('P', 'S', 'E', '2'), "", "format EVT21;height=720;width=1280\n");
  expect_header(v4l2_fourcc('P', 'S', 'E', '2'), "evt3", "evt 3.0\n");
  expect_header(kEvt3, "evt2.1", "evt 2.1\n");
  expect_header(kGrey, "evt3", "evt 3.0\n");
  expect_header(kGrey, "", "geometry 1280x720\n");
}

TEST_F(V4l2, WhatCannotBeOpenedSaysWhy) {
  const auto expect_said = [](const std::string& said, const auto& change, const CameraSetup& setup = {},
                              const std::string& address = "video0") {
    Driver driver;
    change(driver);
    const std::string text = refusal(driver, setup, address);
    EXPECT_NE(text.find(said), std::string::npos) << text;
    EXPECT_EQ(driver.open_count, 0) << said;
    EXPECT_EQ(driver.mapped, 0) << said;
  };
  const auto nothing = [](Driver&) {};
  expect_said("there is no such device", nothing, {}, "video9");
  expect_said("permissions forbid", [](Driver& driver) { driver.open_error = EACCES; });
  expect_said("is busy", [](Driver& driver) { driver.open_error = EBUSY; });
  for (const unsigned long request : {VIDIOC_REQBUFS, VIDIOC_STREAMON}) {
    expect_said("is busy", [request](Driver& driver) { driver.failures[request] = EBUSY; });
    expect_said("check the driver", [request](Driver& driver) { driver.failures[request] = ENOMEM; });
  }
  expect_said("not an event sensor: it does not stream",
              [](Driver& driver) { driver.failures[VIDIOC_QUERYCAP] = ENOTTY; });
  expect_said("not an event sensor: it sends GREY", [](Driver& driver) { driver.formats = {driver.format = kGrey}; });
  expect_said("cannot send evt2; it offers evt3", nothing, {.encoding = "evt2"});
  expect_said("v4l2-ctl", nothing, {.trigger_channels = {"main"}});
  expect_said("v4l2-ctl", nothing, {.max_events_per_s = 5});
}

TEST_F(V4l2, FramesAreCutWhereTheyEndAndWhatIsMissingIsCounted) {
  const TestLog log;
  Driver driver;
  driver.is_multi = true;
  driver.is_unplugged_at_end = true;
  const std::vector<uint8_t> two = {1, 2, 3, 4}, odd = {5, 6, 7};
  driver.frames = {{two, 10}, {odd, 11}, {{}, 12}, {two, 15}, {two, 16, V4L2_BUF_FLAG_ERROR}, {odd, 17}};
  auto source = open(driver).value();
  std::vector<uint8_t> bytes;
  do {
    const std::vector<uint8_t> part = read_rest(*source).value();
    bytes.insert(bytes.end(), part.begin(), part.end());
  } while (source->pass_break());
  const std::vector<uint8_t> expected = {1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6};
  ASSERT_GT(bytes.size(), expected.size());
  EXPECT_TRUE(std::equal(expected.rbegin(), expected.rend(), bytes.rbegin()));
  const LiveBacklog live = source->left_out().live;
  EXPECT_EQ(live.lost_buffers, 3u) << "two by their numbers, and a damaged one";
  const uint64_t header = bytes.size() - expected.size();
  EXPECT_EQ(live.gaps, (std::vector<LiveGap>{{header + 6, 0, 2}, {header + 10, 0, 1}}));
}

TEST_F(V4l2, AStopDrainsWhatHadCome) {
  const TestLog log;
  Driver driver;
  fill(driver);
  auto camera = make_v4l2_camera(driver, "/dev", "video0");
  ASSERT_TRUE(camera->start().ok());
  camera->stop();
  std::vector<uint8_t> bytes, all;
  while (camera->read(bytes).value()) all.insert(all.end(), bytes.begin(), bytes.end());
  EXPECT_TRUE(std::equal(words_.rbegin(), words_.rend(), all.rbegin()));
}

TEST_F(V4l2, TheListHasTheDevicesThatSendEvents) {
  const TestFolder folder;
  for (const char* const name : {"video0", "video1", "audio0"}) std::ofstream(folder / name) << "";
  Driver driver;
  driver.formats = {kGrey, kEvt3};
  EXPECT_EQ(find_v4l2_devices(driver, (folder / ".").string()), std::vector<std::string>{"video0"});
  driver.formats = {kGrey};
  EXPECT_TRUE(find_v4l2_devices(driver, (folder / ".").string()).empty());
  EXPECT_EQ(driver.open_count, 0);
  EXPECT_TRUE(find_v4l2_devices(driver, "/nowhere").empty());
}

}  // namespace
}  // namespace e2lf::recordings
