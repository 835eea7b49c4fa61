// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/engine/engine.h"

namespace e2lf::engine {

/// A network on a device other than the CPU. Any number of threads may run it at once.
class DeviceNetwork {
 public:
  DeviceNetwork() = default;
  DeviceNetwork(const DeviceNetwork&) = delete;
  DeviceNetwork& operator=(const DeviceNetwork&) = delete;
  virtual ~DeviceNetwork() = default;

  /// Computes what Engine::run() computes.
  [[nodiscard]] virtual Result<void> run(std::span<const float> input, size_t height, size_t width,
                                         std::span<float> output) const = 0;
  [[nodiscard]] virtual Precision precision() const = 0;
  /// Returns the lines of Engine::describe().
  [[nodiscard]] virtual std::vector<std::string> describe() const = 0;
};

/// The devices of one kind, such as "cuda" for "cuda" and "cuda:1".
struct DeviceKind {
  /// Fails with kMissingDependency if this machine has no device of the name.
  std::function<Result<void>(const std::string& name)> check;
  /// Prepares a network on EngineOptions::device. Fails as Engine::create() does.
  std::function<Result<std::shared_ptr<const DeviceNetwork>>(const model::Network&, const model::Weights&,
                                                             const EngineOptions&)>
      open;
};

/// Makes a kind of devices known to Engine::create(). A name that is taken breaks the contract.
void add_device_kind(const std::string& kind, DeviceKind devices);

/// Returns whether the kind of a device is known. "cpu" always is.
[[nodiscard]] bool is_known_device(const std::string& name);

/// Fails with kMissingDependency if the kind of a device is not known or if this machine has no such device.
[[nodiscard]] Result<void> check_device(const std::string& name);

}  // namespace e2lf::engine
