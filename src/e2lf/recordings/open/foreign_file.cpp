// SPDX-License-Identifier: MIT
#include "e2lf/recordings/open/foreign_file.h"

#include <string_view>

#include "e2lf/base/text.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings {
namespace {

using namespace std::string_view_literals;

/// The first bytes of a kind of file, and its description.
struct Beginning {
  std::string_view bytes;
  size_t offset;
  const char* text;
};

constexpr Beginning kBeginnings[] = {
    {"PK\x03\x04"sv, 0, "a zip archive; unpack it, then give the recording in it"},
    {"PK\x05\x06"sv, 0, "an empty zip archive; give a recording"},
    {"\x1F\x8B"sv, 0, "compressed twice by gzip; unpack it once with `gzip -d`"},
    {"\x28\xB5\x2F\xFD"sv, 0, "compressed twice; unpack it once with `zstd -d`"},
    {"BZh"sv, 0, "compressed by bzip2; unpack it with `bzip2 -d`, then give the recording in it"},
    {"\3757zXZ\0"sv, 0, "compressed by xz; unpack it with `xz -d`, then give the recording in it"},
    {"\x04\x22\x4D\x18"sv, 0, "compressed by lz4; unpack it with `lz4 -d`, then give the recording in it"},
    {"7z\xBC\xAF\x27\x1C"sv, 0, "a 7-Zip archive; unpack it with `7z x`, then give the recording in it"},
    {"Rar!\x1A\x07"sv, 0, "a RAR archive; unpack it, then give the recording in it"},
    {"ustar"sv, 257, "a tar archive; unpack it with `tar -xf`, then give the recording in it"},
    {"#ROSBAG V"sv, 0, "a bag of ROS 1; convert it to one of ROS 2 with `rosbags-convert` (Python package rosbags)"},
    {"Event Stream"sv, 0, "an Event Stream file (.es); convert it to CSV with `faery`"},
    {"#!AER-DAT1"sv, 0, "an AEDAT 1 recording; save it as AEDAT 2 with jAER, or as AEDAT 4 with DV"},
    {"\xD4\xC3\xB2\xA1"sv, 0, "a capture of network packets (pcap); record the events with the camera's own software"},
    {"\xA1\xB2\xC3\xD4"sv, 0, "a capture of network packets (pcap); record the events with the camera's own software"},
    {"\x4D\x3C\xB2\xA1"sv, 0, "a capture of network packets (pcap); record the events with the camera's own software"},
    {"\x0A\x0D\x0D\x0A"sv, 0,
     "a capture of network packets (pcapng); record the events with the camera's own software"},
    {"PAR1"sv, 0, "a Parquet table; write it as .csv, e.g. with pandas"},
    {"ARROW1"sv, 0, "an Arrow or Feather table; write it as .csv, e.g. with pandas"},
    {"FEA1"sv, 0, "a Feather table; write it as .csv, e.g. with pandas"},
    {"Obj\x01"sv, 0, "an Avro table; write it as .csv"},
    {"[["sv, 0, "JSON; write the events as .csv or .npy"},
    {"[{"sv, 0, "JSON; write the events as .csv or .npy"},
    {"version https://git-lfs"sv, 0, "a pointer of Git LFS and not the file itself; fetch it with `git lfs pull`"},
    {"<?xml"sv, 0, "an XML file and not a recording of events"},
    {"II*\0"sv, 0, "an image (TIFF) and not a recording of events"},
    {"MM\0*"sv, 0, "an image (TIFF) and not a recording of events"},
    {"AVI "sv, 8, "a film (AVI) and not a recording of events"},
    {"ftyp"sv, 4, "a film (MP4) and not a recording of events"},
    {"\x1A\x45\xDF\xA3"sv, 0, "a film (Matroska or WebM) and not a recording of events"},
    {"\x89PNG"sv, 0, "an image (PNG) and not a recording of events"},
    {"\xFF\xD8\xFF"sv, 0, "an image (JPEG) and not a recording of events"},
    {"GIF8"sv, 0, "an image (GIF) and not a recording of events"},
    {"MATLAB 5.0"sv, 0,
     "a MATLAB file without event images or a light field; write events as .csv with the columns t, x, y, p"},
    {"\x89LFP"sv, 0, "a picture of a Lytro camera; decode it to .mat with the Light Field Toolbox"},
    {"\x76\x2F\x31\x01"sv, 0, "an OpenEXR image; write views as PNG of 16 bits"},
    {"\x80\x02"sv, 0, "a Python pickle, which may run programs; write its arrays with numpy.savez"},
    {"\x80\x03"sv, 0, "a Python pickle, which may run programs; write its arrays with numpy.savez"},
    {"\x80\x04"sv, 0, "a Python pickle, which may run programs; write its arrays with numpy.savez"},
    {"\x80\x05"sv, 0, "a Python pickle, which may run programs; write its arrays with numpy.savez"},
    {"\177ELF"sv, 0, "a program and not a recording of events"},
    {"%PDF"sv, 0, "a PDF document and not a recording of events"},
};

}  // namespace

std::optional<std::string> foreign_file_text(std::span<const uint8_t> head) {
  const std::string_view text = as_text(head);
  for (const Beginning& beginning : kBeginnings) {
    if (text.size() < beginning.offset || !text.substr(beginning.offset).starts_with(beginning.bytes)) continue;
    const std::string_view what = beginning.text;
    return what.find(';') != std::string_view::npos
               ? std::string(what)
               : cat(what, "; give a recording, e.g. .raw, .hdf5, .aedat4 or .csv");
  }
  return std::nullopt;
}

std::optional<std::string> foreign_records_text(std::span<const uint8_t> head, const std::string& extension) {
  constexpr size_t kRecordBytes = 5, kLooks = 32;
  if (extension != ".bin" || head.size() < kRecordBytes) return std::nullopt;
  uint32_t last_us = 0;
  for (size_t i = 0; i < kLooks && (i + 1) * kRecordBytes <= head.size(); ++i) {
    const uint8_t* const record = &head[i * kRecordBytes];
    const uint32_t t_us = (record[2] & 0x7FU) << 16 | uint32_t{record[3]} << 8 | record[4];
    if (t_us < last_us) return std::nullopt;
    last_us = t_us;
  }
  return "probably events of 5 bytes each, as in N-MNIST and N-Caltech101; convert them, e.g. with the Python package "
         "tonic, to an array of x, y, p, t (.npy)";
}

}  // namespace e2lf::recordings
