// SPDX-License-Identifier: MIT
#include "e2lf/learn/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <numbers>

#include "e2lf/base/file.h"
#include "e2lf/learn/draws.h"
#include "e2lf/learn/input_form.h"

namespace e2lf::learn {
namespace {

constexpr uint64_t kInitialSeed = 0x1117, kEvaluationSeed = 20;

Result<void> append_line(const std::filesystem::path& path, const std::string& header, const std::string& line) {
  const bool fresh = !std::filesystem::exists(path);
  std::ofstream out(path, std::ios::app);
  if (fresh) out << header << '\n';
  out << line << '\n';
  if (!out.flush()) return Error{ErrorCode::kIo, "could not append; check the disk", path.string()};
  return {};
}

/// How far patterns are from 1/2 everywhere (0) on the way to binary (1).
double binarity(const torch::Tensor& codes) {
  return (2.0 * codes - 1.0).abs().mean().item<double>();
}

}  // namespace

double learning_rate(const TrainConfig& train, uint64_t step) {
  const auto number = [](uint64_t value) { return static_cast<double>(value); };
  if (step < train.warmup_steps) return train.learning_rate * number(step + 1) / number(train.warmup_steps);
  const uint64_t begin = std::max(train.hold_steps, train.warmup_steps);
  if (step < begin || train.steps <= begin) return train.learning_rate;
  const double progress = std::min(1.0, number(step - begin) / number(train.steps - begin));
  return train.learning_rate * 0.5 * (1.0 + std::cos(std::numbers::pi * progress));
}

Trainer::Trainer(Config config, Batches batches, NetworkModule network, torch::Device device)
    : config_(std::move(config)),
      device_(device),
      batches_(std::move(batches)),
      network_(std::move(network)),
      patterns_(config_.patterns.num_patterns, config_.patterns.black_first, device),
      pattern_parameters_{{"patterns", patterns_.parameters()}},
      adam_(network_.parameters()),
      pattern_adam_(pattern_parameters_),
      average_(clone(network_.parameters())) {}

Result<Trainer> Trainer::create(const Config& config) {
  const torch::Device device(config.device);
  E2LF_ASSIGN_OR_RETURN(auto dataset, read_dataset(config.data.file, device));
  E2LF_ASSIGN_OR_RETURN(auto batches, Batches::create(config, std::move(dataset), device));
  torch::manual_seed(mix_seed(config.seed, 0, kInitialSeed));
  Trainer trainer(config, std::move(batches), NetworkModule(make_network(config), device), device);
  if (!config.patterns.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(const auto model, model::read_model(config.patterns.codes));
    if (!model.codes || model.codes->num_patterns != config.patterns.num_patterns) {
      return Error{ErrorCode::kShape, "no codes with patterns.num_patterns patterns in this file; name another",
                   config.patterns.codes};
    }
    trainer.fixed_codes_ = to_tensor(*model.codes, device);
  }
  if (!config.start.empty()) {
    E2LF_ASSIGN_OR_RETURN(const auto model, model::read_model(config.start));
    E2LF_RETURN_IF_ERROR(load_weights(trainer.network_.parameters(), model.weights, config.start));
    trainer.average_ = clone(trainer.network_.parameters());
  }
  return trainer;
}

torch::ScalarType Trainer::compute_type() const {
  return config_.precision == "bfloat16" ? torch::kBFloat16 : torch::kFloat;
}

torch::Tensor Trainer::current_codes() const {
  if (fixed_codes_.defined()) return fixed_codes_;
  const PatternConfig& patterns = config_.patterns;
  if (!learning_patterns()) return patterns_.binary_codes();
  const double progress = static_cast<double>(step_) / static_cast<double>(patterns.learn_steps);
  return patterns_.codes(patterns.scale_begin * std::pow(patterns.scale_end / patterns.scale_begin, progress));
}

StepReport Trainer::train_step() {
  const Batch batch = batches_.at(step_);
  const Pipeline pipeline{&network_,     &network_.parameters(), current_codes(), config_.patterns.event_model,
                          config_.input, compute_type()};
  const auto result = reconstruct(pipeline, batch.light_field, batch.constants);
  const auto errors = (result.light_field - batch.light_field).square().mean({1, 2, 3});
  const auto loss = (errors * batch.gain.pow(-config_.train.gain_weight_power)).mean();

  zero_gradients(network_.parameters());
  zero_gradients(pattern_parameters_);
  loss.backward();
  const double norm = clip_gradients(network_.parameters(), config_.train.clip_norm);
  StepReport report{loss.item<double>(), errors.mean().item<double>(), norm};
  if (!std::isfinite(report.loss) || !std::isfinite(norm)) return report;

  const double rate = learning_rate(config_.train, step_);
  adam_.update(network_.parameters(), rate, step_ + 1);
  if (learning_patterns() && step_ >= config_.patterns.begin_step) {
    pattern_adam_.update(pattern_parameters_, config_.patterns.learning_rate, step_ + 1 - config_.patterns.begin_step);
  }
  // Early on the average follows quickly, so that it forgets the random start.
  const double steps = static_cast<double>(step_);
  update_average(average_, network_.parameters(), std::min(config_.train.ema, (1.0 + steps) / (10.0 + steps)));
  ++step_;
  return report;
}

Result<std::vector<SceneScore>> Trainer::evaluate(const std::vector<std::string>& scenes,
                                                  const aperture::SensorConstants& constants) const {
  const auto codes = (current_codes().detach() > 0.5).to(torch::kFloat);
  const Pipeline pipeline{
      &network_,     &average_,     fixed_codes_.defined() ? fixed_codes_ : codes, config_.patterns.event_model,
      config_.input, compute_type()};
  std::vector<SceneScore> scores;
  for (const std::string& name : scenes) {
    E2LF_ASSIGN_OR_RETURN(const Scene* scene, batches_.dataset().find(name));
    scores.push_back(evaluate_scene(pipeline, *scene, constants, kEvaluationSeed));
  }
  return scores;
}

Result<void> Trainer::write_logs(const std::filesystem::path& folder, const StepReport& report,
                                 double samples_per_s) const {
  if (step_ % config_.train.log_steps == 0 || step_ == config_.train.steps) {
    const auto codes = current_codes().detach();
    E2LF_RETURN_IF_ERROR(append_line(
        folder / "log.csv", "step,samples,loss,mse,learning_rate,gradient_norm,samples_per_s,open_cells,binarity",
        cat(step_, ',', step_ * config_.train.batch, ',', report.loss, ',', report.mse, ',',
            learning_rate(config_.train, step_), ',', report.gradient_norm, ',', samples_per_s, ',',
            codes.sum().item<double>(), ',', binarity(codes))));
  }
  if (step_ % config_.train.evaluate_steps != 0 && step_ != config_.train.steps) return {};
  E2LF_ASSIGN_OR_RETURN(const auto scores, evaluate(config_.data.validation, config_.sensor.nominal));
  for (const SceneScore& score : scores) {
    E2LF_RETURN_IF_ERROR(append_line(folder / "evaluation.csv", "step,samples,scene,psnr_db,events_per_pixel",
                                     cat(step_, ',', step_ * config_.train.batch, ',', score.name, ',', score.psnr_db,
                                         ',', score.events_per_pixel)));
  }
  return {};
}

Result<void> Trainer::run(const std::filesystem::path& folder, const ProgressFn& progress,
                          const std::function<bool()>& keep_going) {
  const auto checkpoint = folder / "checkpoint.safetensors";
  E2LF_RETURN_IF_ERROR(write_file(folder / "config.json", to_json(config_).dump(2) + "\n"));
  using Clock = std::chrono::steady_clock;
  auto last_time = Clock::now();
  uint64_t last_step = step_;
  while (step_ < config_.train.steps) {
    const StepReport report = train_step();
    if (!std::isfinite(report.loss) || !std::isfinite(report.gradient_norm)) {
      return Error{ErrorCode::kInvalidValue,
                   cat("the loss is not finite after step ", step_,
                       "; lower train.learning_rate and resume from the last checkpoint"),
                   checkpoint.string()};
    }
    const bool logs = step_ % config_.train.log_steps == 0;
    const double seconds = std::chrono::duration<double>(Clock::now() - last_time).count();
    const double speed = static_cast<double>((step_ - last_step) * config_.train.batch) / std::max(seconds, 1e-9);
    E2LF_RETURN_IF_ERROR(write_logs(folder, report, speed));
    if (logs) {
      last_time = Clock::now();
      last_step = step_;
    }
    if (progress) progress(step_, config_.train.steps);
    const bool stop = keep_going && !keep_going();
    if (step_ % config_.train.checkpoint_steps == 0 || step_ == config_.train.steps || stop) {
      E2LF_RETURN_IF_ERROR(save_checkpoint(checkpoint));
    }
    if (stop) return Error{ErrorCode::kCancelled, "training stopped; `e2lf resume` continues it", folder.string()};
  }
  return {};
}

model::Model Trainer::to_model() const {
  model::Model model;
  model.name = config_.name;
  model.num_patterns = config_.patterns.num_patterns;
  const auto codes = fixed_codes_.defined() ? fixed_codes_ : patterns_.binary_codes();
  model.codes = to_codes(codes, model.views_y, model.views_x);
  model.event_model = config_.patterns.event_model == EventModel::kQuantised ? "quantised" : "reference-aware";
  model.black_first = config_.patterns.black_first;
  model.constants = config_.sensor.nominal;
  model.input = config_.input;
  model.network = network_.network();
  model.weights = to_weights(average_);
  model.provenance = {{"samples", step_ * config_.train.batch}, {"steps", step_}, {"config", to_json(config_)}};
  return model;
}

}  // namespace e2lf::learn
