// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/byte_sink.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <unistd.h>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"

namespace e2lf::recordings {
namespace {

Error write_error(const std::string& name, int error_number) {
  const char* remedy = error_number == ENOSPC ? "free some disk space" : "check the path and its permissions";
  return {ErrorCode::kIo, cat("cannot write (", std::strerror(error_number), "); ", remedy), name};
}

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
  DescriptorSink(const DescriptorSink&) = delete;
  DescriptorSink& operator=(const DescriptorSink&) = delete;
  ~DescriptorSink() override {
    if (owned_ && descriptor_ >= 0) ::close(descriptor_);
  }

  Result<void> write(std::span<const uint8_t> bytes) override {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0) {
        if (errno == EINTR) continue;
        return write_error(name_, errno);
      }
      bytes = bytes.subspan(static_cast<size_t>(written));
    }
    return {};
  }
  Result<void> commit() override {
    if (!file_) return {};
    const int descriptor = std::exchange(descriptor_, -1);
    if (::close(descriptor) != 0) return write_error(name_, errno);
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

Result<SinkPtr> open_file_sink(const std::filesystem::path& path) {
  if (path == "-") return make_descriptor_sink(STDOUT_FILENO, /*owned=*/false, "stdout");
  if (is_stream(path)) {
    E2LF_ASSIGN_OR_RETURN(const int stream, open_stream(path));
    return make_descriptor_sink(stream, /*owned=*/true, path.string());
  }
  E2LF_ASSIGN_OR_RETURN(AtomicFile file, AtomicFile::create(path));
  const int descriptor = ::open(file.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) return write_error(path.string(), errno);
  return SinkPtr(std::make_unique<DescriptorSink>(descriptor, /*owned=*/true, path.string(), std::move(file)));
}

SinkPtr make_memory_sink(std::vector<uint8_t>& bytes) {
  return std::make_unique<MemorySink>(bytes);
}

SinkPtr make_descriptor_sink(int descriptor, bool owned, std::string name) {
  return std::make_unique<DescriptorSink>(descriptor, owned, std::move(name), std::nullopt);
}

}  // namespace e2lf::recordings
