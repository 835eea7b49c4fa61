// SPDX-License-Identifier: MIT
// The target of event images: the first byte chooses .npz, .npy or a folder's first image, the rest is the file.
// An .npz may hold another measurement.
#include "e2lf/capture/measurement/event_image_io.h"
#include "require.h"
#include "scratch.h"

namespace {

/// What is read as a measurement has all its pixels, and comes back as written.
void check_measurements(const std::filesystem::path& path, const std::filesystem::path& folder) {
  using namespace e2lf;
  using fuzz::require;
  const auto file = capture::read_measurements(path);
  if (!file) return;
  for (const capture::Measurement& cycle : file->cycles) {
    require(cycle.kind == file->cycles[0].kind && cycle.height() > 0 && cycle.width() > 0, "cycles are of one kind");
    require(cycle.images.values.size() == cycle.images.count * cycle.images.image_size(), "all pixels are there");
  }
  require(capture::write_measurements(folder / "measured.npz", *file).ok(), "they can be written");
  const auto back = capture::read_measurements(folder / "measured.npz");
  require(back.ok() && back->cycles.size() == file->cycles.size(), "they come back");
  for (size_t i = 0; i < file->cycles.size(); ++i) {
    require(back->cycles[i].events == file->cycles[i].events, "with their events");
    require(back->cycles[i].images.values == file->cycles[i].images.values, "with their images");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace e2lf;
  using fuzz::require;
  constexpr const char* kNames[] = {"input.npz", "input.npy", "event_image_00000.npy"};
  static const fuzz::ScratchFolder folder;
  folder.clear();
  std::span<const uint8_t> input(data, size);
  const size_t choice = fuzz::take_choice(input, std::size(kNames));
  const auto path = folder.put(kNames[choice], input);
  if (choice == 0) check_measurements(path, folder.path());
  const auto file = capture::read_event_images(choice == 2 ? folder.path() : path);
  if (!file) return 0;
  for (const capture::EventImages& images : file->cycles) {
    require(images.values.size() == images.count * images.image_size(), "images have all their pixels");
    require(images.count == file->cycles[0].count, "cycles have one shape");
  }
  const auto npz = folder.path() / "again.npz";
  require(capture::write_event_images(npz, *file).ok(), "they can be written");
  const auto back = capture::read_event_images(npz);
  require(back.ok() && back->cycles == file->cycles && back->setup.codes == file->setup.codes,
          "they come back as written");
  return 0;
}
