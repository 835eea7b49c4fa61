// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <linux/videodev2.h>
#include <poll.h>
#include <span>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
#include "e2lf/recordings/stream_choice.h"

namespace e2lf::recordings {
namespace fs = std::filesystem;
namespace {

/// The encoding of events that a format of a V4L2 device denotes.
struct V4l2Encoding {
  uint32_t fourcc;
  RawEncoding raw;         ///< raw.codec as in CameraSetup::encoding
  const char* endianness;  ///< the rest of the key `format` of a RAW header
  size_t word_bytes;
};

/// The content of a buffer.
struct V4l2Frame {
  std::vector<uint8_t> bytes;  ///< whole words
  uint64_t lost = 0;           ///< number of frames that the driver lost before it, including itself if it was damaged
};

constexpr uint32_t kBuffers = 32;

constexpr std::array<V4l2Encoding, 4> kV4l2Encodings = {{
    {v4l2_fourcc('P', 'S', 'E', 'E'), kRawEncodings[0], "", 4},
    {v4l2_fourcc('P', 'S', 'E', '1'), kRawEncodings[1], ";endianness=legacy", 8},
    {v4l2_fourcc('P', 'S', 'E', '2'), kRawEncodings[1], "", 8},
    {v4l2_fourcc('P', 'S', 'E', '3'), kRawEncodings[2], "", 2},
}};

const V4l2Encoding* encoding_of(uint32_t fourcc) {
  const auto found = std::find_if(kV4l2Encodings.begin(), kV4l2Encodings.end(),
                                  [fourcc](const V4l2Encoding& one) { return one.fourcc == fourcc; });
  return found == kV4l2Encodings.end() ? nullptr : &*found;
}

std::string fourcc_text(uint32_t fourcc) {
  std::string text;
  for (int byte = 0; byte < 4; ++byte) text += static_cast<char>(fourcc >> (8 * byte) & 0x7FU);
  return one_line(text);
}

bool has_planes(uint32_t type) {
  return type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

/// Returns the text in a field of the kernel, which need not end with a zero.
template <size_t size>
std::string field_text(const __u8 (&field)[size]) {
  return one_line(std::string(std::begin(field), std::find(std::begin(field), std::end(field), 0)));
}

/// Returns the type of the buffers of a streaming device, or nothing for other devices.
uint32_t buffer_type(const v4l2_capability& capability) {
  const uint32_t can =
      (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((can & V4L2_CAP_STREAMING) == 0) return 0;
  if ((can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0) return V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  return (can & V4L2_CAP_VIDEO_CAPTURE) != 0 ? V4L2_BUF_TYPE_VIDEO_CAPTURE : 0;
}

/// Returns the encodings that a device offers.
std::vector<const V4l2Encoding*> offered_encodings(V4l2System& system, int descriptor, uint32_t type) {
  constexpr uint32_t kMostFormats = 64;
  std::vector<const V4l2Encoding*> found;
  for (uint32_t index = 0; index < kMostFormats; ++index) {
    v4l2_fmtdesc format{};
    format.index = index;
    format.type = type;
    if (system.control(descriptor, VIDIOC_ENUM_FMT, &format) < 0) break;
    if (const V4l2Encoding* const encoding = encoding_of(format.pixelformat)) found.push_back(encoding);
  }
  return found;
}

/// A buffer of the driver with memory for the description of its planes.
struct BufferOfDriver {
  BufferOfDriver(uint32_t type, uint32_t index, uint32_t num_planes) {
    buffer.type = type;
    buffer.index = index;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (!has_planes(type)) return;
    buffer.m.planes = planes.data();
    buffer.length = num_planes;
  }
  v4l2_buffer buffer{};
  std::array<v4l2_plane, VIDEO_MAX_PLANES> planes{};
};

/// An open event sensor behind a Linux driver, which streams into memory that is shared with the driver.
class V4l2Device {
 public:
  /// Opens a device and selects its encoding ("evt2", "evt2.1", "evt3"; empty = the current one, if it encodes events).
  /// Fails with kNotFound (no such device), kIo (busy, or permission denied) and kUnsupported (not an event sensor, or
  /// the encoding is not available).
  static Result<std::unique_ptr<V4l2Device>> open(V4l2System& system, const std::string& path,
                                                  const std::string& encoding) {
    const int descriptor = system.open(path);
    if (descriptor < 0) {
      const int reason = errno;
      if (reason == EACCES || reason == EPERM) {
        return Error{ErrorCode::kIo,
                     "its permissions forbid opening the camera; add your user to the group of the device, usually "
                     "\"video\", and log in again",
                     path};
      }
      if (reason == EBUSY) {
        return Error{ErrorCode::kIo, "the camera is busy: another program uses it; end that program first", path};
      }
      return Error{
          ErrorCode::kNotFound,
          cat("there is no such device (", std::strerror(reason), "); e2lf camera list names those that send events"),
          path};
    }
    std::unique_ptr<V4l2Device> device(new V4l2Device(system, path, descriptor));
    E2LF_RETURN_IF_ERROR(device->identify());
    E2LF_RETURN_IF_ERROR(device->select_encoding(encoding));
    return device;
  }

  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;
  ~V4l2Device() {
    if (is_started_) static_cast<void>(control(VIDIOC_STREAMOFF, &type_));
    for (const auto memory : memory_) system_.unmap(const_cast<uint8_t*>(memory.data()), memory.size());
    system_.close(descriptor_);  // also returns the buffers
  }

  [[nodiscard]] const V4l2Encoding& encoding() const { return *encoding_; }
  [[nodiscard]] const std::string& card() const { return card_; }
  [[nodiscard]] const std::string& driver() const { return driver_; }
  [[nodiscard]] uint32_t width() const { return width_; }
  [[nodiscard]] uint32_t height() const { return height_; }

  /// Shares buffers with the driver and starts it. Fails with kIo, also if another program uses it.
  Result<void> start() {
    v4l2_requestbuffers request{};
    request.count = kBuffers;
    request.type = type_;
    request.memory = V4L2_MEMORY_MMAP;
    if (control(VIDIOC_REQBUFS, &request) < 0) return failure("the driver has no memory for buffers");
    for (uint32_t index = 0; index < std::min(request.count, kBuffers); ++index) {
      E2LF_RETURN_IF_ERROR(map_buffer(index));
    }
    if (control(VIDIOC_STREAMON, &type_) < 0) return failure("the camera cannot be started");
    is_started_ = true;
    return {};
  }

  /// Waits up to `timeout_ms` for a buffer. Returns false if none arrived. Fails with kIo if the device was removed.
  Result<bool> read(int timeout_ms, V4l2Frame& frame) {
    const int ready = system_.wait(descriptor_, timeout_ms);
    if (ready == 0) return false;
    // A removed device may still have full buffers.
    BufferOfDriver filled(type_, 0, planes_);
    if (control(VIDIOC_DQBUF, &filled.buffer) < 0) {
      if (errno == EAGAIN && ready > 0) return false;
      if (errno == EAGAIN) errno = EIO;
      return Error{ErrorCode::kIo,
                   cat("the connection to the camera is lost (", std::strerror(errno), "); check its cable"), path_};
    }
    const v4l2_buffer& buffer = filled.buffer;
    if (buffer.index >= memory_.size() / planes_) {
      return Error{ErrorCode::kIo, cat("the driver returned a buffer that does not exist (", buffer.index, ")"), path_};
    }
    frame.bytes.clear();
    frame.lost = has_sequence_ ? buffer.sequence - sequence_ : 0;
    sequence_ = buffer.sequence + 1;
    has_sequence_ = true;
    if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0) {
      ++frame.lost;
    } else if (has_planes(type_)) {
      for (uint32_t plane = 0; plane < planes_; ++plane) {
        const v4l2_plane& one = filled.planes[plane];
        append(buffer.index * planes_ + plane, one.data_offset, one.bytesused, frame.bytes);
      }
    } else {
      append(buffer.index, 0, buffer.bytesused, frame.bytes);
    }
    // An incomplete word at the end of a frame would shift all words of the next one.
    frame.bytes.resize(frame.bytes.size() / encoding_->word_bytes * encoding_->word_bytes);
    if (control(VIDIOC_QBUF, &filled.buffer) < 0) return failure("the driver does not accept its buffer again");
    return true;
  }

 private:
  V4l2Device(V4l2System& system, std::string path, int descriptor)
      : system_(system), path_(std::move(path)), descriptor_(descriptor) {}

  int control(unsigned long request, void* argument) const { return system_.control(descriptor_, request, argument); }

  Error failure(const std::string& what) const {
    const int reason = errno;
    if (reason == EBUSY) {
      return {ErrorCode::kIo, "the camera is busy: another program uses it; end that program first", path_};
    }
    return {ErrorCode::kIo, cat(what, " (", std::strerror(reason), "); check the driver of the camera"), path_};
  }

  Result<void> identify() {
    v4l2_capability capability{};
    if (control(VIDIOC_QUERYCAP, &capability) == 0) type_ = buffer_type(capability);
    if (type_ == 0) {
      return Error{ErrorCode::kUnsupported, "the device is not an event sensor: it does not stream video", path_};
    }
    card_ = field_text(capability.card);
    driver_ = field_text(capability.driver);
    return {};
  }

  Result<void> select_encoding(const std::string& name) {
    v4l2_format format{};
    format.type = type_;
    if (control(VIDIOC_G_FMT, &format) < 0) return failure("the device does not state its format");
    const auto fourcc = [this, &format]() -> uint32_t {
      return has_planes(type_) ? format.fmt.pix_mp.pixelformat : format.fmt.pix.pixelformat;
    };
    encoding_ = encoding_of(fourcc());
    if (encoding_ == nullptr || (!name.empty() && encoding_->raw.codec != name)) {
      const std::vector<const V4l2Encoding*> offered = offered_encodings(system_, descriptor_, type_);
      if (offered.empty() && encoding_ == nullptr) {
        return Error{ErrorCode::kUnsupported,
                     cat("the device is not an event sensor: it sends ", fourcc_text(fourcc()),
                         ", and events are PSEE, PSE1, PSE2 or PSE3"),
                     path_};
      }
      const auto wanted = std::find_if(offered.begin(), offered.end(),
                                       [&](const auto* one) { return name.empty() || one->raw.codec == name; });
      if (wanted != offered.end()) {
        if (has_planes(type_)) format.fmt.pix_mp.pixelformat = (*wanted)->fourcc;
        if (!has_planes(type_)) format.fmt.pix.pixelformat = (*wanted)->fourcc;
        if (control(VIDIOC_S_FMT, &format) < 0) return failure("the device keeps its encoding");
      }
      if (wanted == offered.end() || fourcc() != (*wanted)->fourcc) {
        std::vector<std::string> names;
        for (const V4l2Encoding* const one : offered) names.emplace_back(one->raw.codec);
        return Error{ErrorCode::kUnsupported,
                     cat("the device cannot send ", name.empty() ? "events" : name, "; it offers ", join(names)),
                     path_};
      }
      encoding_ = *wanted;
    }
    const bool is_multi = has_planes(type_);
    width_ = is_multi ? format.fmt.pix_mp.width : format.fmt.pix.width;
    height_ = is_multi ? format.fmt.pix_mp.height : format.fmt.pix.height;
    planes_ = is_multi ? std::clamp<uint32_t>(format.fmt.pix_mp.num_planes, 1, VIDEO_MAX_PLANES) : 1;
    return {};
  }

  Result<void> map_buffer(uint32_t index) {
    BufferOfDriver of_driver(type_, index, planes_);
    if (control(VIDIOC_QUERYBUF, &of_driver.buffer) < 0) return failure("the driver has no memory for buffers");
    for (uint32_t plane = 0; plane < planes_; ++plane) {
      const v4l2_plane& one = of_driver.planes[plane];
      const size_t length = has_planes(type_) ? one.length : of_driver.buffer.length;
      const off_t offset = has_planes(type_) ? one.m.mem_offset : of_driver.buffer.m.offset;
      void* const memory = system_.map(length, descriptor_, offset);
      if (memory == nullptr) return failure("the memory of the driver cannot be shared");
      memory_.emplace_back(static_cast<const uint8_t*>(memory), length);
    }
    if (control(VIDIOC_QBUF, &of_driver.buffer) < 0) return failure("the driver does not accept buffers");
    return {};
  }

  void append(size_t memory, uint32_t offset, uint32_t used, std::vector<uint8_t>& bytes) const {
    const auto part = memory_[memory].first(std::min<size_t>(used, memory_[memory].size()));
    bytes.insert(bytes.end(), part.begin() + static_cast<ptrdiff_t>(std::min<size_t>(offset, part.size())), part.end());
  }

  V4l2System& system_;
  std::string path_, card_, driver_;
  int descriptor_;
  uint32_t type_ = 0;  ///< type of its buffers: with one plane, or with several
  uint32_t width_ = 0, height_ = 0, planes_ = 1;
  const V4l2Encoding* encoding_ = nullptr;
  std::vector<std::span<const uint8_t>> memory_;  ///< [buffer, plane]
  bool is_started_ = false;
  bool has_sequence_ = false;
  uint32_t sequence_ = 0;  ///< expected number of the next frame
};

constexpr char kDeviceFolder[] = "/dev";

V4l2System& kernel() {
  static V4l2System system;
  return system;
}

class V4l2Camera final : public Camera {
 public:
  V4l2Camera(V4l2System& system, std::string folder, std::string address)
      : system_(system), folder_(std::move(folder)), address_(std::move(address)) {}

  Result<void> set_up(const CameraSetup& setup) override {
    encoding_ = setup.encoding;
    CameraSetup others = setup;
    others.encoding.clear();
    if (!has_settings(others)) return {};
    return Error{ErrorCode::kUnsupported,
                 "the drivers of Linux have no common settings for trigger inputs, biases, event rate and regions; "
                 "leave the options out, and set the controls of the sensor with v4l2-ctl",
                 name()};
  }

  Result<void> start() override {
    E2LF_ASSIGN_OR_RETURN(const std::string path, device_path());
    E2LF_ASSIGN_OR_RETURN(device_, V4l2Device::open(system_, path, encoding_));
    E2LF_RETURN_IF_ERROR(device_->start());
    const V4l2Encoding& encoding = device_->encoding();
    const std::string size = cat(device_->width(), "x", device_->height());
    header_ = camera_header({{"evt", encoding.raw.version},
                             {"format", cat(encoding.raw.format, encoding.endianness, ";height=", device_->height(),
                                            ";width=", device_->width())},
                             {"geometry", size},
                             {"plugin_name", "v4l2"},
                             {"sensor_name", device_->card()},
                             {"driver", device_->driver()}});
    return {};
  }

  Result<bool> read(std::vector<uint8_t>& bytes) override {
    bytes.assign(header_.begin(), header_.end());
    header_.clear();
    frame_.lost = 0;
    uint64_t lost = 0;
    while (bytes.empty()) {
      const bool is_stopped = is_stopped_;
      if (is_stopped && Clock::now() > stop_time_.load() + kLongestDrain) return false;
      E2LF_ASSIGN_OR_RETURN(const bool came, device_->read(is_stopped ? 0 : kPollMs, frame_));
      if (!came && is_stopped) return false;
      if (!came) continue;
      lost += frame_.lost;
      bytes.swap(frame_.bytes);
    }
    frame_.lost = lost;
    return true;
  }

  uint64_t lost_buffers() override { return frame_.lost; }

  void stop() override {
    stop_time_ = Clock::now();
    is_stopped_ = true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int kPollMs = 100;                             // longest delay of a stop
  static constexpr auto kLongestDrain = std::chrono::seconds(1);  ///< because a camera continues to send

  [[nodiscard]] std::string name() const { return cat("camera://v4l2", address_.empty() ? "" : "/", address_); }

  [[nodiscard]] Result<std::string> device_path() const {
    if (address_.starts_with('/')) return address_;
    if (!address_.empty()) return cat(folder_, "/", address_);
    const std::vector<std::string> found = find_v4l2_devices(system_, folder_);
    if (found.empty()) {
      return Error{ErrorCode::kNotFound,
                   cat("no device in ", folder_, " sends events; load the driver of the sensor, or give its device"),
                   name()};
    }
    return cat(folder_, "/", found.front());
  }

  V4l2System& system_;
  std::string folder_, address_, encoding_, header_;
  std::unique_ptr<V4l2Device> device_;
  V4l2Frame frame_;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<Clock::time_point> stop_time_;
};

}  // namespace

int V4l2System::open(const std::string& path) {
  return ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
}

int V4l2System::close(int descriptor) {
  return ::close(descriptor);
}

int V4l2System::control(int descriptor, unsigned long request, void* argument) {
  int result = 0;
  do result = ::ioctl(descriptor, request, argument);
  while (result < 0 && errno == EINTR);
  return result;
}

void* V4l2System::map(size_t length, int descriptor, off_t offset) {
  void* const memory = ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, offset);
  return memory == MAP_FAILED ? nullptr : memory;
}

void V4l2System::unmap(void* memory, size_t length) {
  ::munmap(memory, length);
}

int V4l2System::wait(int descriptor, int timeout_ms) {
  pollfd waiting = {descriptor, POLLIN, 0};
  const int ready = ::poll(&waiting, 1, timeout_ms);
  if (ready == 0 || (ready < 0 && errno == EINTR)) return 0;
  return ready > 0 && (waiting.revents & POLLIN) != 0 ? 1 : -1;
}

std::vector<std::string> find_v4l2_devices(V4l2System& system, const std::string& folder) {
  std::vector<std::string> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with("video")) continue;
    const int descriptor = system.open(entry->path().string());
    if (descriptor < 0) continue;
    v4l2_capability capability{};
    const uint32_t type = system.control(descriptor, VIDIOC_QUERYCAP, &capability) < 0 ? 0 : buffer_type(capability);
    if (type != 0 && !offered_encodings(system, descriptor, type).empty()) found.push_back(name);
    system.close(descriptor);
  }
  std::sort(found.begin(), found.end());
  return found;
}

CameraPtr make_v4l2_camera(V4l2System& system, const std::string& folder, const std::string& address) {
  return std::make_unique<V4l2Camera>(system, folder, address);
}

Result<CameraPtr> open_v4l2_camera(const std::string& address) {
  return make_v4l2_camera(kernel(), kDeviceFolder, address);
}

Result<std::vector<std::string>> list_v4l2_cameras() {
  return find_v4l2_devices(kernel(), kDeviceFolder);
}

}  // namespace e2lf::recordings
