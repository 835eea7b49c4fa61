// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/engine/plan_builder.h"
#include "e2lf/engine/reference.h"
#include "e2lf/model/operation.h"

namespace e2lf::engine {

/// An operation that this engine runs beside those of model::Op: what it means for a network, how it is computed, and a
/// slow computation against which tests compare it. docs/library.md adds one.
struct Operation {
  model::Operation model;

  /// Adds the stages of a layer: usually one kernel, by PlanBuilder::add(). Fails as PlanBuilder does.
  Result<void> (*plan)(PlanBuilder& build, const model::Layer& layer) = nullptr;

  /// Computes the output in double precision. Fails with kNotFound if a weight is missing.
  Result<ReferencePlanes> (*reference)(ReferenceCall& call) = nullptr;

  bool has_wide_sums = false;  ///< its output can be float32 if its inputs are bfloat16
};

/// Makes an operation known to this process, to model files and to the engine, before the first network with it is
/// used. A name that is taken breaks the contract.
void add_operation(const Operation& operation);

/// Returns the added operation of that name, or null.
[[nodiscard]] const Operation* find_operation(const std::string& name);

}  // namespace e2lf::engine
