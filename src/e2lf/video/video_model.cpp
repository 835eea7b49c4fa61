// SPDX-License-Identifier: MIT
#include "e2lf/video/video_model.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "e2lf/base/choice.h"
#include "e2lf/base/result.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/model/model_parts.h"
#include "e2lf/model/summary.h"
#include "e2lf/video/operations.h"

namespace e2lf::video {
using model::infer_shapes, model::kFormatVersion, model::kMetadataKey, model::kVoxelGrid, model::network_from_json,
    model::size_multiple, model::validate_weights, model::weight_shapes;

namespace {

constexpr Choice<FrameTone> kTones[] = {{"none", FrameTone::kNone},
                                        {"robust", FrameTone::kRobust},
                                        {"standard", FrameTone::kStandard},
                                        {"exp-robust", FrameTone::kExpRobust}};

constexpr size_t kMaxPadMultiple = 1024;

Result<VideoModel> header_from(const Json& json, const std::string& location) {
  add_operations();
  E2LF_RETURN_IF_ERROR(model::check_kind(json, kVoxelGrid, location));
  VideoModel model;
  std::string tone;
  OptionReader reader(json, location);
  reader.read("name", model.name)
      .read("bins", model.bins)
      .read("normalises_voxels", model.normalises_voxels)
      .read("pad_multiple", model.pad_multiple)
      .read("tone", tone);
  (void)reader.child("format_version");
  (void)reader.child("measurement");
  const Json& network = reader.child("network");
  const Json& provenance = reader.child("provenance");
  E2LF_RETURN_IF_ERROR(reader.finish());
  const auto known_tone = tone_from_name(tone);
  if (!known_tone) return fail(ErrorCode::kUnsupported, reader.child_location("tone"), known_tone.error().message);
  model.tone = *known_tone;
  E2LF_ASSIGN_OR_RETURN(model.network, network_from_json(network, reader.child_location("network")));
  if (!provenance.is_null()) model.provenance = provenance;
  return model;
}

}  // namespace

const char* tone_name(FrameTone tone) {
  return word_of(tone, kTones);
}

Result<FrameTone> tone_from_name(const std::string& name) {
  return choice_of(name, kTones, "tone");
}

Result<void> validate(const VideoModel& model, const std::string& location) {
  add_operations();
  const auto refuse = [&](const std::string& field, const std::string& message,
                          ErrorCode code = ErrorCode::kInvalidValue) {
    return Error{code, message, cat(location, ": ", field)};
  };
  if (model.bins == 0 || model.bins > kMaxBins) {
    return refuse("bins", cat("the model has ", model.bins, " time bins; use 1 to ", kMaxBins));
  }
  const auto shapes = infer_shapes(model.network);
  if (!shapes) return refuse(cat("network: ", shapes.error().location), shapes.error().message, shapes.error().code);
  if (model.network.input_channels != model.bins) {
    return refuse("network.input_channels",
                  cat("the network has ", model.network.input_channels, " input channels, but the model has ",
                      model.bins, " time bins; make them equal"),
                  ErrorCode::kShape);
  }
  if (shapes->back().channels != 1 || shapes->back().scale != 1) {
    return refuse("network",
                  cat("the last layer has ", shapes->back().channels, " channels at scale ", shapes->back().scale,
                      ", not one at scale 1; correct the last layer"),
                  ErrorCode::kShape);
  }
  const size_t multiple = size_multiple(model.network);
  if (model.pad_multiple == 0 || model.pad_multiple > kMaxPadMultiple || model.pad_multiple % multiple != 0) {
    return refuse("pad_multiple", cat("images cannot be padded to multiples of ", model.pad_multiple,
                                      " px; use a multiple of the network's ", multiple, ", up to ", kMaxPadMultiple));
  }
  if (!model.provenance.is_object())
    return refuse("provenance", "the provenance is not a JSON object; enclose it in { }");
  return validate_weights(model.network, model.weights, location);
}

Json video_header_to_json(const VideoModel& model) {
  return {{"format_version", kFormatVersion},
          {"measurement", kVoxelGrid},
          {"name", model.name},
          {"bins", model.bins},
          {"normalises_voxels", model.normalises_voxels},
          {"pad_multiple", model.pad_multiple},
          {"tone", tone_name(model.tone)},
          {"network", model::to_json(model.network)},
          {"provenance", model.provenance}};
}

Result<VideoModel> decode_video_model(std::span<const uint8_t> bytes, const std::string& file) {
  E2LF_ASSIGN_OR_RETURN(const Safetensors tensors, decode_safetensors(bytes, file));
  E2LF_ASSIGN_OR_RETURN(const Json json, model::header_of(tensors, file));
  E2LF_ASSIGN_OR_RETURN(VideoModel model, header_from(json, cat(file, ": ", kMetadataKey, ": $")));
  E2LF_ASSIGN_OR_RETURN(model.weights, model::weights_from_tensors(model.network, tensors, file));
  E2LF_RETURN_IF_ERROR(validate(model, file));
  return model;
}

Result<VideoModel> read_video_model(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(path));
  return decode_video_model(bytes, path.string());
}

Result<void> write_video_model(const std::filesystem::path& path, const VideoModel& model) {
  E2LF_RETURN_IF_ERROR(validate(model, path.string()));
  Safetensors tensors;
  tensors.metadata[kMetadataKey] = json_line(video_header_to_json(model));
  for (const model::WeightShape& tensor : weight_shapes(model.network)) {
    tensors.tensors[tensor.name] = make_tensor(tensor.shape, model.weights.at(tensor.name));
  }
  return write_safetensors(path, tensors);
}

Json summary_json(const VideoModel& model) {
  Json json = video_header_to_json(model);
  json["network"] = model::network_summary(model.network);
  json.erase("provenance");
  json["provenance"] = model.provenance;
  return json;
}

namespace {

/// The position of the rows of planes within larger planes.
struct Frame {
  size_t height, width;  ///< of the inner planes
  size_t outer_height, outer_width;

  [[nodiscard]] size_t top() const { return (outer_height - height + 1) / 2; }
  [[nodiscard]] size_t left() const { return (outer_width - width + 1) / 2; }
  [[nodiscard]] size_t outer_row(size_t plane, size_t y) const {
    return (plane * outer_height + top() + y) * outer_width + left();
  }
};

size_t padded_to(size_t size_px, size_t multiple_px) {
  return (size_px + multiple_px - 1) / multiple_px * multiple_px;
}

}  // namespace

EventVideo::EventVideo(VideoModel model, engine::Engine engine, size_t height, size_t width)
    : model_(std::move(model)),
      engine_(std::move(engine)),
      height_(height),
      width_(width),
      padded_height_(padded_to(height, model_.pad_multiple)),
      padded_width_(padded_to(width, model_.pad_multiple)) {}

Result<EventVideo> EventVideo::create(VideoModel model, size_t height, size_t width,
                                      const engine::EngineOptions& options) {
  E2LF_REQUIRE(height > 0 && width > 0, "the sensor must have pixels");
  E2LF_RETURN_IF_ERROR(validate(model, model.name));
  E2LF_ASSIGN_OR_RETURN(engine::Engine engine, engine::Engine::create(model.network, model.weights, options));
  return EventVideo(std::move(model), std::move(engine), height, width);
}

Result<std::vector<float>> EventVideo::next(capture::VoxelGrid grid) {
  E2LF_REQUIRE(grid.count == model_.bins && grid.height == height_ && grid.width == width_,
               "the grid has another size");
  if (model_.normalises_voxels) capture::normalise_nonzero(grid.values);
  const Frame frame{height_, width_, padded_height_, padded_width_};
  const bool is_padded = padded_height_ != height_ || padded_width_ != width_;
  if (is_padded) {
    std::vector<float> padded(grid.count * padded_height_ * padded_width_);
    for (size_t row = 0; row < grid.count * height_; ++row) {
      std::copy_n(&grid.values[row * width_], width_, &padded[frame.outer_row(row / height_, row % height_)]);
    }
    grid.values = std::move(padded);
  }
  std::vector<float> output(padded_height_ * padded_width_);
  E2LF_RETURN_IF_ERROR(engine_.run_frame(grid.values, padded_height_, padded_width_, state_, output));
  if (!is_padded) return output;
  std::vector<float> picture(height_ * width_);
  for (size_t y = 0; y < height_; ++y) std::copy_n(&output[frame.outer_row(0, y)], width_, &picture[y * width_]);
  return picture;
}

namespace {

/// Maps the values at two quantiles to 0 and 1.
void stretch(std::span<float> frame, double low_share, double high_share) {
  std::vector<float> sorted(frame.begin(), frame.end());
  const float low = quantile(sorted, low_share), high = quantile(sorted, high_share);
  const float scale = high > low ? 1.0F / (high - low) : 0.0F;
  for (float& value : frame) value = (value - low) * scale;
}

}  // namespace

float quantile(std::span<float> values, double share) {
  E2LF_REQUIRE(!values.empty() && share >= 0.0 && share <= 1.0, "a quantile needs values and a share");
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<size_t>(place);
  const auto at = values.begin() + static_cast<ptrdiff_t>(below);
  std::nth_element(values.begin(), at, values.end());
  if (below + 1 == values.size()) return *at;
  const float above = *std::min_element(at + 1, values.end());
  return *at + static_cast<float>(place - static_cast<double>(below)) * (above - *at);
}

void apply_frame_tone(FrameTone tone, std::span<float> frame) {
  constexpr double kRobustShare = 0.01;
  if (frame.empty()) return;
  switch (tone) {
    case FrameTone::kNone:
      break;
    case FrameTone::kExpRobust:
      for (float& value : frame) value = std::exp(value);
      stretch(frame, kRobustShare, 1.0 - kRobustShare);
      break;
    case FrameTone::kRobust:
      stretch(frame, kRobustShare, 1.0 - kRobustShare);
      break;
    case FrameTone::kStandard:
      stretch(frame, 0.0, 1.0);
      break;
  }
  for (float& value : frame) value = std::clamp(value, 0.0F, 1.0F);
}

}  // namespace e2lf::video
