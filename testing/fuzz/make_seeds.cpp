// SPDX-License-Identifier: MIT
// e2lf_fuzz_seeds FOLDER: writes small valid inputs for every fuzz target to FOLDER/<target>/, with our own writers.
#include <cstdio>
#include <map>

#include "chunk_file.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/formats/formats.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/recordings/codecs/metavision_hdf5/ecf.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/recordings/recording.h"
#include "reader_seeds.h"
#include "testing/test_aedat4.h"
#include "testing/test_evt4.h"
#include "testing/test_rosbag.h"
#include "testing/test_streams.h"

namespace {

using namespace e2lf;
namespace ev = e2lf::recordings;
namespace fs = std::filesystem;
using Bytes = std::vector<uint8_t>;

/// Streams that differ in what encodings find easy and hard.
std::map<std::string, ev::EventBatch> example_streams() {
  std::map<std::string, ev::EventBatch> streams;
  streams["empty"] = {};
  streams["few"] = ev::random_stream({.events = 5, .width = 64, .height = 48, .trigger_every = 2});
  streams["sparse"] =
      ev::random_stream({.events = 60, .width = 64, .height = 48, .max_gap_us = 3000, .trigger_every = 20, .seed = 2});
  streams["late"] =
      ev::random_stream({.events = 40, .width = 64, .height = 48, .begin_us = 17'000'000, .max_gap_us = 9, .seed = 3});
  ev::EventBatch rows;  // neighbours at one time: vectors, runs and groups
  for (uint16_t i = 0; i < 160; ++i) {
    rows.events.push_back(
        {static_cast<uint16_t>(i % 40), static_cast<uint16_t>(i / 40), static_cast<uint8_t>(i / 80), 2000 + i / 40});
  }
  streams["rows"] = rows;
  return streams;
}

Result<Bytes> written(const std::string& format, const ev::EventBatch& stream) {
  ev::RecordingInfo info;
  info.format = format;
  info.width = 64;
  info.height = 48;
  Bytes bytes;
  const bool in_memory = (*ev::find_codec(format))->create != nullptr;
  const fs::path path = fs::temp_directory_path() / cat("e2lf_fuzz_seed_", ::getpid());
  E2LF_ASSIGN_OR_RETURN(auto writer, in_memory ? create_recording(ev::make_memory_sink(bytes), format, info)
                                               : create_recording(path, format, info));
  E2LF_RETURN_IF_ERROR(writer->write(stream));
  E2LF_RETURN_IF_ERROR(writer->finish());
  if (in_memory) return bytes;
  auto read = read_file(path);
  fs::remove(path);
  return read;
}

Bytes encoded_chunk(const ev::EventColumns& events) {
  Bytes bytes(ev::ecf::max_encoded_size(events.size()));
  bytes.resize(ev::ecf::encode({events.x, events.y, events.p, events.t}, bytes));
  return bytes;
}

/// Input of make_chunk_file: the chunk twice, then the first of them damaged.
Bytes chunk_input(uint8_t flags, const Bytes& chunk) {
  Bytes input = {flags, 0, 0};
  for (int i = 0; i < 3; ++i) {
    const Bytes part(chunk.begin(), chunk.end() - (i == 2 ? static_cast<ptrdiff_t>(chunk.size() / 3) : 0));
    input.insert(input.end(), {0, static_cast<uint8_t>(part.size()), static_cast<uint8_t>(part.size() >> 8)});
    input.insert(input.end(), part.begin(), part.end());
  }
  return input;
}

Bytes aedat4_file(const ev::EventBatch& stream, e2lf::formats::aedat4::Compression compression) {
  std::vector<std::pair<int8_t, int64_t>> triggers;
  for (const ev::Trigger& trigger : stream.triggers) triggers.emplace_back(trigger.p != 0 ? 1 : 2, trigger.t);
  return e2lf::formats::aedat4::make_file({{0, e2lf::formats::aedat4::event_packet(stream.events)},
                                           {3, e2lf::formats::aedat4::trigger_packet(triggers)},
                                           {2, e2lf::formats::aedat4::begin_packet("IMUS", 0)}},
                                          compression);
}

Result<void> write_bags(const fs::path& folder) {
  using namespace e2lf::formats::rosbag;
  const uint64_t base_ns = 1'700'000'000'000'000'000;
  const Bytes evt3 = words<uint16_t>({0x8001, 0x6002, 0x0005, 0x2807, 0xA101, 0x6003, 0x2009});
  const std::map<std::string, Bytes> messages = {
      {"evt3", packet_message(0, "evt3", 0, evt3)},
      {"mono", packet_message(0, "mono", base_ns, words<uint64_t>({0x8002'0001'0000'03E8, 0x0003'0004'0000'07D0}))},
      {"list", list_message(ev::random_stream({.events = 5, .width = 64, .height = 48}).events)}};
  for (const auto& [name, message] : messages) {
    const std::vector<TestTopic> topics = {{"/events", name == "list" ? kListType : kPacketType}, {"/other"}};
    const TestMessages stored = {{0, message}, {1, message}, {0, message}};
    E2LF_RETURN_IF_ERROR(write_file(folder / "mcap" / name, mcap_file(topics, stored)));
#ifdef E2LF_HAVE_SQLITE
    E2LF_RETURN_IF_ERROR(write_file(folder / "rosbag" / name, sqlite_file(topics, stored)));
#endif
  }
  return {};
}

Result<void> write_recordings(const fs::path& folder) {
  for (const auto& [name, stream] : example_streams()) {
    for (const char* format : {"evt2", "evt2.1", "evt3", "dat", "csv", "npz"}) {
      E2LF_ASSIGN_OR_RETURN(const Bytes bytes, written(format, stream));
      E2LF_RETURN_IF_ERROR(write_file(folder / format / name, bytes));
    }
    E2LF_RETURN_IF_ERROR(write_file(folder / "evt4" / name, ev::evt4_file(stream)));
    using e2lf::formats::aedat4::Compression;
    for (const Compression compression : {Compression::kNone, Compression::kLz4, Compression::kZstd}) {
      const std::string file = cat(name, "_", static_cast<int>(compression));
      E2LF_RETURN_IF_ERROR(write_file(folder / "aedat4" / file, aedat4_file(stream, compression)));
    }
    std::string text;
    std::vector<double> rows;
    for (size_t i = 0; i < stream.events.size(); ++i) {
      const ev::Event event = stream.events[i];
      const double seconds = 1e-6 * static_cast<double>(event.t);
      text += formatted("%.6f %d %d %d\n", seconds, event.x, event.y, event.p);
      rows.insert(rows.end(), {seconds, 1.0 * event.x, 1.0 * event.y, 1.0 * event.p});
    }
    E2LF_RETURN_IF_ERROR(write_file(folder / "txt" / name, text));
    const NpyArray table = make_npy<double>({stream.events.size(), 4}, rows);
    E2LF_RETURN_IF_ERROR(write_file(folder / "npy" / name, encode_npy(table)));
    if (stream.events.empty()) continue;
    const Bytes chunk = encoded_chunk(stream.events);
    E2LF_RETURN_IF_ERROR(write_file(folder / "ecf" / name, chunk));
    const Bytes chunks = chunk_input(2, chunk);
    E2LF_RETURN_IF_ERROR(write_file(folder / "hdf5_chunks" / name, chunks));
    E2LF_RETURN_IF_ERROR(write_file(folder / "hdf5" / name, fuzz::make_chunk_file(chunks)));
    E2LF_RETURN_IF_ERROR(write_file(folder / "dsec" / name, fuzz::make_column_file(stream.events)));
    E2LF_RETURN_IF_ERROR(write_file(folder / "hdf5_chunks" / (name + "_raw"), chunk_input(0, Bytes(16))));
  }
  return write_file(folder / "side_triggers" / "few", std::string("p,id,t\n1,0,100\n0,0,250\n1,3,251\n"));
}

Result<void> write_arrays(const fs::path& folder) {
  const std::vector<float> floats = {0.0F, 0.25F, 1.0F, -1.0F, 0.5F, 0.75F};
  const std::vector<int16_t> counts = {1, -2, 3, 4, 5, 6};
  const NpyArray array = make_npy<float>({2, 3}, floats);
  const NpyArray images = make_npy<int16_t>({1, 2, 3}, counts);
  E2LF_RETURN_IF_ERROR(write_file(folder / "arrays" / "npy", encode_npy(array)));
  E2LF_RETURN_IF_ERROR(write_file(folder / "arrays" / "npz", encode_npz({{"events", images}, {"codes", array}})));
  E2LF_RETURN_IF_ERROR(write_file(folder / "arrays" / "stored", encode_npz({{"events", images}}, false)));
  Safetensors file;
  file.tensors["weight"] = make_npy<float>({2, 3}, floats);
  file.metadata["e2lf"] = R"({"version": 1})";
  E2LF_RETURN_IF_ERROR(write_file(folder / "safetensors" / "one", encode_safetensors(file)));
  E2LF_RETURN_IF_ERROR(write_file(folder / "safetensors" / "none", encode_safetensors({})));
  Safetensors packed;
  packed.tensors["lightfield/a"] = make_npy<uint8_t>({8, 8, 1, 2}, Bytes(128, 7));
  packed.tensors["texture/set/b"] = make_npy<uint8_t>({3, 2}, Bytes(6, 9));
  return write_file(folder / "packed_data" / "both", encode_safetensors(packed));
}

Result<void> write_images(const fs::path& folder) {
  using namespace lightfield;
  for (const size_t channels : {1, 3}) {
    Image image(5, 4, channels);
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i % 7) / 7.0F;
    for (const PngDepth depth : {PngDepth::k8, PngDepth::k16}) {
      E2LF_ASSIGN_OR_RETURN(const Bytes bytes, encode_png(image, depth));
      E2LF_RETURN_IF_ERROR(
          write_file(folder / "image" / cat("png_", channels, "_", depth == PngDepth::k8 ? 8 : 16), bytes));
    }
  }
  return {};
}

Result<void> write_all(const fs::path& folder) {
  E2LF_RETURN_IF_ERROR(write_recordings(folder));
  E2LF_RETURN_IF_ERROR(write_bags(folder));
  E2LF_RETURN_IF_ERROR(write_arrays(folder));
  E2LF_RETURN_IF_ERROR(write_images(folder));
  return fuzz::write_reader_seeds(folder);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  e2lf::formats::add_formats();
  const auto done = write_all(argv[1]);
  if (!done) std::fprintf(stderr, "e2lf_fuzz_seeds: %s\n", done.error().text().c_str());
  return done ? 0 : 1;
}
