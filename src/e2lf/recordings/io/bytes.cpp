// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/bytes.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"

namespace e2lf::recordings {
namespace {

/// Small enough to stay in the second-level cache while it is decoded.
constexpr size_t kReadBytes = size_t{1} << 18;

class MemorySource final : public ByteSource {
 public:
  MemorySource(std::span<const uint8_t> bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
  MemorySource(std::vector<uint8_t>&& bytes, std::string name)
      : owned_(std::move(bytes)), bytes_(owned_), name_(std::move(name)) {}

  Result<std::span<const uint8_t>> fetch(size_t) override { return bytes_.subspan(position_); }
  void consume(size_t count) override {
    E2LF_REQUIRE(count <= bytes_.size() - position_, "more consumed than fetched");
    position_ += count;
  }
  uint64_t position() const override { return position_; }
  Result<void> seek(uint64_t position) override {
    position_ = static_cast<size_t>(std::min<uint64_t>(position, bytes_.size()));
    return {};
  }
  bool seekable() const override { return true; }
  std::optional<uint64_t> size() const override { return bytes_.size(); }
  std::string name() const override { return name_; }

 private:
  std::vector<uint8_t> owned_;
  std::span<const uint8_t> bytes_;
  size_t position_ = 0;
  std::string name_;
};

class DescriptorSource final : public ByteSource {
 public:
  DescriptorSource(int descriptor, bool owned, std::string name, std::filesystem::path path)
      : descriptor_(descriptor), owned_(owned), name_(std::move(name)), path_(std::move(path)) {
    struct stat info {};
    regular_ = ::fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode);
  }
  DescriptorSource(const DescriptorSource&) = delete;
  DescriptorSource& operator=(const DescriptorSource&) = delete;
  ~DescriptorSource() override {
    if (owned_) ::close(descriptor_);
  }

  Result<std::span<const uint8_t>> fetch(size_t wanted) override {
    while (end_ - begin_ < wanted && !ended_) E2LF_RETURN_IF_ERROR(read_more(wanted));
    return std::span<const uint8_t>(buffer_).subspan(begin_, end_ - begin_);
  }
  void consume(size_t count) override {
    E2LF_REQUIRE(count <= end_ - begin_, "more consumed than fetched");
    begin_ += count;
    position_ += count;
  }
  uint64_t position() const override { return position_; }
  Result<void> seek(uint64_t position) override {
    if (!regular_ || ::lseek(descriptor_, static_cast<off_t>(position), SEEK_SET) < 0) {
      return fail(ErrorCode::kUnsupported, name_, "a stream is not seekable; record it to a file first");
    }
    position_ = position;
    begin_ = end_ = 0;
    ended_ = false;
    return {};
  }
  bool seekable() const override { return regular_; }
  std::optional<uint64_t> size() const override {
    struct stat info {};
    if (!regular_ || ::fstat(descriptor_, &info) != 0) return std::nullopt;
    return static_cast<uint64_t>(info.st_size);
  }
  std::string name() const override { return name_; }
  std::filesystem::path path() const override { return path_; }

 private:
  Result<void> read_more(size_t wanted) {
    std::copy(buffer_.begin() + static_cast<ptrdiff_t>(begin_), buffer_.begin() + static_cast<ptrdiff_t>(end_),
              buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
    // Grows in steps, because `wanted` may exceed the content.
    const size_t room = std::max(kReadBytes, std::min(wanted, 2 * end_));
    if (buffer_.size() < end_ + room) buffer_.resize(end_ + room);
    if (!regular_ && !wait_for_bytes()) {
      ended_ = true;
      return {};
    }
    const ssize_t count = ::read(descriptor_, buffer_.data() + end_, buffer_.size() - end_);
    if (count < 0) {
      if (errno == EINTR) return {};
      return fail_to("read", name_, errno);
    }
    ended_ = count == 0;
    end_ += static_cast<size_t>(count);
    return {};
  }

  /// Waits until a pipe has bytes or ends; returns false if a stop is requested before.
  [[nodiscard]] bool wait_for_bytes() const {
    constexpr int kNapMs = 100;
    while (!stop_requested()) {
      pollfd waiting = {descriptor_, POLLIN, 0};
      const int ready = ::poll(&waiting, 1, kNapMs);
      if (ready > 0 || (ready < 0 && errno != EINTR)) return true;
    }
    return false;
  }

  int descriptor_;
  bool owned_;
  bool regular_ = false;
  std::string name_;
  std::filesystem::path path_;
  std::vector<uint8_t> buffer_;
  size_t begin_ = 0;
  size_t end_ = 0;
  uint64_t position_ = 0;
  bool ended_ = false;
};

class MemorySink final : public ByteSink {
 public:
  explicit MemorySink(std::vector<uint8_t>& bytes) : bytes_(bytes) {}
  Result<void> write(std::span<const uint8_t> bytes) override {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return {};
  }
  Result<void> commit() override { return {}; }
  std::string name() const override { return "memory"; }

 private:
  std::vector<uint8_t>& bytes_;
};

/// A sink for a descriptor. If a file belongs to it, commit() moves it to its path.
class DescriptorSink final : public ByteSink {
 public:
  DescriptorSink(int descriptor, bool owned, std::string name, std::optional<AtomicFile> file)
      : descriptor_(descriptor), owned_(owned), name_(std::move(name)), file_(std::move(file)) {}
  ~DescriptorSink() override {
    if (owned_ && descriptor_ >= 0) ::close(descriptor_);
  }

  Result<void> write(std::span<const uint8_t> bytes) override { return write_all(descriptor_, name_, bytes); }
  Result<void> commit() override {
    if (!file_) return {};
    const int descriptor = std::exchange(descriptor_, -1);
    if (::close(descriptor) != 0) return fail_to("write", name_, errno);
    return file_->commit();
  }
  std::string name() const override { return name_; }

 private:
  int descriptor_;
  bool owned_;
  std::string name_;
  std::optional<AtomicFile> file_;
};

}  // namespace

Result<SourcePtr> open_file_source(const std::filesystem::path& path) {
  if (path == "-") return make_descriptor_source(STDIN_FILENO, /*owned=*/false, "stdin");
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return fail_to("open", path, errno);
  SourcePtr source = std::make_unique<DescriptorSource>(descriptor, /*owned=*/true, path.string(), path);
  struct stat info {};
  if (::fstat(descriptor, &info) == 0 && S_ISDIR(info.st_mode)) return fail_to("read", path, EISDIR);
  return source;
}

SourcePtr make_memory_source(std::span<const uint8_t> bytes, std::string name) {
  return std::make_unique<MemorySource>(bytes, std::move(name));
}

SourcePtr make_memory_source(std::vector<uint8_t>&& bytes, std::string name) {
  return std::make_unique<MemorySource>(std::move(bytes), std::move(name));
}

SourcePtr make_descriptor_source(int descriptor, bool owned, std::string name) {
  return std::make_unique<DescriptorSource>(descriptor, owned, std::move(name), std::filesystem::path());
}

Result<std::vector<uint8_t>> read_rest(ByteSource& source, size_t limit) {
  std::vector<uint8_t> bytes;
  bytes.reserve(std::min<uint64_t>(source.size().value_or(0), limit));  // growing would need twice the memory
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> part, source.fetch(1));
    if (part.empty()) return bytes;
    if (part.size() > limit - bytes.size()) {
      return fail(ErrorCode::kUnsupported, source.name(), "larger than the ", limit,
                  " bytes that can be read of this format; split it");
    }
    bytes.insert(bytes.end(), part.begin(), part.end());
    source.consume(part.size());
  }
}

Result<SinkPtr> open_file_sink(const std::filesystem::path& path) {
  if (path == "-") return make_descriptor_sink(STDOUT_FILENO, /*owned=*/false, "stdout");
  if (is_stream(path)) {
    E2LF_ASSIGN_OR_RETURN(const int stream, open_stream(path));
    return make_descriptor_sink(stream, /*owned=*/true, path.string());
  }
  E2LF_ASSIGN_OR_RETURN(AtomicFile file, AtomicFile::create(path));
  const int descriptor = ::open(file.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) return fail_to("write", path, errno);
  return SinkPtr(std::make_unique<DescriptorSink>(descriptor, /*owned=*/true, path.string(), std::move(file)));
}

SinkPtr make_memory_sink(std::vector<uint8_t>& bytes) {
  return std::make_unique<MemorySink>(bytes);
}

SinkPtr make_descriptor_sink(int descriptor, bool owned, std::string name) {
  return std::make_unique<DescriptorSink>(descriptor, owned, std::move(name), std::nullopt);
}

}  // namespace e2lf::recordings
