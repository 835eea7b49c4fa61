// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"

namespace e2lf::info {

/// The kinds of inputs that a path can denote. Every verb calls file_kind(), so that all agree.
enum class FileKind {
  kRecording,    ///< events: a file, or a live source
  kEventImages,  ///< event images: .npz, .npy, or a folder of event_image_00000.npy ...
  kImages,       ///< a measurement with intensity images (.npz): see capture/measurement/event_image_io.h
  kLightField,   ///< a light field of any format
  kCycles,       ///< a folder of cycle_00000 ..., a light field in each
  kModel,        ///< a .safetensors file: a model, or training data
  kTrainingRun,  ///< a folder of `e2lf train`
  kDisplay,      ///< a folder of `e2lf codes render`
  kResults,      ///< a folder with the run.json of any other verb
  kSettings,     ///< a file of settings: a camera, a schedule, patterns, a run.json, or biases
};

/// Returns the name of the kind with its article, e.g. "a light field".
[[nodiscard]] const char* kind_text(FileKind kind);

/// Determines the kind of a path from names, first bytes and headers, without reading the data. A file of no other kind
/// is assumed to be a recording; opening it shows whether it is one. Fails with kNotFound, kIo (no permission), and
/// kFormat (a folder that contains nothing of these kinds, or a view twice).
[[nodiscard]] Result<FileKind> file_kind(const std::filesystem::path& path);

/// Returns the error of a verb that requires `wanted`, e.g. "a light field", and received an input of kind `kind`. It
/// states what the input is and what can be done with it.
[[nodiscard]] Error other_kind_error(const std::filesystem::path& path, FileKind kind, const char* wanted);

/// Returns the path of the bundled model with this name if no such file or folder exists; otherwise returns `path`
/// unchanged.
[[nodiscard]] std::filesystem::path file_or_bundled_model(const std::filesystem::path& path);

}  // namespace e2lf::info
