// Reads the model that is bundled with e2lf and prepares its network.
#include <cstdio>
#include <e2lf/engine/engine.h>
#include <e2lf/files/bundled_files.h>
#include <e2lf/model/model.h>

int main() {
  const auto path = e2lf::bundled_model();
  if (!path) return 1;
  const auto model = e2lf::model::read_model(*path);
  if (!model) return 2;
  std::printf("%s\n", path->c_str());
  return e2lf::engine::Engine::create(model->network, model->weights) ? 0 : 3;
}
