// thread_pool MODEL.safetensors EVENTS.npz CYCLES
// Reconstructs light fields on two threads of the program, which share one Reconstructor and its weights. Each
// reconstruction uses one thread. set_num_threads() applies to the whole process; call it before the workers start.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <e2lf/base/threads.h>
#include <e2lf/capture/measurement/event_image_io.h>
#include <e2lf/model/model.h>
#include <e2lf/recon/reconstruct.h>
#include <thread>
#include <vector>

int main(int count, char** arguments) {
  if (count != 4) return 2;
  const auto create = [](const e2lf::model::Model& model) { return e2lf::recon::Reconstructor::create(model); };
  const auto reconstructor = e2lf::model::read_model(arguments[1]).and_then(create);
  const auto events = e2lf::capture::read_event_images(arguments[2]);
  if (!reconstructor || !events) {
    std::fprintf(stderr, "%s\n", (!reconstructor ? reconstructor.error() : events.error()).text().c_str());
    return 1;
  }
  e2lf::set_num_threads(1);

  const int cycles = std::atoi(arguments[3]);
  std::atomic<int> next = 0, failed = 0;
  std::vector<double> means(static_cast<size_t>(cycles));
  const auto work = [&] {
    for (int cycle = next++; cycle < cycles; cycle = next++) {
      const auto light_field = reconstructor->reconstruct(events->cycles.front());
      if (!light_field) {
        std::fprintf(stderr, "%s\n", light_field.error().text().c_str());
        ++failed;
        continue;
      }
      double sum = 0;
      for (const float value : light_field->data()) sum += static_cast<double>(value);
      means[static_cast<size_t>(cycle)] = sum / static_cast<double>(light_field->data().size());
    }
  };
  std::vector<std::thread> pool;
  for (int worker = 0; worker < 2; ++worker) pool.emplace_back(work);
  for (std::thread& worker : pool) worker.join();
  for (const double mean : means) std::printf("mean %.6f\n", mean);
  return failed == 0 ? 0 : 1;
}
