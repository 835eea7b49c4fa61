// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"

namespace e2lf::cli {

/// What a path stands for. Every verb asks file_kind(), so that all agree.
enum class FileKind {
  kRecording,    ///< events: a file, or what is read as it arrives
  kEventImages,  ///< counts of each pattern transition: .npz, .npy, .mat, folder of event_image_00000.npy ...
  kImages,       ///< a measurement with intensity images (.npz): see capture/measurement/measurement_io.h
  kLightField,   ///< a light field of any format
  kCycles,       ///< a folder of cycle_00000 ..., a light field in each
  kModel,        ///< a .safetensors: a model, or data to train on
  kTrainingRun,  ///< a folder of `e2lf train`
  kDisplay,      ///< a folder of `e2lf codes render`
  kResults,      ///< a folder with the run.json of another verb
};

/// With its article, e.g. "a light field".
[[nodiscard]] const char* kind_text(FileKind kind);

/// Tells what a path stands for from names, first bytes and headers; data are not read. A file that is nothing else may
/// be a recording: opening it tells. Fails with kNotFound, kIo (may not be looked into), kFormat (a folder that holds
/// nothing of all this, or a view twice).
[[nodiscard]] Result<FileKind> file_kind(const std::filesystem::path& path);

/// The error of a verb that takes `wanted`, as "a light field", and was given a thing of this kind: says what it is and
/// what to do with it.
[[nodiscard]] Error other_kind_error(const std::filesystem::path& path, FileKind kind, const char* wanted);

/// The bundled model of a name under which nothing lies here; any other path as it is.
[[nodiscard]] std::filesystem::path thing_named(const std::filesystem::path& path);

}  // namespace e2lf::cli
