// SPDX-License-Identifier: MIT
#include "e2lf/depth/disparity_files.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/files/options.h"

namespace e2lf::depth {
namespace {

using lightfield::Image;

template <typename T>
void append(std::vector<uint8_t>& bytes, const T& value) {
  const auto* const first = reinterpret_cast<const uint8_t*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof(T));
}

void append_text(std::vector<uint8_t>& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

/// Returns true for uncertain pixels beside a jump of the disparity.
bool hangs_between_surfaces(const DisparityMap& map, size_t y, size_t x) {
  constexpr float kSure = 0.6F, kJumpPx = 0.15F;
  const size_t width = map.disparity.width, i = y * width + x;
  if (map.confidence.pixels[i] >= kSure) return false;
  const auto jumps_to = [&](size_t j) { return std::abs(map.disparity.pixels[j] - map.disparity.pixels[i]) > kJumpPx; };
  return (x > 0 && jumps_to(i - 1)) || (x + 1 < width && jumps_to(i + 1)) || (y > 0 && jumps_to(i - width)) ||
         (y + 1 < map.disparity.height && jumps_to(i + width));
}

}  // namespace

std::vector<uint8_t> encode_pfm(const Image& disparity) {
  E2LF_REQUIRE(disparity.channels == 1, "a disparity map has one channel");
  std::vector<uint8_t> bytes;
  append_text(bytes, cat("Pf\n", disparity.width, " ", disparity.height, "\n-1.0\n"));
  for (size_t y = disparity.height; y-- > 0;) {
    for (size_t x = 0; x < disparity.width; ++x) append(bytes, 0.0F - disparity.pixels[y * disparity.width + x]);
  }
  return bytes;
}

Result<Image> decode_pfm(std::span<const uint8_t> bytes, const std::string& name) {
  constexpr size_t kLongestHeader = 128;
  std::istringstream header(
      std::string(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(std::min(bytes.size(), kLongestHeader))));
  std::string magic;
  size_t width = 0, height = 0;
  double scale = 0;
  header >> magic;
  if (magic == "PF") return fail(ErrorCode::kUnsupported, name, "a PFM file in colour; give a grey one (Pf)");
  if (magic != "Pf" || !(header >> width >> height >> scale) || width == 0 || height == 0 || scale == 0) {
    return fail(ErrorCode::kFormat, name, "no PFM file: it begins with Pf, its size and a scale; write it again");
  }
  // A single white-space character or CRLF ends the header.
  auto data = static_cast<size_t>(header.tellg()) + 1;
  if (data < bytes.size() && bytes[data - 1] == '\r' && bytes[data] == '\n') ++data;
  const size_t samples = data > bytes.size() ? 0 : (bytes.size() - data) / sizeof(float);
  if (samples / width < height) {
    return fail(ErrorCode::kTruncated, name, "ends before its ", width, "x", height, " pixels do; copy it again");
  }
  if (bytes.size() - data != width * height * sizeof(float)) {
    return fail(ErrorCode::kFormat, name, "is longer than its ", width, "x", height, " pixels; write it again");
  }
  Image image(width, height, 1);
  for (size_t y = 0; y < height; ++y) {
    std::memcpy(image.pixels.data() + (height - 1 - y) * width, bytes.data() + data + y * width * sizeof(float),
                width * sizeof(float));
  }
  if (scale > 0) {  // big-endian
    for (float& value : image.pixels) value = std::bit_cast<float>(__builtin_bswap32(std::bit_cast<uint32_t>(value)));
  }
  for (float& value : image.pixels) value = 0.0F - value;
  return image;
}

Image png_samples(const Image& disparity) {
  Image image = disparity;
  for (float& value : image.pixels) value = (kPngZero + kPngScale * value) / 65535.0F;
  return image;
}

float assumed_infinity(const DisparityRange& range) {
  return std::max(range.most + std::max(range.most - range.least, 1.0F), 1.0F);
}

Image depth_image(const Image& disparity, const Lens& lens) {
  Image depth = disparity;
  for (float& value : depth.pixels) {
    value =
        value < lens.infinity_px() ? static_cast<float>(lens.depth_m(value)) : std::numeric_limits<float>::quiet_NaN();
  }
  return depth;
}

namespace {

using Position = std::array<double, 3>;  // x, y, z

/// Computes the positions that the pixels of a view show.
class Positions {
 public:
  Positions(const DisparityMap& map, const lightfield::Shape& views, const PointGeometry& geometry)
      : geometry_(geometry),
        pixel_(geometry.field_width / static_cast<float>(map.disparity.width)),
        middle_y_(0.5 * static_cast<double>(map.disparity.height)),
        middle_x_(0.5 * static_cast<double>(map.disparity.width)) {
    if (geometry.lens) {
      // The calibrated view is the middle one that exists: (4, 4) of 8x8.
      pinhole_y_ =
          geometry.lens->baseline_m * (static_cast<double>(map.view.y) - static_cast<double>(views.views_y / 2));
      pinhole_x_ =
          geometry.lens->baseline_m * (static_cast<double>(map.view.x) - static_cast<double>(views.views_x / 2));
    } else {
      const double step = geometry.infinity_px * pixel_;
      pinhole_y_ = step * (static_cast<double>(map.view.y) - 0.5 * static_cast<double>(views.views_y - 1));
      pinhole_x_ = step * (static_cast<double>(map.view.x) - 0.5 * static_cast<double>(views.views_x - 1));
    }
  }

  [[nodiscard]] double infinity_px() const {
    return geometry_.lens ? geometry_.lens->infinity_px() : geometry_.infinity_px;
  }

  /// Each ray begins at the pinhole of the view and meets that of the middle view at the focus distance.
  [[nodiscard]] Position at(size_t y, size_t x, double disparity) const {
    const double nearness = 1 - disparity / infinity_px(), share = 1 / nearness;
    double focus = 1, focus_y = pixel_ * (static_cast<double>(y) + 0.5 - middle_y_),
           focus_x = pixel_ * (static_cast<double>(x) + 0.5 - middle_x_);
    if (geometry_.lens) {
      const auto [ray_x, ray_y] = geometry_.lens->ray(static_cast<double>(x), static_cast<double>(y));
      focus = geometry_.lens->focus_m;
      focus_y = focus * ray_y;
      focus_x = focus * ray_x;
    }
    return {pinhole_x_ + share * (focus_x - pinhole_x_), pinhole_y_ + share * (focus_y - pinhole_y_), focus * share};
  }

 private:
  const PointGeometry& geometry_;
  double pixel_, middle_y_, middle_x_, pinhole_y_ = 0, pinhole_x_ = 0;
};

}  // namespace

Result<std::vector<uint8_t>> encode_point_cloud(const DisparityMap& map, const Image& picture,
                                                const lightfield::Shape& views, const PointGeometry& geometry,
                                                float least_confidence) {
  const size_t width = map.disparity.width, height = map.disparity.height;
  E2LF_REQUIRE(picture.width == width && picture.height == height, "a picture of the view");
  if (geometry.lens && (geometry.lens->width != width || geometry.lens->height != height)) {
    return fail(ErrorCode::kShape, "", "the lens was calibrated with views of ", geometry.lens->width, "x",
                geometry.lens->height, " px, but these have ", width, "x", height,
                " px; calibrate with views of this size");
  }
  const Positions positions(map, views, geometry);
  std::vector<uint8_t> points;
  size_t count = 0;
  for (size_t y = 0; y < height; ++y) {
    for (size_t x = 0; x < width; ++x) {
      const size_t i = y * width + x;
      if (map.confidence.pixels[i] < least_confidence || hangs_between_surfaces(map, y, x)) continue;
      const float d = map.disparity.pixels[i];
      if (d >= positions.infinity_px()) {
        if (geometry.lens) continue;  // noise of very far points
        return fail(ErrorCode::kInvalidValue, "", "the disparity at (", y, ", ", x, ") is ", d,
                    " px, not less than that of infinity, ", geometry.infinity_px, " px; give a larger one");
      }
      for (const double value : positions.at(y, x, d)) append(points, static_cast<float>(value));
      for (size_t channel = 0; channel < picture.channels; ++channel) {
        const float value = std::clamp(picture.pixels[i * picture.channels + channel], 0.0F, 1.0F);
        points.push_back(static_cast<uint8_t>(255 * value + 0.5F));
      }
      append(points, map.confidence.pixels[i]);
      ++count;
    }
  }
  std::vector<uint8_t> bytes;
  append_text(bytes, cat("ply\nformat binary_little_endian 1.0\n", "comment x right, y down, z away from the camera; ",
                         geometry.lens ? geometry.lens->focus_m : 1.0, " = the distance of disparity 0; infinity at ",
                         positions.infinity_px(), " px\n", "element vertex ", count,
                         "\nproperty float x\nproperty float y\nproperty float z\n",
                         picture.channels == 1 ? "property uchar grey\n"
                                               : "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                         "property float confidence\nend_header\n"));
  bytes.insert(bytes.end(), points.begin(), points.end());
  return bytes;
}

std::array<double, 2> Lens::ray(double x_px, double y_px) const {
  constexpr int kIterations = 20;  // the distortion is inverted by fixed-point iteration, as OpenCV does
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const double distorted_x = (x_px - centre_px[0]) / focal_px[0], distorted_y = (y_px - centre_px[1]) / focal_px[1];
  double x = distorted_x, y = distorted_y;
  for (int i = 0; i < kIterations; ++i) {
    const double r2 = x * x + y * y, radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double next_x = (distorted_x - 2 * p1 * x * y - p2 * (r2 + 2 * x * x)) / radial;
    y = (distorted_y - p1 * (r2 + 2 * y * y) - 2 * p2 * x * y) / radial;
    x = next_x;
  }
  return {x, y};
}

Result<Lens> read_lens(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Json json, read_json(path));
  Lens lens;
  OptionReader reader(json, path.string() + ": $");
  E2LF_VISIT(lens, reader, width, height, focal_px, centre_px, distortion, baseline_m, focus_m);
  E2LF_RETURN_IF_ERROR(reader.finish());
  const std::pair<const char*, double> lengths[] = {{"width", static_cast<double>(lens.width)},
                                                    {"height", static_cast<double>(lens.height)},
                                                    {"focal_px", lens.focal_px[0]},
                                                    {"focal_px", lens.focal_px[1]},
                                                    {"baseline_m", lens.baseline_m},
                                                    {"focus_m", lens.focus_m}};
  for (const auto& [name, value] : lengths) {
    if (value > 0) continue;
    return fail(ErrorCode::kInvalidValue, reader.child_location(name),
                "the lens needs a positive length; calibrate it again");
  }
  return lens;
}

}  // namespace e2lf::depth
