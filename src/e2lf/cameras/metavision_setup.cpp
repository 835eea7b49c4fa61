// SPDX-License-Identifier: MIT
// Compiled only where the vendor's open HAL is found.
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <map>
#include <metavision/hal/device/device.h>
#include <metavision/hal/facilities/i_antiflicker_module.h>
#include <metavision/hal/facilities/i_erc_module.h>
#include <metavision/hal/facilities/i_event_trail_filter_module.h>
#include <metavision/hal/facilities/i_geometry.h>
#include <metavision/hal/facilities/i_hw_identification.h>
#include <metavision/hal/facilities/i_ll_biases.h>
#include <metavision/hal/facilities/i_roi.h>
#include <metavision/hal/facilities/i_trigger_in.h>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::cameras {
namespace fs = std::filesystem;
namespace {

using Channel = Metavision::I_TriggerIn::Channel;

Error has_no(const std::string& what) {
  return {ErrorCode::kUnsupported, cat("the camera has no ", what, "; leave the option out"), "camera://metavision"};
}

Error refuses(const std::string& what) {
  return {ErrorCode::kInvalidValue, cat("the camera rejects ", what), "camera://metavision"};
}

std::string channel_name(Channel channel) {
  return channel == Channel::Main ? "main" : channel == Channel::Aux ? "aux" : "loopback";
}

/// Formats trigger channels, e.g. "main=0, aux=6".
std::string channels_text(const std::map<Channel, short>& channels) {
  std::vector<std::string> names;
  for (const auto& [channel, id] : channels) names.push_back(cat(channel_name(channel), "=", id));
  return join(names);
}

/// Enables trigger inputs, which are initially disabled. The loopback channel is the output of the camera itself and
/// would add triggers that have no external cause.
Result<void> switch_on_triggers(Metavision::I_TriggerIn* triggers, const std::vector<std::string>& wanted) {
  if (triggers == nullptr) return wanted.empty() ? Result<void>() : has_no("trigger inputs");
  const auto channels = triggers->get_available_channels();
  for (const auto& [channel, id] : channels) {
    const auto is_this = [channel = channel, id = id](const std::string& name) {
      return name == channel_name(channel) || name == cat(id);
    };
    const bool is_on = wanted.empty() ? channel != Channel::Loopback : std::ranges::any_of(wanted, is_this);
    if (!is_on) continue;
    if (triggers->enable(channel) && triggers->is_enabled(channel)) continue;
    const Error refusal =
        refuses(cat("to switch on its trigger input ", channel_name(channel), "; unplug it and plug it in again"));
    if (!wanted.empty() || channel == Channel::Main) return refusal;
    log_warning(refusal.text());  // the user did not request this setting
  }
  for (const std::string& name : wanted) {
    const bool is_known = name == "none" || std::ranges::any_of(channels, [&](const auto& known) {
                            return name == channel_name(known.first) || name == cat(known.second);
                          });
    if (!is_known) return has_no(cat("trigger input ", name, " among ", channels_text(channels)));
  }
  return {};
}

Result<void> limit_events(Metavision::I_ErcModule* controller, uint32_t events_per_s) {
  if (controller == nullptr) return has_no("event rate controller");
  if (events_per_s == 0) {
    return controller->enable(false) ? Result<void>() : refuses("to switch off its event rate controller; try without");
  }
  if (controller->set_cd_event_rate(events_per_s) && controller->enable(true)) return {};
  return refuses(cat(events_per_s, " events/s; its controller takes ", controller->get_min_supported_cd_event_rate(),
                     " to ", controller->get_max_supported_cd_event_rate()));
}

Result<void> limit_regions(Metavision::I_ROI* roi, const Metavision::I_Geometry* geometry,
                           const std::vector<SensorRegion>& regions) {
  if (roi == nullptr) return has_no("regions of its sensor");
  std::vector<Metavision::I_ROI::Window> windows;
  for (const SensorRegion& region : regions) {
    const bool is_inside = region.x >= 0 && region.y >= 0 && region.width > 0 && region.height > 0 &&
                           (geometry == nullptr || (region.x <= geometry->get_width() - region.width &&
                                                    region.y <= geometry->get_height() - region.height));
    if (!is_inside) {
      return refuses(cat("the region ", region.x, ",", region.y, ",", region.width, ",", region.height,
                         "; give one within its sensor"));
    }
    windows.emplace_back(region.x, region.y, region.width, region.height);
  }
  if (roi->set_windows(windows) && roi->enable(true)) return {};
  return refuses(cat(windows.size(), " regions; it takes up to ", roi->get_max_supported_windows_count()));
}

/// Switches off a filter of events, if the camera has it.
template <typename Filter>
Result<void> switch_off(Filter* filter, const char* name) {
  if (filter == nullptr || !filter->is_enabled() || (filter->enable(false) && !filter->is_enabled())) return {};
  return refuses(cat("to switch off its ", name, "; leave the setting out"));
}

std::string regions_text(const Metavision::I_ROI& roi) {
  if (!roi.is_enabled()) return "all";
  std::vector<std::string> windows;
  for (const auto& window : roi.get_windows()) {
    windows.push_back(cat(window.x, ",", window.y, ",", window.width, ",", window.height));
  }
  return windows.empty() ? "on" : join(windows, " ");
}

/// Returns the settings as read back from the camera.
std::vector<std::pair<std::string, std::string>> settings_of(Metavision::Device& device) {
  std::vector<std::pair<std::string, std::string>> settings;
  if (const auto* const triggers = device.get_facility<Metavision::I_TriggerIn>()) {
    auto channels = triggers->get_available_channels();
    std::erase_if(channels, [triggers](const auto& channel) { return !triggers->is_enabled(channel.first); });
    settings.emplace_back("trigger_channels", channels.empty() ? "none" : channels_text(channels));
  }
  if (const auto* const biases = device.get_facility<Metavision::I_LL_Biases>()) {
    std::vector<std::string> values;
    for (const auto& [name, value] : biases->get_all_biases()) values.push_back(cat(name, "=", value));
    settings.emplace_back("biases", join(values));
  }
  if (const auto* const controller = device.get_facility<Metavision::I_ErcModule>()) {
    settings.emplace_back("max_events_per_s", controller->is_enabled() ? cat(controller->get_cd_event_rate()) : "off");
  }
  if (const auto* const roi = device.get_facility<Metavision::I_ROI>())
    settings.emplace_back("regions", regions_text(*roi));
  if (const auto* const filter = device.get_facility<Metavision::I_AntiFlickerModule>()) {
    settings.emplace_back("anti_flicker", filter->is_enabled() ? "on" : "off");
  }
  if (const auto* const filter = device.get_facility<Metavision::I_EventTrailFilterModule>()) {
    settings.emplace_back("event_trail_filter", filter->is_enabled() ? "on" : "off");
  }
  return settings;
}

/// Returns the range of a bias, or that of all biases of current sensors if the HAL states none.
std::pair<int, int> bias_range(const Metavision::I_LL_Biases& biases, const std::string& name) {
  Metavision::LL_Bias_Info info;
  return biases.get_bias_info(name, info) ? info.get_bias_range() : std::pair(-100, 255);
}

std::string evt_version(const std::string& format) {
  if (format.starts_with("EVT3")) return "3.0";
  return format.starts_with("EVT21") || format.starts_with("EVT2.1") ? "2.1" : "2.0";
}

std::string local_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::localtime_r(&now, &parts);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts)};
}

/// Returns a header with these keys and the present date, up to "% end". Keys without a value are left out.
std::string camera_header(std::map<std::string, std::string> keys) {
  keys.erase("end");
  keys.emplace("date", local_time());
  std::string text;
  for (const auto& [key, value] : keys) {
    if (!value.empty()) text += cat("% ", key, " ", header_text(value), "\n");
  }
  return text + "% end\n";
}

}  // namespace

Result<void> set_up_device(Metavision::Device& device, const CameraSetup& setup) {
  if (!setup.biases.empty()) {
    auto* const biases = device.get_facility<Metavision::I_LL_Biases>();
    if (biases == nullptr) return has_no("biases");
    if (!is_file(setup.biases)) {
      return fail(ErrorCode::kNotFound, setup.biases, "there is no such file of biases; check the path");
    }
    try {
      biases->load_from_file(setup.biases.string());
    } catch (const std::exception& failure) {
      return fail(ErrorCode::kInvalidValue, setup.biases, "the camera rejects these biases (", hal_text(failure),
                  "); give a file made for it");
    }
  }
  if (setup.max_events_per_s) {
    E2LF_RETURN_IF_ERROR(limit_events(device.get_facility<Metavision::I_ErcModule>(), *setup.max_events_per_s));
  }
  if (!setup.regions.empty()) {
    E2LF_RETURN_IF_ERROR(limit_regions(device.get_facility<Metavision::I_ROI>(),
                                       device.get_facility<Metavision::I_Geometry>(), setup.regions));
  }
  if (setup.switches_filters_off) {
    E2LF_RETURN_IF_ERROR(switch_off(device.get_facility<Metavision::I_AntiFlickerModule>(), "anti-flicker filter"));
    E2LF_RETURN_IF_ERROR(switch_off(device.get_facility<Metavision::I_EventTrailFilterModule>(), "event trail filter"));
  }
  return switch_on_triggers(device.get_facility<Metavision::I_TriggerIn>(), setup.trigger_channels);
}

std::vector<CameraControl> device_controls(Metavision::Device& device) {
  std::vector<CameraControl> controls;
  if (const auto* const biases = device.get_facility<Metavision::I_LL_Biases>()) {
    for (const auto& [name, value] : biases->get_all_biases()) {
      const auto [least, most] = bias_range(*biases, name);
      controls.push_back({name, std::to_string(value), std::min(least, value), std::max(most, value)});
    }
  }
  if (const auto* const controller = device.get_facility<Metavision::I_ErcModule>()) {
    controls.push_back({"max-event-rate", controller->is_enabled() ? cat(controller->get_cd_event_rate()) : "0", 0,
                        controller->get_max_supported_cd_event_rate()});
  }
  if (const auto* const roi = device.get_facility<Metavision::I_ROI>()) {
    controls.push_back({"roi", regions_text(*roi)});
  }
  return controls;
}

Result<void> change_device(Metavision::Device& device, const std::string& name, const std::string& value) {
  if (name == "roi") {
    auto* const roi = device.get_facility<Metavision::I_ROI>();
    E2LF_ASSIGN_OR_RETURN(const std::vector<SensorRegion> regions, parse_regions(value));
    if (roi == nullptr || !regions.empty()) {
      return limit_regions(roi, device.get_facility<Metavision::I_Geometry>(), regions);
    }
    return roi->enable(false) ? Result<void>() : refuses("to use its whole sensor; start it again");
  }
  const auto number = parse_number<int64_t>(value);
  if (name == "max-event-rate") {
    if (!number || *number < 0 || *number > UINT32_MAX) return refuses(cat("\"", value, "\" events/s; give a number"));
    return limit_events(device.get_facility<Metavision::I_ErcModule>(), static_cast<uint32_t>(*number));
  }
  auto* const biases = device.get_facility<Metavision::I_LL_Biases>();
  if (biases == nullptr || !biases->get_all_biases().contains(name)) return has_no("bias " + name);
  const auto [least, most] = bias_range(*biases, name);
  if (number && *number >= least && *number <= most && biases->set(name, static_cast<int>(*number))) return {};
  return refuses(cat(name, " ", value, "; give ", least, " to ", most));
}

std::string device_header(Metavision::Device& device) {
  const auto& identity = *device.get_facility<Metavision::I_HW_Identification>();
  auto known = identity.get_header().get_header_map();
  const std::string format = identity.get_current_data_encoding_format();
  known.emplace("sensor_name", identity.get_sensor_info().name_);
  known.emplace("serial_number", identity.get_serial());
  known.emplace("evt", evt_version(format));
  known.emplace("format", format.substr(0, format.find(';')));
  if (const auto* const geometry = device.get_facility<Metavision::I_Geometry>()) {
    known.emplace("geometry", cat(geometry->get_width(), "x", geometry->get_height()));
  }
  for (const auto& [key, value] : settings_of(device)) known[key] = value;
  return camera_header(std::move(known));
}

std::string device_biases(Metavision::Device& device) {
  const auto* const biases = device.get_facility<Metavision::I_LL_Biases>();
  if (biases == nullptr) return {};
  std::string folder = (fs::temp_directory_path() / "e2lf-bias-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return {};
  const fs::path file = fs::path(folder) / "camera.bias";
  biases->save_to_file(file.string());
  const auto bytes = read_file(file);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  return bytes ? std::string(bytes->begin(), bytes->end()) : std::string();
}

}  // namespace e2lf::cameras
