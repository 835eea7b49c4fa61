// events_to_light_field MODEL.safetensors EVENTS.npz FOLDER
// Reconstructs the light field of the first cycle and writes its 64 views into a folder.
#include <cstdio>
#include <e2lf/capture/measurement/event_image_io.h>
#include <e2lf/lightfield/light_field_io.h>
#include <e2lf/model/model.h>
#include <e2lf/recon/reconstruct.h>

int main(int count, char** arguments) {
  if (count != 4) return 2;
  const auto fail = [](const e2lf::Error& error) {
    std::fprintf(stderr, "%s\n", error.text().c_str());
    return 1;
  };
  auto model = e2lf::model::read_model(arguments[1]);
  if (!model) return fail(model.error());
  const auto events = e2lf::capture::read_event_images(arguments[2]);
  if (!events) return fail(events.error());
  const auto reconstructor = e2lf::recon::Reconstructor::create(std::move(*model));
  if (!reconstructor) return fail(reconstructor.error());
  auto light_field = reconstructor->reconstruct(events->cycles.front());
  if (!light_field) return fail(light_field.error());
  const float gain = e2lf::recon::auto_gain(*light_field);
  for (float& value : light_field->data()) value *= gain;
  const auto written = e2lf::lightfield::write_light_field(arguments[3], *light_field);
  return written ? 0 : fail(written.error());
}
