// SPDX-License-Identifier: MIT
#include <algorithm>
#include <span>
#include <torch/torch.h>

#include "e2lf/geometry/shift.h"
#include "e2lf/learn/network/network_module.h"

namespace e2lf::learn {
namespace {

using geometry::LinearShift, geometry::Viewpoints;
using torch::autograd::AutogradContext, torch::autograd::variable_list;

/// Returns `length` elements along an axis: element i is the sum of weights[n] x[first + i + n].
torch::Tensor weighted_slices(const torch::Tensor& x, int64_t axis, int64_t first, std::span<const float> weights,
                              int64_t length) {
  torch::Tensor sum;
  for (size_t n = 0; n < weights.size(); ++n) {
    if (weights[n] == 0.0F) continue;
    const auto slice = x.narrow(axis, first + static_cast<int64_t>(n), length);
    sum = sum.defined() ? sum.add_(slice, weights[n]) : slice * weights[n];
  }
  return sum;
}

/// Adds the gradient of weighted_slices() with respect to x.
void add_to_slices(const torch::Tensor& gradient, int64_t axis, int64_t first, std::span<const float> weights,
                   const torch::Tensor& of_x) {
  for (size_t n = 0; n < weights.size(); ++n) {
    if (weights[n] == 0.0F) continue;
    of_x.narrow(axis, first + static_cast<int64_t>(n), gradient.size(axis)).add_(gradient, weights[n]);
  }
}

/// Differentiable weighted_slices().
class Slices : public torch::autograd::Function<Slices> {
 public:
  static torch::Tensor forward(AutogradContext* context, const torch::Tensor& x, int64_t axis, int64_t first,
                               const std::vector<float>& weights, int64_t length) {
    context->saved_data["axis"] = axis;
    context->saved_data["first"] = first;
    context->saved_data["sizes"] = x.sizes().vec();
    context->saved_data["weights"] = torch::tensor(at::ArrayRef<float>(weights));
    return weighted_slices(x, axis, first, weights, length);
  }

  static variable_list backward(AutogradContext* context, const variable_list& gradients) {
    const auto weights = context->saved_data["weights"].toTensor();
    const auto of_x = torch::zeros(context->saved_data["sizes"].toIntVector(), gradients[0].options());
    add_to_slices(gradients[0], context->saved_data["axis"].toInt(), context->saved_data["first"].toInt(),
                  {weights.data_ptr<float>(), static_cast<size_t>(weights.numel())}, of_x);
    return {of_x, {}, {}, {}, {}};
  }
};

/// The shifts of the pictures of all samples, by sample, disparity, and picture.
struct Shifts {
  int64_t samples, planes, pictures, reach = 0;
  std::vector<LinearShift> down, across;

  Shifts(const torch::Tensor& offsets, const std::vector<double>& disparities)
      : samples(offsets.size(0)), planes(static_cast<int64_t>(disparities.size())), pictures(offsets.size(1)) {
    const auto values = offsets.to(torch::kDouble).contiguous();
    const double* const offset = values.data_ptr<double>();
    for (int64_t s = 0; s < samples; ++s) {
      for (const double disparity : disparities) {
        for (int64_t p = 0; p < pictures; ++p) {
          const double* const own = offset + 2 * (s * pictures + p);
          down.push_back(geometry::linear_shift(own[0] * disparity));
          across.push_back(geometry::linear_shift(own[1] * disparity));
        }
      }
    }
    reach = static_cast<int64_t>(std::max(geometry::reach_of(down), geometry::reach_of(across)));
  }

  /// Calls visit(sample, plane, picture, number of the shift) for each shift.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    size_t n = 0;
    for (int64_t s = 0; s < samples; ++s) {
      for (int64_t k = 0; k < planes; ++k) {
        for (int64_t p = 0; p < pictures; ++p) visit(s, k, p, n++);
      }
    }
  }
};

constexpr int64_t kDown = -2, kAcross = -1;  // axes

/// The sums over the pictures at each disparity, and of their squares, for pictures [batch, P, G, y, x] with a border
/// of zeros of the reach of the shifts: [2, batch, K, G, y, x]. Pictures are moved again for the gradient, because
/// keeping them would need P times the memory of the sums.
class SweepSums : public torch::autograd::Function<SweepSums> {
 public:
  static torch::Tensor forward(AutogradContext* context, const torch::Tensor& pictures, const torch::Tensor& offsets,
                               const std::vector<double>& disparities) {
    const Shifts shifts(offsets, disparities);
    context->save_for_backward({pictures, offsets, torch::tensor(at::ArrayRef<double>(disparities), torch::kDouble)});
    const int64_t height = pictures.size(3) - 2 * shifts.reach, width = pictures.size(4) - 2 * shifts.reach;
    const auto sums =
        torch::zeros({2, pictures.size(0), shifts.planes, pictures.size(2), height, width}, pictures.options());
    shifts.for_each([&](int64_t s, int64_t k, int64_t p, size_t n) {
      const auto moved = move(of_sample(pictures, 0, s, shifts).select(1, p), shifts, n);
      of_sample(sums[0], 0, s, shifts).select(1, k).add_(moved);
      of_sample(sums[1], 0, s, shifts).select(1, k).addcmul_(moved, moved);
    });
    return sums;
  }

  static variable_list backward(AutogradContext* context, const variable_list& gradients) {
    const auto saved = context->get_saved_variables();
    const auto& pictures = saved[0];
    const double* const disparities = saved[2].data_ptr<double>();
    const Shifts shifts(saved[1], {disparities, disparities + saved[2].numel()});
    const auto of_sums = gradients[0].contiguous();
    const auto result = torch::zeros_like(pictures);
    shifts.for_each([&](int64_t s, int64_t k, int64_t p, size_t n) {
      const auto moved = move(of_sample(pictures, 0, s, shifts).select(1, p), shifts, n);
      const auto of_moved = of_sample(of_sums[0], 0, s, shifts)
                                .select(1, k)
                                .addcmul(moved, of_sample(of_sums[1], 0, s, shifts).select(1, k), 2.0);
      move_back(of_moved, shifts, n, of_sample(result, 0, s, shifts).select(1, p));
    });
    return {result, {}, {}};
  }

 private:
  /// Returns the samples that have the offsets of sample `s`: itself, or all of them.
  static torch::Tensor of_sample(const torch::Tensor& x, int64_t axis, int64_t s, const Shifts& shifts) {
    const int64_t length = x.size(axis) / shifts.samples;
    return x.narrow(axis, s * length, length);
  }

  static torch::Tensor move(const torch::Tensor& picture, const Shifts& shifts, size_t n) {
    const LinearShift &down = shifts.down[n], &across = shifts.across[n];
    const auto moved = weighted_slices(picture, kDown, shifts.reach + down.first, down.weights,
                                       picture.size(kDown) - 2 * shifts.reach);
    return weighted_slices(moved, kAcross, shifts.reach + across.first, across.weights,
                           picture.size(kAcross) - 2 * shifts.reach);
  }

  static void move_back(const torch::Tensor& gradient, const Shifts& shifts, size_t n,
                        const torch::Tensor& of_picture) {
    auto sizes = of_picture.sizes().vec();
    sizes[sizes.size() - 2] = gradient.size(kDown);
    const auto of_lines = torch::zeros(sizes, gradient.options());
    add_to_slices(gradient, kAcross, shifts.reach + shifts.across[n].first, shifts.across[n].weights, of_lines);
    add_to_slices(of_lines, kDown, shifts.reach + shifts.down[n].first, shifts.down[n].weights, of_picture);
  }
};

torch::Tensor in_float(const torch::Tensor& x) {
  return x.scalar_type() == torch::kDouble ? x : x.to(torch::kFloat);
}

/// Returns both maps of the planes [batch, 2, K, y, x]: opacities, of which the last is 1, and intensities, with edges
/// repeated for the reach of the shifts.
torch::Tensor maps_of_planes(const torch::Tensor& input, const Viewpoints& viewpoints) {
  const auto planes = static_cast<int64_t>(viewpoints.planes), reach = static_cast<int64_t>(viewpoints.reach);
  const auto opaque = torch::ones_like(input.narrow(1, 0, 1));
  const auto maps =
      torch::cat({torch::sigmoid(input.narrow(1, 0, planes - 1)), opaque, input.narrow(1, planes, planes)}, 1);
  return at::replication_pad2d(maps, {reach, reach, reach, reach}).unflatten(1, {2, planes});
}

}  // namespace

torch::Tensor sweep_planes(const torch::Tensor& pictures, const torch::Tensor& offsets,
                           const std::vector<double>& disparities, int64_t window) {
  const int64_t reach = Shifts(offsets, disparities).reach, planes = static_cast<int64_t>(disparities.size());
  const auto bordered = at::constant_pad_nd(pictures, {reach, reach, reach, reach}).contiguous();
  const auto sums = SweepSums::apply(bordered, offsets, disparities);
  const auto squares = sums[1];
  const auto products = 0.5 * (sums[0].square() - squares);
  const auto means = torch::avg_pool2d(torch::cat({products, squares}, 1).mean(2), window, 1, window / 2);
  return means.narrow(1, 0, planes) / (1.0 + means.narrow(1, planes, planes));
}

torch::Tensor apply_plane_sweep(const TorchCall& call) {
  const torch::Tensor& input = call.inputs[0];
  const std::vector<double> offsets = geometry::numbers(call.layer, "offsets");
  const auto pictures = static_cast<int64_t>(offsets.size() / 2);
  const auto of_all = torch::tensor(at::ArrayRef<double>(offsets), torch::kDouble).reshape({1, pictures, 2});
  return sweep_planes(in_float(input).unflatten(1, {pictures, -1}), of_all,
                      geometry::numbers(call.layer, "disparities"), static_cast<int64_t>(call.layer.kernel))
      .to(input.scalar_type());
}

torch::Tensor apply_render_layers(const TorchCall& call) {
  const torch::Tensor& input = call.inputs[0];
  const Viewpoints viewpoints(call.layer);
  const auto maps = maps_of_planes(in_float(input), viewpoints);
  const auto reach = static_cast<int64_t>(viewpoints.reach);
  const auto shifted = [&](const torch::Tensor& map, int64_t axis, const geometry::CubicShift& shift) {
    return Slices::apply(map, axis, reach + shift.first, std::vector<float>(shift.weights.begin(), shift.weights.end()),
                         map.size(axis) - 2 * reach);
  };
  std::vector<torch::Tensor> views;
  for (size_t row = 0; row < viewpoints.rows; ++row) {
    std::vector<torch::Tensor> lines;
    for (size_t k = 0; k < viewpoints.planes; ++k) {
      const auto both = maps.select(2, static_cast<int64_t>(k));
      lines.push_back(shifted(both, kDown, viewpoints.down[row * viewpoints.planes + k]));
    }
    for (size_t column = 0; column < viewpoints.columns; ++column) {
      torch::Tensor view, passed;
      for (size_t k = 0; k < viewpoints.planes; ++k) {
        const auto moved = shifted(lines[k], kAcross, viewpoints.across[column * viewpoints.planes + k]);
        const auto opacity = moved.select(1, 0).clamp(0.0, 1.0);
        const auto share = passed.defined() ? passed * opacity : opacity;
        const auto light = share * moved.select(1, 1);
        view = view.defined() ? view + light : light;
        passed = passed.defined() ? passed - share : 1.0 - share;
      }
      views.push_back(view);
    }
  }
  return torch::stack(views, 1).to(input.scalar_type());
}

torch::Tensor apply_warp(const TorchCall& call) {
  const geometry::Warp warp(call.layer);
  const auto pictures = in_float(call.inputs[0]).unflatten(1, {-1, static_cast<int64_t>(warp.pictures())});
  const auto disparity = in_float(call.inputs[1]).select(1, 0).clamp(warp.least, warp.most);
  const auto places = [&](int64_t axis, int64_t size, double offset) {
    const auto numbers = torch::arange(size, disparity.options());
    const auto place = (axis == 1 ? numbers.unsqueeze(1) : numbers) + offset * disparity;
    return place * (2.0 / std::max<int64_t>(size - 1, 1)) - 1.0;
  };
  std::vector<torch::Tensor> moved;
  for (size_t p = 0; p < warp.pictures(); ++p) {
    const auto down = places(1, pictures.size(3), warp.offsets[2 * p]);
    const auto across = places(2, pictures.size(4), warp.offsets[2 * p + 1]);
    moved.push_back(torch::grid_sampler(pictures.select(2, static_cast<int64_t>(p)), torch::stack({across, down}, -1),
                                        /*interpolation_mode=*/0, /*padding_mode=*/1, /*align_corners=*/true));
  }
  return torch::stack(moved, 2).flatten(1, 2).to(call.inputs[0].scalar_type());
}

}  // namespace e2lf::learn
