// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/trainer.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <numbers>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/run/torch_setup.h"

namespace e2lf::learn {
namespace {

constexpr uint64_t kEvaluationSeed = 20;

PatternTie tie_of(const PatternConfig& patterns) {
  if (patterns.complementary) return PatternTie::kComplementary;
  if (patterns.whole_cycle) return PatternTie::kWholeCycle;
  return patterns.black_first ? PatternTie::kBlackFirst : PatternTie::kNone;
}

NamedTensors without(NamedTensors tensors, const NamedTensors& left_out) {
  std::erase_if(tensors, [&](const auto& entry) { return left_out.contains(entry.first); });
  return tensors;
}

/// Reads the codes [n, views], where n is between `fewest` and patterns.num_codes(). From a whole cycle, the codes
/// before the inverses are taken.
Result<torch::Tensor> read_codes(const std::string& name, size_t fewest, const PatternConfig& patterns,
                                 torch::Device device) {
  E2LF_ASSIGN_OR_RETURN(capture::Codes codes, read_pattern_set(name));
  if (patterns.whole_cycle) codes = capture::codes_of_whole_cycle(codes).value_or(codes);
  const uint64_t most = patterns.num_codes();
  if (codes.num_patterns < fewest || codes.num_patterns > most ||
      (patterns.whole_cycle && !capture::is_black_first(codes))) {
    return fail(ErrorCode::kShape, name, "the file does not contain ", fewest < most ? "at most " : "", most,
                " patterns", patterns.whole_cycle ? " that begin with black" : "",
                ", as patterns.num_patterns requires; choose another file");
  }
  return to_tensor(codes, device);
}

/// Returns a configuration as a model file stores it, without the folders of files.
Json without_folders(Config config) {
  for (std::string* path :
       {&config.start, &config.data.file, &config.sensor.camera, &config.patterns.codes, &config.patterns.start}) {
    *path = std::filesystem::path(*path).filename().string();
  }
  for (auto* const paths : {&config.patterns.known, &config.patterns.evaluated}) {
    for (std::string& path : *paths) path = std::filesystem::path(path).filename().string();
  }
  return to_json(config);
}

SceneScore mean_score(const std::vector<SceneScore>& scores) {
  SceneScore mean{.name = "mean"};
  for (const SceneScore& score : scores) {
    mean.score += score.score / static_cast<double>(scores.size());
    mean.events_per_pixel += score.events_per_pixel / static_cast<double>(scores.size());
  }
  return mean;
}

constexpr const char* kCheckpointVersion = "1";

void add_tensors(Safetensors& file, const std::string& prefix, const NamedTensors& tensors) {
  for (const auto& [name, tensor] : tensors) {
    const auto values = tensor.detach().to(torch::kCPU, torch::kFloat).contiguous();
    std::vector<size_t> shape(values.sizes().begin(), values.sizes().end());
    file.tensors[prefix + name] =
        make_npy<float>(shape, std::span<const float>(values.data_ptr<float>(), static_cast<size_t>(values.numel())));
  }
}

Result<void> take_tensors(const Safetensors& file, const std::string& prefix, const NamedTensors& tensors,
                          const std::string& location) {
  torch::NoGradGuard no_grad;
  for (const auto& [name, tensor] : tensors) {
    E2LF_ASSIGN_OR_RETURN(const e2lf::Tensor* stored, file.find(prefix + name, location));
    if (static_cast<int64_t>(stored->num_elements()) != tensor.numel()) {
      return fail(ErrorCode::kShape, location, "\"", prefix, name,
                  "\" has another shape; resume with the network of the run");
    }
    E2LF_ASSIGN_OR_RETURN(const auto values, stored->to_float(location));
    auto target = tensor;
    target.copy_(torch::tensor(at::ArrayRef<float>(values)).reshape(tensor.sizes()));
  }
  return {};
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

Trainer::Trainer(Config config, std::unique_ptr<Task> task, torch::Device device, const Peers& peers)
    : config_(std::move(config)),
      device_(device),
      peers_(peers),
      task_(std::move(task)),
      patterns_(config_.patterns.num_patterns, tie_of(config_.patterns), device),
      pattern_parameters_{{"patterns", patterns_.parameters()}},
      by_muon_(config_.train.optimiser == "muon" ? task_->weights_of_muon() : NamedTensors()),
      by_adam_(without(parameters(), by_muon_)),
      muon_(by_muon_),
      adam_(by_adam_, config_.train.adam_decay),
      pattern_adam_(pattern_parameters_),
      average_(clone(parameters())) {}

Result<Trainer> Trainer::create(const Config& given, const Peers& peers) {
  Config config = given;
  if (config.train.batch % static_cast<uint64_t>(peers.size()) != 0) {
    return fail(ErrorCode::kInvalidValue, "train.batch", "a batch of ", config.train.batch,
                " cannot be split evenly between ", peers.size(), " processes; make it a multiple of this number");
  }
  E2LF_ASSIGN_OR_RETURN(const torch::Device device, open_device(config.device));
  E2LF_ASSIGN_OR_RETURN(auto task, open_task(config, device));
  Trainer trainer(config, std::move(task), device, peers);
  E2LF_RETURN_IF_ERROR(trainer.choose_patterns());
  if (!config.start.empty()) E2LF_RETURN_IF_ERROR(trainer.start_at(config.start));
  return trainer;
}

Result<void> Trainer::choose_patterns() {
  const PatternConfig& patterns = config_.patterns;
  if (model::measurement_of(config_.input).value() == capture::MeasurementKind::kLensArray) {
    fixed_codes_ = torch::ones({1, kViews}, torch::device(device_));
  } else if (!patterns.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(fixed_codes_, read_codes(patterns.codes, patterns.num_codes(), patterns, device_));
    if (patterns.whole_cycle) {
      fixed_codes_ = torch::cat({fixed_codes_, 1.0 - fixed_codes_, fixed_codes_.slice(0, 0, 1)});
    }
  } else if (!patterns.start.empty()) {
    const auto fewest = static_cast<size_t>(std::min<uint64_t>(2, patterns.num_codes()));
    E2LF_ASSIGN_OR_RETURN(const auto codes, read_codes(patterns.start, fewest, patterns, device_));
    patterns_.start_at(codes);
  } else if (patterns.noise_start > 0.0) {
    patterns_.start_at_noise(patterns.noise_start);
  }
  return {};
}

Result<void> Trainer::start_at(const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const auto path, find_file_or_bundled(kBundledModels, name));
  E2LF_ASSIGN_OR_RETURN(const auto model, model::read_model(path));
  const auto weights = task_->starting_weights(model);
  if (!weights) return Error{weights.error().code, weights.error().message, name};
  E2LF_RETURN_IF_ERROR(load_weights(parameters(), *weights, name));
  average_ = clone(parameters());
  return {};
}

torch::Tensor Trainer::current_codes() const {
  if (fixed_codes_.defined()) return fixed_codes_;
  const PatternConfig& patterns = config_.patterns;
  if (!learning_patterns()) return patterns_.binary_codes();
  const double progress = static_cast<double>(step_) / static_cast<double>(patterns.learn_steps);
  return patterns_.codes(patterns.scale_begin * std::pow(patterns.scale_end / patterns.scale_begin, progress));
}

Result<void> Trainer::start_together() {
  auto step = torch::tensor({static_cast<int64_t>(step_)}, torch::device(device_));
  E2LF_RETURN_IF_ERROR(peers_.copy_from_first(step));
  step_ = static_cast<uint64_t>(step.item<int64_t>());
  for (const auto& [prefix, tensors] : state()) {
    for (const auto& [name, tensor] : *tensors) E2LF_RETURN_IF_ERROR(peers_.copy_from_first(tensor.detach()));
  }
  return {};
}

Result<bool> Trainer::any_peer(bool value) const {
  const auto votes = torch::tensor({value ? 1 : 0}, torch::device(device_));
  E2LF_RETURN_IF_ERROR(peers_.sum(votes));
  return votes.item<int>() > 0;
}

/// Averages in one message for all.
Result<void> Trainer::replace_by_peers_mean(const NamedTensors& tensors) const {
  if (peers_.size() == 1) return {};
  std::vector<torch::Tensor> parts;
  for (const auto& [name, tensor] : tensors) parts.push_back(tensor.flatten());
  const auto sums = torch::cat(parts);
  E2LF_RETURN_IF_ERROR(peers_.sum(sums));
  int64_t offset = 0;
  for (const auto& [name, tensor] : tensors) {
    auto target = tensor;
    target.copy_(sums.slice(0, offset, offset + tensor.numel()).reshape(tensor.sizes()) / peers_.size());
    offset += tensor.numel();
  }
  return {};
}

Result<void> Trainer::backward(const torch::Tensor& loss) {
  zero_gradients(parameters());
  zero_gradients(pattern_parameters_);
  loss.backward();
  NamedTensors gradients;
  const auto add = [&](const NamedTensors& parameters) {
    for (const auto& [name, tensor] : parameters) {
      // Patterns that are not learned have none.
      if (tensor.grad().defined()) gradients.emplace(name, tensor.grad());
    }
  };
  add(parameters());
  add(pattern_parameters_);
  return replace_by_peers_mean(gradients);
}

Result<StepReport> Trainer::train_step() {
  NamedTensors input_means;
  E2LF_ASSIGN_OR_RETURN(const StepLoss now, task_->loss(step_, {peers_.rank(), peers_.size()}, current_codes(),
                                                        config_.train.centred ? &input_means : nullptr));
  E2LF_RETURN_IF_ERROR(backward(now.loss));
  const auto means =
      torch::tensor({now.loss.item<double>(), now.figure.item<double>()}, torch::device(device_).dtype(torch::kDouble));
  E2LF_RETURN_IF_ERROR(replace_by_peers_mean({{"loss and error", means}}));
  E2LF_RETURN_IF_ERROR(replace_by_peers_mean(input_means));
  centre_gradients(parameters(), input_means);
  const StepReport report{means[0].item<double>(), means[1].item<double>(),
                          clip_gradients(parameters(), config_.train.clip_norm)};
  if (!std::isfinite(report.loss) || !std::isfinite(report.gradient_norm)) return report;

  const double rate = learning_rate(config_.train, step_);
  const auto before = clone(parameters());
  muon_.update(by_muon_, rate);
  adam_.update(by_adam_, rate, step_ + 1);
  keep_mean_outputs(parameters(), before, input_means);
  if (learning_patterns() && step_ >= config_.patterns.begin_step) {
    pattern_adam_.update(pattern_parameters_, config_.patterns.learning_rate, step_ + 1 - config_.patterns.begin_step);
  }
  // At first the average follows quickly, so that it forgets the random initialisation.
  const double steps = static_cast<double>(step_);
  update_average(average_, parameters(), std::min(config_.train.ema, (1.0 + steps) / (10.0 + steps)));
  ++step_;
  return report;
}

Result<std::vector<SceneScore>> Trainer::evaluate(const std::vector<std::string>& scenes,
                                                  const capture::SensorProfile& camera, size_t cycles) const {
  const auto codes = (current_codes().detach() > 0.5).to(torch::kFloat);
  std::vector<SceneScore> scores;
  for (const std::string& name : scenes) {
    E2LF_ASSIGN_OR_RETURN(auto of_scene, task_->evaluate(average_, fixed_codes_.defined() ? fixed_codes_ : codes, name,
                                                         {camera, cycles, kEvaluationSeed}));
    for (SceneScore& score : of_scene) {
      if (camera.is_pixel()) score.name += "@" + camera.name;
      scores.push_back(std::move(score));
    }
  }
  return scores;
}

std::vector<capture::SensorProfile> Trainer::cameras() const {
  std::vector<capture::SensorProfile> list(1);
  list.front().constants = config_.sensor.nominal;
  if (task_->samples().camera()) list.push_back(*task_->samples().camera());
  return list;
}

StepRow Trainer::step_row(const StepReport& report, double samples_per_s) const {
  const auto codes = current_codes().detach();
  return {.step = step_,
          .samples = step_ * config_.train.batch,
          .loss = report.loss,
          .figure = report.figure,
          .learning_rate = learning_rate(config_.train, step_),
          .gradient_norm = report.gradient_norm,
          .samples_per_s = samples_per_s,
          .open_cells = codes.sum().item<double>(),
          .binarity = (2.0 * codes - 1.0).abs().mean().item<double>()};
}

/// Every process evaluates, so that none waits longer for another than kPatience; the first one writes.
Result<void> Trainer::log_evaluation(const RunLog& log) const {
  const uint64_t samples = step_ * config_.train.batch;
  std::vector<SceneScore> all;
  for (const capture::SensorProfile& camera : cameras()) {
    E2LF_ASSIGN_OR_RETURN(const auto scores, evaluate(task_->samples().validation(), camera));
    all.insert(all.end(), scores.begin(), scores.end());
  }
  if (!peers_.leads()) return {};
  if (all.size() > 1) all.push_back(mean_score(all));
  for (const SceneScore& score : all) E2LF_RETURN_IF_ERROR(log.add(step_, samples, score));
  const auto codes = current_codes().detach().to(torch::kCPU, torch::kFloat).contiguous();
  const std::span<const float> cells(codes.data_ptr<float>(), static_cast<size_t>(codes.numel()));
  E2LF_RETURN_IF_ERROR(log.add(step_, samples, cells));
  return log.draw_curves(config_.name, to_json(config_));
}

Result<void> Trainer::run(const std::filesystem::path& folder, const ProgressFn& progress,
                          const std::function<bool()>& keep_going) {
  const auto checkpoint = folder / "checkpoint.safetensors";
  E2LF_RETURN_IF_ERROR(start_together());
  if (step_ > config_.train.steps) {
    return fail(ErrorCode::kInvalidValue, "train.steps", "the run has already trained ", step_,
                " steps; give at least as many");
  }
  if (peers_.leads()) {
    E2LF_RETURN_IF_ERROR(write_file(folder / "config.json", json_text(to_json(config_))));
    const std::vector<std::string> scenes = task_->samples().trained_scenes();
    if (!scenes.empty())
      log_info(cat("the samples that are not synthesised are parts of ", scenes.size(), " scenes: ", join(scenes)));
  }
  const RunLog log(folder, figures());
  const auto draw_curves = [&]() -> Result<void> {
    return peers_.leads() ? log.draw_curves(config_.name, to_json(config_)) : Result<void>();
  };
  if (peers_.leads()) E2LF_RETURN_IF_ERROR(log.rewind(step_));
  E2LF_RETURN_IF_ERROR(draw_curves());
  using Clock = std::chrono::steady_clock;
  auto last_time = Clock::now();
  uint64_t last_step = step_;
  StepReport sum;
  while (step_ < config_.train.steps) {
    E2LF_ASSIGN_OR_RETURN(const StepReport report, train_step());
    if (!std::isfinite(report.loss) || !std::isfinite(report.gradient_norm)) {
      return fail(ErrorCode::kInvalidValue, checkpoint, "the loss is not finite after step ", step_,
                  "; lower train.learning_rate and resume from the last checkpoint");
    }
    sum = {sum.loss + report.loss, sum.figure + report.figure, sum.gradient_norm + report.gradient_norm};
    const bool ends = step_ == config_.train.steps;
    if (step_ % config_.train.log_steps == 0 || ends) {
      const double seconds = std::chrono::duration<double>(Clock::now() - last_time).count();
      const double speed = static_cast<double>((step_ - last_step) * config_.train.batch) / std::max(seconds, 1e-9);
      const auto steps = static_cast<double>(step_ - last_step);
      const StepReport mean{sum.loss / steps, sum.figure / steps, sum.gradient_norm / steps};
      if (peers_.leads()) E2LF_RETURN_IF_ERROR(log.add(step_row(mean, speed)));
      E2LF_RETURN_IF_ERROR(draw_curves());
      sum = {};
      last_time = Clock::now();
      last_step = step_;
    }
    if (step_ % config_.train.evaluate_steps == 0 || ends) E2LF_RETURN_IF_ERROR(log_evaluation(log));
    if (progress && peers_.leads()) progress(step_, config_.train.steps);
    E2LF_ASSIGN_OR_RETURN(const bool stop, any_peer(keep_going && !keep_going()));
    if (step_ % config_.train.checkpoint_steps == 0 || step_ == config_.train.steps || stop) {
      if (peers_.leads()) E2LF_RETURN_IF_ERROR(save_checkpoint(checkpoint));
    }
    if (stop) return fail(ErrorCode::kCancelled, folder, "training stopped; `e2lf resume` continues it");
  }
  return {};
}

std::vector<std::pair<const char*, const NamedTensors*>> Trainer::state() const {
  return {{"weights/", &parameters()},
          {"average/", &average_},
          {"momentum/", &muon_.momenta()},
          {"first/", &adam_.first_moments()},
          {"second/", &adam_.second_moments()},
          {"", &pattern_parameters_},
          {"first/", &pattern_adam_.first_moments()},
          {"second/", &pattern_adam_.second_moments()}};
}

Result<void> Trainer::save_checkpoint(const std::filesystem::path& path) const {
  Safetensors file;
  for (const auto& [prefix, tensors] : state()) add_tensors(file, prefix, *tensors);
  file.metadata = {
      {"version", kCheckpointVersion}, {"step", std::to_string(step_)}, {"config", json_line(to_json(config_))}};
  return write_safetensors(path, file);
}

Result<void> Trainer::load_checkpoint(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto file, read_safetensors(path));
  const auto version = file.metadata.find("version"), step = file.metadata.find("step");
  if (version == file.metadata.end() || version->second != kCheckpointVersion || step == file.metadata.end()) {
    return fail(ErrorCode::kFormat, path, "this is not a training checkpoint of this version; choose another file");
  }
  const std::string location = path.string();
  for (const auto& [prefix, tensors] : state()) {
    E2LF_RETURN_IF_ERROR(take_tensors(file, prefix, *tensors, location));
  }
  const std::string& number = step->second;
  if (std::from_chars(number.data(), number.data() + number.size(), step_).ec != std::errc()) {
    return fail(ErrorCode::kFormat, location, "the step of this checkpoint is not a number; choose another checkpoint");
  }
  return {};
}

Result<model::Model> Trainer::to_model() const {
  model::Model model;
  model.name = config_.name;
  model.num_patterns = config_.patterns.num_patterns;
  const auto codes = fixed_codes_.defined() ? fixed_codes_ : patterns_.binary_codes();
  model.codes = to_codes(codes, model.views_y, model.views_x);
  model.event_model = capture::event_model_name(config_.patterns.event_model);
  model.black_first = capture::is_black_first(*model.codes);  // the first pattern may have been learned to be black
  if (!config_.patterns.in_model) model.codes.reset();
  model.constants = config_.sensor.nominal;
  model.camera = task_->samples().camera();
  model.input = config_.input;
  model.provenance = {{"samples", step_ * config_.train.batch},
                      {"steps", step_},
                      {"scenes", task_->samples().trained_scenes()},
                      {"config", without_folders(config_)}};
  return task_->complete(std::move(model), average_);
}

}  // namespace e2lf::learn
