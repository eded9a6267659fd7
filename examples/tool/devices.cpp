// The devices command: what there is to compute on, and why not where there isn't.

#include "commands.hpp"
#include "device_list.hpp"
#include "options.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace skybark::tool {

namespace {

using json = nlohmann::ordered_json;

json as_json(const device_info& device) {
    return {{"index", device.index},
            {"name", device.name},
            {"driver", device.driver},
            {"api", device.api},
            {"limits",
             {{"max_buffer_bytes", device.limits.max_buffer_bytes},
              {"view_alignment", device.limits.view_alignment},
              {"max_elements", device.limits.max_elements},
              {"max_image_size", device.limits.max_image_size}}}};
}

json as_json(const backend_info& backend) {
    json out{{"name", backend.name}, {"available", backend.unavailable.empty()}};
    if (!backend.unavailable.empty()) {
        out["reason"] = backend.unavailable;
    }
    out["devices"] = json::array();
    for (const device_info& device : backend.devices) {
        out["devices"].push_back(as_json(device));
    }
    return out;
}

void print(const backend_info& backend) {
    std::printf("%s\n", backend.name.c_str());
    if (!backend.unavailable.empty()) {
        std::printf("  unavailable: %s\n", backend.unavailable.c_str());
    }
    for (const device_info& device : backend.devices) {
        std::printf("  %u: %s\n     %s; %s\n     buffers up to %llu MiB, images up to %u x %u\n",
                    device.index, device.name.c_str(), device.api.c_str(), device.driver.c_str(),
                    static_cast<unsigned long long>(device.limits.max_buffer_bytes >> 20u),
                    device.limits.max_image_size, device.limits.max_image_size);
    }
}

int run_devices(bool as_text) {
    const backend_info backends[] = {list_cpu(), list_opengl(), list_vulkan()};
    if (as_text) {
        for (const backend_info& backend : backends) {
            print(backend);
        }
        return exit_done;
    }
    json all{{"backends", json::array()}};
    for (const backend_info& backend : backends) {
        all["backends"].push_back(as_json(backend));
    }
    std::printf("%s\n", all.dump(2, ' ', false, json::error_handler_t::replace).c_str());
    return exit_done;
}

} // namespace

command add_devices_command(CLI::App& to) {
    const auto json_wanted = std::make_shared<bool>(false);
    CLI::App* devices = to.add_subcommand("devices", "Name the backends and their devices");
    devices->add_flag("--json", *json_wanted, "As JSON");
    return {"devices", [json_wanted] { return run_devices(!*json_wanted); }};
}

} // namespace skybark::tool
