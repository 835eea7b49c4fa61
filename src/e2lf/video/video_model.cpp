// SPDX-License-Identifier: MIT
#include "e2lf/video/video_model.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "e2lf/files/file.h"
#include "e2lf/model/model_parts.h"
#include "e2lf/video/operations.h"

namespace e2lf::video {
using model::infer_shapes, model::kFormatVersion, model::kMetadataKey, model::kVoxelGrid, model::network_from_json,
    model::size_multiple, model::validate_weights, model::weight_shapes;

namespace {

constexpr size_t kMaxPadMultiple = 1024;

/// The fields of the header that are plain.
template <typename AnyModel, typename Visitor>
void visit_header(AnyModel& model, Visitor& visit) {
  E2LF_VISIT(model, visit, name, bins, normalises_voxels, pad_multiple);
  visit.choice("tone", model.tone, kFrameTones, ErrorCode::kUnsupported);
}

Result<VideoModel> header_from(const Json& json, const std::string& location) {
  add_operations();
  E2LF_RETURN_IF_ERROR(model::check_kind(json, /*is_video=*/true, location));
  VideoModel model;
  OptionReader reader(json, location);
  visit_header(model, reader);
  (void)reader.child("format_version");
  (void)reader.child("measurement");
  const Json& network = reader.child("network");
  const Json& provenance = reader.child("provenance");
  E2LF_RETURN_IF_ERROR(reader.finish());
  E2LF_ASSIGN_OR_RETURN(model.network, network_from_json(network, reader.child_location("network")));
  if (!provenance.is_null()) model.provenance = provenance;
  return model;
}

/// Returns the part of planes [plane, y, x] that images of the sensor's size take, in their middle.
template <typename T>
PlanesView<T> middle_of(const PlanesView<T>& planes, size_t height, size_t width) {
  PlanesView<T> middle = planes;
  middle.extents = {planes.extents[0], height, width};
  middle.data += (planes.extents[1] - height + 1) / 2 * planes.extents[2] + (planes.extents[2] - width + 1) / 2;
  return middle;
}

/// Maps the values at two quantiles to 0 and 1.
void stretch(std::span<float> frame, double low_share, double high_share) {
  std::vector<float> sorted(frame.begin(), frame.end());
  const float low = quantile(sorted, low_share), high = quantile(sorted, high_share);
  const float scale = high > low ? 1.0F / (high - low) : 0.0F;
  for (float& value : frame) value = (value - low) * scale;
}

}  // namespace

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
  FieldWriter writer;
  writer("format_version", kFormatVersion);
  writer("measurement", kVoxelGrid);
  visit_header(model, writer);
  writer("network", model::to_json(model.network));
  writer("provenance", model.provenance);
  return std::move(writer).json();
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
    tensors.tensors[tensor.name] = make_npy<float>(tensor.shape, model.weights.at(tensor.name));
  }
  return write_safetensors(path, tensors);
}

Json summary_json(const VideoModel& model) {
  Json json = video_header_to_json(model);
  json["network"] = model::network_summary(model.network);
  return json;
}

EventVideo::EventVideo(VideoModel model, engine::Engine engine, size_t height, size_t width)
    : model_(std::move(model)),
      engine_(std::move(engine)),
      height_(height),
      width_(width),
      padded_height_(engine::round_up(height, model_.pad_multiple)),
      padded_width_(engine::round_up(width, model_.pad_multiple)) {}

Result<EventVideo> EventVideo::create(VideoModel model, size_t height, size_t width,
                                      const engine::EngineOptions& options) {
  E2LF_REQUIRE(height > 0 && width > 0, "the sensor must have pixels");
  E2LF_RETURN_IF_ERROR(validate(model, model.name));
  E2LF_ASSIGN_OR_RETURN(engine::Engine engine, engine::Engine::create(model.network, model.weights, options));
  return EventVideo(std::move(model), std::move(engine), height, width);
}

void normalise_nonzero(std::span<float> voxels) {
  double sum = 0.0, squares = 0.0;
  size_t count = 0;
  for (const float value : voxels) {
    if (value == 0.0F) continue;
    sum += value;
    squares += static_cast<double>(value) * value;
    ++count;
  }
  if (count == 0) return;
  constexpr double kLeastDeviation = 1e-6;
  const double mean = sum / static_cast<double>(count);
  const double variance = squares / static_cast<double>(count) - mean * mean;
  const double deviation = std::max(std::sqrt(std::max(variance, 0.0)), kLeastDeviation);
  for (float& value : voxels) {
    if (value != 0.0F) value = static_cast<float>((value - mean) / deviation);
  }
}

Result<std::vector<float>> EventVideo::next(capture::VoxelGrid grid) {
  E2LF_REQUIRE(grid.count == model_.bins && grid.height == height_ && grid.width == width_,
               "the grid has another size");
  if (model_.normalises_voxels) normalise_nonzero(grid.values);
  const bool is_padded = padded_height_ != height_ || padded_width_ != width_;
  if (is_padded) {
    capture::VoxelGrid padded(grid.count, padded_height_, padded_width_);
    copy_values(PlanesView<const float>(grid), middle_of<float>(padded, height_, width_));
    grid = std::move(padded);
  }
  Planes<float> output(1, padded_height_, padded_width_);
  E2LF_RETURN_IF_ERROR(engine_.run_frame(grid.values, padded_height_, padded_width_, state_, output.values));
  return is_padded ? owned(middle_of<float>(output, height_, width_)).values : std::move(output.values);
}

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

void add_operations() {
  static std::once_flag once;
  std::call_once(once, [] {
    for (const engine::Operation& operation :
         {attention(), bilinear_upsampling(), conv_gru(), conv_lstm(), dynamic_filter(), hyperbolic_tangent(),
          layer_norm(), position_code(), previous_output()}) {
      engine::add_operation(operation);
    }
  });
}

}  // namespace e2lf::video
