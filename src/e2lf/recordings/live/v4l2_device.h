// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <sys/types.h>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"

namespace e2lf::recordings {

/// The system calls of a V4L2 camera, which tests replace. Like those of the C library, they return -1 and set errno on
/// failure.
class V4l2System {
 public:
  virtual ~V4l2System() = default;
  virtual int open(const std::string& path);
  virtual int close(int descriptor);
  virtual int control(int descriptor, unsigned long request, void* argument);  ///< ioctl()
  virtual void* map(size_t length, int descriptor, off_t offset);              ///< null on failure
  virtual void unmap(void* memory, size_t length);
  /// Waits for data. Returns 1 if they can be read, 0 after the timeout, and -1 if the device failed.
  virtual int wait(int descriptor, int timeout_ms);
};

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

/// An open event sensor behind a Linux driver, which streams into memory that is shared with the driver.
class V4l2Device {
 public:
  /// Opens a device and selects its encoding ("evt2", "evt2.1", "evt3"; empty = the current one, if it encodes events).
  /// Fails with kNotFound (no such device), kIo (busy, or permission denied) and kUnsupported (not an event sensor, or
  /// the encoding is not available).
  [[nodiscard]] static Result<V4l2Device> open(V4l2System& system, const std::string& path,
                                               const std::string& encoding);
  V4l2Device(V4l2Device&& other) noexcept;
  V4l2Device& operator=(V4l2Device&& other) = delete;
  ~V4l2Device();

  [[nodiscard]] const V4l2Encoding& encoding() const { return *encoding_; }
  [[nodiscard]] const std::string& card() const { return card_; }
  [[nodiscard]] const std::string& driver() const { return driver_; }
  [[nodiscard]] uint32_t width() const { return width_; }
  [[nodiscard]] uint32_t height() const { return height_; }

  /// Shares buffers with the driver and starts it. Fails with kIo, also if another program uses it.
  [[nodiscard]] Result<void> start();

  /// Waits up to `timeout_ms` for a buffer. Returns false if none arrived. Fails with kIo if the device was removed.
  [[nodiscard]] Result<bool> read(int timeout_ms, V4l2Frame& frame);

 private:
  struct Memory {
    const uint8_t* bytes;
    size_t length;
  };

  V4l2Device(V4l2System& system, std::string path, int descriptor)
      : system_(system), path_(std::move(path)), descriptor_(descriptor) {}
  [[nodiscard]] int control(unsigned long request, void* argument) const;
  [[nodiscard]] Error failure(const std::string& what) const;
  [[nodiscard]] Result<void> identify();
  [[nodiscard]] Result<void> select_encoding(const std::string& name);
  [[nodiscard]] Result<void> map_buffer(uint32_t index);
  void append(size_t memory, uint32_t offset, uint32_t used, std::vector<uint8_t>& bytes) const;

  V4l2System& system_;
  std::string path_, card_, driver_;
  int descriptor_;
  uint32_t type_ = 0;  ///< type of its buffers: with one plane, or with several
  uint32_t width_ = 0, height_ = 0, planes_ = 1;
  const V4l2Encoding* encoding_ = nullptr;
  std::vector<Memory> memory_;  ///< [buffer, plane]
  bool is_started_ = false;
  bool has_sequence_ = false;
  uint32_t sequence_ = 0;  ///< expected number of the next frame
};

/// Returns the devices of a folder that send events, by their file names ("video0").
[[nodiscard]] std::vector<std::string> find_v4l2_devices(V4l2System& system, const std::string& folder);

}  // namespace e2lf::recordings
