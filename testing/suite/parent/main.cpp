// Reads a model that is bundled with e2lf, whose operations are those of networks with a geometry, and reconstructs
// with it.
#include <cstdio>
#include <e2lf/files/bundled_files.h>
#include <e2lf/model/model.h>
#include <e2lf/recon/reconstruct.h>

int main() {
  const auto path = e2lf::bundled_file("models/e2lf-n4-geometry.safetensors");
  if (!path) return 1;
  auto model = e2lf::model::read_model(*path);
  if (!model) {
    std::printf("%s\n", model.error().text().c_str());
    return 2;
  }
  const auto reconstructor = e2lf::recon::Reconstructor::create(std::move(*model));
  if (!reconstructor) return 3;
  const auto light_field = reconstructor->reconstruct(e2lf::capture::EventImages(3, 16, 24));
  std::printf("%s\n", path->c_str());
  return light_field && light_field->shape().width == 24 ? 0 : 4;
}
