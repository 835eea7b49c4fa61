// custom_camera RECORDING.raw
// Adds a live camera and divides its events into pattern cycles as they arrive. This camera sends the bytes of a RAW
// recording; a real one would receive them from its driver.
#include <atomic>
#include <cstdio>
#include <e2lf/cycles/cycle_reader.h>
#include <e2lf/recordings/live/camera.h>
#include <e2lf/recordings/open/registry.h>
#include <fstream>

namespace {

using namespace e2lf;

class FileCamera final : public recordings::Camera {
 public:
  explicit FileCamera(const std::string& path) : file_(path, std::ios::binary) {}

  Result<void> start() override {
    if (!file_) return Error{ErrorCode::kIo, "cannot open the camera's file; check the path", ""};
    return {};
  }

  Result<bool> read(std::vector<uint8_t>& bytes) override {
    bytes.resize(4096);
    file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<size_t>(file_.gcount()));
    return !bytes.empty() && !stopped_;
  }

  void stop() override { stopped_ = true; }

 private:
  std::ifstream file_;
  std::atomic<bool> stopped_ = false;
};

Result<std::unique_ptr<recordings::Camera>> open_file_camera(const std::string& address) {
  return std::unique_ptr<recordings::Camera>(std::make_unique<FileCamera>(address));
}

Result<size_t> count_cycles(const std::string& camera) {
  E2LF_ASSIGN_OR_RETURN(auto reader, recordings::open_named_recording(camera));
  E2LF_ASSIGN_OR_RETURN(auto cycles, cycles::CycleReader::open(std::move(reader), {}));
  size_t count = 0;
  for (;; ++count) {
    E2LF_ASSIGN_OR_RETURN(const auto cycle, cycles.next());
    if (!cycle) return count;
    std::printf("cycle %zu: %zu event images of %zux%zu px\n", count, cycle->images.count, cycle->images.width,
                cycle->images.height);
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  recordings::add_camera_plugin({"mine", "the bytes of a file", open_file_camera});
  const auto cycles = count_cycles(std::string("camera://mine/") + arguments[1]);
  if (!cycles) {
    std::fprintf(stderr, "%s\n", cycles.error().text().c_str());
    return 1;
  }
  std::printf("%zu cycles\n", *cycles);
  return 0;
}
