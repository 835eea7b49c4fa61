// A camera plugin: a shared library that e2lf loads at run time, without a new build.
//   c++ -std=c++17 -shared -fPIC -I PREFIX/include examples/camera_plugin.cpp -o edge.so
//   E2LF_CAMERA_PLUGINS=$PWD/edge.so e2lf camera list
// The camera generates events of a bright edge that moves to the right over 64x48 px, and a trigger every 10 ms.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <e2lf/recordings/live/camera_plugin.h>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr int kWidth = 64, kHeight = 48;
constexpr int64_t kBufferUs = 1000, kTriggerUs = 10'000, kUnplugUs = 500'000;

int fail(char* error, const std::string& text) {
  std::snprintf(error, E2LF_CAMERA_ERROR_SIZE, "%s", text.c_str());
  return -1;
}

/// Appends a word of EVT3: a type of 4 bits and 12 bits of data, little-endian.
void put(std::vector<uint8_t>& bytes, unsigned kind, int64_t data) {
  const unsigned word = kind << 12U | (static_cast<unsigned>(data) & 0xFFFU);
  bytes.push_back(static_cast<uint8_t>(word));
  bytes.push_back(static_cast<uint8_t>(word >> 8U));
}

void put_time(std::vector<uint8_t>& bytes, int64_t t_us) {
  put(bytes, 0x8, t_us >> 12);
  put(bytes, 0x6, t_us);
}

}  // namespace

struct e2lf_camera {
  bool is_loose = false;  ///< whether its cable comes off after half a second
  bool has_triggers = false, has_header = false;
  int threshold = 0;  ///< its only bias, which has no effect
  std::string bias_text;
  std::vector<uint8_t> bytes;
  int64_t t_us = 0;
  std::chrono::steady_clock::time_point begin;
  std::atomic<bool> is_stopped{false};
};

namespace {

int list(void (*add)(void*, const char*), void* list, char*) {
  add(list, "edge");
  add(list, "loose");
  return 0;
}

e2lf_camera* open(const char* address, char* error) {
  const std::string name = address;
  if (!name.empty() && name != "edge" && name != "loose") {
    fail(error, "there is no camera " + name + "; give edge or loose");
    return nullptr;
  }
  auto* camera = new e2lf_camera;
  camera->is_loose = name == "loose";
  return camera;
}

void close(e2lf_camera* camera) {
  delete camera;
}

int triggers_on(e2lf_camera* camera, const char* const* inputs, size_t count, char* error) {
  for (size_t i = 0; i < count; ++i) {
    if (std::strcmp(inputs[i], "main") != 0) return fail(error, std::string("there is no trigger input ") + inputs[i]);
  }
  camera->has_triggers = true;
  return 0;
}

int load_biases(e2lf_camera* camera, const char* text, char* error) {
  int length = 0;
  if (std::sscanf(text, "%d %% bias_diff_on %n", &camera->threshold, &length) != 1 || text[length] != '\0') {
    return fail(error, "the biases must be one line, \"NUMBER % bias_diff_on\"");
  }
  return 0;
}

const char* save_biases(e2lf_camera* camera, char*) {
  camera->bias_text = std::to_string(camera->threshold) + " % bias_diff_on\n";
  return camera->bias_text.c_str();
}

int start(e2lf_camera* camera, char*) {
  camera->begin = std::chrono::steady_clock::now();
  return 0;
}

e2lf_camera_state next(e2lf_camera* camera, e2lf_camera_buffer* buffer, char* error) {
  std::vector<uint8_t>& bytes = camera->bytes;
  bytes.clear();
  if (!camera->has_header) {
    camera->has_header = true;
    const std::string header = "% evt 3.0\n% format EVT3\n% geometry 64x48\n% sensor_name edge\n% end\n";
    bytes.assign(header.begin(), header.end());
  } else {
    if (camera->is_stopped) return E2LF_CAMERA_ENDED;
    if (camera->is_loose && camera->t_us >= kUnplugUs) {
      fail(error, "the cable came off; plug it in again");
      return E2LF_CAMERA_FAILED;
    }
    std::this_thread::sleep_until(camera->begin + std::chrono::microseconds(camera->t_us + kBufferUs));
    put_time(bytes, camera->t_us);
    if (camera->has_triggers && camera->t_us % kTriggerUs == 0) put(bytes, 0xA, 1);  // a rising edge of input 0
    for (int y = 0; y < kHeight; ++y) {
      put(bytes, 0x0, y);
      put(bytes, 0x2, camera->t_us / kBufferUs % kWidth | 1 << 11);  // ON
    }
    camera->t_us += kBufferUs;
  }
  buffer->bytes = bytes.data();
  buffer->size = bytes.size();
  return E2LF_CAMERA_RUNS;
}

void stop(e2lf_camera* camera) {
  camera->is_stopped = true;
}

}  // namespace

const e2lf_camera_functions* e2lf_camera_plugin() {
  static const e2lf_camera_functions functions = {
      E2LF_CAMERA_PLUGIN_VERSION,
      "edge",
      "an edge that moves; ADDRESS is edge, or loose for a camera whose cable comes off",
      list,
      open,
      close,
      triggers_on,
      load_biases,
      save_biases,
      nullptr,  // it has no other settings
      start,
      next,
      stop,
  };
  return &functions;
}
