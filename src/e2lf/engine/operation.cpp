// SPDX-License-Identifier: MIT
#include "e2lf/engine/operation.h"

#include <map>
#include <mutex>

#include "e2lf/base/contract.h"

namespace e2lf::engine {
namespace {

/// The operations by name. Pointers to the elements of a map stay valid.
struct Registry {
  std::mutex mutex;
  std::map<std::string, Operation> operations;
};

Registry& registry() {
  static Registry instance;
  return instance;
}

}  // namespace

void add_operation(const Operation& operation) {
  E2LF_REQUIRE(operation.plan != nullptr && operation.reference != nullptr, "the engine cannot compute it");
  model::add_operation(operation.model);
  const std::scoped_lock lock(registry().mutex);
  registry().operations.emplace(operation.model.name, operation);
}

const Operation* find_operation(const std::string& name) {
  const std::scoped_lock lock(registry().mutex);
  const auto found = registry().operations.find(name);
  return found == registry().operations.end() ? nullptr : &found->second;
}

}  // namespace e2lf::engine
